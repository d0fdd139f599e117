use tyndall_core::Integrator;
use tyndall_host_rpt::RptHost;
use tyndall_path::Path;

fn renders<I: Integrator<RptHost>>(_: I) {}

fn main() {
    renders(Path::with_unhittable_lights());
    renders(Path::new());
}
