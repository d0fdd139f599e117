//! `[[include]]`: glTF files as parts of a scene.

use super::document::{Node, Value};
use super::reader::{Field, Table};
use super::shape::{self, transform};
use crate::files::Files;
use crate::gltf::{self, Lamp, Loaded, Options, Projection, SceneChoice, View};
use crate::media::MediumDescription;
use crate::texture::Budget;
use crate::{Error, Place};
use std::collections::BTreeMap;
use std::path::Path;

/// What the includes of a scene bring, read before anything else of it.
#[derive(Debug)]
pub(super) struct Included {
    files: Vec<Loaded>,
    /// Whether the scene file is nothing but an include that the author did not write.
    direct: bool,
}

/// The text of a scene file that has nothing in it but a glTF file.
pub(super) fn scene_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = toml::Value::String(name.into_owned());
    format!("include = [{{ file = {name} }}]")
}

/// Whether a file of this name is glTF.
pub(super) fn is_gltf(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    extension == "gltf" || extension == "glb"
}

impl Included {
    /// Reads the files of all includes; `direct` if the scene is but one, of that file.
    pub(super) fn read(
        fields: &[Field<'_>],
        files: &Files,
        direct: bool,
        budget: &Budget,
    ) -> Result<Self, Error> {
        let loaded = (fields.iter()).map(|field| read(field, files, direct, budget));
        let files = loaded.collect::<Result<_, _>>()?;
        Ok(Self { files, direct })
    }

    /// Writes the first camera of the includes into the scene, where it has none.
    ///
    /// # Errors
    /// If there is no camera at all.
    pub(super) fn look_through(&self, root: &mut Node, path: &Path) -> Result<(), Error> {
        let Some(view) = self.files.iter().find_map(|file| file.view) else {
            let has = matches!(&root.value, Value::Table(t) if t.contains_key("camera"));
            if self.direct && !has {
                return Err(Error::Gltf {
                    path: path.to_owned(),
                    field: "cameras".into(),
                    problem: "the scene has no camera: add one to it, or set `camera.position`, \
                              `camera.look_at`, `camera.fov`, `film.width` and `film.height`"
                        .into(),
                });
            }
            return Ok(());
        };
        let place = root.place.clone();
        if let Value::Table(scene) = &mut root.value {
            complete(scene, &view, &place);
        }
        Ok(())
    }

    /// What was left out of the files.
    pub(super) fn notices(&self) -> impl Iterator<Item = String> {
        self.files.iter().flat_map(|file| file.notices.clone())
    }

    /// Adds shapes and materials to those of the scene, and names of media to `names`; the media
    /// that go by them.
    pub(super) fn add_to(
        &mut self,
        fields: &[Field<'_>],
        scene: &mut shape::Reader<'_>,
        names: &mut Vec<String>,
    ) -> Result<Vec<MediumDescription>, Error> {
        let mut media = Vec::new();
        for (field, file) in fields.iter().zip(&mut self.files) {
            let table = field.table()?;
            let replaced = replaced(&table, file, scene)?;
            let (first_medium, first_material) = (names.len(), scene.materials.len());
            for (name, medium) in file.media.drain(..) {
                names.push(name);
                media.push(medium);
            }
            for named in file.materials.drain(..) {
                let mut material = named.material;
                material.inside.iter_mut().for_each(|m| *m += first_medium);
                scene.materials.push(material);
            }
            for (solid, i) in file.shapes.drain(..) {
                scene.add(solid, replaced[i].unwrap_or(first_material + i), None);
            }
        }
        Ok(media)
    }

    /// The lights of all files.
    pub(super) fn lamps(&self) -> impl Iterator<Item = &Lamp> {
        self.files.iter().flat_map(|file| &file.lamps)
    }
}

/// Reads the file of an include.
fn read(field: &Field<'_>, files: &Files, direct: bool, budget: &Budget) -> Result<Loaded, Error> {
    let table = field.table()?;
    let file = table.required("file")?;
    let path = files.named(file.string()?);
    if !is_gltf(&path) {
        return Err(file.error("is no glTF file: name a .gltf or .glb file, or use `[[shapes]]`"));
    }
    let options = options(&table)?;
    table.expect(&["materials"]);
    table.finish()?;
    let loaded = gltf::load(&path, &options, (files, budget));
    loaded.map_err(|e| if direct { e } else { file.error(e) })
}

fn options(table: &Table<'_>) -> Result<Options, Error> {
    let flag = |key, or| table.optional(key).map_or(Ok(or), |f| f.boolean());
    let efficacy = match table.optional("luminous_efficacy") {
        Some(field) => f64::from(field.positive()?),
        None => LUMENS_PER_WATT,
    };
    let scene = match table.optional("scene") {
        Some(field) if field.is_string() => Some(SceneChoice::Name(field.string()?.into())),
        Some(field) => Some(SceneChoice::Index(
            field.integer(0, u32::MAX.into())? as usize
        )),
        None => None,
    };
    let camera = table.optional("camera").map(|f| f.string()).transpose()?;
    Ok(Options {
        transform: transform(table)?,
        scene,
        camera: camera.map(str::to_owned),
        lights: flag("lights", true)?,
        luminous_efficacy: efficacy,
        draft_extensions: flag("draft_extensions", false)?,
    })
}

/// What exporters count: lumens of the green light that is seen best.
const LUMENS_PER_WATT: f64 = 683.0;

/// For each material of the file, that of the scene which `materials` puts in its place.
fn replaced(
    table: &Table<'_>,
    file: &Loaded,
    scene: &shape::Reader<'_>,
) -> Result<Vec<Option<usize>>, Error> {
    let mut replaced = vec![None; file.materials.len()];
    let Some(field) = table.optional("materials") else {
        return Ok(replaced);
    };
    let known: Vec<_> = file.materials.iter().map(|m| m.name.as_str()).collect();
    for (name, field) in field.table()?.named() {
        field.check_name(name, "material of the glTF file", &known)?;
        let material = scene.material(&field)?;
        for (i, _) in known
            .iter()
            .enumerate()
            .filter(|(_, known)| **known == name)
        {
            replaced[i] = Some(material);
            let mut of_it = file.shapes.iter().filter(|(_, m)| *m == i);
            scene.check_uvs(material, of_it.all(|(solid, _)| solid.has_uvs()), &field)?;
        }
    }
    Ok(replaced)
}

/// Width of a picture whose film does not say it.
const WIDTH: f64 = 640.0;

/// Puts a camera into a scene that does not say where its own is, and gives the film the shape of
/// its picture where it has none.
fn complete(scene: &mut BTreeMap<String, Node>, view: &View, place: &Place) {
    let mut section = |name: &str| {
        let absent = || written(Value::Table(BTreeMap::new()), place);
        scene.remove(name).unwrap_or_else(absent)
    };
    let (mut camera, mut film) = (section("camera"), section("film"));
    if let (Value::Table(camera), Value::Table(film)) = (&mut camera.value, &mut film.value)
        && !camera.contains_key("position")
        && !camera.contains_key("look_at")
    {
        let aspect = view.aspect.unwrap_or(16.0 / 9.0);
        let [width, height] = ["width", "height"].map(|key| film.get(key).and_then(number));
        let [width, height] = match (width, height) {
            (None, Some(height)) => [(height * aspect).round().max(1.0), height],
            (width, height) => {
                let width = width.unwrap_or(WIDTH);
                [width, height.unwrap_or((width / aspect).round().max(1.0))]
            }
        };
        let add = |table: &mut BTreeMap<String, Node>, key: &str, value| {
            table
                .entry(key.into())
                .or_insert_with(|| written(value, place));
        };
        add(film, "width", Value::Integer(width as i64));
        add(film, "height", Value::Integer(height as i64));
        let vector = |v: glam::DVec3| {
            let numbers = v.to_array().map(|x| written(Value::Float(x), place));
            Value::Array(numbers.into())
        };
        add(camera, "position", vector(view.position));
        add(camera, "look_at", vector(view.position + view.forward));
        add(camera, "up", vector(view.up));
        let keys = ["fov", "vertical_fov", "width", "height"];
        match view.projection {
            _ if keys.iter().any(|&key| camera.contains_key(key)) => {}
            Projection::Perspective { yfov } => {
                add(camera, "vertical_fov", Value::Float(yfov.to_degrees()));
            }
            Projection::Orthographic { height } => {
                add(camera, "kind", Value::String("orthographic".into()));
                add(camera, "height", Value::Float(height));
            }
        }
    }
    scene.insert("camera".into(), camera);
    scene.insert("film".into(), film);
}

fn number(node: &Node) -> Option<f64> {
    match node.value {
        Value::Integer(i) => Some(i as f64),
        _ => None,
    }
}

fn written(value: Value, place: &Place) -> Node {
    Node {
        value,
        place: place.clone(),
        key: place.clone(),
    }
}
