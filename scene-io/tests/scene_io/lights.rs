//! Lights that rays cannot find: what leaves them is what arrives from them.

use glam::Vec3;
use std::path::Path;
use tyndall_core::{
    Anchor, EmissionSample, Geometry, LightDirect, LightEmission, LightKind, Ray, Rgb, Sampler,
    Spectrum,
};
use tyndall_scene_io::{Hit, Scene, SceneFile};
use tyndall_testkit::rng;
use tyndall_testkit::stats::chi2_sphere;

fn scene(lights: &str) -> Scene<Rgb> {
    let text = format!(
        "
        [film]
        width = 8
        height = 8
        [camera]
        position = [0, 0, 5]
        look_at = [0, 0, 0]
        fov = 60
        [materials.wall]
        kind = 'diffuse'
        reflectance = 0.5
        [[shapes]]
        kind = 'sphere'
        center = [0, -3, 0]
        radius = 1
        material = 'wall'
        {lights}"
    );
    let file = SceneFile::parse(&text, Path::new("lights.toml"), &[]);
    file.and_then(|f| f.build())
        .unwrap_or_else(|e| panic!("{e}"))
}

const LIGHTS: [&str; 6] = [
    "kind = 'point'\nposition = [1, 2, 3]\npower = [1, 20, 300]",
    "kind = 'spot'\nposition = [1, 2, 3]\nlook_at = [0, 0, 0]\ncone_angle = 70\npower = 5",
    "kind = 'spot'\nposition = [1, 2, 3]\ndirection = [0, 1, 0]\ncone_angle = 10\nfalloff_angle = 10\nintensity = 2",
    "kind = 'spot'\nposition = [0, 0, 0]\ndirection = [0, 1, 2]\ncone_angle = 180\nfalloff_angle = 0\npower = 2",
    "kind = 'directional'\ndirection = [1, 2, 3]\nirradiance = [1, 2, 3]",
    "kind = 'beam'\nposition = [1, 2, 3]\ndirection = [1, 2, -1]\nradius = 0.5\npower = [0, 0, 4]",
];

/// Irradiance on a plane that faces the light, at distance `t` along an emitted ray.
fn arriving(emission: &EmissionSample<Rgb, Hit>, t: f32) -> Rgb {
    match emission.kind {
        LightKind::Point => emission.flux * (emission.pdf.pdf_w / (t * t)),
        _ => emission.flux * emission.pdf.pdf_a,
    }
}

#[test]
fn what_leaves_is_what_arrives() {
    for light in LIGHTS {
        let scene = scene(&format!("[[lights]]\n{light}"));
        let mut sampler = rng(1);
        let mut missed = 0;
        for _ in 0..1000 {
            let emission = scene.sample_emission(sampler.next()).unwrap();
            let t = 0.01 + 5.0 * sampler.next_1d();
            let sent = arriving(&emission, t);
            let Some(direct) = scene.sample_direct(emission.ray.at(t), sampler.next()) else {
                missed += 1; // rounding decides at the rim of a cone or a beam
                continue;
            };
            let off = (direct.weight - sent).map(f32::abs).max_channel();
            let peak = sent.max_channel();
            assert!(
                off <= 1e-3 * peak + 1e-6 / (t * t),
                "{light}: {direct:?}, {emission:?}"
            );
            assert!((direct.wi + emission.ray.direction).length() < 1e-3);
            assert_eq!(direct.pdf_w, 0.0);
            let ray = scene.connect(&Anchor::Point(emission.ray.at(t)), &direct.target);
            assert!(ray.t_max.is_infinite() || (ray.t_max - t).abs() < 1e-3 * t.max(1.0));
        }
        assert!(missed < 10, "{light}: {missed}");
    }
}

/// False alarm 1e-6 for each of the lights.
#[test]
fn spots_send_light_by_their_density() {
    for light in &LIGHTS[..4] {
        let scene = scene(&format!("[[lights]]\n{light}"));
        let mut sampler = rng(2);
        let EmissionSample { ray, flux, .. } = scene.sample_emission([0.5; 6]).unwrap();
        chi2_sphere(
            |_| Some(scene.sample_emission(sampler.next()).unwrap().ray.direction),
            // The density of emission is the intensity seen over the power.
            |w| {
                let direct = scene.sample_direct(ray.origin + w, [0.5; 4]);
                direct.map_or(0.0, |d| d.weight.sum() / flux.sum())
            },
            200_000,
            1e-6,
        )
        .unwrap_or_else(|why| panic!("{light}: {why}"));
    }
}

#[test]
fn a_beam_lights_its_cylinder_only() {
    let scene = scene(&format!("[[lights]]\n{}", LIGHTS[5]));
    let axis = Vec3::new(1.0, 2.0, -1.0).normalize();
    let (start, across) = (Vec3::new(1.0, 2.0, 3.0), axis.any_orthonormal_vector());
    let lit = |t: f32, r: f32| {
        scene
            .sample_direct(start + t * axis + r * across, [0.5; 4])
            .is_some()
    };
    assert!(lit(1.0, 0.0) && lit(100.0, 0.49) && lit(0.01, -0.49));
    assert!(!lit(-0.01, 0.0) && !lit(1.0, 0.51) && !lit(100.0, -0.51));
}

#[test]
fn pivots_are_where_light_matters() {
    let point = scene(&format!("[[lights]]\n{}", LIGHTS[0]));
    let ray = Ray::new(Vec3::new(0.0, 5.0, 0.0), Vec3::X);
    assert_eq!(point.pivot(&ray, [0.5; 4]), Some(Vec3::new(1.0, 2.0, 3.0)));
    let sun = scene(&format!("[[lights]]\n{}", LIGHTS[4]));
    assert_eq!(sun.pivot(&ray, [0.5; 4]), None);
    let laser =
        "kind = 'beam'\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nradius = 0.5\npower = 1";
    let laser = scene(&format!("[[lights]]\n{laser}"));
    let pivot = |origin: [f32; 3], direction: Vec3| {
        laser
            .pivot(&Ray::new(origin.into(), direction), [0.5; 4])
            .unwrap()
    };
    // Above the axis at z = 3: nearest at (0, 0, 3), half a unit away from the ray.
    assert!((pivot([-9.0, 2.0, 3.0], Vec3::X) - Vec3::new(0.0, -0.5, 3.0)).length() < 1e-6);
    // Behind the start.
    assert!((pivot([-9.0, 2.0, -3.0], Vec3::X) - Vec3::new(0.0, -0.5, 0.0)).length() < 1e-6);
    for origin in [[0.0, 0.0, 1.0], [0.3, 0.0, -1.0]] {
        let along = pivot(origin, Vec3::Z);
        assert!((along.truncate().length() - 0.5).abs() < 1e-6 && along.z >= 0.0);
    }
}

#[test]
fn a_lamp_is_sampled_at_its_pivot_and_a_round_one_around_it() {
    let square = "kind = 'quad'\ncorner = [2, 2, -1]\nedge_u = [2, 0, 0]\nedge_v = [0, 0, 2]";
    let round = "kind = 'sphere'\ncenter = [2, 2, 0]\nradius = 0.5";
    for (lamp, center) in [(square, None), (round, Some(Vec3::new(2.0, 2.0, 0.0)))] {
        let scene = scene(&format!(
            "[[shapes]]\n{lamp}\nmaterial = 'wall'\nemission = 4"
        ));
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        let mut sampler = rng(3);
        let mut found = 0;
        for _ in 0..100 {
            let u = sampler.next();
            let Some(direct) = scene.sample_direct(ray.origin, u) else {
                continue;
            };
            found += 1;
            let Anchor::Surface(hit) = &direct.target else {
                panic!("{direct:?}");
            };
            let expected = center.unwrap_or(scene.surface(hit).position);
            assert_eq!(scene.pivot(&ray, u), Some(expected));
            let radiance = direct.weight * direct.pdf_w;
            let off = (radiance - Rgb::splat(4.0)).map(f32::abs);
            assert!(off.max_channel() < 1e-3);
        }
        assert!(found > 40, "{lamp}: {found}");
    }
}

#[test]
fn a_lamp_is_found_beside_a_sun_over_a_wide_ground() {
    let wide = "
        [[shapes]]
        kind = 'quad'
        corner = [-1e4, -4, -1e4]
        edge_u = [0, 0, 2e4]
        edge_v = [2e4, 0, 0]
        material = 'wall'
        [[lights]]
        kind = 'point'
        position = [0, 2, 0]
        power = 100
        [[lights]]
        kind = 'directional'
        direction = [0, -1, 0]
        irradiance = 0.001";
    // Half of them, within six standard errors: a false alarm of 2e-9.
    let lamps = lamps_in_a_thousand(&scene(wide));
    assert!((405..=595).contains(&lamps), "{lamps}");
}

/// How many of a thousand samples of direct light find a point light.
fn lamps_in_a_thousand(scene: &Scene<Rgb>) -> usize {
    let mut sampler = rng(1);
    (0..1_000)
        .filter_map(|_| scene.sample_direct(Vec3::ZERO, sampler.next()))
        .filter(|direct| direct.kind == LightKind::Point)
        .count()
}
