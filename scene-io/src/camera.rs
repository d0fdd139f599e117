//! Pinhole and thin lens cameras.

use glam::{Vec2, Vec3};
use tyndall_core::{Ray, SensorConnection, Spectrum, warp};

/// A perspective camera; every point of the film gathers the mean radiance over the lens.
///
/// It looks along +z of its axes, x points right and y up in the picture; the picture's rows run
/// downwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    position: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    resolution: [u32; 2],
    /// Half the width and the height of the picture at distance 1.
    half: Vec2,
    lens: Option<Lens>,
}

/// A thin lens.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    pub(crate) radius: f32,
    /// Distance of the plane that is sharp.
    pub(crate) focus_distance: f32,
}

impl Camera {
    /// A camera at `position` that looks along the unit vector `forward`, `up` not being parallel
    /// to it; `fov` is the horizontal angle in radians.
    pub(crate) fn new(
        position: Vec3,
        forward: Vec3,
        up: Vec3,
        fov: f32,
        resolution: [u32; 2],
        lens: Option<Lens>,
    ) -> Self {
        let right = forward.cross(up).normalize();
        let [width, height] = resolution.map(|n| n as f32);
        let half = (0.5 * fov).tan();
        Self {
            position,
            right,
            up: right.cross(forward),
            forward,
            resolution,
            half: Vec2::new(half, half * height / width),
            lens,
        }
    }

    pub(crate) fn position(&self) -> Vec3 {
        self.position
    }

    pub(crate) fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    fn in_world(&self, v: Vec3) -> Vec3 {
        v.x * self.right + v.y * self.up + v.z * self.forward
    }

    /// The ray through point `u[0..2]` of pixel `px` and point `u[2..4]` of the lens.
    pub(crate) fn ray(&self, px: [u32; 2], u: [f32; 4]) -> Ray {
        let [width, height] = self.resolution.map(|n| n as f32);
        let x = 2.0 * (px[0] as f32 + u[0]) / width - 1.0;
        let y = 1.0 - 2.0 * (px[1] as f32 + u[1]) / height;
        let pinhole = Vec3::new(x * self.half.x, y * self.half.y, 1.0);
        let Some(lens) = self.lens else {
            return Ray::new(self.position, self.in_world(pinhole).normalize());
        };
        let on_lens = (lens.radius * warp::disk([u[2], u[3]])).extend(0.0);
        let direction = pinhole * lens.focus_distance - on_lens;
        let origin = self.position + self.in_world(on_lens);
        Ray::new(origin, self.in_world(direction).normalize())
    }

    /// Density per steradian of directions from a point of the lens: cos⁻³θ/A, A being the
    /// picture's area at distance 1.
    pub(crate) fn pdf_w(&self, direction: Vec3) -> f32 {
        let cos = direction.dot(self.forward);
        1.0 / (4.0 * self.half.x * self.half.y * cos * cos * cos)
    }

    /// The connection of `from` to point `u` of the lens.
    ///
    /// A pixel is the mean of radiance over its area and the lens. Per steradian at the lens point
    /// there are [`Camera::pdf_w`] times their number: over d², that is the importance of a
    /// connection of length d (Veach 1997, §8.2, for this sensor).
    pub(crate) fn connect<S: Spectrum>(
        &self,
        from: Vec3,
        u: [f32; 2],
    ) -> Option<SensorConnection<S>> {
        let lens = self.lens.unwrap_or(Lens {
            radius: 0.0,
            focus_distance: 1.0,
        });
        let on_lens = (lens.radius * warp::disk(u)).extend(0.0);
        let to_lens = self.position + self.in_world(on_lens) - from;
        let (wi, distance) = to_lens.normalize_and_length();
        let (sin_x, sin_y) = (-wi.dot(self.right), -wi.dot(self.up));
        let cos = -wi.dot(self.forward);
        if !(cos > 0.0 && distance > 0.0) {
            return None;
        }
        let sharp = on_lens.truncate() / lens.focus_distance + Vec2::new(sin_x, sin_y) / cos;
        let [width, height] = self.resolution.map(|n| n as f32);
        let raster = [
            0.5 * (1.0 + sharp.x / self.half.x) * width,
            0.5 * (1.0 - sharp.y / self.half.y) * height,
        ];
        let inside =
            raster[0] >= 0.0 && raster[0] < width && raster[1] >= 0.0 && raster[1] < height;
        let pdf_w = self.pdf_w(-wi);
        let weight = pdf_w * width * height / (distance * distance);
        (inside && weight.is_finite()).then(|| SensorConnection {
            raster,
            weight: S::splat(weight),
            wi,
            distance,
            pdf_w,
        })
    }
}
