//! What a pass takes of the heap, alone in a process.

use cap::Cap;
use std::alloc::System;
use std::path::Path;
use tyndall_core::{Integrator, PassContext, Rgb};
use tyndall_driver::PassStreams;
use tyndall_photon_beams::PhotonBeams;
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::{check_memory, cornell_box};

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

const EVEN: &str = r#"{ kind = "homogeneous", sigma_a = 0.01, sigma_s = [0.5, 0.4, 0.3] }"#;
const SMOKE: &str = r#"{ kind = "grid", plume = { resolution = 16 }, min = [-1, 0, -1], max = [1, 2, 1], scale = 1, albedo = [0.9, 0.8, 0.7] }"#;

fn scene(fog: &str) -> Scene<Rgb> {
    let file = SceneFile::parse(&cornell_box(fog), Path::new("memory"), &[]);
    file.and_then(|file| file.build()).expect("a scene")
}

#[test]
fn beams_take_no_more_than_is_allowed() {
    let (even, smoke) = (scene(EVEN), scene(SMOKE));
    let method = PhotonBeams::new().paths(10_000).beam_radius(0.01);
    let pass = |scene, method: PhotonBeams| {
        move |allowed, cx: &PassContext<'_, PassStreams>| {
            method
                .max_bytes(allowed)
                .begin_pass(scene, cx, None)
                .map(drop)
        }
    };
    check_memory(
        &[
            &pass(&even, method),
            &pass(&even, method.beam_differentials(2.0)),
            &pass(&even, method.beam_nearest(8)),
            &pass(&even, method.paths(30_000).beam_radius(10.0)), // points
            &pass(&smoke, method.light_flights(16)),
        ],
        || [MEMORY.allocated(), MEMORY.max_allocated()],
    );
}
