//! What a pass takes of the heap, alone in a process.

use cap::Cap;
use std::alloc::System;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use tyndall_beam_radiance::BeamRadiance;
use tyndall_core::{Integrator, PassContext, PassError, Rgb};
use tyndall_driver::PassStreams;
use tyndall_scene_io::{Scene, SceneFile};

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

/// For the queues of the thread pool.
const BASE: u64 = 1 << 20;

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
    let (streams, running) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let mut allowed = 1 << 20;
    loop {
        let before = MEMORY.allocated();
        let method = BeamRadiance::new().paths(10_000).max_bytes(allowed);
        let cx = PassContext::new(0, &streams, &running);
        let pass = method.begin_pass(&scene, &cx, None);
        let peak = (MEMORY.max_allocated() - before) as u64;
        assert!(peak <= allowed + BASE, "{peak} bytes of {allowed}");
        match pass {
            Ok(_) => break,
            Err(PassError::Memory { needed, .. }) => assert!(needed > allowed),
            Err(other) => panic!("{other}"),
        }
        allowed += allowed / 4;
    }
}
