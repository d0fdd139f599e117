//! Points on surfaces and their scattering.

use glam::Vec3;

/// The geometry of a point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// In scene units.
    pub position: Vec3,
    /// Unit normal of the true geometry; it does not turn towards the viewer.
    pub geometric_normal: Vec3,
    /// Unit normal for shading, on the same side as the geometric one.
    pub shading_normal: Vec3,
}

/// What an integrator must know of a surface before it asks for directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceKind {
    /// Light passes straight through: the boundary of a medium of equal index. No bounce. It may
    /// emit.
    Null,
    /// Directions are discrete only (mirror, smooth glass): `bsdf_eval` is zero, photons are not
    /// stored here and lights are not connected to.
    Delta,
    /// `bsdf_eval` may be positive. `bsdf_sample` may still return delta samples, and marks them.
    Finite,
}

/// The end of a path that an estimator started from.
///
/// The names say where the *path* started, since renderers use the words radiance and importance
/// with opposite meanings. Refraction and shading normals are not symmetric (Veach 1997, §5.2–5.3);
/// correcting for it is the host's duty inside `bsdf_*`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathFrom {
    /// The path started at the sensor and carries importance: it gathers radiance.
    Sensor,
    /// The path started at a light and carries flux.
    Light,
}

/// A sampled direction at a surface.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<S> {
    /// Unit vector away from the surface.
    pub wi: Vec3,
    /// f·|cos θ|/pdf; for a delta sample its reflectance or transmittance over its probability.
    pub weight: S,
    /// Density per steradian; 0 for a delta sample.
    pub pdf_w: f32,
    /// Whether the direction is discrete.
    pub delta: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`; 1 for a reflection.
    /// Radiance scales with its square, which Russian roulette must not take for a loss.
    pub eta: f32,
}
