//! What a pass prepares.

use rayon::prelude::*;
use tyndall_core::{Figure, MediumId, PassError, Spectrum};
use tyndall_kd_tree::{Photon, Photons};
use tyndall_photons::{Blur, Emission, Largest, PhotonDiscs, PhotonMaps, Search, SurfacePhotons};

/// Bytes that a photon in a medium takes at most, in its map and while its disc is built.
const PEAK: usize = 128;

/// The photons of a pass.
#[derive(Debug)]
pub struct Pass<S> {
    pub(crate) surfaces: SurfacePhotons<S>,
    /// How those are searched.
    pub(crate) search: Search,
    /// In media, in the order of their ids.
    media: Vec<(MediumId, PhotonDiscs<S>)>,
    /// Radii over those of the start.
    shrink: f32,
    /// Photons whose radii were out of bounds.
    left_out: usize,
    pub(crate) error: Largest,
    /// See [`PhotonMaps::lost`].
    pub(crate) lost: u64,
}

impl<S: Spectrum> Pass<S> {
    pub(crate) fn build(
        emission: Emission,
        maps: PhotonMaps<S>,
        search: Search,
        volume: Search,
        blur: Blur,
        shrink: f32,
    ) -> Result<Self, PassError> {
        let discs = |(medium, photons): (MediumId, Photons<S>)| {
            Ok((medium, PhotonDiscs::build(&photons, volume, blur)?))
        };
        let [traced, on_surfaces] = maps.photons();
        emission.allow(PEAK * traced + size_of::<Photon<S>>() * on_surfaces)?;
        let media = maps.volume.into_par_iter().map(discs);
        let media = media.collect::<Result<Vec<_>, PassError>>()?;
        let kept: usize = media.iter().map(|(_, discs)| discs.len()).sum();
        Ok(Self {
            surfaces: maps.surfaces,
            search,
            media,
            shrink,
            left_out: traced - kept,
            error: Largest::default(),
            lost: maps.lost,
        })
    }

    /// The photons of a medium, if it has any.
    pub(crate) fn photons_in(&self, medium: MediumId) -> Option<&PhotonDiscs<S>> {
        let index = self.media.binary_search_by_key(&medium.0, |(id, _)| id.0);
        index.ok().map(|i| &self.media[i].1)
    }

    /// The largest error of a transmittance that [tables](crate::Transmittance::Table) have met so
    /// far, an absolute one; 0 where none was made.
    pub fn transmittance_error(&self) -> f32 {
        self.error.get()
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
        let volume = self.media.iter().map(|(_, discs)| discs.len()).sum();
        [volume, self.surfaces.len()]
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let volume: usize = self.media.iter().map(|(_, discs)| discs.bytes()).sum();
        volume + self.surfaces.bytes()
    }
}
