//! The caustic of a ball of glass in thin fog, lit by a small lamp: photon beams, photons (the beam
//! radiance estimate) and path tracing, error against time on the same cores.
//!
//!     cargo run --release -p tyndall-photon-beams --example caustic_in_fog
//!     cargo run --release -p tyndall-photon-beams --example caustic_in_fog -- pictures/caustic_in_fog.png
//!
//! The first prints the curves, and takes ten minutes; the second renders the three for equal times
//! beside each other. Two errors are told, both relative, roots of means over
//! the pixels: that of the squared difference from the reference over the squared mean of the picture,
//! which the bright caustic decides, and that of relMSE (ε: the square of a tenth of the mean), for
//! which all pixels count alike. The scene is `scenes/caustic_in_fog.toml`: what the rays of sight meet is fog
//! and glass, so that all of the error is that of light in the fog.
#![allow(clippy::print_stdout)]

mod curves;
mod picture;
mod reference;

use std::error::Error;
use std::path::Path;
use tyndall_beam_radiance::BeamRadiance;
use tyndall_core::{AnyIntegrator, Rgb};
use tyndall_driver::PassStreams;
use tyndall_photon_beams::PhotonBeams;
use tyndall_scene_io::{Scene, SceneFile};

type Host = Scene<Rgb>;
type Method = dyn AnyIntegrator<Host, PassStreams>;

/// The methods, each with the best settings of a few: beams of 10,000 to 100,000 paths a pass and of
/// radii from 0.01 to 0.1, photons of 50,000 to 400,000 paths and of radii of 0.03 and 0.1 or to the
/// 2nd to 30th nearest.
fn methods() -> [(&'static str, Box<Method>); 3] {
    let beams = PhotonBeams::new().paths(40_000).beam_radius(0.02);
    let points = BeamRadiance::new().paths(400_000).nearest(3);
    [
        ("beams", Box::new(beams)),
        ("points", Box::new(points)),
        ("path", Box::new(tyndall_path::Path::new())),
    ]
}

/// The scene, with what is given in place of what its file says.
fn scene(overrides: &[(&str, &str)]) -> Result<Host, tyndall_scene_io::Error> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenes/caustic_in_fog.toml"
    );
    let owned = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    let overrides: Vec<_> = overrides.iter().map(owned).collect();
    SceneFile::load(Path::new(path), &overrides)?.build()
}

fn main() -> Result<(), Box<dyn Error>> {
    match std::env::args_os().nth(1) {
        Some(png) => picture::write(Path::new(&png)),
        None => curves::print(),
    }
}
