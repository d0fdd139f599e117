//! The demo scenes are the same to the bit on any number of threads.

use std::path::Path as FilePath;
use tyndall_core::Rgb;
use tyndall_driver::{Budget, Film, Render};
use tyndall_path::Path;
use tyndall_scene_io::{Scene, SceneFile};

fn film(scene: &Scene<Rgb>, threads: usize) -> Film<Rgb> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a pool")
        .install(|| {
            Render::new(scene, &Path::new())
                .seed(3)
                .run(Budget::Passes(2), |_| {})
        })
        .expect("a film")
}

#[test]
fn one_two_and_seven_threads_give_the_same_bits() {
    for name in [
        "cornell_fog",
        "glass_ball",
        "laser",
        "spot_smoke",
        "two_plumes",
    ] {
        let path = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let small = ["film.width", "film.height"].map(|key| (key.into(), "50".into()));
        let file = SceneFile::load(FilePath::new(&path), &small).unwrap_or_else(|e| panic!("{e}"));
        let scene = file.build::<Rgb>().unwrap_or_else(|e| panic!("{e}"));
        let one = film(&scene, 1);
        assert!(one.mean().iter().any(|v| *v > 0.0), "{name} is black");
        assert_eq!(one.non_finite(), 0, "{name}");
        for threads in [2, 7] {
            assert!(one == film(&scene, threads), "{name} on {threads} threads");
        }
    }
}
