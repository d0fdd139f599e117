//! The photons of a pass.

use crate::{Emission, Traced, unsupported};
use std::collections::BTreeMap;
use tyndall_core::{
    Geometry, LightEmission, Media, MediumId, PassContext, PassError, Shading, Spectrum, Streams,
};
use tyndall_kd_tree::{Photon, Photons};
use tyndall_walk::{DirectLight, Flight};

/// The photons of a pass at surfaces, by what light met before.
#[derive(Clone, Debug, Default)]
pub struct SurfacePhotons<S> {
    /// Straight from the lights (if photons bring direct light) or through specular surfaces alone.
    pub caustic: Photons<S>,
    /// Scattered before.
    pub diffuse: Photons<S>,
}

impl<S: Spectrum> SurfacePhotons<S> {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.caustic.len() + self.diffuse.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        self.caustic.bytes() + self.diffuse.bytes()
    }
}

/// The photons of a pass, by what light met before and where it arrives.
#[derive(Clone, Debug)]
pub struct PhotonMaps<S> {
    /// At surfaces.
    pub surfaces: SurfacePhotons<S>,
    /// At collisions, a map for each medium that has any, in the order of ids. Their flux is what
    /// the medium scatters: what arrives, times the albedo there.
    pub volume: Vec<(MediumId, Photons<S>)>,
    /// Photons dropped, see [`Traced::lost`].
    pub lost: u64,
}

impl<S: Spectrum> PhotonMaps<S> {
    /// Traces the light paths of a pass. Photons are stored at collisions, unless the albedo is
    /// zero, and at surfaces that scatter into many directions.
    ///
    /// # Errors
    /// See [`Traced::trace`].
    pub fn trace<H, D, R>(
        host: &H,
        cx: &PassContext<'_, R>,
        emission: Emission,
    ) -> Result<Self, PassError>
    where
        H: Geometry<Spectrum = S> + Shading + Media + LightEmission,
        D: DirectLight<H>,
        R: Streams,
    {
        let paths = emission.light_paths(cx);
        let traced = Traced::trace::<H, D, R>(host, paths, emission, |flight, _, keep| {
            if let Some(photon) = collided(flight) {
                keep.push((flight.medium, photon));
            }
        })?;
        let mut volume = VolumeLists::new(traced.media().copied(), traced.bytes(), emission)?;
        let (surfaces, lost, media) = traced.split();
        media.for_each(|(medium, photon)| volume.push(medium, photon));
        Ok(Self {
            surfaces,
            lost: lost + volume.lost(),
            volume: volume.maps()?,
        })
    }

    /// How many there are, in media and on surfaces.
    pub fn photons(&self) -> [usize; 2] {
        let volume = self.volume.iter().map(|(_, photons)| photons.len()).sum();
        [volume, self.surfaces.len()]
    }

    /// The photons in a medium, if there are any.
    pub fn in_medium(&self, id: MediumId) -> Option<&Photons<S>> {
        let index = self.volume.binary_search_by_key(&id.0, |(id, _)| id.0);
        index.ok().map(|i| &self.volume[i].1)
    }
}

/// The photon of a flight that collided, unless all is absorbed there: it carries what scatters.
pub fn collided<S: Spectrum>(flight: &Flight<S>) -> Option<Photon<S>> {
    let collision = flight.collision?;
    let photon = Photon {
        position: flight.ray.at(collision.t),
        direction: flight.ray.direction,
        flux: flight.end * collision.coefficients.albedo(),
    };
    (!photon.flux.is_black()).then_some(photon)
}

/// Photons of media on their way into maps, a list each.
#[derive(Debug)]
pub struct VolumeLists<S> {
    lists: BTreeMap<u32, Vec<Photon<S>>>,
    lost: u64,
}

impl<S: Spectrum> VolumeLists<S> {
    /// Room for those that maps can hold. `held` bytes are taken already.
    ///
    /// # Errors
    /// [`PassError::Memory`].
    pub fn new(
        photons: impl Iterator<Item = (MediumId, Photon<S>)>,
        held: usize,
        emission: Emission,
    ) -> Result<Self, PassError> {
        let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
        for (medium, _) in photons.filter(|(_, photon)| photon.is_storable()) {
            *counts.entry(medium.0).or_default() += 1;
        }
        let all: usize = counts.values().sum();
        emission.allow(held + all * size_of::<Photon<S>>())?;
        let list = |(medium, count)| (medium, Vec::with_capacity(count));
        Ok(Self {
            lists: counts.into_iter().map(list).collect(),
            lost: 0,
        })
    }

    /// Adds a photon, if maps can hold it.
    pub fn push(&mut self, medium: MediumId, photon: Photon<S>) {
        if photon.is_storable() {
            self.lists.entry(medium.0).or_default().push(photon);
        } else {
            self.lost += 1;
        }
    }

    /// Photons that were not added.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// A map for each medium that has photons, in the order of ids.
    ///
    /// # Errors
    /// [`PassError::Unsupported`] for more photons than a map can number.
    pub fn maps(self) -> Result<Vec<(MediumId, Photons<S>)>, PassError> {
        let map = |(medium, list): (u32, Vec<_>)| {
            let photons = Photons::build(&list).map_err(unsupported)?;
            Ok((MediumId(medium), photons))
        };
        self.lists.into_iter().map(map).collect()
    }
}
