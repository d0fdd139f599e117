//! The integrators that the command knows, and what a scene tells them.

use tyndall_beam_radiance::{BeamRadiance, Blur, Transmittance};
use tyndall_core::{AnyIntegrator, Spectrum};
use tyndall_driver::PassStreams;
use tyndall_path::{Path, Scattering};
use tyndall_photon_beams::{Extent, PhotonBeams};
use tyndall_photon_map::PhotonMap;
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_scene_io::{IntegratorConfig, PhotonConfig, Place, Scene};
use tyndall_walk::{ByPhotons, BySampling, DirectLight};

/// Names of integrators.
pub(crate) const INTEGRATORS: [&str; 5] = [
    "path",
    "photon_map",
    "progressive_photon_map",
    "beam_radiance",
    "photon_beams",
];

/// What is said of methods whose radii shrink from pass to pass.
pub(crate) const SHRINKING: &str = "biased: photons blur light, less with every pass";

/// Flights a ray, where they find the transmittance.
const FLIGHTS: u32 = 16;

/// An integrator of scenes.
pub(crate) type Integrator<S> = dyn AnyIntegrator<Scene<S>, PassStreams>;

type Boxed<S> = Box<Integrator<S>>;

/// The integrator of this name, as the scene configures it.
pub(crate) fn integrator<S: Spectrum>(name: &str, config: &IntegratorConfig) -> Option<Boxed<S>> {
    let photons = &config.photons;
    let sampled = photons.sample_lights == Some(true);
    Some(match (name, sampled) {
        ("path", _) => Box::new(
            Path::new()
                .max_depth(config.max_depth)
                .scattering(scattering(config)),
        ),
        ("photon_map", false) => photon_map::<S, ByPhotons>(photons),
        ("photon_map", true) => photon_map::<S, BySampling>(photons),
        ("progressive_photon_map", false) => progressive::<S, ByPhotons>(photons),
        ("progressive_photon_map", true) => progressive::<S, BySampling>(photons),
        ("beam_radiance", false) => beam_radiance::<S, ByPhotons>(photons),
        ("beam_radiance", true) => beam_radiance::<S, BySampling>(photons),
        ("photon_beams", false) => photon_beams::<S, ByPhotons>(photons),
        ("photon_beams", true) => photon_beams::<S, BySampling>(photons),
        _ => return None,
    })
}

/// `integrator` with an option set, if the scene says so.
fn with<I, T>(integrator: I, option: Option<T>, set: impl FnOnce(I, T) -> I) -> I {
    match option {
        Some(value) => set(integrator, value),
        None => integrator,
    }
}

fn photon_map<S: Spectrum, D: DirectLight<Scene<S>>>(config: &PhotonConfig) -> Boxed<S> {
    let map = PhotonMap::<D>::default();
    let map = with(map, config.paths, PhotonMap::paths);
    let map = with(map, bytes(config), PhotonMap::max_bytes);
    let map = with(map, config.nearest, PhotonMap::nearest);
    let map = with(map, config.max_radius, PhotonMap::max_radius);
    let map = with(map, config.radius, PhotonMap::radius);
    let map = with(map, config.kernel, PhotonMap::kernel);
    Box::new(with(map, config.final_gather, PhotonMap::final_gather))
}

fn progressive<S: Spectrum, D: DirectLight<Scene<S>>>(config: &PhotonConfig) -> Boxed<S> {
    let map = ProgressivePhotonMap::<D>::default();
    let map = with(map, config.paths, ProgressivePhotonMap::paths);
    let map = with(map, bytes(config), ProgressivePhotonMap::max_bytes);
    let map = with(map, config.nearest, ProgressivePhotonMap::nearest);
    let map = with(map, config.max_radius, ProgressivePhotonMap::max_radius);
    let map = with(map, config.radius, ProgressivePhotonMap::radius);
    let map = with(map, config.alpha, ProgressivePhotonMap::alpha);
    let map = with(map, config.kernel, ProgressivePhotonMap::kernel);
    let statistics = config.statistics == Some(true);
    let radii = statistics.then_some(Radii::Statistics);
    Box::new(with(map, radii, ProgressivePhotonMap::radii))
}

fn beam_radiance<S: Spectrum, D: DirectLight<Scene<S>>>(config: &PhotonConfig) -> Boxed<S> {
    let beams = BeamRadiance::<D>::default();
    let beams = with(beams, config.paths, BeamRadiance::paths);
    let beams = with(beams, bytes(config), BeamRadiance::max_bytes);
    let beams = with(beams, config.nearest, |beams, count| {
        beams.nearest(count).surface_nearest(count)
    });
    let beams = with(beams, config.max_radius, |beams, radius| {
        beams.max_radius(radius).surface_max_radius(radius)
    });
    let beams = with(beams, config.radius, |beams, radius| {
        beams.radius(radius).surface_radius(radius)
    });
    let beams = with(beams, config.surface_nearest, BeamRadiance::surface_nearest);
    let beams = with(
        beams,
        config.surface_max_radius,
        BeamRadiance::surface_max_radius,
    );
    let beams = with(beams, config.surface_radius, BeamRadiance::surface_radius);
    let beams = with(beams, config.alpha, BeamRadiance::alpha);
    let beams = with(beams, config.kernel, BeamRadiance::kernel);
    let balls = (config.blur == Some(3)).then_some(Blur::Ball);
    let beams = with(beams, balls, BeamRadiance::blur);
    let transmittance = transmittance(config);
    Box::new(with(beams, transmittance, BeamRadiance::transmittance))
}

fn photon_beams<S: Spectrum, D: DirectLight<Scene<S>>>(config: &PhotonConfig) -> Boxed<S> {
    let extent = |short| if short { Extent::Short } else { Extent::Long };
    let beams = PhotonBeams::<D>::default();
    let beams = with(beams, config.paths, PhotonBeams::paths);
    let beams = with(beams, bytes(config), PhotonBeams::max_bytes);
    let beams = with(beams, config.estimator, PhotonBeams::estimator);
    let beams = with(beams, config.beam_radius, PhotonBeams::beam_radius);
    let scale = config.beam_differentials;
    let beams = with(beams, scale, PhotonBeams::beam_differentials);
    let beams = with(beams, config.beam_nearest, PhotonBeams::beam_nearest);
    let light = config.short_light_beams.map(extent);
    let beams = with(beams, light, PhotonBeams::light_beams);
    let sight = config.short_sight_beams.map(extent);
    let beams = with(beams, sight, PhotonBeams::sight_beams);
    let beams = with(beams, config.light_flights, PhotonBeams::light_flights);
    let beams = with(beams, config.nearest, |beams, count| {
        beams.nearest(count).surface_nearest(count)
    });
    let beams = with(beams, config.max_radius, |beams, radius| {
        beams.max_radius(radius).surface_max_radius(radius)
    });
    let beams = with(beams, config.radius, |beams, radius| {
        beams.radius(radius).surface_radius(radius)
    });
    let beams = with(beams, config.surface_nearest, PhotonBeams::surface_nearest);
    let beams = with(
        beams,
        config.surface_max_radius,
        PhotonBeams::surface_max_radius,
    );
    let beams = with(beams, config.surface_radius, PhotonBeams::surface_radius);
    let beams = with(beams, config.alpha, PhotonBeams::alpha);
    let beams = with(beams, config.kernel, PhotonBeams::kernel);
    let transmittance = transmittance(config);
    Box::new(with(beams, transmittance, PhotonBeams::transmittance))
}

fn transmittance(config: &PhotonConfig) -> Option<Transmittance> {
    config.tracking.map(|tracking| match tracking {
        true => Transmittance::Tracking { flights: FLIGHTS },
        false => Transmittance::default(),
    })
}

fn bytes(config: &PhotonConfig) -> Option<u64> {
    config.memory.map(|mebibytes| mebibytes << 20)
}

fn scattering(config: &IntegratorConfig) -> Scattering {
    match config.scattering {
        tyndall_scene_io::Scattering::None => Scattering::None,
        tyndall_scene_io::Scattering::Single => Scattering::Single,
        tyndall_scene_io::Scattering::Multiple => Scattering::Multiple,
    }
}

/// The integrator and its options, defaults filled in: for people and for checkpoints.
pub(crate) fn describe<S: Spectrum>(name: &str, integrator: &Integrator<S>) -> String {
    let options = integrator.options_any().into_iter();
    options.fold(name.to_owned(), |text, (key, value)| {
        format!("{text}, {key} {value}")
    })
}

/// What the scene says that this integrator does not heed, a sentence each.
pub(crate) fn unheeded<S: Spectrum>(
    name: &str,
    integrator: &Integrator<S>,
    config: &IntegratorConfig,
) -> Vec<String> {
    let options = integrator.options_any();
    let heeds = |key: &str| {
        let key = if key == "memory" { "max_bytes" } else { key };
        options.iter().any(|(option, _)| *option == key)
    };
    let unheeded = config.set.iter().filter(|(key, _)| !heeds(key));
    let sentence = |(key, place): &(String, Place)| {
        format!("{place}: `integrator.{key}`: {name} does not heed it: remove it")
    };
    unheeded.map(sentence).collect()
}

/// What is wrong with the image, however well it is sampled.
pub(crate) fn biases(name: &str, config: &IntegratorConfig) -> Vec<String> {
    let mut biases = Vec::new();
    match name {
        "path" => {}
        "photon_map" => biases.push("biased: photons blur light, however many the passes".into()),
        _ if config.photons.alpha == Some(1.0) => {
            biases.push("biased: photons blur light, however many the passes (alpha)".into());
        }
        _ => biases.push(SHRINKING.into()),
    }
    if let ("path", Some(depth)) = (name, config.max_depth) {
        biases.push(format!(
            "biased: paths of more than {depth} scatterings are left out (max_depth)"
        ));
    }
    match scattering(config) {
        _ if name != "path" => {}
        Scattering::Multiple => {}
        Scattering::Single => {
            biases.push("light that media scatter more than once is left out (scattering)".into())
        }
        Scattering::None => {
            biases.push("light that media scatter is left out (scattering)".into());
        }
    }
    biases
}
