//! Light that reaches a vertex straight from its source.

use crate::Connection;
use glam::Vec3;
use tyndall_core::{
    Anchor, Geometry, HostTypes, LightDirect, Media, MediumId, Sampler, Shading, Spectrum,
};

/// How a method finds the light that nothing has scattered before: by its photons, or by sampling
/// the lights. Never by both, or it counts twice.
#[diagnostic::on_unimplemented(
    message = "`{Self}` finds no direct light on the host `{H}`",
    note = "`BySampling` needs `LightDirect` of the host; `ByPhotons` does not"
)]
pub trait DirectLight<H: HostTypes>: Sync + 'static {
    /// Whether photons on a [`Route::Direct`](crate::Route::Direct) count.
    const BY_PHOTONS: bool;

    /// An estimate of ∫ `scattering`(wi) L(wi) dwi over the light L that arrives at `from` straight
    /// from the lights, through the media (and null surfaces) in between; 0 if photons bring it.
    /// `towards` is the medium in which a direction leaves `from`.
    fn scattered(
        host: &H,
        from: &Anchor<H::Hit>,
        position: Vec3,
        towards: impl Fn(Vec3) -> MediumId,
        scattering: impl Fn(Vec3) -> H::Spectrum,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum;
}

/// Photons bring direct light as any other: no capability is asked for, small lights blur.
#[derive(Clone, Copy, Debug, Default)]
pub struct ByPhotons;

/// One light sample and one connection a vertex: sharp shadows, and less noise where lights are few.
#[derive(Clone, Copy, Debug, Default)]
pub struct BySampling;

impl<H: HostTypes> DirectLight<H> for ByPhotons {
    const BY_PHOTONS: bool = true;

    fn scattered(
        _: &H,
        _: &Anchor<H::Hit>,
        _: Vec3,
        _: impl Fn(Vec3) -> MediumId,
        _: impl Fn(Vec3) -> H::Spectrum,
        _: &mut impl Sampler,
    ) -> H::Spectrum {
        H::Spectrum::default()
    }
}

impl<H: Geometry + Shading + Media + LightDirect> DirectLight<H> for BySampling {
    const BY_PHOTONS: bool = false;

    fn scattered(
        host: &H,
        from: &Anchor<H::Hit>,
        position: Vec3,
        towards: impl Fn(Vec3) -> MediumId,
        scattering: impl Fn(Vec3) -> H::Spectrum,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let Some(direct) = host.sample_direct(position, sampler.next()) else {
            return H::Spectrum::default();
        };
        let scattered = scattering(direct.wi);
        if scattered.is_black() {
            return scattered;
        }
        let visible = Connection::new(host, from, &direct.target, towards(direct.wi))
            .transmittance(host, sampler);
        direct.weight * scattered * visible
    }
}
