//! What the command tells of methods that gather photons.

use crate::support::images::{said, tyndall};
use std::process::Output;
use tempfile::TempDir;
use tyndall_core::{Figure, FigureValue};
use tyndall_scene_io::{RenderedImage, read_exr};

fn scene(name: &str) -> String {
    format!("{}/../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// Renders a small picture of a scene in few passes, with these values set.
fn run(folder: &TempDir, scene: &str, out: &str, flags: &[&str], set: &[String]) -> Output {
    let small = ["film.width=12", "film.height=9"].map(str::to_owned);
    let set = small.iter().chain(set);
    let set: Vec<_> = set.flat_map(|set| ["--set", set]).collect();
    let head = ["render", scene, "-o", out, "--passes", "2"];
    tyndall(folder, &[&head[..], flags, &set].concat())
}

fn render(
    folder: &TempDir,
    scene: &str,
    out: &str,
    integrator: &str,
    set: &[String],
) -> RenderedImage {
    let output = run(folder, scene, out, &["--integrator", integrator], set);
    assert!(output.status.success(), "{integrator}: {}", said(&output));
    read_exr(&folder.path().join(out)).expect("an image")
}

fn integrator_set(options: &[(&str, &str)]) -> Vec<String> {
    let set = |(key, value): &(&str, &str)| format!("integrator.{key}={value}");
    options.iter().map(set).collect()
}

/// The values of an image's `tyndall.integrator`, as `--set` takes them. Left out is what a scene
/// file does not say: constants of the version, and that nothing limits or replaces an option.
fn options_in(image: &RenderedImage) -> Vec<String> {
    let constant = [
        "starting_paths",
        "step",
        "min_steps",
        "max_error",
        "flights",
    ];
    let absent = ["inf", "unlimited", "a tenth of the scene", "0"];
    let optimal = "2/3 on surfaces and 4/7 in media";
    let (_, options) = (image.metadata.integrator)
        .split_once(", ")
        .expect("options behind the name");
    let pairs = options
        .split(", ")
        .map(|o| o.split_once(' ').expect("a value"));
    pairs
        .filter(|(key, value)| {
            !constant.contains(key) && !absent.contains(value) && *value != optimal
        })
        .map(|(key, value)| match key {
            "max_bytes" => {
                let bytes: u64 = value.parse().expect("a number of bytes");
                format!("integrator.memory={}", bytes >> 20)
            }
            _ => format!("integrator.{key}={value}"),
        })
        .collect()
}

#[test]
fn a_picture_can_be_rendered_again_from_what_it_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene("cornell_fog");
    let few = ("paths", "3000");
    for (integrator, set) in [
        ("path", vec![]),
        ("path", vec![("max_depth", "3"), ("scattering", "single")]),
        ("photon_map", vec![few]),
        (
            "photon_map",
            vec![few, ("radius", "0.2"), ("kernel", "cone")],
        ),
        (
            "photon_map",
            vec![few, ("sample_lights", "true"), ("final_gather", "2")],
        ),
        ("progressive_photon_map", vec![few]),
        (
            "progressive_photon_map",
            vec![
                few,
                ("statistics", "true"),
                ("alpha", "0.7"),
                ("max_radius", "0.3"),
            ],
        ),
        ("beam_radiance", vec![few]),
        (
            "beam_radiance",
            vec![
                few,
                ("nearest", "20"),
                ("surface_radius", "0.15"),
                ("blur", "3"),
                ("transmittance", "tracking"),
                ("memory", "100"),
            ],
        ),
        ("photon_beams", vec![few]),
        ("photon_beams", vec![few, ("beam_differentials", "1.5")]),
        (
            "photon_beams",
            vec![
                few,
                ("beam_radius", "0.07"),
                ("beam_nearest", "9"),
                ("estimator", "beam_beam_2d_ray"),
                ("light_beams", "short"),
                ("light_flights", "2"),
                ("alpha", "0.7"),
                ("sight_beams", "short"),
                ("radius", "0.1"),
                ("surface_nearest", "40"),
            ],
        ),
    ] {
        let first = render(&folder, &scene, "a.exr", integrator, &integrator_set(&set));
        let options = options_in(&first);
        for (key, value) in &set {
            let said = format!("integrator.{key}={value}");
            assert!(options.contains(&said), "{said} is not in {options:?}");
        }
        let default = if integrator == "path" {
            "scattering"
        } else {
            "kernel"
        };
        assert!(options.iter().any(|o| o.contains(default)), "{options:?}");
        let second = render(&folder, &scene, "b.exr", integrator, &options);
        assert_eq!(first.metadata.integrator, second.metadata.integrator);
        assert!(
            first.radiance == second.radiance,
            "{integrator}: {options:?}"
        );
    }
}

/// The figure of this name.
fn figure(figures: &[Figure], name: &str) -> Option<FigureValue> {
    figures.iter().find(|f| f.name == name).map(|f| f.value)
}

#[test]
fn figures_of_the_passes_are_told_and_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let few = integrator_set(&[("paths", "3000")]);
    let flags = ["--integrator", "beam_radiance"];
    let output = run(&folder, &scene("spot_smoke"), "a.exr", &flags, &few);
    let said = said(&output);
    let image = read_exr(&folder.path().join("a.exr")).expect("an image");
    let figures = &image.metadata.figures;
    let is = |name| figure(figures, name);
    assert_eq!(is("light paths"), Some(FigureValue::Total(6000)));
    assert!(matches!(is("photons in media"), Some(FigureValue::Total(n)) if n > 0));
    // The smoke varies, so that the table errs; by its default no more than this.
    let bounded = |value| matches!(value, Some(FigureValue::Largest(e)) if e > 0.0 && e <= 0.01);
    assert!(bounded(is("error of transmittance")), "{figures:?}");
    let shrinks = |value| matches!(value, Some(FigureValue::Range([a, b])) if a < b && b < 1.0);
    assert!(shrinks(is("radius over the starting one")), "{figures:?}");
    for figure in figures {
        assert!(said.contains(&figure.to_string()), "{figure}: {said}");
    }
    // Where the medium is the same everywhere there is nothing to err in; a path tracer has nothing
    // to tell.
    let fog = render(
        &folder,
        &scene("cornell_fog"),
        "b.exr",
        "beam_radiance",
        &few,
    );
    assert_eq!(
        figure(&fog.metadata.figures, "error of transmittance"),
        None
    );
    let path = render(&folder, &scene("cornell_fog"), "c.exr", "path", &[]);
    assert_eq!(path.metadata.figures, []);
}

#[test]
fn options_that_are_not_heeded_are_told_once_before_the_render() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene("cornell_fog");
    for (integrator, set, unheeded) in [
        ("path", &["paths", "alpha"][..], &["paths", "alpha"][..]),
        ("photon_map", &["alpha", "nearest", "memory"], &["alpha"]),
        ("photon_map", &["max_depth", "final_gather"], &["max_depth"]),
        (
            "progressive_photon_map",
            &["surface_nearest", "alpha"],
            &["surface_nearest"],
        ),
        (
            "beam_radiance",
            &["final_gather", "max_depth", "memory", "surface_nearest"],
            &["final_gather", "max_depth"],
        ),
    ] {
        let value = |key: &str| if key == "alpha" { "0.5" } else { "100" };
        let mut options: Vec<_> = set.iter().map(|key| (*key, value(key))).collect();
        options.extend((integrator != "path").then_some(("paths", "500")));
        let flags = ["--integrator", integrator];
        let output = run(&folder, &scene, "a.exr", &flags, &integrator_set(&options));
        let said = said(&output);
        assert!(output.status.success(), "{said}");
        let told: Vec<_> = said
            .lines()
            .take_while(|l| !l.contains("2 passes in"))
            .collect();
        let told: Vec<_> = told.iter().filter(|l| l.contains("heed")).collect();
        assert_eq!(told.len(), unheeded.len(), "{said}");
        for key in unheeded {
            let sentence = format!("`integrator.{key}`: {integrator} does not heed it: remove it");
            assert_eq!(said.matches(&sentence).count(), 1, "{said}");
        }
        let image = read_exr(&folder.path().join("a.exr")).expect("an image");
        let notes = image.metadata.notes.join(" ");
        assert!(
            !notes.contains("heed"),
            "not a matter of the image: {notes}"
        );
    }
}

#[test]
fn photons_that_do_not_fit_are_an_error_that_names_the_option() {
    let folder = tempfile::tempdir().expect("a folder");
    let set = integrator_set(&[("paths", "200000"), ("memory", "1")]);
    let flags = ["--integrator", "photon_map"];
    let output = run(&folder, &scene("cornell_fog"), "a.exr", &flags, &set);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert_eq!(said.trim_end().lines().count(), 1, "{said}");
    for needle in [
        "cornell_fog.toml",
        "`integrator.memory`",
        "1 MiB",
        "`integrator.paths`",
    ] {
        assert!(said.contains(needle), "{said}");
    }
}
