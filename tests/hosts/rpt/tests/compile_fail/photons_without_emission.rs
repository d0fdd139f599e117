use tyndall_core::{HostTypes, LightEmission};
use tyndall_host_rpt::RptHost;

/// As an integrator that traces light bounds it.
fn traces_photons<H: HostTypes + LightEmission>() {}

fn main() {
    traces_photons::<RptHost>();
}
