//! The integrators that the command knows, and what a scene tells them.

use tyndall_beam_radiance::{BeamRadiance, Blur, Transmittance};
use tyndall_core::{AnyIntegrator, Spectrum};
use tyndall_density::Kernel;
use tyndall_driver::PassStreams;
use tyndall_path::{Path, Scattering};
use tyndall_photon_map::PhotonMap;
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_scene_io::{IntegratorConfig, PhotonConfig, Scene};
use tyndall_walk::{ByPhotons, BySampling, DirectLight};

/// Names of integrators.
pub(crate) const INTEGRATORS: [&str; 4] = [
    "path",
    "photon_map",
    "progressive_photon_map",
    "beam_radiance",
];

/// Flights a ray, where they find the transmittance.
const FLIGHTS: u32 = 16;

type Boxed<S> = Box<dyn AnyIntegrator<Scene<S>, PassStreams>>;

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
    let map = with(map, config.radius, PhotonMap::radius);
    let map = with(map, kernel(config), PhotonMap::kernel);
    Box::new(with(map, config.final_gather, PhotonMap::final_gather))
}

fn progressive<S: Spectrum, D: DirectLight<Scene<S>>>(config: &PhotonConfig) -> Boxed<S> {
    let map = ProgressivePhotonMap::<D>::default();
    let map = with(map, config.paths, ProgressivePhotonMap::paths);
    let map = with(map, bytes(config), ProgressivePhotonMap::max_bytes);
    let nearest = config.nearest.map(|count| count as u32);
    let map = with(map, nearest, ProgressivePhotonMap::nearest);
    let map = with(map, config.radius, ProgressivePhotonMap::radius);
    let map = with(map, config.alpha, ProgressivePhotonMap::alpha);
    let map = with(map, kernel(config), ProgressivePhotonMap::kernel);
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
    let beams = with(beams, config.radius, |beams, radius| {
        beams.radius(radius).surface_radius(radius)
    });
    let beams = with(beams, config.alpha, BeamRadiance::alpha);
    let beams = with(beams, kernel(config), BeamRadiance::kernel);
    let balls = (config.blur == Some(3)).then_some(Blur::Ball);
    let beams = with(beams, balls, BeamRadiance::blur);
    let tracking = config.transmittance == Some("tracking");
    let tracking = tracking.then_some(Transmittance::Tracking { flights: FLIGHTS });
    Box::new(with(beams, tracking, BeamRadiance::transmittance))
}

fn bytes(config: &PhotonConfig) -> Option<u64> {
    config.memory.map(|mebibytes| mebibytes << 20)
}

fn kernel(config: &PhotonConfig) -> Option<Kernel> {
    config.kernel.map(|name| match name {
        "constant" => Kernel::Constant,
        "biweight" => Kernel::Biweight,
        "cone" => Kernel::Cone,
        "gaussian" => Kernel::Gaussian,
        _ => Kernel::Epanechnikov,
    })
}

fn scattering(config: &IntegratorConfig) -> Scattering {
    match config.scattering {
        tyndall_scene_io::Scattering::None => Scattering::None,
        tyndall_scene_io::Scattering::Single => Scattering::Single,
        tyndall_scene_io::Scattering::Multiple => Scattering::Multiple,
    }
}

/// The integrator and its settings, for people and for checkpoints.
pub(crate) fn describe(name: &str, config: &IntegratorConfig) -> String {
    if name == "path" {
        let depth = config
            .max_depth
            .map_or("unlimited".into(), |depth| depth.to_string());
        return format!(
            "{name}, max_depth {depth}, {:?} scattering in media",
            scattering(config)
        );
    }
    settings(&config.photons).fold(name.to_owned(), |text, (key, value)| {
        format!("{text}, {key} {value}")
    })
}

/// What the scene says that this integrator does not heed.
fn unheeded(name: &str, config: &IntegratorConfig) -> Vec<&'static str> {
    let only = |key: &'static str| match key {
        "final_gather" => "photon_map",
        "statistics" => "progressive_photon_map",
        "blur" | "transmittance" => "beam_radiance",
        _ => name,
    };
    let of_photons = settings(&config.photons).map(|(key, _)| key);
    if name == "path" {
        return of_photons.collect();
    }
    let depth = config.max_depth.map(|_| "max_depth");
    let scattering = (scattering(config) != Scattering::Multiple).then_some("scattering");
    let alpha = (name == "photon_map" && config.photons.alpha.is_some()).then_some("alpha");
    let others = of_photons.filter(|key| only(key) != name);
    depth
        .into_iter()
        .chain(scattering)
        .chain(alpha)
        .chain(others)
        .collect()
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
        _ => biases.push("biased: photons blur light, less with every pass".into()),
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
    let unheeded = unheeded(name, config);
    biases.extend(
        unheeded
            .iter()
            .map(|key| format!("`{key}` is not for {name}: not heeded")),
    );
    biases
}

/// What the scene says about photons.
fn settings(config: &PhotonConfig) -> impl Iterator<Item = (&'static str, String)> {
    let PhotonConfig {
        paths,
        memory,
        radius,
        nearest,
        alpha,
        kernel,
        sample_lights,
        final_gather,
        statistics,
        blur,
        transmittance,
        ..
    } = config;
    let said = [
        ("paths", paths.map(|x| x.to_string())),
        ("memory", memory.map(|x| x.to_string())),
        ("radius", radius.map(|x| x.to_string())),
        ("nearest", nearest.map(|x| x.to_string())),
        ("alpha", alpha.map(|x| x.to_string())),
        ("kernel", kernel.map(str::to_owned)),
        ("sample_lights", sample_lights.map(|x| x.to_string())),
        ("final_gather", final_gather.map(|x| x.to_string())),
        ("statistics", statistics.map(|x| x.to_string())),
        ("blur", blur.map(|x| x.to_string())),
        ("transmittance", transmittance.map(str::to_owned)),
    ];
    (said.into_iter()).filter_map(|(key, value)| value.map(|value| (key, value)))
}
