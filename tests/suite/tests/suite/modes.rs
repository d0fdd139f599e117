//! The ways in which photons are gathered, for the battery.

use tyndall_beam_radiance::{BeamRadiance, Blur, Transmittance};
use tyndall_core::{AnyIntegrator, Rgb};
use tyndall_driver::PassStreams;
use tyndall_photon_beams::{Estimate, PhotonBeams};
use tyndall_photon_map::PhotonMap;
use tyndall_progressive_photon_map::{ProgressivePhotonMap, Radii};
use tyndall_scene_io::Scene;

pub(crate) type Method = Box<dyn AnyIntegrator<Scene<Rgb>, PassStreams>>;

/// A method and its options.
#[derive(Clone, Copy)]
pub(crate) struct Mode {
    pub(crate) name: &'static str,
    /// With radii times a scale and so many light paths a pass.
    pub(crate) at_scale: fn(f32, u64) -> Method,
    /// The wider of the two scales; the other is half of it.
    pub(crate) scale: f32,
    /// The least and the most of its bias that may be left at half the scale, over what is gone.
    pub(crate) left: [f64; 2],
}

/// In scenes of side 2.
const RADIUS: f32 = 0.12;

/// Of a bias between linear and quadratic in radii that are halved.
const HALVED: [f64; 2] = [1.0 / 3.0, 1.0];
/// In radii that reach to an eighth of the photons: half as far in media, 1/√8 on surfaces.
const AN_EIGHTH: [f64; 2] = [1.0 / 7.0, 1.0];
/// In radii that pixels shrink by what they find: each by another share, a fifth more or less.
const SHRUNK: [f64; 2] = [0.25, 1.5];
/// On surfaces so curved that discs lose photons while they are large, and then none.
const CURVED: [f64; 2] = [0.0, 1.0];

const fn mode(name: &'static str, left: [f64; 2], at_scale: fn(f32, u64) -> Method) -> Mode {
    Mode {
        name,
        at_scale,
        scale: 1.0,
        left,
    }
}

impl Mode {
    /// Where media are no larger than a few radii: what they lose at their boundaries falls more
    /// slowly than radii, until these are small.
    pub(crate) const fn fine(self) -> Self {
        let scale = 0.5 * self.scale;
        Self { scale, ..self }
    }

    /// Where surfaces are curved.
    pub(crate) const fn curved(self) -> Self {
        let left = CURVED;
        Self { left, ..self }
    }
}

/// Photons as far as which radii reach.
fn nearest(scale: f32) -> usize {
    (24.0 * scale.powi(3)).round() as usize
}

fn map<D>(map: PhotonMap<D>, scale: f32, paths: u64) -> PhotonMap<D> {
    map.paths(paths).radius(RADIUS * scale)
}

fn progressive<D>(map: ProgressivePhotonMap<D>, scale: f32, paths: u64) -> ProgressivePhotonMap<D> {
    map.paths(paths).radius(RADIUS * scale).alpha(1.0)
}

fn beams<D>(beams: BeamRadiance<D>, scale: f32, paths: u64) -> BeamRadiance<D> {
    let beams = beams.paths(paths).alpha(1.0);
    beams.radius(RADIUS * scale).surface_radius(RADIUS * scale)
}

pub(crate) const MAP: Mode = mode("photon_map", HALVED, |scale, paths| {
    Box::new(map(PhotonMap::new(), scale, paths))
});
pub(crate) const MAP_FINAL: Mode = mode("photon_map, final gathering", HALVED, |scale, paths| {
    Box::new(map(PhotonMap::new(), scale, paths).final_gather(2))
});
pub(crate) const MAP_SAMPLED: Mode = mode("photon_map, lights sampled", HALVED, |scale, paths| {
    Box::new(map(PhotonMap::sampling_lights(), scale, paths))
});
pub(crate) const MAP_SAMPLED_FINAL: Mode = mode(
    "photon_map, lights sampled, final gathering",
    HALVED,
    |scale, paths| Box::new(map(PhotonMap::sampling_lights(), scale, paths).final_gather(2)),
);
pub(crate) const MAP_NEAREST: Mode = mode("photon_map, nearest", AN_EIGHTH, |scale, paths| {
    Box::new(PhotonMap::new().paths(paths).nearest(nearest(scale)))
});

pub(crate) const PROGRESSIVE: Mode = mode("progressive_photon_map", HALVED, |scale, paths| {
    Box::new(progressive(ProgressivePhotonMap::new(), scale, paths))
});
pub(crate) const PROGRESSIVE_SAMPLED: Mode = mode(
    "progressive_photon_map, lights sampled",
    HALVED,
    |scale, paths| {
        let map = ProgressivePhotonMap::sampling_lights();
        Box::new(progressive(map, scale, paths))
    },
);
pub(crate) const STATISTICS: Mode = mode(
    "progressive_photon_map, statistics",
    SHRUNK,
    |scale, paths| {
        let map = ProgressivePhotonMap::new().paths(paths);
        let map = map.radius(RADIUS * scale).starting_paths(16 * paths);
        Box::new(map.radii(Radii::Statistics))
    },
);
pub(crate) const STATISTICS_SAMPLED: Mode = mode(
    "progressive_photon_map, statistics, lights sampled",
    SHRUNK,
    |scale, paths| {
        let map = ProgressivePhotonMap::sampling_lights().paths(paths);
        let map = map.radius(RADIUS * scale).starting_paths(16 * paths);
        Box::new(map.radii(Radii::Statistics))
    },
);

pub(crate) const BEAMS: Mode = mode("beam_radiance", HALVED, |scale, paths| {
    Box::new(beams(BeamRadiance::new(), scale, paths))
});
pub(crate) const BEAMS_SAMPLED_BALLS: Mode = mode(
    "beam_radiance, lights sampled, balls",
    HALVED,
    |scale, paths| {
        let beams = beams(BeamRadiance::sampling_lights(), scale, paths);
        Box::new(beams.blur(Blur::Ball))
    },
);
pub(crate) const BEAMS_NEAREST: Mode = mode("beam_radiance, nearest", AN_EIGHTH, |scale, paths| {
    let beams = BeamRadiance::new().paths(paths).starting_paths(paths);
    let beams = beams.nearest(nearest(scale)).alpha(1.0);
    Box::new(beams.surface_nearest(nearest(scale)))
});
pub(crate) const BEAMS_TRACKING: Mode = mode("beam_radiance, tracking", HALVED, |scale, paths| {
    let tracking = Transmittance::Tracking { flights: 2 };
    Box::new(beams(BeamRadiance::new(), scale, paths).transmittance(tracking))
});
pub(crate) const BEAMS_TRACKING_BALLS: Mode = mode(
    "beam_radiance, tracking, lights sampled, balls",
    HALVED,
    |scale, paths| {
        let tracking = Transmittance::Tracking { flights: 2 };
        let beams = beams(BeamRadiance::sampling_lights(), scale, paths).blur(Blur::Ball);
        Box::new(beams.transmittance(tracking))
    },
);

/// Beams are met by far more rays than photons.
fn photon_beams<D>(beams: PhotonBeams<D>, scale: f32, paths: u64) -> PhotonBeams<D> {
    let radius = RADIUS * scale;
    let beams = beams.paths(paths / 4).alpha(1.0).beam_radius(radius);
    beams.radius(radius).surface_radius(radius)
}

pub(crate) const BEAMS1D: Mode = mode("photon_beams", HALVED, |scale, paths| {
    Box::new(photon_beams(PhotonBeams::new(), scale, paths))
});
pub(crate) const BEAMS2D_SAMPLED: Mode = mode(
    "photon_beams, lights sampled, 2D",
    HALVED,
    |scale, paths| {
        let beams = photon_beams(PhotonBeams::sampling_lights(), scale, paths);
        Box::new(beams.estimator(Estimate::BeamBeam2DRay))
    },
);
pub(crate) const BEAMS_DIFFERENTIALS: Mode =
    mode("photon_beams, differentials", HALVED, |scale, paths| {
        let beams = photon_beams(PhotonBeams::new(), scale, paths);
        let beams = beams.starting_paths(paths / 4);
        Box::new(beams.beam_differentials(2.0 * scale))
    });
pub(crate) const BEAMS_NEAREST_ENDS: Mode =
    mode("photon_beams, nearest ends", HALVED, |scale, paths| {
        let beams = photon_beams(PhotonBeams::new(), scale, paths);
        let beams = beams.starting_paths(paths / 4);
        Box::new(beams.beam_nearest(nearest(scale)))
    });
