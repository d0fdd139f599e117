//! Errors as diagnostics: the text that they point at.

use miette::Diagnostic;
use std::path::Path;
use tyndall_scene_io::SceneFile;

const SCENE: &str = "
[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]
fov = 40

[film]
width = 8
height = 8

[materials.\"größe\"]
kind = \"diffuse\"
reflectance = 0.5
";

/// What is underlined in the scene with `from` replaced by `to`, and the message.
fn underlined(from: &str, to: &str) -> (String, String) {
    let text = SCENE.replace(from, to);
    assert_ne!(text, SCENE);
    let error = SceneFile::parse(&text, Path::new("a.toml"), &[]).expect_err("an error");
    let label = error.labels().and_then(|mut l| l.next()).expect("a label");
    let source = error.source_code().expect("a text");
    let read = source.read_span(label.inner(), 0, 0).expect("a span");
    let shown = &text.as_bytes()[label.offset()..label.offset() + label.len()];
    assert!(read.data().len() >= shown.len());
    let shown = String::from_utf8(shown.to_vec()).expect("whole characters");
    (shown, error.to_string())
}

#[test]
fn the_value_or_key_at_fault_is_underlined() {
    for (from, to, shown, message) in [
        ("fov = 40", "fov = 400", "400", "a.toml:5:7: `camera.fov`"),
        ("width", "widht", "widht", "a.toml:8:1: `film.widht`"),
        (
            "= 0.5",
            "= [1, 2]",
            "[1, 2]",
            "a.toml:13:15: `materials.größe.reflectance`",
        ),
        ("\"diffuse\"", "\"größer\"", "\"größer\"", "a.toml:12:8"),
        ("height = 8", "", "[film]", "a.toml:7:1: `film`"),
        ("= 40", "= 4x", "", "a.toml:5:"),
    ] {
        let (underlined, said) = underlined(from, to);
        assert!(said.starts_with(message), "{said}");
        if !shown.is_empty() {
            assert_eq!(underlined, shown, "{said}");
        }
        assert!(!underlined.contains('\n'));
    }
}

#[test]
fn what_is_not_in_a_file_has_no_excerpt() {
    let overrides = [("film.width".to_owned(), "0".to_owned())];
    let error = SceneFile::parse(SCENE, Path::new("a.toml"), &overrides).expect_err("an error");
    assert!(error.source_code().is_none() && error.labels().is_none());
    let error = SceneFile::load(Path::new("missing.toml"), &[]).expect_err("an error");
    assert!(error.source_code().is_none());
}
