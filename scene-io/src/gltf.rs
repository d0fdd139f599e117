//! glTF 2.0: what an artist exports, as shapes, materials, media, lights and a camera.
//!
//! Everything is read in the coordinates of the file (right-handed, y up) and moved by the
//! transformation of the include. Indices, offsets and counts are checked before they are used, and
//! all that is made of a file is bounded by its size.

mod accessor;
mod camera;
mod container;
mod document;
mod geometry;
mod image;
mod light;
mod material;
mod medium;
mod node;
mod placement;
mod uri;

pub(crate) use camera::{Projection, View};
pub(crate) use light::Lamp;
pub(crate) use node::SceneChoice;

use crate::Error;
use crate::file::{Material, Solid};
use crate::files::Files;
use crate::media::MediumDescription;
use crate::texture::Budget;
use document::Document;
use glam::DAffine3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// What of a file is wanted, and how.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// From the file's coordinates to those of the scene.
    pub(crate) transform: DAffine3,
    pub(crate) scene: Option<SceneChoice>,
    pub(crate) camera: Option<String>,
    pub(crate) lights: bool,
    /// Lumens that count as one watt.
    pub(crate) luminous_efficacy: f64,
    pub(crate) draft_extensions: bool,
}

impl Options {
    /// Factor of lengths: the cube root of that of volumes.
    fn scale(&self) -> f64 {
        self.transform.matrix3.determinant().abs().cbrt()
    }
}

/// What a file brings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Loaded {
    /// Shapes, and their materials by index.
    pub(crate) shapes: Vec<(Solid, usize)>,
    pub(crate) materials: Vec<Named>,
    /// Media, and what to call them.
    pub(crate) media: Vec<(String, MediumDescription)>,
    pub(crate) lamps: Vec<Lamp>,
    /// The camera that was asked for, or the first of the scene.
    pub(crate) view: Option<View>,
    /// What was left out, a line each.
    pub(crate) notices: Vec<String>,
}

/// A material by the name that the file gives it, empty if none; its medium `inside` is an index of
/// [`Loaded::media`].
#[derive(Clone, Debug)]
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) material: Material,
}

impl Loaded {
    /// Gives shapes without texture coordinates materials without textures.
    fn strip_textures(&mut self, path: &Path) {
        let mut plain = BTreeMap::new();
        for (solid, index) in &mut self.shapes {
            let Named { name, material } = &self.materials[*index];
            if solid.has_uvs() || !material.maps.have_textures() {
                continue;
            }
            *index = match plain.get(index) {
                Some(&known) => known,
                None => {
                    self.notices.push(format!(
                        "{}: faces of material {name:?} have no texture coordinates: its textures \
                         are left out there",
                        path.display()
                    ));
                    let material = Material {
                        maps: material.maps.without_textures(),
                        ..material.clone()
                    };
                    let name = name.clone();
                    plain.insert(*index, self.materials.len());
                    self.materials.push(Named { name, material });
                    self.materials.len() - 1
                }
            };
        }
    }
}

/// Reads a `.gltf` or `.glb` file, its buffers and its images; the latter on a budget.
///
/// # Errors
/// [`Error::Read`], or [`Error::Gltf`] with the first thing that is wrong: where in the JSON, and
/// the mend.
pub(crate) fn load(
    path: &Path,
    options: &Options,
    (files, budget): (&Files, &Budget),
) -> Result<Loaded, Error> {
    let mut loaded = Loaded::default();
    let document = Document::open(path, files, options.draft_extensions, &mut loaded.notices)?;
    let nodes = node::walk(&document, options.scene.as_ref(), options.transform)?;
    let primitives = placement::primitives(&document, &nodes, &mut loaded.notices)?;
    let used: BTreeSet<Option<usize>> = primitives.iter().map(|p| p.material).collect();
    let conventions = (options.scale(), options.draft_extensions);
    let mut traits = Vec::new();
    let mut reader = material::Reader::new(&document, conventions, budget, &mut loaded.notices);
    for index in &used {
        let read = reader.read(*index)?;
        let mut material = read.material;
        let has_normal_map = material.maps.normal.is_some();
        let name = index.and_then(|i| document.root.materials[i].name.clone());
        let name = name.unwrap_or_default();
        if let Some(medium) = read.medium {
            material.inside = vec![loaded.media.len()];
            loaded.media.push((format!("inside of {name}"), medium));
        }
        loaded.materials.push(Named { name, material });
        traits.push(placement::Traits {
            uv_set: read.uv_set,
            has_normal_map,
        });
    }
    let place_of = |index: Option<usize>| used.iter().take_while(|&&i| i < index).count();
    let traits = |index: Option<usize>| traits[place_of(index)];
    let solids = placement::solids(&document, primitives, traits, &mut loaded.notices)?;
    loaded.shapes = solids
        .into_iter()
        .map(|(solid, m)| (solid, place_of(m)))
        .collect();
    loaded.strip_textures(path);
    if options.lights {
        let (efficacy, scale) = (options.luminous_efficacy, options.scale());
        loaded.lamps = light::read(&document, &nodes, efficacy, scale)?;
    }
    loaded.view = camera::find(&document, &nodes, options.camera.as_deref())?;
    Ok(loaded)
}
