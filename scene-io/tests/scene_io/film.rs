//! Crops, reconstruction filters and cameras.
//!
//! False alarms: 1e-6 a statistical test, fixed seeds.

use glam::Vec3;
use std::path::Path;
use tyndall_core::{Ray, Sampler, Sensor, SensorImportance};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Moments, check_mean, sidak};

const FALSE_ALARM: f64 = 1e-6;
const WIDTH: u32 = 10;
const HEIGHT: u32 = 8;
/// Half sides of the picture at distance 1.
const HALF: [f32; 2] = [0.5, 0.4];

/// A camera at 0 that looks along −z.
fn scene(camera: &str, film: &str) -> Scene<f32> {
    let text = format!(
        "
        [film]
        width = {WIDTH}
        height = {HEIGHT}
        {film}
        [camera]
        position = [0, 0, 0]
        look_at = [0, 0, -1]
        {camera}"
    );
    let file = SceneFile::parse(&text, Path::new("film.toml"), &[]);
    file.and_then(|f| f.build())
        .unwrap_or_else(|e| panic!("{e}"))
}

/// The horizontal angle of [`HALF`].
fn pinhole() -> String {
    format!("fov = {}", 2.0 * f64::from(HALF[0]).atan().to_degrees())
}

fn thin_lens() -> String {
    let lens = "kind = 'thin_lens'\nlens_radius = 0.2\nfocus_distance = 3";
    format!("{lens}\n{}", pinhole())
}

/// Where a direction from the pinhole crosses the film, in pixels.
fn place(w: Vec3) -> [f32; 2] {
    let [x, y] = [w.x / -w.z / HALF[0], w.y / w.z / HALF[1]];
    [
        0.5 * (1.0 + x) * WIDTH as f32,
        0.5 * (1.0 + y) * HEIGHT as f32,
    ]
}

/// The direction through a place on the film.
fn through([x, y]: [f32; 2]) -> Vec3 {
    let x = (2.0 * x / WIDTH as f32 - 1.0) * HALF[0];
    let y = (1.0 - 2.0 * y / HEIGHT as f32) * HALF[1];
    Vec3::new(x, y, -1.0).normalize()
}

/// A filter as the scene file names it, its radius, and its textbook formula, not normalised.
type Known = (&'static str, f64, fn(f64) -> f64);

const FILTERS: [Known; 8] = [
    ("'box'", 0.5, |_| 1.0),
    ("{ kind = 'box', radius = 1.25 }", 1.25, |_| 1.0),
    ("'tent'", 1.0, |x| 1.0 - x),
    ("'gaussian'", 2.0, |x| {
        (-2.0 * x * x).exp() - (-8.0_f64).exp()
    }),
    (
        "{ kind = 'gaussian', stddev = 1, radius = 1.5 }",
        1.5,
        |x| (-0.5 * x * x).exp() - (-1.125_f64).exp(),
    ),
    ("'mitchell'", 2.0, |x| {
        if x < 1.0 {
            7.0 * x.powi(3) - 12.0 * x * x + 16.0 / 3.0
        } else {
            -7.0 / 3.0 * x.powi(3) + 12.0 * x * x - 20.0 * x + 32.0 / 3.0
        }
    }),
    // Catmull–Rom
    ("{ kind = 'mitchell', b = 0, c = 0.5 }", 2.0, |x| {
        if x < 1.0 {
            1.5 * x.powi(3) - 2.5 * x * x + 1.0
        } else {
            -0.5 * x.powi(3) + 2.5 * x * x - 4.0 * x + 2.0
        }
    }),
    ("'blackman_harris'", 1.5, |x| {
        let phase = std::f64::consts::PI * (x / 1.5 + 1.0);
        0.35875 - 0.48829 * phase.cos() + 0.14128 * (2.0 * phase).cos()
            - 0.01168 * (3.0 * phase).cos()
    }),
];

/// The integral of a filter from its left end to `x`, over the whole.
fn share((_, radius, formula): Known, x: f64) -> f64 {
    const STEPS: usize = 20_000;
    let integral = |end: f64| -> f64 {
        let step = (end + radius) / STEPS as f64;
        (0..STEPS)
            .map(|i| step * formula((step * (i as f64 + 0.5) - radius).abs()))
            .sum()
    };
    integral(x.clamp(-radius, radius)) / integral(radius)
}

#[test]
fn filters_keep_the_mean_and_answer_to_an_edge_as_they_should() {
    let px = [4, 3];
    for known in FILTERS {
        let (name, radius, _) = known;
        let scene = scene(&pinhole(), &format!("filter = {name}"));
        let edges: Vec<f64> = (-4..=4).map(|i| 0.24 * radius * f64::from(i)).collect();
        let mut below = vec![[Moments::new(); 2]; edges.len()];
        let mut white = Moments::new();
        let mut sampler = rng(1);
        for _ in 0..100_000 {
            let start = scene.sensor_ray(px, sampler.next());
            white.push(start.weight.into());
            let at = place(start.ray.direction);
            for (edge, moments) in edges.iter().zip(&mut below) {
                for axis in 0..2 {
                    let offset = f64::from(at[axis]) - f64::from(px[axis]) - 0.5;
                    assert!(offset.abs() <= radius + 1e-5, "{name}: {offset}");
                    let counts = offset < *edge;
                    moments[axis].push(if counts { start.weight.into() } else { 0.0 });
                }
            }
        }
        let each = sidak(FALSE_ALARM, FILTERS.len() * (2 * edges.len() + 1));
        check_mean(name, white.estimate(), 1.0, each).unwrap();
        for (edge, moments) in edges.iter().zip(&below) {
            // A table of 1024 steps, and places rounded to `f32`.
            let expected = share(known, *edge);
            for axis in moments {
                let estimate = axis.estimate();
                let nearest = estimate.mean.clamp(expected - 1e-4, expected + 1e-4);
                let what = format!("{name}, edge at {edge}");
                check_mean(&what, estimate, nearest, each).unwrap();
            }
        }
        // A filter without negative lobes shows white as white in every sample.
        if !name.contains("mitchell") {
            assert_eq!(white.variance(), 0.0, "{name}");
        }
    }
}

/// Radiance that a far sphere sends to the middle from the direction `w`: an edge and a slope.
fn sphere_radiance(w: Vec3) -> f64 {
    let [x, y] = place(w);
    f64::from(0.2 + 0.1 * y.max(0.0) + if x > 3.3 { 2.0 } else { 0.0 })
}

const FAR: f32 = 50.0;

/// Where a ray from within the sphere leaves it, as a direction from the middle.
fn leaves(ray: &Ray) -> Vec3 {
    let b = ray.origin.dot(ray.direction);
    let c = ray.origin.length_squared() - FAR * FAR;
    ray.at((b * b - c).sqrt() - b) / FAR
}

/// Every pixel of the image by the sensor's rays and by connections, with the same filter.
#[test]
fn splats_are_filtered_as_rays_are() {
    for (name, _, _) in FILTERS {
        for camera in [pinhole(), thin_lens()] {
            for crop in ["", "crop = [2, 1, 5, 4]"] {
                compare_images(&scene(&camera, &format!("filter = {name}\n{crop}")), name);
            }
        }
    }
}

fn compare_images(scene: &Scene<f32>, name: &str) {
    const SAMPLES: usize = 2_000;
    /// Pixels around the picture from which its own see light.
    const MARGIN: f32 = 4.0;
    let [width, height] = scene.resolution();
    let pixels = (width * height) as usize;
    let mut sampler = rng(2);
    let mut traced = vec![Moments::new(); pixels];
    for (i, moments) in traced.iter_mut().enumerate() {
        let px = [i as u32 % width, i as u32 / width];
        moments.extend((0..SAMPLES).map(|_| {
            let start = scene.sensor_ray(px, sampler.next());
            f64::from(start.weight) * sphere_radiance(leaves(&start.ray))
        }));
    }
    let mut sums = vec![[0.0_f64; 2]; pixels];
    let sides = [WIDTH, HEIGHT].map(|n| n as f32 + 2.0 * MARGIN);
    let count = SAMPLES * 100;
    for _ in 0..count {
        let u = sampler.next::<2>();
        let w = through([u[0] * sides[0] - MARGIN, u[1] * sides[1] - MARGIN]);
        let pixel = 4.0 * HALF[0] * HALF[1] / (WIDTH * HEIGHT) as f32;
        let angle = sides[0] * sides[1] * pixel * w.z.abs().powi(3);
        let Some(c) = scene.connect_sensor(FAR * w, sampler.next()) else {
            continue;
        };
        let area = angle * FAR * FAR;
        let value = f64::from(c.weight * area * c.wi.dot(-w)) * sphere_radiance(w);
        let [x, y] = c.raster.map(|x| x as u32);
        let sum = &mut sums[(y * width + x) as usize];
        sum[0] += value;
        sum[1] += value * value;
    }
    let each = sidak(FALSE_ALARM, pixels * 4 * FILTERS.len());
    for (i, (traced, [sum, squares])) in traced.iter().zip(sums).enumerate() {
        let n = count as f64;
        let mean = sum / n;
        let traced = traced.estimate();
        let difference = tyndall_testkit::stats::Estimate {
            mean: mean - traced.mean,
            standard_error: ((squares / n - mean * mean) / n + traced.standard_error.powi(2))
                .sqrt(),
            count: traced.count,
        };
        check_mean(&format!("{name}, pixel {i}"), difference, 0.0, each).unwrap();
    }
}

#[test]
fn a_crop_is_a_part_of_the_picture() {
    let mut sampler = rng(3);
    for (camera, filter) in [(pinhole(), "'box'"), (thin_lens(), "'mitchell'")] {
        let whole = scene(&camera, &format!("filter = {filter}"));
        let part = scene(&camera, &format!("filter = {filter}\ncrop = [3, 2, 4, 5]"));
        assert_eq!(part.resolution(), [4, 5]);
        for (x, y) in (0..4).flat_map(|x| (0..5).map(move |y| (x, y))) {
            let u = sampler.next();
            let a = part.sensor_ray([x, y], u);
            let b = whole.sensor_ray([x + 3, y + 2], u);
            assert_eq!(
                (a.ray.origin, a.ray.direction, a.weight),
                (b.ray.origin, b.ray.direction, b.weight)
            );
            // The film is smaller, so that a ray through it is more probable.
            assert!((a.pdf_w / b.pdf_w * 20.0 / 80.0 - 1.0).abs() < 1e-5);
        }
    }
}

#[test]
fn a_point_out_of_focus_is_a_disc_of_the_known_radius() {
    let scene = scene(&thin_lens(), "");
    let (lens, focus) = (0.2, 3.0);
    for distance in [1.5_f32, 2.5, 3.0, 6.0, 40.0] {
        // By similar triangles, in pixels.
        let radius = lens * (1.0 / focus - 1.0 / distance).abs();
        let expected = radius / HALF[0] * 0.5 * WIDTH as f32;
        let point = Vec3::new(0.0, 0.0, -distance);
        let mut farthest = 0.0_f32;
        for i in 0..10_000 {
            let u = [(i % 100) as f32 / 99.0, (i / 100) as f32 / 99.0];
            let Some(c) = scene.connect_sensor(point, u) else {
                continue;
            };
            let [x, y] = [
                c.raster[0] - 0.5 * WIDTH as f32,
                c.raster[1] - 0.5 * HEIGHT as f32,
            ];
            farthest = farthest.max(x.hypot(y));
        }
        let off = (farthest - expected).abs();
        assert!(
            off < 1e-4 * WIDTH as f32,
            "{distance}: {farthest}, {expected}"
        );
    }
}

#[test]
fn orthographic_rays_are_parallel() {
    for size in ["width = 4", "height = 3.2"] {
        let scene = scene(&format!("kind = 'orthographic'\n{size}"), "");
        let ray = |px, u| scene.sensor_ray(px, [u, u, 0.3, 0.7]).ray;
        let (first, last) = (ray([0, 0], 0.0), ray([WIDTH - 1, HEIGHT - 1], 1.0));
        assert_eq!(
            (first.direction, last.direction),
            (Vec3::NEG_Z, Vec3::NEG_Z)
        );
        assert!(first.origin.distance(Vec3::new(-2.0, 1.6, 0.0)) < 1e-5);
        assert!(last.origin.distance(Vec3::new(2.0, -1.6, 0.0)) < 1e-5);
        assert!(scene.connect_sensor(Vec3::NEG_Z, [0.5; 2]).is_none());
    }
}

#[test]
fn angles_of_view_are_across_or_upright() {
    let [w, h] = HALF.map(|half| 2.0 * f64::from(half).atan().to_degrees());
    let px = [7, 1];
    let across = scene(&format!("fov = {w}"), "")
        .sensor_ray(px, [0.2; 4])
        .ray;
    let upright = scene(&format!("vertical_fov = {h}"), "")
        .sensor_ray(px, [0.2; 4])
        .ray;
    assert!(across.direction.distance(upright.direction) < 1e-6);
    assert!(across.direction.distance(through([7.2, 1.2])) < 1e-6);
}
