//! What a host offers: one capability a trait.
//!
//! An integrator bounds on just those it uses; what a host lacks is an error of the compiler that
//! says so in a sentence. Methods stand on the host, not on the hit, because an adapter crate may
//! not implement a foreign trait for a foreign type.

use crate::{
    Aabb, Anchor, BsdfSample, DirectSample, EmissionPdf, EmissionSample, Medium, MediumId,
    PathFrom, Ray, SensorConnection, SensorRay, Spectrum, Surface, SurfaceKind,
};
use glam::Vec3;

/// The types that every capability shares.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a host of Tyndall",
    note = "implement `tyndall_core::HostTypes`: its spectrum, its hit and its medium"
)]
pub trait HostTypes: Sync {
    /// Channels of radiance.
    type Spectrum: Spectrum;
    /// A point on a surface as the host remembers it; small, for it is cloned.
    type Hit: Clone + Send + Sync;
    /// What fills space; [`Vacuum`](crate::Vacuum) if nothing does.
    type Medium: Medium<Spectrum = Self::Spectrum>;
}

/// Where surfaces are.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not say where its surfaces are",
    note = "implement `tyndall_core::Geometry`: intersection, spawned rays, occlusion"
)]
pub trait Geometry: HostTypes {
    /// A box around all surfaces and bounded lights: empty if there are none, infinite where they
    /// are. An integrator that derives a length from it needs a rule for both.
    fn bounds(&self) -> Aabb;

    /// The nearest surface within the ray, and its distance. The ray travels in `here`: a host
    /// with nested boundaries keeps in the hit what its scattering needs to know of it (the index
    /// of refraction on this side, or that a boundary of lower priority is not there at all).
    fn intersect(&self, ray: &Ray, here: MediumId) -> Option<(f32, Self::Hit)>;

    /// The geometry of a hit.
    fn surface(&self, hit: &Self::Hit) -> Surface;

    /// The infinite ray leaving `from` in the unit direction `direction`, started where it cannot
    /// meet the surface it leaves again: a walk that crosses null surfaces advances, or it would
    /// never end.
    ///
    /// # Panics
    /// May panic if `from` is [`Anchor::Direction`], which is nowhere.
    fn spawn(&self, from: &Anchor<Self::Hit>, direction: Vec3) -> Ray;

    /// The ray that ends just before `to`, so that neither end is met.
    ///
    /// # Panics
    /// As [`Geometry::spawn`].
    fn connect(&self, from: &Anchor<Self::Hit>, to: &Anchor<Self::Hit>) -> Ray;

    /// Whether a surface lies within the ray. Asked only if the host says that no surface is
    /// [`SurfaceKind::Null`], see [`Media::has_null_surfaces`].
    fn occluded(&self, ray: &Ray) -> bool;
}

/// How surfaces scatter and emit.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not say how its surfaces scatter and emit light",
    note = "implement `tyndall_core::Shading`"
)]
pub trait Shading: HostTypes {
    /// What the surface is.
    fn surface_kind(&self, hit: &Self::Hit) -> SurfaceKind;

    /// The scattering function f per steradian, without the cosine; zero for discrete directions.
    /// An integrator multiplies by the cosine between `wi` and the shading normal nₛ. Both ends
    /// agree: f(wo, wi, Sensor)·|wi·nₛ|/|wi·n| = f(wi, wo, Light)·|wo·nₛ|/|wo·n|.
    fn bsdf_eval(&self, hit: &Self::Hit, wo: Vec3, wi: Vec3, from: PathFrom) -> Self::Spectrum;

    /// A direction, or `None` if the path ends here.
    fn bsdf_sample(
        &self,
        hit: &Self::Hit,
        wo: Vec3,
        u: [f32; 3],
        from: PathFrom,
    ) -> Option<BsdfSample<Self::Spectrum>>;

    /// Radiance that the surface emits towards `wo`.
    fn emitted(&self, hit: &Self::Hit, wo: Vec3) -> Self::Spectrum;

    /// Radiance arriving from infinity against the unit direction of travel `direction` of a ray
    /// that left the scene.
    fn background(&self, direction: Vec3) -> Self::Spectrum;
}

/// The density of sampled directions at surfaces.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not tell the density of the directions that it samples at surfaces",
    note = "implement `tyndall_core::ShadingPdf`, or pick an integrator that needs no multiple importance sampling"
)]
pub trait ShadingPdf: Shading {
    /// Density per steradian of [`Shading::bsdf_sample`] at `wi`, discrete directions left out.
    fn bsdf_pdf_w(&self, hit: &Self::Hit, wo: Vec3, wi: Vec3, from: PathFrom) -> f32;
}

/// What fills space.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not say what fills its space",
    note = "implement `tyndall_core::Media`; a host without media returns `None` and stays in `MediumId::VACUUM`"
)]
pub trait Media: HostTypes {
    /// The medium of an id; `None` for vacuum.
    fn medium(&self, id: MediumId) -> Option<&Self::Medium>;

    /// The medium behind the surface for light that arrives in `here` and leaves the hit along
    /// `direction`. A direction that does not cross the surface stays in `here`. Nested and
    /// overlapping boundaries are the host's to resolve.
    fn medium_across(&self, hit: &Self::Hit, direction: Vec3, here: MediumId) -> MediumId;

    /// Whether any surface is, or may turn out to be, [`SurfaceKind::Null`]: if so, connections
    /// walk from surface to surface instead of asking [`Geometry::occluded`].
    fn has_null_surfaces(&self) -> bool {
        true
    }
}

/// Light leaving its sources: photons, beams, virtual lights.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot emit light paths",
    note = "implement `tyndall_core::LightEmission`, or pick an integrator that starts at the sensor only"
)]
pub trait LightEmission: HostTypes {
    /// An emitted ray; `None` if this `u` emits nothing. `u[0]` chooses the light, so that
    /// stratifying it stratifies the choice.
    fn sample_emission(&self, u: [f32; 6]) -> Option<EmissionSample<Self::Spectrum, Self::Hit>>;
}

/// Light arriving from its sources: next event estimation.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot sample the light that arrives at a point",
    note = "implement `tyndall_core::LightDirect`"
)]
pub trait LightDirect: HostTypes {
    /// Light arriving at `from`; `None` if this `u` finds none.
    fn sample_direct(
        &self,
        from: Vec3,
        u: [f32; 4],
    ) -> Option<DirectSample<Self::Spectrum, Self::Hit>>;

    /// The point near which light that [`LightDirect::sample_direct`] finds with the same `u`
    /// matters to the points of `ray`; `None` for light from infinity. Points along the ray are
    /// sampled with a density that falls with the squared distance from it (equiangular sampling).
    ///
    /// For a point on a lamp: that point. For a beam of light of radius r: a point at distance r
    /// from where the axis comes nearest to the ray. Any answer is unbiased; a good one has less
    /// variance.
    fn pivot(&self, ray: &Ray, u: [f32; 4]) -> Option<Vec3> {
        let _ = (ray, u);
        None
    }
}

/// The densities of light sampling.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not tell the densities with which it samples its lights",
    note = "implement `tyndall_core::LightPdf`, or pick an integrator that needs no multiple importance sampling"
)]
pub trait LightPdf: HostTypes {
    /// Density per steradian of [`LightDirect::sample_direct`] at `from` for light arriving from
    /// `to`: a hit seen from there, or the direction to the background. 0 for what is no light.
    fn pdf_direct_w(&self, from: Vec3, to: &Anchor<Self::Hit>) -> f32;

    /// Densities of [`LightEmission::sample_emission`] for light leaving `at` (a hit, or the
    /// direction to the background) along `direction`.
    fn pdf_emission(&self, at: &Anchor<Self::Hit>, direction: Vec3) -> EmissionPdf;
}

/// Where pictures are taken.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no sensor",
    note = "implement `tyndall_core::Sensor`: its resolution and its rays"
)]
pub trait Sensor: HostTypes {
    /// Width and height in pixels.
    fn resolution(&self) -> [u32; 2];

    /// A ray through pixel `px`; `u[0..2]` places it within the pixel, `u[2..4]` on the lens.
    fn sensor_ray(&self, px: [u32; 2], u: [f32; 4]) -> SensorRay<Self::Spectrum>;
}

/// Connections from the scene to the sensor: light tracing, bidirectional methods.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot connect a point of the scene to its sensor",
    note = "implement `tyndall_core::SensorImportance`, or pick an integrator that does not trace light to the sensor"
)]
pub trait SensorImportance: Sensor {
    /// A connection; `None` if the sensor does not see `from`.
    fn connect_sensor(&self, from: Vec3, u: [f32; 2]) -> Option<SensorConnection<Self::Spectrum>>;
}
