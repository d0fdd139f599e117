use tyndall_core::{HostTypes, LightEmission, Rgb, Vacuum};

/// A host that has nothing.
struct Bare;

impl HostTypes for Bare {
    type Spectrum = Rgb;
    type Hit = ();
    type Medium = Vacuum<Rgb>;
}

/// As an integrator that traces light bounds it.
fn traces_photons<H: HostTypes + LightEmission>() {}

fn main() {
    traces_photons::<Bare>();
}
