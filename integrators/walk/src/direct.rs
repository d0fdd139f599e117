//! Light that reaches a vertex straight from its source.

use crate::{Collided, Connection, Line, LinePoint, Segment};
use glam::Vec3;
use tyndall_core::{
    Anchor, Geometry, HostTypes, LightDirect, Media, Medium, MediumId, PhaseFunction, Sampler,
    Shading, Spectrum,
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

    /// An estimate of what the medium of a segment scatters towards its start of the light that
    /// arrives straight from the lights, per unit of what the walk carries into it; `carried` says
    /// which channels matter. 0 if photons bring it.
    fn along(
        host: &H,
        segment: &Segment<H>,
        carried: H::Spectrum,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum;
}

/// Photons bring direct light as any other: no capability is asked for, small lights blur.
#[derive(Clone, Copy, Debug, Default)]
pub struct ByPhotons;

/// One light sample and one connection a vertex, or a segment in a medium: sharp shadows, and less
/// noise where lights are few.
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

    fn along(_: &H, _: &Segment<H>, _: H::Spectrum, _: &mut impl Sampler) -> H::Spectrum {
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
        let u = sampler.next();
        connected(host, (from, position, u), towards, scattering, sampler)
    }

    /// At a point sampled by free flight or by the inverse squared distance to a light: see [`Line`].
    fn along(
        host: &H,
        segment: &Segment<H>,
        carried: H::Spectrum,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let Some(medium) = host.medium(segment.medium) else {
            return H::Spectrum::default();
        };
        let line = Line::new(host, medium, segment, carried, sampler);
        let flight = medium.sample_free_flight(&segment.ray, carried, sampler);
        let collided = flight.collision.map(|collision| Collided {
            t: collision.t,
            arriving: carried * flight.weight,
            coefficients: collision.coefficients,
        });
        let light = line.gather(collided, sampler, |point, sampler| {
            let LinePoint {
                position, wo, u, ..
            } = point;
            let phase = medium.phase(position);
            connected(
                host,
                (&Anchor::Point(position), position, u),
                |_| point.medium,
                |wi| H::Spectrum::splat(phase.eval(wo, wi)),
                sampler,
            )
        });
        light.ratio(carried)
    }
}

/// `scattering` of the light that direct sampling finds with `u`, if it arrives.
fn connected<H: Geometry + Shading + Media + LightDirect>(
    host: &H,
    (from, position, u): (&Anchor<H::Hit>, Vec3, [f32; 4]),
    towards: impl Fn(Vec3) -> MediumId,
    scattering: impl Fn(Vec3) -> H::Spectrum,
    sampler: &mut impl Sampler,
) -> H::Spectrum {
    let Some(direct) = host.sample_direct(position, u) else {
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
