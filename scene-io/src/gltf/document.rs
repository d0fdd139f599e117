//! Opens a glTF file: its JSON, checked as a whole, and its buffers.

use super::container;
use super::uri;
use crate::files::Files;
use crate::{Error, open};
use gltf::json::validation::{Error as Fault, Validate};
use gltf::json::{Index, Path as JsonPath, Root, buffer};
use serde::Deserialize;
use std::cell::Cell;
use std::collections::HashMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A glTF file. Indices within its JSON are known to be in range.
pub(super) struct Document {
    pub(super) path: PathBuf,
    pub(super) root: Root,
    /// Beside the file.
    pub(super) files: Files,
    /// `None` for a buffer without a source.
    buffers: Vec<Option<Arc<[u8]>>>,
    /// Bytes that may still be made of those of the file.
    means: Cell<u64>,
}

/// Extensions whose meaning is known; others that a file requires are an error.
const EXTENSIONS: [&str; 8] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Known only on request.
const DRAFTS: [&str; 1] = ["KHR_materials_volume_scatter"];

/// What is made of a file is at most this many times its size: more comes from a few bytes that are
/// used over and over.
const EXPANSION: u64 = 64;

/// What decides whether the rest can be read at all.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Head {
    asset: Asset,
    #[serde(default)]
    extensions_used: Vec<String>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Asset {
    version: String,
    min_version: Option<String>,
}

impl Document {
    /// Opens a file with the buffers that it names. What it uses and nobody here understands is
    /// added to `notices`.
    pub(super) fn open(
        path: &Path,
        files: &Files,
        drafts: bool,
        notices: &mut Vec<String>,
    ) -> Result<Self, Error> {
        let files = files.followed_from(path);
        let bytes = open::read(path)?;
        let (json, bin) = container::split(path, &bytes)?;
        check_head(path, json, drafts, notices)?;
        let root: Root = deserialize(path, json)?;
        check_positions(path, &root)?;
        validate(path, &root)?;
        let buffers = buffers(path, &files, &root, bin)?;
        let held: usize = buffers.iter().flatten().map(|b| b.len()).sum();
        let means = EXPANSION * (bytes.len() as u64 + held as u64) + (1 << 20);
        Ok(Self {
            path: path.to_owned(),
            root,
            files,
            buffers,
            means: Cell::new(means),
        })
    }

    /// A complaint about a part of the file.
    pub(super) fn error(&self, field: impl Display, problem: impl Display) -> Error {
        error(&self.path, field, problem)
    }

    /// The bytes of a buffer view, and its stride.
    pub(super) fn view(&self, view: Index<buffer::View>) -> Result<(&[u8], Option<usize>), Error> {
        let field = format!("bufferViews[{}]", view.value());
        let view = &self.root.buffer_views[view.value()];
        let index = view.buffer.value();
        let buffer = self.buffers[index].as_deref().ok_or_else(|| {
            self.error(
                format!("buffers[{index}].uri"),
                "is missing: name a file, or embed the buffer",
            )
        })?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0);
        let bytes = end.and_then(|end| buffer.get(start as usize..end as usize));
        let bytes = bytes.ok_or_else(|| {
            let (length, held) = (view.byte_length.0, buffer.len());
            let range = format!("{length} bytes from byte {start}");
            let why = format!("covers {range} of buffer {index}, which has {held}: export again");
            self.error(&field, why)
        })?;
        Ok((bytes, view.byte_stride.map(|s| s.0)))
    }

    /// Counts `bytes` that are made of the file.
    pub(super) fn spend(&self, bytes: usize, field: impl Display) -> Result<(), Error> {
        match self.means.get().checked_sub(bytes as u64) {
            Some(rest) => {
                self.means.set(rest);
                Ok(())
            }
            None => Err(self.error(
                field,
                format!(
                    "all that is described is more than {EXPANSION} times as large as the file: \
                     the same data are used too often; use nodes that share a mesh"
                ),
            )),
        }
    }
}

pub(super) fn error(path: &Path, field: impl Display, problem: impl Display) -> Error {
    Error::Gltf {
        path: path.to_owned(),
        field: field.to_string(),
        problem: problem.to_string(),
    }
}

fn check_head(
    path: &Path,
    json: &[u8],
    drafts: bool,
    notices: &mut Vec<String>,
) -> Result<(), Error> {
    let head: Head = deserialize(path, json)?;
    let asset = &head.asset;
    let newer = asset.min_version.as_deref().is_some_and(|v| v != "2.0");
    if !asset.version.starts_with("2.") || newer {
        let found = asset.min_version.as_ref().unwrap_or(&asset.version);
        let why = format!("is {found:?}: export as glTF 2.0");
        return Err(error(path, "asset.version", why));
    }
    let known = |name: &String| {
        EXTENSIONS.contains(&name.as_str()) || drafts && DRAFTS.contains(&name.as_str())
    };
    let unknown = |names: &[String]| -> Vec<String> {
        names.iter().filter(|name| !known(name)).cloned().collect()
    };
    let required = unknown(&head.extensions_required);
    if !required.is_empty() {
        let draft = DRAFTS.iter().any(|d| required.iter().any(|r| r == d));
        let hint = if draft {
            ", or read drafts with `draft_extensions = true`"
        } else {
            ""
        };
        let why = format!(
            "{} not supported: export without{hint}",
            required.join(", ")
        );
        return Err(error(path, "extensionsRequired", why));
    }
    let used = unknown(&head.extensions_used);
    if !used.is_empty() {
        let what = used.join(", ");
        notices.push(format!("{}: left out: {what}", path.display()));
    }
    Ok(())
}

/// Reads JSON; a fault is named with its place in the tree, and its line.
fn deserialize<'a, T: Deserialize<'a>>(path: &Path, json: &'a [u8]) -> Result<T, Error> {
    let mut reader = serde_json::Deserializer::from_slice(json);
    let fault = |field: String, e: serde_json::Error| {
        // Where nothing was read yet, there is no place in the tree.
        let field = match field.as_str() {
            "." | "?" => "glTF".into(),
            _ => field,
        };
        error(path, field, format!("{e}: export again, or mend the JSON"))
    };
    let value = serde_path_to_error::deserialize(&mut reader)
        .map_err(|e| fault(e.path().to_string(), e.into_inner()))?;
    reader.end().map_err(|e| fault(".".into(), e))?;
    Ok(value)
}

/// The crate's own checks look at the accessors of positions before they look whether there are
/// such.
fn check_positions(path: &Path, root: &Root) -> Result<(), Error> {
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let bad =
                (primitive.attributes.iter()).find(|(_, a)| a.value() >= root.accessors.len());
            if let Some((name, accessor)) = bad {
                let name = name.to_string();
                let field = format!("meshes[{m}].primitives[{p}].attributes.{name}");
                let count = root.accessors.len();
                let why = format!("is accessor {accessor}, but there are {count}: export again");
                return Err(error(path, field, why));
            }
        }
    }
    Ok(())
}

/// What the crate calls extensions, and what they are called in files.
const NAMES: [(&str, &str); 3] = [
    (".khrLightsPunctual", ".KHR_lights_punctual"),
    (
        ".extensions.transmission",
        ".extensions.KHR_materials_transmission",
    ),
    (".extensions.volume", ".extensions.KHR_materials_volume"),
];

fn validate(path: &Path, root: &Root) -> Result<(), Error> {
    let mut faults = Vec::new();
    root.validate(root, JsonPath::new, &mut |at, fault| {
        faults.push((at().0, fault));
    });
    // Extensions were checked, bounds are not needed, and attributes of unknown names not looked at.
    let matters = |(at, fault): &(String, Fault)| {
        *fault != Fault::Unsupported
            && !at.contains("<invalid semantic name>")
            && !(at.ends_with(".min") || at.ends_with(".max"))
    };
    match faults.into_iter().find(matters) {
        None => Ok(()),
        Some((at, fault)) => {
            let why = match fault {
                Fault::IndexOutOfBounds => "refers to what the file does not have",
                Fault::Missing => "is missing",
                Fault::Oversize => "is larger than memory can be",
                _ => "has a value that glTF 2.0 does not know",
            };
            let mut field = at.replace("[\"", ".").replace("\"]", "");
            for (found, name) in NAMES {
                field = field.replace(found, name);
            }
            Err(error(path, field, format!("{why}: export again")))
        }
    }
}

fn buffers(
    path: &Path,
    files: &Files,
    root: &Root,
    bin: Option<&[u8]>,
) -> Result<Vec<Option<Arc<[u8]>>>, Error> {
    let mut known: HashMap<&str, Arc<[u8]>> = HashMap::new();
    let mut buffers = Vec::new();
    for (i, buffer) in root.buffers.iter().enumerate() {
        let fault = |problem: String| error(path, format!("buffers[{i}].uri"), problem);
        let bytes = match (buffer.uri.as_deref(), bin) {
            (Some(uri), _) => Some(match known.get(uri) {
                Some(bytes) => bytes.clone(),
                None => {
                    let bytes: Arc<[u8]> = uri::read(files, uri).map_err(fault)?.into();
                    known.insert(uri, bytes.clone());
                    bytes
                }
            }),
            (None, Some(bin)) if i == 0 => Some(bin.into()),
            (None, _) => None,
        };
        let (claimed, held) = (buffer.byte_length.0, bytes.as_ref().map(|b| b.len()));
        if let Some(held) = held.filter(|&held| (held as u64) < claimed) {
            return Err(error(
                path,
                format!("buffers[{i}].byteLength"),
                format!(
                    "is {claimed}, but there are {held} bytes: the file is cut off, copy it again"
                ),
            ));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}
