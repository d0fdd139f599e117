//! What a denoiser takes: the colour, normal and distance of what rays meet first.
//!
//! False alarms: 1e-6 a statistical test, fixed seeds.

use glam::Vec3;
use std::path::Path;
use tyndall_core::{Domain, Rgb, Spectrum, Streams};
use tyndall_scene_io::{Features, Scene, SceneFile};
use tyndall_testkit::stats::{Moments, check_mean};
use tyndall_testkit::{TestSampler, rng};

/// A stream for each index.
struct Numbered;

impl Streams for Numbered {
    type Sampler = TestSampler;

    fn sampler(&self, domain: Domain, index: u64) -> TestSampler {
        rng(index << 8 | u64::from(domain.0))
    }
}

/// A wall at z = 0 that fills the right half of the view from z = 4; `wall` is its material.
fn scene<S: Spectrum>(film: &str, wall: &str, more: &str) -> Scene<S> {
    let text = format!(
        "
        [film]
        {film}
        [camera]
        position = [0, 0, 4]
        look_at = [0, 0, 0]
        fov = 40
        [materials.wall]
        {wall}
        [[shapes]]
        kind = 'quad'
        corner = [0, -9, 0]
        edge_u = [0, 18, 0]
        edge_v = [9, 0, 0]
        material = 'wall'
        {more}"
    );
    let file = SceneFile::parse(&text, Path::new("features.toml"), &[]);
    file.and_then(|f| f.build())
        .unwrap_or_else(|e| panic!("{e}"))
}

const FILM: &str = "width = 8\nheight = 6";

#[test]
fn surfaces_show_their_colour_and_the_side_that_is_seen() {
    let clay = "kind = 'diffuse'\nreflectance = [0.5, 0.25, 0.125]";
    for filter in ["", "filter = 'mitchell'"] {
        let scene = scene::<Rgb>(&format!("{FILM}\n{filter}"), clay, "");
        let Features {
            albedo,
            normal,
            depth,
            ..
        } = scene.features(&Numbered, 4);
        assert_eq!(albedo.len(), 48);
        assert_eq!(albedo[6], Rgb::new(0.5, 0.25, 0.125));
        // The quad's own normal points away.
        assert!(normal[6].distance(Vec3::Z) < 1e-6);
        assert!(depth[6] > 4.0 && depth[6] < 4.5);
        assert_eq!((albedo[1], normal[1]), (Rgb::default(), Vec3::ZERO));
        assert_eq!(depth[1], f32::INFINITY);
    }
}

#[test]
fn what_has_no_colour_of_its_own_is_white() {
    let seen = |wall: &str| scene::<Rgb>(FILM, wall, "").features(&Numbered, 1).albedo[6];
    let white = Rgb::splat(1.0);
    assert_eq!(seen("kind = 'mirror'\nreflectance = 0.5"), white);
    assert_eq!(seen("kind = 'conductor'\neta = 0.2\nk = 3"), white);
    // ((η − 1)² + k²)/((η + 1)² + k²) at normal incidence
    let rough = seen("kind = 'conductor'\neta = 2\nk = [0, 1, 2]\nroughness = 0.2");
    let expected = Rgb::new(1.0 / 9.0, 2.0 / 10.0, 5.0 / 13.0);
    assert!(
        (rough - expected).map(f32::abs).max_channel() < 1e-5,
        "{rough:?}"
    );
}

#[test]
fn fog_and_what_is_behind_it_blend_as_they_are_seen() {
    // Fog of σt = 0.3, albedo 0.8 in a box that reaches from z = 3 to z = 1.
    let fog = "
        [media.fog]
        kind = 'homogeneous'
        sigma_a = 0.06
        sigma_s = 0.24
        [materials.fog]
        kind = 'null'
        inside = 'fog'
        [[shapes]]
        kind = 'box'
        min = [-9, -9, 1]
        max = [9, 9, 3]
        material = 'fog'
    ";
    let wall = "kind = 'diffuse'\nreflectance = 0.2";
    let row = "width = 100\nheight = 100\ncrop = [52, 50, 40, 1]";
    let features = scene::<f32>(row, wall, fog).features(&Numbered, 2_000);
    let mut albedo = Moments::new();
    let mut normal = Moments::new();
    for (i, (a, n)) in features.albedo.iter().zip(&features.normal).enumerate() {
        let x = (2.0 * (f64::from(i as u32) + 52.5) / 100.0 - 1.0) * 20_f64.to_radians().tan();
        let passing = (-0.3 * 2.0 * (1.0 + x * x).sqrt()).exp();
        albedo.push(f64::from(a.channel(0)) - (0.2 * passing + 0.8 * (1.0 - passing)));
        normal.push(f64::from(n.z) - passing);
    }
    check_mean("albedo", albedo.estimate(), 0.0, 1e-6).unwrap();
    check_mean("normal", normal.estimate(), 0.0, 1e-6).unwrap();
    assert!(features.depth.iter().all(|d| (1.0..5.0).contains(d)));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let wall = "kind = 'diffuse'\nreflectance = 0.2";
    let lens = scene::<Rgb>(FILM, wall, "[environment]\nradiance = 1");
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build()
            .unwrap()
            .install(|| lens.features(&Numbered, 3))
    };
    assert_eq!(on(1), on(3));
}
