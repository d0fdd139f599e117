//! What a pass prepares.

use crate::Estimate;
use crate::beam::Left;
use crate::width::Radii;
use std::collections::BTreeMap;
use tyndall_bvh::{BeamShape, Beams};
use tyndall_core::{Figure, MediumId, PassError, Spectrum};
use tyndall_kd_tree::Photons;
use tyndall_photons::{
    Blur, Emission, Largest, PhotonDiscs, Search, SurfacePhotons, Traced, VolumeLists, unsupported,
};

/// Bytes that a beam takes at most while its tree is built, beside the list of what was traced.
const PEAK: usize = 768;

/// The light of a pass.
#[derive(Debug)]
pub struct Pass<S> {
    /// Photons at surfaces.
    pub(crate) surfaces: SurfacePhotons<S>,
    /// How those are searched.
    pub(crate) search: Search,
    /// How points in media are.
    pub(crate) volume: Search,
    pub(crate) media: BTreeMap<u32, InMedium<S>>,
    /// Radius of beams over that of the start.
    shrink: f32,
    /// Of transmittance along rays of sight, the largest.
    pub(crate) error: Largest,
    lost: u64,
}

/// The light in a medium.
#[derive(Debug, Default)]
pub(crate) struct InMedium<S> {
    pub(crate) beams: Option<LightBeams<S>>,
    pub(crate) points: Option<Points<S>>,
}

/// Photons in a medium, as the estimator asks for them.
#[derive(Debug)]
pub(crate) enum Points<S> {
    Marched(Photons<S>),
    Along(PhotonDiscs<S>),
}

/// The beams in a medium.
#[derive(Debug)]
pub(crate) struct LightBeams<S> {
    pub(crate) tree: Beams,
    /// At their starts, in W.
    flux: Vec<S>,
    /// Transmittance along them where there is no closed form: so many steps each, or none.
    steps: Vec<(f32, S)>,
    steps_each: usize,
}

impl<S: Spectrum> LightBeams<S> {
    /// The flux of a beam at distance `v`, but for a transmittance that has a closed form.
    #[inline]
    pub(crate) fn flux(&self, beam: usize, v: f32) -> S {
        let flux = self.flux[beam];
        if self.steps_each == 0 {
            return flux;
        }
        let steps = &self.steps[beam * self.steps_each..][..self.steps_each];
        let before = steps.partition_point(|(t, _)| *t <= v);
        steps
            .get(before)
            .map_or(S::default(), |(_, transmittance)| flux * *transmittance)
    }

    fn bytes(&self) -> usize {
        self.tree.bytes() + size_of_val(self.flux.as_slice()) + size_of_val(self.steps.as_slice())
    }
}

/// Beams of a medium before their tree is built.
#[derive(Default)]
pub(crate) struct List<S> {
    pub(crate) shapes: Vec<BeamShape>,
    pub(crate) flux: Vec<S>,
    pub(crate) steps: Vec<(f32, S)>,
}

impl<S: Spectrum> Pass<S> {
    pub(crate) fn build(
        emission: Emission,
        traced: Traced<S, Left<S>>,
        estimate: Estimate,
        [search, volume]: [Search; 2],
        radii: Radii,
        shrink: f32,
    ) -> Result<Self, PassError> {
        let beams = traced.media().filter(|left| matches!(left, Left::Beam(..)));
        emission.allow(traced.bytes() + beams.count() * PEAK)?;
        let points = traced.media().filter_map(|left| match left {
            Left::Point(medium, photon) => Some((*medium, *photon)),
            _ => None,
        });
        let mut points = VolumeLists::new(points, traced.bytes(), emission)?;
        let (surfaces, mut lost, left) = traced.split();
        let mut lists: BTreeMap<u32, List<S>> = BTreeMap::new();
        let mut last = None;
        for left in left {
            match left {
                Left::Point(medium, photon) => points.push(medium, photon),
                Left::Beam(MediumId(medium), shape, flux) => {
                    let storable = flux.is_finite() && shape.is_valid();
                    last = storable.then_some(medium);
                    if storable {
                        let list = lists.entry(medium).or_default();
                        list.shapes.push(shape);
                        list.flux.push(flux);
                    } else {
                        lost += 1;
                    }
                }
                Left::Reached(t, transmittance) => {
                    if let Some(list) = last.and_then(|medium| lists.get_mut(&medium)) {
                        list.steps.push((t, transmittance));
                    }
                }
            }
        }
        lost += points.lost();
        let mut media: BTreeMap<u32, InMedium<S>> = BTreeMap::new();
        for (medium, mut list) in lists {
            radii.of_all(&mut list)?;
            let light = LightBeams {
                tree: Beams::build(&list.shapes).map_err(unsupported)?,
                steps_each: list.steps.len() / list.flux.len(),
                flux: list.flux,
                steps: list.steps,
            };
            media.entry(medium).or_default().beams = Some(light);
        }
        for (MediumId(medium), photons) in points.maps()? {
            let discs = |blur| PhotonDiscs::build(&photons, volume, blur);
            let points = match estimate {
                Estimate::PointPoint3D | Estimate::BeamPoint2D | Estimate::BeamPoint3D => {
                    Points::Marched(photons)
                }
                Estimate::PointBeam3D => Points::Along(discs(Blur::Ball)?),
                _ => Points::Along(discs(Blur::Disc)?),
            };
            media.entry(medium).or_default().points = Some(points);
        }
        Ok(Self {
            surfaces,
            search,
            volume,
            media,
            shrink,
            error: Largest::default(),
            lost,
        })
    }

    /// Photons kept in media and on surfaces.
    pub fn photons(&self) -> [usize; 2] {
        let points = |light: &InMedium<S>| match &light.points {
            Some(Points::Marched(photons)) => photons.len(),
            Some(Points::Along(discs)) => discs.len(),
            None => 0,
        };
        let volume = self.media.values().map(points).sum();
        [volume, self.surfaces.len()]
    }

    /// Beams kept.
    pub fn beams(&self) -> usize {
        let beams = self.media.values().filter_map(|light| light.beams.as_ref());
        beams.map(|beams| beams.tree.len()).sum()
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let of_medium = |light: &InMedium<S>| {
            let beams = light.beams.as_ref().map_or(0, LightBeams::bytes);
            beams
                + match &light.points {
                    Some(Points::Marched(photons)) => photons.bytes(),
                    Some(Points::Along(discs)) => discs.bytes(),
                    None => 0,
                }
        };
        self.surfaces.bytes() + self.media.values().map(of_medium).sum::<usize>()
    }

    /// What a reader of the image must know.
    pub(crate) fn figures(&self, emission: Emission) -> Vec<Figure> {
        let mut figures = emission.figures(self.photons(), self.lost);
        figures.push(Figure::total("beams", self.beams() as u64));
        let error = Figure::largest("error of transmittance", self.error.get());
        figures.extend([error].into_iter().filter(|figure| !figure.is_zero()));
        figures.push(Figure::range("radius over the starting one", self.shrink));
        figures
    }
}
