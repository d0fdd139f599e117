//! Where the weights of multiple importance sampling take their densities from.

use glam::Vec3;
use tyndall_core::{Anchor, HostTypes, LightPdf, PathFrom, ShadingPdf};

/// Densities of what a path and a light sample can both find.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no densities for the host `{H}`",
    note = "`Mis` needs `ShadingPdf` and `LightPdf` of the host; `Path::with_unhittable_lights` needs neither"
)]
pub trait Densities<H: HostTypes>: Sync {
    /// Density per steradian of scattering at a surface from `wo` to `wi`.
    fn bsdf_pdf_w(host: &H, hit: &H::Hit, wo: Vec3, wi: Vec3) -> f32;

    /// Density per steradian of direct sampling at `from` for light arriving from `to`.
    fn direct_pdf_w(host: &H, from: Vec3, to: &Anchor<H::Hit>) -> f32;
}

/// Asks the host.
#[derive(Clone, Copy, Debug)]
pub struct Mis;

impl<H: ShadingPdf + LightPdf> Densities<H> for Mis {
    fn bsdf_pdf_w(host: &H, hit: &H::Hit, wo: Vec3, wi: Vec3) -> f32 {
        host.bsdf_pdf_w(hit, wo, wi, PathFrom::Sensor)
    }

    fn direct_pdf_w(host: &H, from: Vec3, to: &Anchor<H::Hit>) -> f32 {
        host.pdf_direct_w(from, to)
    }
}

/// No light that is sampled directly can be hit, and none that can be hit is sampled.
#[derive(Clone, Copy, Debug)]
pub struct UnhittableLights;

impl<H: HostTypes> Densities<H> for UnhittableLights {
    fn bsdf_pdf_w(_: &H, _: &H::Hit, _: Vec3, _: Vec3) -> f32 {
        0.0
    }

    fn direct_pdf_w(_: &H, _: Vec3, _: &Anchor<H::Hit>) -> f32 {
        0.0
    }
}
