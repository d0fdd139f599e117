//! Sensors that measure what the closed forms state.

use glam::{Vec2, Vec3};
use std::f32::consts::PI;
use tyndall_core::{Frame, Ray, SensorConnection, Spectrum, warp};

/// What is measured.
#[derive(Clone, Debug)]
pub enum View {
    /// Radiance along fixed rays, one a pixel, in a row.
    Rays(Vec<Ray>),
    /// Fluence at a point, ∫ L dω over the sphere: one pixel.
    Fluence {
        /// The point.
        position: Vec3,
    },
    /// Flux per area through a point, ∫ L cos θ dω over the hemisphere that the sensor looks into:
    /// one pixel.
    Flux {
        /// The point.
        position: Vec3,
        /// Unit normal of the measured area, the axis of that hemisphere.
        towards: Vec3,
    },
    /// Orthographic row of pixels: parallel rays whose origins fill the edge from that of `first`.
    Row {
        /// The first ray of the row.
        first: Ray,
        /// From the first origin to the last.
        edge: Vec3,
        /// Number of pixels.
        pixels: u32,
    },
    /// Pinhole camera; x of the image runs along one vector across `forward`, y along another.
    Pinhole {
        /// The eye.
        eye: Vec3,
        /// Unit direction of the middle of the image.
        forward: Vec3,
        /// Tangent of half the field of view.
        half_width: f32,
        /// Pixels of the square image in each axis.
        pixels: u32,
    },
}

impl View {
    pub(super) fn resolution(&self) -> [u32; 2] {
        match self {
            Self::Rays(rays) => [rays.len() as u32, 1],
            Self::Fluence { .. } | Self::Flux { .. } => [1, 1],
            Self::Row { pixels, .. } => [*pixels, 1],
            Self::Pinhole { pixels, .. } => [*pixels; 2],
        }
    }

    /// The ray of a pixel and its weight: 1 for radiance, 1/`pdf_w` (times the cosine) for an
    /// integral over directions.
    pub(super) fn ray(&self, px: [u32; 2], u: [f32; 4]) -> (Ray, f32) {
        match self {
            Self::Rays(rays) => (rays[px[0] as usize], 1.0),
            Self::Fluence { position } => {
                let direction = warp::uniform_sphere([u[0], u[1]]);
                (Ray::new(*position, direction), 4.0 * PI)
            }
            Self::Flux { position, towards } => {
                let local = warp::cosine_hemisphere([u[0], u[1]]);
                let direction = Frame::around(*towards).to_world(local);
                (Ray::new(*position, direction), PI)
            }
            Self::Row {
                first,
                edge,
                pixels,
            } => {
                let share = (px[0] as f32 + u[0]) / *pixels as f32;
                (Ray::new(first.origin + share * *edge, first.direction), 1.0)
            }
            Self::Pinhole {
                eye,
                forward,
                half_width,
                pixels,
            } => {
                let raster = Vec2::new(px[0] as f32 + u[0], px[1] as f32 + u[1]);
                let film = (2.0 * raster / *pixels as f32 - 1.0) * *half_width;
                let direction = Frame::around(*forward).to_world(film.extend(1.0));
                (Ray::new(*eye, direction.normalize()), 1.0)
            }
        }
    }

    /// Density per steradian of the directions of a pinhole, cos⁻³θ over the area of the image at
    /// distance 1; 0 for the others, which nothing connects to.
    pub(super) fn pdf_w(&self, direction: Vec3) -> f32 {
        match self {
            Self::Pinhole {
                forward,
                half_width,
                ..
            } => (4.0 * half_width * half_width * direction.dot(*forward).powi(3)).recip(),
            _ => 0.0,
        }
    }

    /// The connection of `from` to a pinhole that sees it. Its weight is the density times the
    /// number of pixels over the squared distance (Veach 1997, §8.2).
    pub(super) fn connect<S: Spectrum>(&self, from: Vec3) -> Option<SensorConnection<S>> {
        let Self::Pinhole {
            eye,
            forward,
            half_width,
            pixels,
        } = self
        else {
            return None;
        };
        let (wi, distance) = (*eye - from).normalize_and_length();
        let local = Frame::around(*forward).to_local(-wi);
        let film = local.truncate() / (local.z * *half_width);
        let raster = 0.5 * (film + 1.0) * *pixels as f32;
        let inside = raster.min_element() >= 0.0 && raster.max_element() < *pixels as f32;
        let pdf_w = self.pdf_w(-wi);
        let weight = pdf_w * (*pixels as f32 / distance).powi(2);
        (local.z > 0.0 && inside && weight.is_finite()).then(|| SensorConnection {
            raster: raster.into(),
            weight: S::splat(weight),
            wi,
            distance,
            pdf_w,
        })
    }
}
