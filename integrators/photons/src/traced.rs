//! What the light paths of a pass leave behind.

use crate::{Emission, SurfacePhotons, ensure, unsupported};
use tyndall_core::{
    Geometry, LightEmission, Media, PassError, Shading, Spectrum, Streams, SurfaceKind,
};
use tyndall_kd_tree::{Photon, Photons};
use tyndall_walk::{DirectLight, Flight, LightPaths, Route, Site, Vertex, Visit};

/// What the light paths of a pass have left: photons at surfaces, and a `T` for whatever a method
/// keeps of what they met in media.
#[derive(Debug)]
pub struct Traced<S, T> {
    /// At surfaces that scatter into many directions.
    pub surfaces: SurfacePhotons<S>,
    /// Photons at surfaces dropped because no map can hold them: of a position, direction or flux
    /// that is not finite. They end the paths of a host that emits or scatters such light.
    pub lost: u64,
    left: Vec<Vec<Left<S, T>>>,
}

/// What a light path leaves somewhere.
#[derive(Debug)]
enum Left<S, T> {
    Caustic(Photon<S>),
    Diffuse(Photon<S>),
    Medium(T),
}

/// Takes what a method keeps of a flight.
pub struct Keep<'a, S, T>(&'a mut Vec<Left<S, T>>);

impl<S, T> Keep<'_, S, T> {
    /// Keeps it.
    #[inline]
    pub fn push(&mut self, item: T) {
        self.0.push(Left::Medium(item));
    }
}

impl<S: Spectrum, T: Send> Traced<S, T> {
    /// Traces the light paths of a pass, as `emission` has them. `media` says what to keep of a
    /// flight through a medium.
    ///
    /// Whether a sensor will look there is not asked: mirrors and scattering between surfaces make
    /// that as dear to know as the picture itself.
    ///
    /// # Errors
    /// See [`LightPaths::collect`]; [`PassError::Memory`]; [`PassError::Unsupported`] for no paths,
    /// and for more photons than a map can number.
    pub fn trace<H, D, R>(
        host: &H,
        paths: LightPaths<'_, '_, R>,
        emission: Emission,
        media: impl Fn(&Flight<S>, &mut R::Sampler, &mut Keep<'_, S, T>) + Sync,
    ) -> Result<Self, PassError>
    where
        H: Geometry<Spectrum = S> + Shading + Media + LightEmission,
        D: DirectLight<H>,
        R: Streams,
    {
        ensure(emission.paths > 0, || {
            "`paths` is 0; trace at least 1 light path a pass".to_owned()
        })?;
        let left = paths.collect(host, |walk, sampler, left| {
            walk.visit(sampler, |visit, route, sampler| match visit {
                _ if route == Route::Direct && !D::BY_PHOTONS => {}
                Visit::Vertex(vertex, flux) => left.extend(deposit(host, vertex, flux, route)),
                Visit::Flight(flight) => media(&flight, sampler, &mut Keep(left)),
            });
        })?;
        let mut traced = Self {
            surfaces: SurfacePhotons::default(),
            lost: 0,
            left,
        };
        traced.surfaces.caustic = traced.map(emission, |left| match left {
            Left::Caustic(photon) => Some(photon),
            _ => None,
        })?;
        traced.surfaces.diffuse = traced.map(emission, |left| match left {
            Left::Diffuse(photon) => Some(photon),
            _ => None,
        })?;
        Ok(traced)
    }

    /// The photons that `of_map` knows.
    fn map(
        &mut self,
        emission: Emission,
        of_map: impl Fn(&Left<S, T>) -> Option<&Photon<S>>,
    ) -> Result<Photons<S>, PassError> {
        let all = || self.left.iter().flatten().filter_map(&of_map);
        let storable = || all().filter(|photon| photon.is_storable());
        let count = storable().count();
        let lost = all().count() - count;
        emission.allow(self.bytes() + self.surfaces.bytes() + count * size_of::<Photon<S>>())?;
        let mut list = Vec::with_capacity(count);
        list.extend(storable().copied());
        self.lost += lost as u64;
        Photons::build(&list).map_err(unsupported)
    }

    /// Bytes held beside the photons at surfaces.
    pub fn bytes(&self) -> usize {
        let held: usize = self.left.iter().map(Vec::capacity).sum();
        held * size_of::<Left<S, T>>()
    }

    /// What is kept of media, in the order of the paths.
    pub fn media(&self) -> impl Iterator<Item = &T> {
        self.left.iter().flatten().filter_map(|left| match left {
            Left::Medium(item) => Some(item),
            Left::Caustic(_) | Left::Diffuse(_) => None,
        })
    }

    /// The photons at surfaces, how many are lost, and what is kept of media, the memory of which
    /// is freed on the way.
    pub fn split(self) -> (SurfacePhotons<S>, u64, impl Iterator<Item = T>) {
        let media = |left| match left {
            Left::Medium(item) => Some(item),
            Left::Caustic(_) | Left::Diffuse(_) => None,
        };
        let left = self.left.into_iter().flatten().filter_map(media);
        (self.surfaces, self.lost, left)
    }
}

/// What is stored at a surface.
fn deposit<H: Geometry + Shading, T>(
    host: &H,
    vertex: &Vertex<H>,
    flux: H::Spectrum,
    route: Route,
) -> Option<Left<H::Spectrum, T>> {
    let Site::Surface(hit) = &vertex.site else {
        return None;
    };
    if flux.is_black() || host.surface_kind(hit) != SurfaceKind::Finite {
        return None;
    }
    let photon = Photon {
        position: vertex.position,
        direction: -vertex.wo,
        flux,
    };
    Some(match route {
        Route::Diffuse => Left::Diffuse(photon),
        Route::Direct | Route::Specular => Left::Caustic(photon),
    })
}
