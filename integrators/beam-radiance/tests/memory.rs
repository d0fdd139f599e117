//! What a pass takes of the heap, alone in a process.

use cap::Cap;
use std::alloc::System;
use std::path::Path;
use tyndall_beam_radiance::BeamRadiance;
use tyndall_core::{Integrator, Rgb};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::check_memory;

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

const SCENE: &str = r#"
camera = { position = [0, 0, 0.5], look_at = [0, 0, 0], fov = 40, medium = "fog" }
film = { width = 1, height = 1 }
[media]
fog = { kind = "homogeneous", sigma_a = 0.1, sigma_s = [5, 4, 3] }
[materials]
wall = { kind = "diffuse", reflectance = 0.5 }
[[shapes]]
kind = "box"
min = [-1, -1, -1]
max = [1, 1, 1]
material = "wall"
[[lights]]
kind = "point"
position = [0, 0, 0]
power = 1
"#;

#[test]
fn photons_take_no_more_than_is_allowed() {
    let file = SceneFile::parse(SCENE, Path::new("memory"), &[]).unwrap();
    let scene: Scene<Rgb> = file.build().unwrap();
    check_memory(
        &[&|allowed, cx| {
            let method = BeamRadiance::new().paths(10_000).max_bytes(allowed);
            method.begin_pass(&scene, cx, None).map(drop)
        }],
        || [MEMORY.allocated(), MEMORY.max_allocated()],
    );
}
