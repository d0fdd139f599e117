//! The scene that is rendered, made from its description.

use crate::boundary::{Boundaries, Boundary};
use crate::camera::Camera;
use crate::file::SceneFile;
use crate::light::{Area, Light, Lights, Source, World};
use crate::locate::boundaries_around;
use crate::look::Look;
use crate::media::{Filling, glow_without_end, together};
use crate::spectrum::convert;
use crate::{Error, Place, View};
use glam::{DVec3, Vec3};
use std::sync::Arc;
use tyndall_core::{Aabb, Anchor, MediumId, Spectrum};
use tyndall_media::{AnyMedium, MediumError};
use tyndall_surface::{Backend, Surfaces};

/// A scene, ready to be rendered: it implements every trait of a host.
pub struct Scene<S> {
    pub(crate) surfaces: Surfaces,
    pub(crate) looks: Vec<Look<S>>,
    /// By the number of what fills a place, see [`Boundaries::medium`].
    pub(crate) media: Vec<AnyMedium<S>>,
    pub(crate) boundaries: Boundaries,
    pub(crate) lights: Lights<S>,
    pub(crate) camera: Camera,
    pub(crate) camera_medium: MediumId,
    pub(crate) bounds: Aabb,
    pub(crate) has_null_surfaces: bool,
    origin: DVec3,
}

impl<S: Spectrum> Scene<S> {
    /// Builds the scene that `file` describes.
    ///
    /// # Errors
    /// [`Error::Build`] if the geometry is unusable, [`Error::Scene`] if the camera's medium
    /// contradicts it.
    pub(crate) fn build(file: &SceneFile, backend: Backend) -> Result<Self, Error> {
        let problem = |problem: String| Error::Build {
            path: file.path.clone(),
            problem,
        };
        let looks = looks(file);
        let shapes = file.parts.iter().map(|p| p.shape.clone()).collect();
        let surfaces = Surfaces::build(shapes, backend).map_err(|e| problem(e.to_string()))?;
        let boundaries = boundaries(file, &surfaces, &looks)?;
        let media = media(file, &boundaries).map_err(|e| problem(e.to_string()))?;
        let camera_medium = locate(file.camera.position(), &surfaces, &boundaries, &looks);
        let lamps = Aabb::of_points(file.lights.iter().filter_map(|l| l.source.position()));
        let lights = lights(file, &looks, &surfaces, &boundaries);
        let bounds = surfaces.bounds().union(lamps);
        let bounds = bounds.union(unbounded_grids(file, &boundaries));
        let lights = Lights::new(lights, World::around(bounds), boundaries.ambient());
        if !lights.power().is_finite() {
            let why =
                "the power of all lights overflows: lower their radiance or scale the scene down";
            return Err(problem(why.into()));
        }
        Ok(Self {
            lights,
            has_null_surfaces: boundaries.all().any(|b| boundaries.may_be_null(b))
                || looks.iter().any(Look::may_be_cut),
            surfaces,
            looks,
            media,
            boundaries,
            camera: file.camera.clone(),
            camera_medium,
            bounds,
            origin: file.origin,
        })
    }

    /// The point of the scene file that is 0 here: scenes far from the origin are moved to it, in
    /// `f64`, when they are loaded.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// What an image file says of the camera.
    pub fn view(&self) -> View {
        self.camera.view(self.origin)
    }

    /// The medium around a point.
    pub(crate) fn locate(&self, p: Vec3) -> MediumId {
        locate(p, &self.surfaces, &self.boundaries, &self.looks)
    }
}

/// For every filling of a state the media that it consists of, as one.
fn media<S: Spectrum>(
    file: &SceneFile,
    boundaries: &Boundaries,
) -> Result<Vec<AnyMedium<S>>, MediumError> {
    let built = file.media.iter().map(|m| m.build(file.origin));
    let built: Vec<_> = built.collect::<Result<_, _>>()?;
    let fillings = boundaries.fillings().iter();
    fillings
        .map(|filling| together(filling.iter().map(|&m| built[m].clone()).collect()))
        .collect()
}

/// The boxes of the grids that are not inside of shapes.
fn unbounded_grids(file: &SceneFile, boundaries: &Boundaries) -> Aabb {
    let outside = boundaries.outside().flatten();
    let grids = outside.filter_map(|&m| file.media[m].grid());
    let boxes = grids.map(|grid| grid.density.bounds(file.origin));
    boxes.fold(Aabb::EMPTY, Aabb::union)
}

/// One a shape; what materials share is made once.
fn looks<S: Spectrum>(file: &SceneFile) -> Vec<Look<S>> {
    let materials = file.materials.iter().map(|material| Look {
        bsdf: material.bsdf.map(convert),
        emission: S::default(),
        maps: (!material.maps.is_empty()).then(|| Arc::new(material.maps.clone())),
    });
    let materials: Vec<_> = materials.collect();
    let look = |part: &crate::file::Part| Look {
        emission: convert(part.emission),
        ..materials[part.material].clone()
    };
    file.parts.iter().map(look).collect()
}

fn locate<S: Spectrum>(
    p: Vec3,
    surfaces: &Surfaces,
    boundaries: &Boundaries,
    looks: &[Look<S>],
) -> MediumId {
    boundaries.state(&boundaries_around(p, surfaces, boundaries, looks))
}

/// The boundaries, in the medium that fills all space outside: that of the camera if it is named
/// and no boundary is around it.
fn boundaries<S: Spectrum>(
    file: &SceneFile,
    surfaces: &Surfaces,
    looks: &[Look<S>],
) -> Result<Boundaries, Error> {
    let list = || {
        let parts = file.parts.iter().enumerate();
        parts
            .filter_map(|(shape, part)| part.boundary(shape, file))
            .collect()
    };
    let build = |ambient: Filling| {
        Boundaries::new(list(), ambient).ok_or_else(|| Error::Build {
            path: file.path.clone(),
            problem: "too many shapes that light can enter have overlapping bounding boxes: \
                      join them into fewer shapes or move them apart"
                .into(),
        })
    };
    let table = build(Vec::new())?;
    let Some((named, place)) = &file.camera_medium else {
        return Ok(table);
    };
    let around = boundaries_around(file.camera.position(), surfaces, &table, looks);
    if around.is_empty() {
        return if glow_without_end(named.iter().map(|&m| &file.media[m])) {
            Err(camera_medium_error(
                place,
                "glows and does not absorb (in some channel), and fills unbounded space, which \
                 would be infinitely bright: give it `sigma_a`, or put it into a shape",
            ))
        } else {
            build(named.clone())
        };
    }
    let found = table.filling(table.state(&around));
    if found == named {
        return Ok(table);
    }
    Err(contradiction(file, place, named, found))
}

fn contradiction(file: &SceneFile, place: &Place, named: &[usize], found: &[usize]) -> Error {
    camera_medium_error(
        place,
        format!(
            "is {:?}, but the camera is inside a shape filled with {:?}: remove the key",
            file.filling_name(named),
            file.filling_name(found)
        ),
    )
}

fn camera_medium_error(place: &Place, problem: impl Into<String>) -> Error {
    Error::Scene {
        place: place.clone(),
        field: "camera.medium".into(),
        problem: problem.into(),
    }
}

fn lights<S: Spectrum>(
    file: &SceneFile,
    looks: &[Look<S>],
    surfaces: &Surfaces,
    boundaries: &Boundaries,
) -> Vec<Light<S>> {
    let locate = |p| locate(p, surfaces, boundaries, looks);
    let listed = file.lights.iter().map(|light| {
        let mut light = light.clone().map(convert);
        light.source.immerse(locate);
        light
    });
    let emissive = looks
        .iter()
        .enumerate()
        .filter(|(_, l)| !l.emission.is_black());
    let areas = emissive.flat_map(|(shape, look)| {
        let shape = shape as u32;
        let medium = medium_before(shape, surfaces, locate);
        (0..surfaces.primitive_count(shape) as u32).map(move |primitive| Light {
            colour: look.mean_radiance(surfaces, shape, primitive),
            source: Source::Area(Area {
                shape,
                primitive,
                area: surfaces.area(shape, primitive),
                medium,
            }),
        })
    });
    listed.chain(areas).collect()
}

/// The medium that a light shines into, judged at a few points; `None` if they differ.
fn medium_before(
    shape: u32,
    surfaces: &Surfaces,
    locate: impl Fn(Vec3) -> MediumId,
) -> Option<MediumId> {
    const PROBES: usize = 16;
    let count = surfaces.primitive_count(shape);
    let mut media = (0..PROBES).map(|i| {
        let primitive = (i * count / PROBES) as u32;
        let u = [
            (i as f32 + 0.5) / PROBES as f32,
            (i as f32 * 0.618 + 0.5).fract(),
        ];
        let hit = surfaces.sample(shape, primitive, u);
        let normal = surfaces.surface(&hit).geometric_normal;
        locate(surfaces.spawn(&Anchor::Surface(hit), normal).origin)
    });
    let first = media.next()?;
    media.all(|medium| medium == first).then_some(first)
}

impl crate::file::Part {
    fn boundary(&self, shape: usize, file: &SceneFile) -> Option<Boundary> {
        let material = &file.materials[self.material];
        material.bsdf.transmits().then(|| Boundary {
            shape,
            bounds: self.bounds,
            inside: material.inside.clone(),
            adds: material.adds,
            outside: material.outside.clone(),
            ior: material.bsdf.ior(),
            priority: material.priority,
        })
    }
}
