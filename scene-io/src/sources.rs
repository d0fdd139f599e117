//! The files that a scene is made of.

use crate::Error;
use crate::file::{Node, Value, parse_document};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// The scene file, the files that it (or an override) names, and those that they name in turn: MTL
/// files and textures of an OBJ, buffers and images of a glTF. In a fixed order, each once. What
/// their bytes say, and the overrides, is all that a scene depends on.
///
/// # Errors
/// [`Error::Read`], and what [`SceneFile::load`](crate::SceneFile::load) says of a file that is no
/// TOML.
pub fn sources(path: &Path, overrides: &[(String, String)]) -> Result<Vec<PathBuf>, Error> {
    let mut found = vec![path.to_owned()];
    let mut next = 0;
    while let Some(path) = found.get(next).cloned() {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut see = |name: &str| {
            let file = folder.join(name);
            if file.is_file() && !found.contains(&file) {
                found.push(file);
            }
        };
        let unreadable = |source| Error::Read {
            path: path.clone(),
            source,
        };
        match extension(&path).as_str() {
            "obj" | "mtl" => in_lines(&path, &mut see).map_err(unreadable)?,
            "gltf" | "glb" => in_gltf(&path, &mut see).map_err(unreadable)?,
            _ if next == 0 => {
                let text = std::fs::read_to_string(&path).map_err(unreadable)?;
                in_node(&parse_document(&path, &text, overrides)?, &mut see);
            }
            _ => {}
        }
        next += 1;
    }
    Ok(found)
}

fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

/// Every string of a scene file may be the name of a file.
fn in_node(node: &Node, see: &mut impl FnMut(&str)) {
    match &node.value {
        Value::String(text) => see(text),
        Value::Array(nodes) => nodes.iter().for_each(|n| in_node(n, see)),
        Value::Table(nodes) => nodes.values().for_each(|n| in_node(n, see)),
        _ => {}
    }
}

/// `mtllib` of an OBJ and the maps of an MTL, whose options may stand before the name, and whose
/// name may hold spaces: every rest of the line may be one.
fn in_lines(path: &Path, see: &mut impl FnMut(&str)) -> std::io::Result<()> {
    const WORDS: [&str; 6] = ["mtllib", "bump", "disp", "decal", "refl", "norm"];
    let mut reader = BufReader::new(File::open(path)?);
    let mut line = Vec::new();
    while reader.read_until(b'\n', &mut line)? > 0 {
        let text = String::from_utf8_lossy(&line);
        let text = text.trim();
        let word = text.split_whitespace().next().unwrap_or_default();
        let lower = word.to_lowercase();
        if WORDS.contains(&lower.as_str()) || lower.starts_with("map_") {
            let starts = text.match_indices(char::is_whitespace);
            starts.for_each(|(i, _)| see(text[i..].trim_start()));
            text.split_whitespace().skip(1).for_each(&mut *see);
        }
        line.clear();
    }
    Ok(())
}

/// Every `uri` of the JSON that is no data.
fn in_gltf(path: &Path, see: &mut impl FnMut(&str)) -> std::io::Result<()> {
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    let mut header = [0; 20];
    // The JSON of a GLB is its first chunk: 12 bytes of header, length, type, text.
    if extension(path) == "glb" && file.read_exact(&mut header).is_ok() {
        let length = u32::from_le_bytes([header[12], header[13], header[14], header[15]]);
        file.take(length.into()).read_to_end(&mut bytes)?;
    } else {
        file.read_to_end(&mut bytes)?;
    }
    // What is no JSON names nothing; loading it says so.
    if let Ok(json) = serde_json::from_slice(&bytes) {
        in_json(&json, see);
    }
    Ok(())
}

fn in_json(json: &serde_json::Value, see: &mut impl FnMut(&str)) {
    use serde_json::Value;
    match json {
        Value::Array(values) => values.iter().for_each(|v| in_json(v, see)),
        Value::Object(entries) => {
            for (key, value) in entries {
                match value {
                    Value::String(uri) if key == "uri" && !uri.starts_with("data:") => {
                        see(uri);
                        see(&percent_decoded(uri));
                    }
                    value => in_json(value, see),
                }
            }
        }
        _ => {}
    }
}

fn percent_decoded(uri: &str) -> String {
    let mut parts = uri.split('%');
    let mut bytes: Vec<u8> = parts.next().unwrap_or_default().into();
    for part in parts {
        let digits = part.get(..2).map(|d| u8::from_str_radix(d, 16));
        match digits {
            Some(Ok(byte)) => {
                bytes.push(byte);
                bytes.extend(&part.as_bytes()[2..]);
            }
            _ => {
                bytes.push(b'%');
                bytes.extend(part.bytes());
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn files_are_followed_through_the_files_that_name_them() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write(
            "scene.toml",
            "[a]\nfile = 'm.obj'\nother = 'missing.vol'\n[[b]]\ngltf = 'g.gltf'\n[c]\nf = 'old'",
        );
        write("m.obj", "v 0 0 0\nmtllib two words.mtl\n");
        write("two words.mtl", "newmtl x\nmap_Kd -s 2 2 2 wood.png\n");
        write(
            "g.gltf",
            r#"{"images": [{"uri": "a%20b.png"}, {"uri": "data:,"}]}"#,
        );
        for name in ["a b.png", "wood.png", "old", "new"] {
            write(name, "");
        }
        let overrides = [("c.f".to_owned(), "new".to_owned())];
        let found = sources(&folder.path().join("scene.toml"), &overrides).unwrap();
        let names: Vec<_> = found
            .iter()
            .map(|p| p.file_name().unwrap().to_str().unwrap())
            .collect();
        assert_eq!(names[0], "scene.toml");
        let mut sorted = names.clone();
        sorted.sort();
        assert_eq!(
            sorted,
            [
                "a b.png",
                "g.gltf",
                "m.obj",
                "new",
                "scene.toml",
                "two words.mtl",
                "wood.png"
            ]
        );
    }
}
