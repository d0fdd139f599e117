//! The photons of a pass.

use crate::{ensure, unsupported};
use std::collections::BTreeMap;
use tyndall_core::{
    Figure, Geometry, LightEmission, Media, MediumId, PassContext, PassError, Shading, Spectrum,
    Streams, SurfaceKind,
};
use tyndall_kd_tree::{Photon, Photons};
use tyndall_walk::{DirectLight, LightPaths, Route, Site, Vertex};

/// How many light paths a pass has, and what their photons may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Emission {
    /// Light paths emitted in a pass, at least 1.
    pub paths: u64,
    /// Bytes that photons may take at any time of a pass. Tracing and sorting them takes most: 80
    /// to 124 each in three channels.
    pub max_bytes: u64,
}

impl Default for Emission {
    /// 100,000 paths, 4 GiB.
    fn default() -> Self {
        Self {
            paths: 100_000,
            max_bytes: 4 << 30,
        }
    }
}

impl Emission {
    /// The number of the first path of a pass among all that were ever traced.
    pub fn first_path(&self, pass: u64) -> u64 {
        pass.saturating_mul(self.paths)
    }

    /// Refuses a pass whose photons need so many bytes, if they may not take as many.
    ///
    /// # Errors
    /// [`PassError::Memory`].
    pub fn allow(&self, needed: usize) -> Result<(), PassError> {
        let (needed, allowed) = (needed as u64, self.max_bytes);
        if needed <= allowed {
            Ok(())
        } else {
            Err(PassError::Memory { needed, allowed })
        }
    }

    /// What a method tells of these options, see
    /// [`Integrator::options`](tyndall_core::Integrator::options); `by_photons` is
    /// [`DirectLight::BY_PHOTONS`].
    pub fn options(&self, by_photons: bool) -> Vec<(&'static str, String)> {
        vec![
            ("paths", self.paths.to_string()),
            ("max_bytes", self.max_bytes.to_string()),
            ("sample_lights", (!by_photons).to_string()),
        ]
    }

    /// What a method tells of a pass that has kept so many photons in media and on surfaces and
    /// has [`lost`](PhotonMaps::lost) some, see
    /// [`Integrator::figures`](tyndall_core::Integrator::figures).
    pub fn figures(&self, [media, surfaces]: [usize; 2], lost: u64) -> Vec<Figure> {
        let mut figures = vec![
            Figure::total("light paths", self.paths),
            Figure::total("photons in media", media as u64),
            Figure::total("photons on surfaces", surfaces as u64),
        ];
        if lost > 0 {
            figures.push(Figure::total("photons lost, not finite", lost));
        }
        figures
    }
}

/// The photons of a pass, by what light met before and where it arrives.
#[derive(Clone, Debug)]
pub struct PhotonMaps<S> {
    /// At surfaces, straight from the lights (if photons bring direct light) or through specular
    /// surfaces alone.
    pub caustic: Photons<S>,
    /// At surfaces, scattered before.
    pub diffuse: Photons<S>,
    /// At collisions, a map for each medium that has any, in the order of ids. Their flux is what
    /// the medium scatters: what arrives, times the albedo there.
    pub volume: Vec<(MediumId, Photons<S>)>,
    /// Photons dropped because no map can hold them: of a position, direction or flux that is not
    /// finite. They end the paths of a host that emits or scatters such light.
    pub lost: u64,
}

/// Which map a photon belongs to.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Map {
    Caustic,
    Diffuse,
    /// Of the medium of this number.
    Volume(u32),
}

impl<S: Spectrum> PhotonMaps<S> {
    /// Traces the light paths of a pass. Photons are stored at collisions, unless the albedo is
    /// zero, and at surfaces that scatter into many directions.
    ///
    /// Whether a sensor will look there is not asked: mirrors and scattering between surfaces make
    /// that as dear to know as the picture itself.
    ///
    /// # Errors
    /// See [`LightPaths::collect`]; [`PassError::Memory`]; [`PassError::Unsupported`] for no paths, and for more photons
    /// than a map can number.
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
        ensure(emission.paths > 0, || {
            "`paths` is 0; trace at least 1 light path a pass".to_owned()
        })?;
        let paths = LightPaths::new(cx, emission.paths, emission.max_bytes);
        let found = paths.collect(host, |walk, sampler, found| {
            walk.visit(sampler, |vertex, flux, route| {
                if route != Route::Direct || D::BY_PHOTONS {
                    found.extend(deposit(host, vertex, flux, route));
                }
            });
        })?;
        let mut counts: BTreeMap<Map, usize> = BTreeMap::new();
        let storable = |(_, photon): &&(Map, Photon<S>)| photon.is_storable();
        for (map, _) in found.iter().flatten().filter(storable) {
            *counts.entry(*map).or_default() += 1;
        }
        let batches: usize = found.iter().map(Vec::capacity).sum();
        let photons: usize = counts.values().sum();
        emission
            .allow(batches * size_of::<(Map, Photon<S>)>() + photons * size_of::<Photon<S>>())?;
        let list = |(map, count)| (map, Vec::with_capacity(count));
        let mut lists: BTreeMap<Map, Vec<Photon<S>>> = counts.into_iter().map(list).collect();
        let mut maps = Self {
            caustic: Photons::default(),
            diffuse: Photons::default(),
            volume: Vec::new(),
            lost: 0,
        };
        for (map, photon) in found.into_iter().flatten() {
            if photon.is_storable() {
                lists.entry(map).or_default().push(photon);
            } else {
                maps.lost += 1;
            }
        }
        for (map, list) in lists {
            let photons = Photons::build(&list).map_err(unsupported)?;
            match map {
                Map::Caustic => maps.caustic = photons,
                Map::Diffuse => maps.diffuse = photons,
                Map::Volume(id) => maps.volume.push((MediumId(id), photons)),
            }
        }
        Ok(maps)
    }

    /// How many there are, in media and on surfaces.
    pub fn photons(&self) -> [usize; 2] {
        let volume = self.volume.iter().map(|(_, photons)| photons.len()).sum();
        [volume, self.caustic.len() + self.diffuse.len()]
    }

    /// The photons at surfaces: caustic and diffuse.
    pub fn surfaces(&self) -> [&Photons<S>; 2] {
        [&self.caustic, &self.diffuse]
    }

    /// The photons in a medium, if there are any.
    pub fn in_medium(&self, id: MediumId) -> Option<&Photons<S>> {
        let index = self.volume.binary_search_by_key(&id.0, |(id, _)| id.0);
        index.ok().map(|i| &self.volume[i].1)
    }
}

/// What is stored at a vertex.
fn deposit<H: Geometry + Shading>(
    host: &H,
    vertex: &Vertex<H>,
    arriving: H::Spectrum,
    route: Route,
) -> Option<(Map, Photon<H::Spectrum>)> {
    let (map, flux) = match &vertex.site {
        Site::Collision(coefficients) => {
            let map = Map::Volume(vertex.medium.0);
            (map, arriving * coefficients.albedo())
        }
        Site::Surface(hit) if host.surface_kind(hit) != SurfaceKind::Finite => return None,
        Site::Surface(_) if route == Route::Diffuse => (Map::Diffuse, arriving),
        Site::Surface(_) => (Map::Caustic, arriving),
    };
    let photon = Photon {
        position: vertex.position,
        direction: -vertex.wo,
        flux,
    };
    (!flux.is_black()).then_some((map, photon))
}
