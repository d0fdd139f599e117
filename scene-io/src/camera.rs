//! Perspective and orthographic cameras.

mod film;
mod filter;

pub(crate) use film::Film;
pub(crate) use filter::{Filter, Shape as FilterShape};

use crate::image_out::View;
use glam::{DVec3, Vec2, Vec3};
use tyndall_core::{Ray, SensorConnection, Spectrum, warp};

/// A camera; every point of the film gathers the mean radiance over the lens, if it has one.
///
/// It looks along +z of its axes, x points right and y up in the picture; the picture's rows run
/// downwards.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    pose: Pose,
    projection: Projection,
    /// Half the width and the height of the whole picture, at distance 1 in a perspective.
    half: Vec2,
    film: Film,
}

/// Where a camera is, and its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    position: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
}

/// An angle or a length across the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Across {
    Width(f32),
    Height(f32),
}

/// How the rays of a camera run.
#[derive(Clone, Copy, Debug)]
enum Projection {
    /// Through a point, or the points of a lens.
    Perspective(Option<Lens>),
    /// Parallel, from the plane through the camera's position.
    Orthographic,
}

/// A thin lens.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    pub(crate) radius: f32,
    /// Distance of the plane that is sharp.
    pub(crate) focus_distance: f32,
}

impl Pose {
    /// At `position`, looking along the unit vector `forward`, with `up` (of any length) not
    /// parallel to it.
    pub(crate) fn new(position: Vec3, forward: Vec3, up: Vec3) -> Self {
        let right = forward.cross(up).normalize();
        Self {
            position,
            right,
            up: right.cross(forward),
            forward,
        }
    }

    fn in_world(&self, v: Vec3) -> Vec3 {
        v.x * self.right + v.y * self.up + v.z * self.forward
    }
}

impl Across {
    fn map(self, f: impl FnOnce(f32) -> f32) -> Self {
        match self {
            Self::Width(x) => Self::Width(f(x)),
            Self::Height(x) => Self::Height(f(x)),
        }
    }

    /// Both half sides of the picture.
    fn halves(self, film: &Film) -> Vec2 {
        let [width, height] = film.picture().map(|n| n as f32);
        0.5 * match self {
            Self::Width(x) => Vec2::new(x, x * height / width),
            Self::Height(y) => Vec2::new(y * width / height, y),
        }
    }
}

impl Camera {
    /// A perspective camera: a pinhole, or with a lens. `fov` is an angle in radians, between 0
    /// and π.
    pub(crate) fn perspective(pose: Pose, fov: Across, lens: Option<Lens>, film: Film) -> Self {
        Self {
            pose,
            projection: Projection::Perspective(lens),
            half: fov.map(|angle| 2.0 * (0.5 * angle).tan()).halves(&film),
            film,
        }
    }

    /// A camera whose picture has this `size` in scene units, at any distance.
    pub(crate) fn orthographic(pose: Pose, size: Across, film: Film) -> Self {
        Self {
            pose,
            projection: Projection::Orthographic,
            half: size.halves(&film),
            film,
        }
    }

    pub(crate) fn position(&self) -> Vec3 {
        self.pose.position
    }

    pub(crate) fn resolution(&self) -> [u32; 2] {
        self.film.resolution()
    }

    /// A ray of pixel `px`, and the weight of its radiance in the pixel: `u[0..2]` is spent by the
    /// reconstruction filter, `u[2..4]` on the lens.
    pub(crate) fn ray(&self, px: [u32; 2], u: [f32; 4]) -> (Ray, f32) {
        let (raster, weight) = self.film.sample(px, [u[0], u[1]]);
        let [width, height] = self.film.picture().map(|n| n as f32);
        let x = (2.0 * raster[0] / width - 1.0) * self.half.x;
        let y = (1.0 - 2.0 * raster[1] / height) * self.half.y;
        let Pose {
            position, forward, ..
        } = self.pose;
        let ray = match self.projection {
            Projection::Orthographic => {
                let on_film = Vec3::new(x, y, 0.0);
                Ray::new(position + self.pose.in_world(on_film), forward)
            }
            Projection::Perspective(None) => {
                let through = Vec3::new(x, y, 1.0);
                Ray::new(position, self.pose.in_world(through).normalize())
            }
            Projection::Perspective(Some(lens)) => {
                let on_lens = (lens.radius * warp::disk([u[2], u[3]])).extend(0.0);
                let direction = Vec3::new(x, y, 1.0) * lens.focus_distance - on_lens;
                let origin = position + self.pose.in_world(on_lens);
                Ray::new(origin, self.pose.in_world(direction).normalize())
            }
        };
        (ray, weight)
    }

    /// Density per steradian of directions from a point of the lens: cos⁻³θ/A, A being the area of
    /// the film at distance 1. It takes rays as uniform over the film, whatever the filter: all it
    /// serves is to weigh techniques, which must but agree on it. 0 where rays are parallel.
    pub(crate) fn pdf_w(&self, direction: Vec3) -> f32 {
        match self.projection {
            Projection::Orthographic => 0.0,
            Projection::Perspective(_) => {
                let cos = direction.dot(self.pose.forward);
                let area = 4.0 * self.half.x * self.half.y * self.film.share();
                1.0 / (area * cos * cos * cos)
            }
        }
    }

    /// The connection of `from` to point `u` of the lens; `None` for parallel rays, which meet no
    /// given point.
    ///
    /// A pixel is the filtered mean of radiance over the film and the lens. Per steradian at the
    /// lens point there are [`Camera::pdf_w`] times their number: over d², that is the importance
    /// of a connection of length d (Veach 1997, §8.2, for this sensor).
    ///
    /// A pinhole spends `u` on the filter. A lens spends it, as [`Camera::ray`] does; the filter
    /// then takes numbers that are hashed from it.
    pub(crate) fn connect<S: Spectrum>(
        &self,
        from: Vec3,
        u: [f32; 2],
    ) -> Option<SensorConnection<S>> {
        let Projection::Perspective(lens) = self.projection else {
            return None;
        };
        let on_lens = lens.map_or(Vec2::ZERO, |lens| lens.radius * warp::disk(u));
        let pose = &self.pose;
        let to_lens = pose.position + pose.in_world(on_lens.extend(0.0)) - from;
        let (wi, distance) = to_lens.normalize_and_length();
        let (sin_x, sin_y) = (-wi.dot(pose.right), -wi.dot(pose.up));
        let cos = -wi.dot(pose.forward);
        if !(cos > 0.0 && distance > 0.0) {
            return None;
        }
        let sharp = lens.map_or(Vec2::ZERO, |lens| on_lens / lens.focus_distance)
            + Vec2::new(sin_x, sin_y) / cos;
        let [width, height] = self.film.picture().map(|n| n as f32);
        let place = [
            0.5 * (1.0 + sharp.x / self.half.x) * width,
            0.5 * (1.0 - sharp.y / self.half.y) * height,
        ];
        let u = if lens.is_some() { hashed(u) } else { u };
        let (raster, filtered) = self.film.splat(place, u)?;
        let pdf_w = self.pdf_w(-wi);
        let pixels = width * height * self.film.share();
        let weight = filtered * (pdf_w * pixels / (distance * distance));
        weight.is_finite().then(|| SensorConnection {
            raster,
            weight: S::splat(weight),
            wi,
            distance,
            pdf_w,
        })
    }

    /// What an image file says of the camera; `origin` is the point of the scene file that is 0
    /// here.
    pub(crate) fn view(&self, origin: DVec3) -> View {
        let Pose {
            position,
            right,
            up,
            forward,
        } = self.pose;
        let position = position.as_dvec3() + origin;
        let axes = [right, up, -forward].map(Vec3::as_dvec3);
        View {
            picture: self.film.picture(),
            offset: self.film.offset(),
            axes: axes.map(|axis| axis.as_vec3()),
            shift: DVec3::from(axes.map(|axis| -axis.dot(position))).as_vec3(),
            screen_width: 2.0 * self.half.x,
        }
    }
}

/// Two numbers of 24 bits that the lens has not seen: the finaliser of SplitMix64 (Steele, Lea &
/// Flood 2014).
fn hashed(u: [f32; 2]) -> [f32; 2] {
    let mut x = u64::from(u[0].to_bits()) << 32 | u64::from(u[1].to_bits());
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    [x >> 40, x & 0xff_ffff].map(|bits| bits as f32 / (1 << 24) as f32)
}
