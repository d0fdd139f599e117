//! What a pass prepares.

use crate::BeamRadiance;
use crate::discs::PhotonDiscs;
use crate::options::{Radii, shrinkage, unsupported};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};
use tyndall_core::{Figure, MediumId, PassError, Spectrum};
use tyndall_density::{Dimension, Schedule};
use tyndall_kd_tree::Photons;
use tyndall_photons::{PhotonMaps, Search};

/// The photons of a pass.
#[derive(Debug)]
pub struct Pass<S> {
    /// At surfaces, straight from lights or through specular surfaces alone.
    pub(crate) caustic: Photons<S>,
    /// At surfaces, scattered before.
    pub(crate) diffuse: Photons<S>,
    /// How the two are searched.
    pub(crate) search: Search,
    /// In media, in the order of their ids.
    media: Vec<PhotonDiscs<S>>,
    /// Radii over those of the start.
    shrink: f32,
    /// Photons whose radii were out of bounds.
    left_out: usize,
    /// Bits of a number that is not negative: they are ordered as the numbers.
    transmittance_error: AtomicU32,
}

impl<S: Spectrum> Pass<S> {
    pub(crate) fn build<D>(
        config: &BeamRadiance<D>,
        maps: PhotonMaps<S>,
        first_path: u64,
    ) -> Result<Self, PassError> {
        let (paths, starting) = (config.emission.paths, config.starting_paths);
        // Two dimensions for balls too: a ray meets r² photons, each for a chord of r/r³.
        let shrinkage = shrinkage(Dimension::Two, config.alpha)?;
        let schedule = Schedule::new(shrinkage, starting).map_err(unsupported)?;
        let shrink = schedule.scale(first_path, paths);
        let search = match config.surfaces.fixed {
            Some(radius) => Search::Within(radius * shrink),
            None => Search::Nearest {
                count: config.surfaces.count(paths, starting),
                max_radius: config.surfaces.max,
                shrink,
            },
        };
        let PhotonMaps {
            caustic,
            diffuse,
            volume,
        } = maps;
        let (bounds, count, blur) = (
            config.volume,
            config.volume.count(paths, starting),
            config.blur,
        );
        let discs = |(medium, photons): (MediumId, Photons<S>)| {
            let radii = radii(bounds, count, &photons, shrink);
            PhotonDiscs::build(medium, &photons, &radii, blur)
        };
        let traced: usize = volume.iter().map(|(_, photons)| photons.len()).sum();
        let media = volume
            .into_par_iter()
            .map(discs)
            .collect::<Result<Vec<_>, _>>()?;
        let kept: usize = media.iter().map(PhotonDiscs::len).sum();
        Ok(Self {
            caustic,
            diffuse,
            search,
            media,
            shrink,
            left_out: traced - kept,
            transmittance_error: AtomicU32::new(0),
        })
    }

    /// The photons of a medium, if it has any.
    pub(crate) fn photons_in(&self, medium: MediumId) -> Option<&PhotonDiscs<S>> {
        let index = self.media.binary_search_by_key(&medium.0, |m| m.medium.0);
        index.ok().map(|i| &self.media[i])
    }

    pub(crate) fn report(&self, error: f32) {
        if error.to_bits() > self.transmittance_error.load(Ordering::Relaxed) {
            self.transmittance_error
                .fetch_max(error.to_bits(), Ordering::Relaxed);
        }
    }

    /// The largest error of a transmittance that [tables](crate::Transmittance::Table) have met so
    /// far, an absolute one; 0 where none was made.
    pub fn transmittance_error(&self) -> f32 {
        f32::from_bits(self.transmittance_error.load(Ordering::Relaxed))
    }

    /// What a reader of the image must know beside the number of photons.
    pub(crate) fn figures(&self) -> impl Iterator<Item = Figure> {
        let left_out = self.left_out as u64;
        let error = self.transmittance_error();
        let left_out = Figure::total("photons left out, their radii out of bounds", left_out);
        let error = Figure::largest("error of transmittance", error);
        let shrink = Figure::range("radius over the starting one", self.shrink);
        let errors = [left_out, error].into_iter().filter(|f| !f.is_zero());
        errors.chain([shrink])
    }

    /// Photons kept in media and on surfaces.
    pub fn photons(&self) -> [usize; 2] {
        let volume = self.media.iter().map(PhotonDiscs::len).sum();
        [volume, self.caustic.len() + self.diffuse.len()]
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let volume: usize = self.media.iter().map(PhotonDiscs::bytes).sum();
        volume + self.caustic.bytes() + self.diffuse.bytes()
    }
}

/// The radius of every photon of a medium. One alone has no density, and
/// no radius unless one is given.
fn radii<S: Spectrum>(bounds: Radii, count: usize, photons: &Photons<S>, scale: f32) -> Vec<f32> {
    if let Some(radius) = bounds.fixed {
        return vec![radius * scale; photons.len()];
    }
    let mut radii = photons.nearest_radii(count, bounds.max);
    radii.par_iter_mut().for_each(|radius| *radius *= scale);
    radii
}
