//! What a pass takes of the heap, alone in a process.

use cap::Cap;
use std::alloc::System;
use std::path::Path;
use tyndall_beam_radiance::BeamRadiance;
use tyndall_core::{Integrator, Rgb};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::{check_memory, cornell_box};

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

const FOG: &str = r#"{ kind = "homogeneous", sigma_a = 0.1, sigma_s = [5, 4, 3] }"#;

#[test]
fn photons_take_no_more_than_is_allowed() {
    let file = SceneFile::parse(&cornell_box(FOG), Path::new("memory"), &[]);
    let scene: Scene<Rgb> = file.and_then(|file| file.build()).expect("a scene");
    check_memory(
        &[&|allowed, cx| {
            let method = BeamRadiance::new().paths(10_000).max_bytes(allowed);
            method.begin_pass(&scene, cx, None).map(drop)
        }],
        || [MEMORY.allocated(), MEMORY.max_allocated()],
    );
}
