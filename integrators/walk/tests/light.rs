//! Light paths of a pass. False alarms: 1e-3 a test, fixed seeds.

use glam::Vec3;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use tyndall_core::{Coefficients, PassContext, PassError, Rgb, Spectrum};
use tyndall_driver::PassStreams;
use tyndall_media::{Homogeneous, Phase};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::hosts::{AnalyticHost, Interface, Light, View};
use tyndall_testkit::stats::{Moments, check_means};
use tyndall_walk::{LightPaths, Route, Visit};

const POWER: Rgb = Rgb(Vec3::new(3.0, 1.0, 0.5));

fn medium(sigma_a: Rgb, sigma_s: Rgb) -> Homogeneous<Rgb> {
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: Rgb::default(),
    };
    Homogeneous::new(coefficients, Phase::Isotropic).expect("valid coefficients")
}

fn fog() -> AnalyticHost<Homogeneous<Rgb>> {
    let medium = medium(Rgb::new(0.5, 1.0, 0.02), Rgb::new(2.0, 0.3, 1.5));
    AnalyticHost::infinite_medium(medium, Vec3::ONE, POWER, View::Rays(vec![]))
}

/// What is collected in pass `pass`.
fn pass<T>(pass: u64, run: impl FnOnce(&PassContext<'_, PassStreams>) -> T) -> T {
    let (streams, running) = (PassStreams::new(1, pass), AtomicBool::new(false));
    run(&PassContext::new(pass, &streams, &running))
}

/// Position and flux at every collision.
fn collisions(index: u64, paths: u64) -> Vec<(Vec3, Rgb)> {
    let host = fog();
    let collected = pass(index, |cx| {
        LightPaths::new(cx, paths, u64::MAX).collect(&host, |walk, sampler, found| {
            walk.visit(sampler, |visit, _, _| {
                if let Visit::Vertex(vertex, flux) = visit {
                    found.push((vertex.position, flux));
                }
            });
        })
    });
    collected.expect("light paths").concat()
}

#[test]
fn light_is_neither_lost_nor_made() {
    // Of what arrives at collisions 1 − albedo is absorbed, and all is absorbed in the end; also
    // where a pass has more paths than a sequence, or fewer than a batch.
    let albedo = Rgb::new(0.8, 0.3 / 1.3, 1.5 / 1.52);
    for (paths, passes) in [(100, 400), (70_000, 4)] {
        let mut absorbed = [Moments::new(); 3];
        for index in 0..passes {
            let found = collisions(index, paths);
            let sum = found.iter().map(|(_, flux)| *flux).sum::<Rgb>() * (Rgb::splat(1.0) - albedo);
            for (i, moments) in absorbed.iter_mut().enumerate() {
                moments.push(f64::from(sum.channel(i)));
            }
        }
        let cases: Vec<_> = (0..3)
            .map(|i| {
                (
                    "absorbed",
                    absorbed[i].estimate(),
                    f64::from(POWER.channel(i)),
                )
            })
            .collect();
        check_means(&cases, 1e-3).unwrap_or_else(|why| panic!("{paths} paths: {why}"));
    }
}

#[test]
fn emission_is_stratified() {
    // Of n directions, np fall into a cone that holds the share p; independent ones with variance
    // np(1 − p), stratified ones with much less. Of 200 estimates of a variance a tenth of it none
    // is half of it by chance: that is 40 standard errors.
    let host = fog();
    let (paths, p) = (1000, 0.25);
    let counts: Moments = (0..200)
        .map(|index| {
            let upward = pass(index, |cx| {
                LightPaths::new(cx, paths, u64::MAX).collect(&host, |walk, _, found| {
                    found.extend((walk.segment().ray.direction.x > 0.5).then_some(()));
                })
            });
            upward.expect("light paths").concat().len() as f64
        })
        .collect();
    let (n, variance) = (paths as f64, counts.variance());
    check_means(&[("share", counts.estimate(), n * p)], 1e-3).unwrap_or_else(|why| panic!("{why}"));
    assert!(variance < 0.5 * n * p * (1.0 - p), "{variance}");
}

#[test]
fn paths_are_in_order_on_any_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| collisions(3, 5000))
    };
    let one = on(1);
    assert!(one == on(2) && one == on(7));
    assert!(one != collisions(4, 5000), "passes differ");
}

#[test]
fn routes_tell_what_light_has_met() {
    // A lamp in front of a ball of fog: with a matched boundary its first collisions are direct,
    // behind glass they are specular, and the later ones diffuse.
    for (interface, first) in [
        (Interface::Matched, Route::Direct),
        (Interface::Dielectric(1.5), Route::Specular),
    ] {
        let light = Light::Point {
            position: Vec3::new(0.0, 0.0, -2.0),
            power: POWER,
        };
        let fog = medium(Rgb::splat(0.1), Rgb::splat(1.0));
        let host = AnalyticHost::sphere(fog, 1.0, interface, light, View::Rays(vec![]));
        let routes = pass(0, |cx| {
            LightPaths::new(cx, 2000, u64::MAX).collect(&host, |walk, sampler, found| {
                let mut collisions = 0;
                walk.visit(sampler, |visit, route, _| match visit {
                    Visit::Vertex(vertex, _) if vertex.is_collision() => {
                        found.push((collisions, route));
                        collisions += 1;
                    }
                    _ => {}
                });
            })
        });
        let routes = routes.expect("light paths").concat();
        assert!(routes.iter().any(|(collisions, _)| *collisions > 0));
        for (collisions, route) in routes {
            let expected = if collisions == 0 {
                first
            } else {
                Route::Diffuse
            };
            assert_eq!(route, expected, "{interface:?}");
        }
    }
}

/// A room of side 2 with another material on each wall, open at its edges; in it a ball of glass,
/// one of fog, and a lamp.
fn room() -> Scene<Rgb> {
    let text = r#"
        camera = { position = [0, 0, 0.9], look_at = [0, 0, 0], fov = 40 }
        film = { width = 4, height = 4 }
        media.fog = { kind = "homogeneous", sigma_a = 0.1, sigma_s = 1 }
        lights = [{ kind = "point", position = [0, 0, 0], power = 1 }]
        [materials]
        coated = { kind = "metallic_roughness", base_color = 0.9, roughness = 0 }
        nearly_smooth = { kind = "conductor", eta = 0.2, k = 3, roughness = 0.001 }
        rough = { kind = "metallic_roughness", base_color = 0.9, metallic = 1, roughness = 0.6 }
        matt = { kind = "diffuse", reflectance = 0.9 }
        mirror = { kind = "mirror", reflectance = 0.9 }
        polished = { kind = "conductor", eta = 0.2, k = 3 }
        glass = { kind = "dielectric", ior = 1.5 }
        boundary = { kind = "null", inside = "fog" }
        [[shapes]]
        kind = "quad"
        corner = [-0.9, -1, -0.9]
        edge_u = [0, 0, 1.8]
        edge_v = [1.8, 0, 0]
        material = "coated"
        [[shapes]]
        kind = "quad"
        corner = [-0.9, 1, -0.9]
        edge_u = [1.8, 0, 0]
        edge_v = [0, 0, 1.8]
        material = "nearly_smooth"
        [[shapes]]
        kind = "quad"
        corner = [-1, -0.9, -0.9]
        edge_u = [0, 1.8, 0]
        edge_v = [0, 0, 1.8]
        material = "rough"
        [[shapes]]
        kind = "quad"
        corner = [1, -0.9, -0.9]
        edge_u = [0, 0, 1.8]
        edge_v = [0, 1.8, 0]
        material = "matt"
        [[shapes]]
        kind = "quad"
        corner = [-0.9, -0.9, -1]
        edge_u = [1.8, 0, 0]
        edge_v = [0, 1.8, 0]
        material = "mirror"
        [[shapes]]
        kind = "quad"
        corner = [-0.9, -0.9, 1]
        edge_u = [0, 1.8, 0]
        edge_v = [1.8, 0, 0]
        material = "polished"
        [[shapes]]
        kind = "sphere"
        center = [-0.5, 0, 0]
        radius = 0.3
        material = "glass"
        [[shapes]]
        kind = "sphere"
        center = [0.5, 0, 0]
        radius = 0.3
        material = "boundary"
    "#;
    let scene = SceneFile::parse(text, Path::new("room"), &[]).and_then(|file| file.build());
    scene.unwrap_or_else(|why| panic!("{why}"))
}

/// What scatters at a place of the room.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Thing {
    Fog,
    Glass,
    /// Mirror or smooth metal.
    Smooth,
    /// A diffuse base under a smooth coat: after the coat, and after the base.
    Coat,
    Base,
    /// Roughness of the smallest α there is.
    NearlySmooth,
    Rough,
    Matt,
}

impl Thing {
    fn sends_on_in_discrete_directions(self) -> bool {
        matches!(self, Self::Glass | Self::Smooth | Self::Coat)
    }
}

/// By where it is; `wi` is where light went on from there.
fn thing(collided: bool, position: Vec3, wo: Vec3, wi: Vec3) -> Thing {
    let on = |wall: Vec3| (position.dot(wall) - 1.0).abs() < 1e-4;
    if collided {
        Thing::Fog
    } else if on(Vec3::NEG_Y) {
        let mirrored = Vec3::new(-wo.x, wo.y, -wo.z);
        // One diffuse direction in a million is so near to it.
        match mirrored.distance(wi) < 2e-3 {
            true => Thing::Coat,
            false => Thing::Base,
        }
    } else if on(Vec3::Y) {
        Thing::NearlySmooth
    } else if on(Vec3::NEG_X) {
        Thing::Rough
    } else if on(Vec3::X) {
        Thing::Matt
    } else if on(Vec3::Z) || on(Vec3::NEG_Z) {
        Thing::Smooth
    } else {
        assert!((position.distance(Vec3::new(-0.5, 0.0, 0.0)) - 0.3).abs() < 1e-4);
        Thing::Glass
    }
}

#[test]
fn routes_tell_what_light_has_met_at_surfaces() {
    let host = room();
    let paths = pass(0, |cx| {
        LightPaths::new(cx, 20_000, u64::MAX).collect(&host, |walk, sampler, found| {
            let mut path = Vec::new();
            walk.visit(sampler, |visit, route, _| {
                if let Visit::Vertex(vertex, _) = visit {
                    path.push((vertex.is_collision(), vertex.position, vertex.wo, route));
                }
            });
            found.push(path);
        })
    });
    let mut met = BTreeSet::new();
    for path in paths.expect("light paths").concat() {
        let mut expected = Route::Direct;
        // The boundary of fog is nothing that light meets.
        for (i, &(collided, position, wo, route)) in path.iter().enumerate() {
            assert_eq!(route, expected, "vertex {i} of {path:?}");
            let Some((_, _, next, _)) = path.get(i + 1) else {
                break;
            };
            let thing = thing(collided, position, wo, -*next);
            met.insert((format!("{route:?}"), thing));
            expected = match route {
                Route::Diffuse => Route::Diffuse,
                _ if thing.sends_on_in_discrete_directions() => Route::Specular,
                _ => Route::Diffuse,
            };
        }
    }
    // Everything was met by light of every route.
    assert_eq!(met.len(), 3 * 8, "{met:?}");
}

#[test]
fn a_pass_may_end_early() {
    let host = fog();
    let (streams, cancelled) = (PassStreams::new(1, 0), AtomicBool::new(true));
    let cx = PassContext::new(0, &streams, &cancelled);
    let result = LightPaths::new(&cx, 100, u64::MAX).collect(&host, |_, _, found| found.push(()));
    assert_eq!(result, Err(PassError::Cancelled));
    let result = pass(0, |cx| {
        LightPaths::new(cx, 10_000, 4096).collect(&host, |_, _, found| found.push(0_u64))
    });
    assert!(matches!(
        result,
        Err(PassError::Memory { allowed: 4096, .. })
    ));
    let none = pass(0, |cx| {
        LightPaths::new(cx, 0, 0).collect(&host, |_, _, found| found.push(0_u64))
    });
    assert_eq!(none, Ok(vec![]));
}
