//! Photons on surfaces, and caustics.

use crate::FALSE_ALARM;
use std::f64::consts::PI;
use std::path::Path;
use tyndall_beam_radiance::BeamRadiance;
use tyndall_core::Rgb;
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::stats::Figures;
use tyndall_testkit::{Run, Tier, in_both_tiers};

const REFLECTANCE: [f64; 3] = [0.5, 0.2, 0.8];
const SIGMA_A: [f64; 3] = [0.1, 0.2, 0.4];

/// A scene of one pixel in haze that absorbs, on the way of light and on that of sight.
fn scene(camera: &str, rest: &str) -> Scene<Rgb> {
    let text = format!(
        "
        film = {{ width = 1, height = 1 }}
        camera = {{ fov = 0.1, medium = 'haze', {camera} }}
        media.haze = {{ kind = 'homogeneous', sigma_a = {SIGMA_A:?}, sigma_s = 0 }}
        [materials]
        matt = {{ kind = 'diffuse', reflectance = {REFLECTANCE:?} }}
        dark = {{ kind = 'diffuse', reflectance = 0.001 }}
        glass = {{ kind = 'dielectric', ior = 1.5 }}
        {rest}"
    );
    let scene = SceneFile::parse(&text, Path::new("surfaces"), &[]).and_then(|file| file.build());
    scene.unwrap_or_else(|why| panic!("{why}"))
}

fn floor(material: &str) -> String {
    format!(
        "[[shapes]]
        kind = 'quad'
        corner = [-20, 0, 20]
        edge_u = [40, 0, 0]
        edge_v = [0, 0, -40]
        material = '{material}'\n"
    )
}

in_both_tiers! {
    a_floor_under_a_lamp,
    a_caustic_under_a_pane,
    an_integrating_sphere,
}

/// The mean of a function over Epanechnikov's kernel, by the midpoints of many rings and sectors.
fn over_kernel(radius: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..64 {
        let u = (f64::from(i) + 0.5) / 64.0;
        for k in 0..32 {
            let (sin, cos) = (PI * f64::from(k) / 16.0).sin_cos();
            sum += 4.0 * u * (1.0 - u * u) * f(radius * u * cos, radius * u * sin);
        }
    }
    sum / (64.0 * 32.0)
}

fn a_floor_under_a_lamp(tier: Tier) {
    let rest = "[[lights]]\nkind = 'point'\nposition = [0, 2, 0]\npower = 10";
    let scene = scene(
        "position = [1, 2, 1], look_at = [1, 0, 0]",
        &(floor("matt") + rest),
    );
    // I h/D³ e^(−σD), at a point one unit from below the lamp.
    let irradiance = |c: usize, x: f64, y: f64| {
        let distance = (4.0 + (1.0 + x).powi(2) + y * y).sqrt();
        10.0 / (4.0 * PI) * 2.0 / distance.powi(3) * (-SIGMA_A[c] * distance).exp()
    };
    let mut figures = Figures::default();
    let method = BeamRadiance::new().paths(10_000).alpha(1.0);
    let nearest = method.surface_nearest(20).starting_paths(10_000);
    // 143 photons a unit, so that 20 are in a radius of 0.21, which blurs light by 0.2 %.
    for (name, method, radius, passes) in [
        ("fixed", method.surface_radius(0.5), 0.5, [40, 400]),
        ("nearest", nearest, 0.21, [100, 1_500]),
    ] {
        let run = Run {
            passes: tier.passes(passes),
            samples: 1,
            seed: 1,
        };
        for (c, mean) in run.measure(&scene, &method).into_iter().enumerate() {
            let blurred = over_kernel(radius, |x, y| irradiance(c, x, y));
            let seen = (-SIGMA_A[c] * 5.0_f64.sqrt()).exp() * REFLECTANCE[c] / PI * blurred;
            figures.add(
                format!("{name} channel {c}"),
                mean,
                seen,
                tier.precision(0.04),
            );
        }
    }
    figures.check(FALSE_ALARM);
    // Sampled, nothing blurs it and nothing is left to chance but where the ray falls.
    let sampled = BeamRadiance::sampling_lights().paths(10);
    let run = Run {
        passes: 1,
        samples: 4,
        seed: 1,
    };
    let pixel = run.image(&scene, &sampled, 0)[0];
    for (c, found) in pixel.0.to_array().into_iter().enumerate() {
        let seen = (-SIGMA_A[c] * 5.0_f64.sqrt()).exp() * REFLECTANCE[c] / PI;
        let off = f64::from(found) / (seen * irradiance(c, 0.0, 0.0)) - 1.0;
        assert!(off.abs() < 2e-3, "channel {c}: {off}");
    }
}

fn a_caustic_under_a_pane(tier: Tier) {
    // A pane at normal incidence lets 2n/(n² + 1) pass, of all orders of reflection in it: photons
    // find it, whoever finds the light that meets nothing.
    let rest = floor("dark")
        + "[[shapes]]
        kind = 'box'
        min = [-8, 1.0, -8]
        max = [8, 1.2, 8]
        material = 'glass'
        [[lights]]
        kind = 'beam'
        position = [0, 3, 0]
        direction = [0, -1, 0]
        radius = 2
        power = 7";
    let scene = scene("position = [0.5, 0.6, 0.5], look_at = [0, 0, 0]", &rest);
    let through = 0.001 / PI * 7.0 / (4.0 * PI) * 3.0 / 3.25;
    let way = 2.8 + 0.86_f64.sqrt();
    let run = Run {
        passes: tier.passes([60, 400]),
        samples: 1,
        seed: 1,
    };
    let by_photons = BeamRadiance::new().surface_radius(0.6);
    let by_sampling = BeamRadiance::sampling_lights().surface_nearest(200);
    let found = [
        (
            "photons",
            run.measure(&scene, &by_photons.paths(2_000).alpha(1.0)),
        ),
        (
            "sampling",
            run.measure(
                &scene,
                &by_sampling.paths(2_000).starting_paths(2_000).alpha(1.0),
            ),
        ),
    ];
    let mut figures = Figures::default();
    for (name, found) in found {
        for (c, mean) in found.into_iter().enumerate() {
            let expected = through * (-SIGMA_A[c] * way).exp();
            figures.add(
                format!("{name} channel {c}"),
                mean,
                expected,
                tier.precision(0.02),
            );
        }
    }
    figures.check(FALSE_ALARM);
}

fn an_integrating_sphere(tier: Tier) {
    // Irradiance is the same everywhere, and a disc cuts a cap of area πr² out of a sphere: nothing
    // blurs it. From wall to wall, ways are 2R cos θ long: the share that arrives of what a wall
    // scatters is T = ∫2μ e^(−xμ) dμ = 2(1 − (1 + x)e^−x)/x², x = 2σR.
    let rest = "[[shapes]]
        kind = 'sphere'
        center = [0, 0, 0]
        radius = 1
        material = 'matt'
        [[lights]]
        kind = 'point'
        position = [0, 0, 0]
        power = 10";
    let scene = scene("position = [0.1, 0, 0.3], look_at = [0, 0, -1]", rest);
    let expected = |c: usize| {
        let (rho, sigma, x) = (REFLECTANCE[c], SIGMA_A[c], 2.0 * SIGMA_A[c]);
        let passing = 2.0 * (1.0 - (1.0 + x) * (-x).exp()) / (x * x);
        let irradiance = 10.0 / (4.0 * PI) * (-sigma).exp() / (1.0 - rho * passing);
        rho / PI * irradiance * (-sigma * 1.7_f64.sqrt()).exp()
    };
    let run = Run {
        passes: tier.passes([80, 2_500]),
        samples: 1,
        seed: 1,
    };
    let by_photons = BeamRadiance::new().surface_radius(0.3);
    let by_sampling = BeamRadiance::sampling_lights().surface_nearest(40);
    let found = [
        (
            "photons",
            run.measure(&scene, &by_photons.paths(3_000).alpha(1.0)),
        ),
        (
            "sampling",
            run.measure(
                &scene,
                &by_sampling.paths(3_000).starting_paths(3_000).alpha(1.0),
            ),
        ),
    ];
    let mut figures = Figures::default();
    for (name, found) in found {
        for (c, mean) in found.into_iter().enumerate() {
            let name = format!("{name} channel {c}");
            figures.add(name, mean, expected(c), tier.precision(0.04));
        }
    }
    figures.check(FALSE_ALARM);
}
