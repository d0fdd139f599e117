//! Photons on surfaces.

use glam::Vec3;
use tyndall_core::{Geometry, PathFrom, Shading, Spectrum, Surface};

/// Half the thickness of the disc in which photons count, over its radius.
///
/// A ball around a point near a corner also holds photons of the other wall: half a disc of them at
/// the corner, where half of the disc is lost beyond it. In a flat disc they lie in a strip of
/// 0.3 r × 2 r at the most, 19 % of its area. A surface of curvature 1/R leaves the disc by r²/(2R)
/// at its edge, so that no photon of it is lost while r < 0.6 R: what is smaller than that is
/// darkened. A flatter disc would darken more of it, a rounder one take in more light from beside.
const FLATNESS: f32 = 0.3;

/// Rounding of a position, over its largest coordinate: two points of a plane may be so far off it.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// Largest ratio of cosines to the shading and to the geometric normal.
///
/// On a plane few photons arrive at grazing angles, ∝ |wi·n|, and the ratio's mean is finite. On a
/// curved surface the photon's own normal is another, photons arrive at any |wi·n|, and the mean
/// of 1/|wi·n| would diverge. In uniform light on a plane whose shading normal is δ off, the bound
/// costs at most sin²δ/400 of the irradiance: 8e-5 at 10°.
const STEEPEST: f32 = 100.0;

/// Scattering function times cosine, per steradian, above which a direction is sharp. A mirror-like
/// lobe about 10° wide has it; what is diffuse has 1/π at the most.
const SHARP: f32 = 10.0;

/// A point of a surface that gathers photons, seen from `wo`.
///
/// One photon of flux Φ at distance d from it scatters towards `wo` the radiance
///
/// ```text
/// L = f(wo, wi) · |wi·nₛ|/|wi·n| · Φ · K₂(d, r),   wi = −direction of the photon
/// ```
///
/// in W·sr⁻¹·m⁻²: Φ·K₂ is irradiance on the *geometric* surface, which the ratio turns to the one
/// that shading sees; the ratio is bounded by 100. Jensen (1996), "Global Illumination Using Photon
/// Maps"; the ratio: Veach (1997), "Robust Monte Carlo Methods for Light Transport
/// Simulation", §5.3.
#[derive(Clone, Debug)]
pub struct SurfacePoint<'h, H: Geometry + Shading> {
    host: &'h H,
    hit: &'h H::Hit,
    wo: Vec3,
    surface: Surface,
}

impl<'h, H: Geometry + Shading> SurfacePoint<'h, H> {
    /// The point at `hit`; `wo` is a unit vector away from it, towards the sensor.
    pub fn new(host: &'h H, hit: &'h H::Hit, wo: Vec3) -> Self {
        Self {
            host,
            hit,
            wo,
            surface: host.surface(hit),
        }
    }

    /// Where it is.
    #[inline]
    pub fn position(&self) -> Vec3 {
        self.surface.position
    }

    /// Whether a photon at `offset` from the point, within the radius, lies on this surface rather
    /// than on another wall: |n·offset| ≤ 0.3 r, but for rounding.
    #[inline]
    pub fn is_near(&self, offset: Vec3, radius: f32) -> bool {
        let rounding = ROUNDING * self.surface.position.abs().max_element();
        self.surface.geometric_normal.dot(offset).abs() <= FLATNESS * radius + rounding
    }

    /// The radiance towards `wo` of a photon that travels in `photon_direction` with `flux`, times
    /// area: multiply it by the weight of a kernel, 1/unit².
    #[inline]
    pub fn radiance(&self, photon_direction: Vec3, flux: H::Spectrum) -> H::Spectrum {
        let wi = -photon_direction;
        self.scattered(wi) * flux / self.slant(wi)
    }

    /// As [`SurfacePoint::radiance`], but 0 for a photon from a [sharp](SurfacePoint::is_sharp)
    /// direction.
    #[inline]
    pub fn smooth_radiance(&self, photon_direction: Vec3, flux: H::Spectrum) -> H::Spectrum {
        let wi = -photon_direction;
        let scattered = self.scattered(wi);
        if is_sharp(scattered) {
            return H::Spectrum::default();
        }
        scattered * flux / self.slant(wi)
    }

    /// Whether the surface scatters so much of the light from `wi` towards `wo` that photons, which
    /// come from few directions, would show it as noise: f·|wi·nₛ| > 10 per steradian. A walk that
    /// goes on in such directions finds their light better.
    pub fn is_sharp(&self, wi: Vec3) -> bool {
        is_sharp(self.scattered(wi))
    }

    /// f(wo, wi)·|wi·nₛ|.
    #[inline]
    pub fn scattered(&self, wi: Vec3) -> H::Spectrum {
        let cosine = wi.dot(self.surface.shading_normal).abs();
        self.host.bsdf_eval(self.hit, self.wo, wi, PathFrom::Sensor) * cosine
    }

    /// |wi·n|, no less than 1/100 of the cosine to the shading normal.
    #[inline]
    fn slant(&self, wi: Vec3) -> f32 {
        let Surface {
            geometric_normal,
            shading_normal,
            ..
        } = self.surface;
        let least = wi.dot(shading_normal).abs() / STEEPEST;
        wi.dot(geometric_normal)
            .abs()
            .max(least)
            .max(f32::MIN_POSITIVE)
    }
}

fn is_sharp<S: Spectrum>(scattered: S) -> bool {
    scattered.max_channel() > SHARP
}
