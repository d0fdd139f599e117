//! Scene files: TOML in, a checked description out.

mod document;
mod film;
mod include;
mod integrator;
mod light;
mod material;
mod medium;
mod mtl;
mod obj_shape;
mod overrides;
mod reader;
mod shape;
mod texture;
mod view;
mod volume;

pub use integrator::{IntegratorConfig, PhotonConfig, Scattering};
pub(crate) use material::Material;
pub(crate) use reader::nearest;
pub(crate) use shape::{Solid, around_points};

use crate::camera::Camera;
use crate::files::Files;
use crate::light::Light;
use crate::media::{Filling, MediumDescription};
use crate::spectrum::is_grey;
use crate::texture::Budget;
use crate::{Error, Place, Scene};
use document::Node;
use glam::DVec3;
use include::Included;
use reader::{Field, Table};
use std::path::{Path, PathBuf};
use tyndall_core::{Aabb, Rgb, Spectrum};
use tyndall_surface::{Backend, Shape};

/// A scene file, read and checked, with the files that it names.
#[derive(Clone, Debug)]
pub struct SceneFile {
    pub(crate) path: PathBuf,
    pub(crate) camera: Camera,
    /// What the file says is around the camera, and where it says so.
    pub(crate) camera_medium: Option<(Filling, Place)>,
    pub(crate) media_names: Vec<String>,
    pub(crate) media: Vec<MediumDescription>,
    pub(crate) materials: Vec<Material>,
    pub(crate) parts: Vec<Part>,
    pub(crate) lights: Vec<Light<Rgb>>,
    /// The point of the file that is 0 in the scene.
    pub(crate) origin: DVec3,
    integrator: IntegratorConfig,
    notices: Vec<String>,
    sources: Vec<PathBuf>,
}

/// A shape, its material by index, and the radiance that it emits.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) shape: Shape,
    /// A box around it; the smallest one if light can enter it.
    pub(crate) bounds: Aabb,
    pub(crate) material: usize,
    pub(crate) emission: Rgb,
}

/// The tree of a scene file with its overrides.
fn parse_document(path: &Path, text: &str, overrides: &[(String, String)]) -> Result<Node, Error> {
    let mut root = document::parse(&path.display().to_string(), text)?;
    for (key, value) in overrides {
        overrides::apply(&mut root, key, value)?;
    }
    Ok(root)
}

impl SceneFile {
    /// Reads a scene file, or a glTF file (by its name, `.gltf` or `.glb`) as a scene file that
    /// includes nothing else. `overrides` are pairs of a dotted key and a value as TOML writes it:
    /// they replace a value or add one that the table could hold.
    ///
    /// # Errors
    /// The first thing that is wrong: its place, its key and the mend.
    pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Self, Error> {
        if include::is_gltf(path) {
            let text = include::scene_of(path);
            return Self::whole(path, parse_document(path, &text, overrides)?, true);
        }
        let text = std::fs::read_to_string(path).map_err(|source| Error::Read {
            path: path.to_owned(),
            source,
        })?;
        let mut scene = Self::parse(&text, path, overrides)?;
        scene.sources.insert(0, path.to_owned());
        Ok(scene)
    }

    /// [`SceneFile::load`] of a text; `path` is what messages call it, and its folder is where
    /// the files are that it names.
    ///
    /// # Errors
    /// As there.
    pub fn parse(text: &str, path: &Path, overrides: &[(String, String)]) -> Result<Self, Error> {
        Self::whole(path, parse_document(path, text, overrides)?, false)
    }

    /// The scene of a tree; `direct` if it is nothing but the glTF file of this path.
    fn whole(path: &Path, mut root: Node, direct: bool) -> Result<Self, Error> {
        let table = Field::root(&root).table()?;
        table.expect(&SECTIONS);
        table.finish()?;
        let files = Files::beside(path);
        let budget = Budget::default();
        let included = Included::read(&listed(&table, "include")?, &files, direct, &budget)?;
        drop(table);
        included.look_through(&mut root, path)?;
        Self::read(path, &root, included, (&files, &budget))
    }

    fn read(
        path: &Path,
        root: &Node,
        mut included: Included,
        (files, budget): (&Files, &Budget),
    ) -> Result<Self, Error> {
        let table = Field::root(root).table()?;
        let fields = media_fields(&table)?;
        let names: Vec<_> = fields.iter().map(|(name, _)| *name).collect();
        let volumes = volume::Volumes::new(files);
        let media = fields
            .iter()
            .map(|(_, field)| medium::read(field, &volumes));
        let mut media: Vec<_> = media.collect::<Result<_, _>>()?;
        let mut media_names: Vec<_> = names.iter().map(|&name| name.into()).collect();
        let mut shapes = materials_and_shapes(&table, (files, budget), &names)?;
        let includes = listed(&table, "include")?;
        let added = included.add_to(&includes, &mut shapes, &mut media_names)?;
        let (materials, placed) = (shapes.materials, shapes.placed);
        let origin = origin(&placed, &media);
        for ((_, field), medium) in fields.iter().zip(&media) {
            medium.build::<Rgb>(origin).map_err(|e| field.error(e))?;
        }
        media.extend(added);
        let (camera, film) = (table.required("camera")?, table.required("film")?);
        let (camera, camera_medium) = view::read(&camera, &film, &names, origin)?;
        let place = |p: shape::Placed| {
            let is_boundary = materials[p.material].bsdf.transmits();
            p.place(origin, is_boundary)
        };
        let parts = placed.into_iter().map(place).collect();
        let lamps = included.lamps().map(|lamp| lamp.place(origin));
        Ok(Self {
            path: path.to_owned(),
            camera,
            camera_medium,
            media,
            media_names,
            materials,
            parts,
            lights: lights(&table, files, origin)?
                .into_iter()
                .chain(lamps)
                .collect(),
            origin,
            integrator: integrator::read(table.optional("integrator").as_ref())?,
            notices: shapes
                .notices
                .into_iter()
                .chain(included.notices())
                .chain(volumes.notices())
                .collect(),
            sources: files.all(),
        })
    }

    /// Whether every colour has equal channels: such a scene is rendered with one.
    pub fn is_grey(&self) -> bool {
        let mut grey = true;
        let mut see = |colour| grey &= is_grey(colour);
        for part in &self.parts {
            see(part.emission);
            self.materials[part.material].bsdf.map(|colour| {
                see(colour);
                colour
            });
        }
        self.lights.iter().for_each(|light| see(light.colour));
        grey &= self.lights.iter().all(|light| light.source.is_grey());
        let textured = |part: &Part| self.materials[part.material].maps.are_grey();
        grey && self.parts.iter().all(textured) && self.media.iter().all(MediumDescription::is_grey)
    }

    /// The names of media that fill the same place.
    pub(crate) fn filling_name(&self, filling: &[usize]) -> String {
        if filling.is_empty() {
            return "vacuum".into();
        }
        let names: Vec<_> = filling
            .iter()
            .map(|&m| self.media_names[m].as_str())
            .collect();
        names.join(" + ")
    }

    /// What of the files was left out, a line each: for people to read.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// The files that were read: the scene file, those that it or an override names, and those that
    /// they name in turn. In an order that their contents fix, each once; an MTL file that nobody
    /// needs may be missing. What their bytes say, and the overrides, is all that a scene depends
    /// on.
    pub fn sources(&self) -> &[PathBuf] {
        &self.sources
    }

    /// Which integrator the file asks for.
    pub fn integrator(&self) -> &IntegratorConfig {
        &self.integrator
    }

    /// The scene with the channels of `S`: `f32` for a grey scene, [`Rgb`] for any. In one
    /// channel, a colour is its mean.
    ///
    /// # Errors
    /// [`Error::Build`] and [`Error::Scene`] for what only the whole scene shows.
    pub fn build<S: Spectrum>(&self) -> Result<Scene<S>, Error> {
        self.build_with(Backend::default())
    }

    /// [`SceneFile::build`] over a chosen backend.
    ///
    /// # Errors
    /// As there.
    pub fn build_with<S: Spectrum>(&self, backend: Backend) -> Result<Scene<S>, Error> {
        Scene::build(self, backend)
    }
}

impl shape::Placed {
    fn place(self, origin: DVec3, is_boundary: bool) -> Part {
        let bounds = if is_boundary {
            self.solid.tight_bounds()
        } else {
            self.solid.bounds()
        };
        Part {
            bounds: shape::rounded(bounds, origin),
            shape: self.solid.place(origin),
            material: self.material,
            emission: self.emission,
        }
    }
}

/// The centre of the shapes (of the grids, if there are none) if it is farther from 0 than they are
/// large, else 0.
fn origin(placed: &[shape::Placed], media: &[MediumDescription]) -> DVec3 {
    let grids = media.iter().filter_map(MediumDescription::grid);
    let grids = grids.map(|grid| grid.density.bounds(DVec3::ZERO));
    let grids = grids.filter(|b| placed.is_empty() && !b.is_empty());
    let corners = grids.flat_map(|b| [b.min.as_dvec3(), b.max.as_dvec3()]);
    let [min, max] = around_points(placed.iter().flat_map(|p| p.solid.bounds()).chain(corners));
    let center = 0.5 * (min + max);
    if center.length() > (max - min).length() {
        center
    } else {
        DVec3::ZERO
    }
}

/// The tables that a file may have.
const SECTIONS: [&str; 9] = [
    "camera",
    "film",
    "integrator",
    "media",
    "materials",
    "shapes",
    "lights",
    "environment",
    "include",
];

fn media_fields<'a>(table: &Table<'a>) -> Result<Vec<(&'a str, Field<'a>)>, Error> {
    let media = named(table, "media")?;
    match media.iter().find(|(name, _)| *name == "vacuum") {
        Some((_, field)) => Err(field.error("is there without being said: choose another name")),
        None => Ok(media),
    }
}

fn materials_and_shapes<'a>(
    table: &Table<'_>,
    (files, budget): (&'a Files, &'a Budget),
    media: &[&str],
) -> Result<shape::Reader<'a>, Error> {
    let mut reader = shape::Reader {
        textures: texture::Textures::new(files, budget),
        names: Vec::new(),
        materials: Vec::new(),
        placed: Vec::new(),
        notices: Vec::new(),
    };
    for (name, field) in named(table, "materials")? {
        let material = material::read(&field, media, &mut reader.textures)?;
        reader.materials.push(material);
        reader.names.push(name.into());
    }
    for field in listed(table, "shapes")? {
        reader.read(&field)?;
    }
    Ok(reader)
}

fn lights(table: &Table<'_>, files: &Files, origin: DVec3) -> Result<Vec<Light<Rgb>>, Error> {
    let fields = listed(table, "lights")?;
    let listed = fields.iter().map(|field| light::read(field, origin));
    let environment = table.optional("environment");
    let environment = environment
        .iter()
        .map(|field| light::read_environment(field, files));
    listed.chain(environment).collect()
}

/// The entries of a table whose keys the author chose.
fn named<'a>(table: &Table<'a>, key: &'static str) -> Result<Vec<(&'a str, Field<'a>)>, Error> {
    match table.optional(key) {
        Some(field) => Ok(field.table()?.named().collect()),
        None => Ok(Vec::new()),
    }
}

fn listed<'a>(table: &Table<'a>, key: &'static str) -> Result<Vec<Field<'a>>, Error> {
    table.optional(key).map_or(Ok(Vec::new()), |f| f.elements())
}
