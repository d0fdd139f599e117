//! Photons on surfaces, in scenes of the command's own host.

use crate::support::{Figures, estimate, integrate, kernel_mean, sensor};
use std::f64::consts::PI;
use std::path::Path as FilePath;
use tyndall_core::Rgb;
use tyndall_path::Path;
use tyndall_photon_map::{Kernel, PhotonMap};
use tyndall_scene_io::{Scene, SceneFile};
use tyndall_testkit::measure;
use tyndall_testkit::stats::Estimate;

const REFLECTANCE: [f64; 3] = [0.5, 0.2, 0.8];

/// A scene of one pixel; the camera, then the rest.
fn scene(camera: &str, rest: &str) -> Scene<Rgb> {
    let text = format!(
        "
        [film]
        width = 1
        height = 1
        [camera]
        fov = 0.1
        {camera}
        [materials.matt]
        kind = 'diffuse'
        reflectance = [0.5, 0.2, 0.8]
        [materials.dark]
        kind = 'diffuse'
        reflectance = 0.001
        [materials.glass]
        kind = 'dielectric'
        ior = 1.5
        [media.milk]
        kind = 'homogeneous'
        sigma_a = 0.1
        sigma_s = [0.4, 0.8, 1.6]
        {rest}"
    );
    let file = SceneFile::parse(&text, FilePath::new("surfaces.toml"), &[]);
    file.and_then(|file| file.build())
        .unwrap_or_else(|why| panic!("{why}"))
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

#[test]
fn a_floor_under_a_lamp() {
    let light = "[[lights]]\nkind = 'point'\nposition = [0, 2, 0]\npower = 10";
    let scene = scene(
        "position = [1, 1, 0.5]\nlook_at = [1, 0, 0]",
        &(floor("matt") + light),
    );
    // I h/(h² + d²)^1.5, at a point one unit from below the lamp.
    let irradiance = |x: f64, y: f64| {
        let squared = 4.0 + (1.0 + x).powi(2) + y * y;
        10.0 / (4.0 * PI) * 2.0 / squared.powf(1.5)
    };
    let radius = 0.5;
    let blurred = kernel_mean(Kernel::Cone, radius, 2, |d| {
        let around = |a: f64| irradiance(d * a.cos(), d * a.sin());
        integrate(0.0, 2.0 * PI, 32, around) / (2.0 * PI)
    });
    let mut figures = Figures::within(0.01);
    let map = PhotonMap::new().paths(20_000).kernel(Kernel::Cone);
    let photons = estimate(&scene, &[map.radius(radius as f32)], 60, 1, sensor(&scene));
    figures.add_channels("photons", &photons[0], |c| REFLECTANCE[c] / PI * blurred);
    let map = PhotonMap::sampling_lights().paths(100);
    let sampled = estimate(&scene, &[map], 10, 10, sensor(&scene));
    let sharp = irradiance(0.0, 0.0);
    for (channel, estimate) in sampled[0].iter().enumerate() {
        // No noise, but for where in the pixel the ray falls.
        let off = estimate.mean / (REFLECTANCE[channel] / PI * sharp) - 1.0;
        assert!(off.abs() < 1e-3, "{off}");
    }
    figures.check();
}

#[test]
fn light_through_a_pane_is_found_by_photons_alone() {
    // A pane at normal incidence lets 2n/(n² + 1) pass, of all orders of reflection in it.
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
    let scene = scene("position = [0.5, 0.6, 0.5]\nlook_at = [0, 0, 0]", &rest);
    let expected = 0.001 / PI * 7.0 / (4.0 * PI) * 3.0 / 3.25;
    let mut figures = Figures::within(0.01);
    let map = PhotonMap::new().paths(2000).radius(0.6);
    let photons = estimate(&scene, &[map], 60, 1, sensor(&scene));
    figures.add_channels("photons", &photons[0], |_| expected);
    let map = PhotonMap::sampling_lights().paths(2000).nearest(200);
    let sampled = estimate(&scene, &[map], 60, 1, sensor(&scene));
    figures.add_channels("sampled", &sampled[0], |_| expected);
    figures.check();
}

const ROOM: &str = "
    [[shapes]]
    kind = 'sphere'
    center = [0, 0, 0]
    radius = 1
    material = 'matt'
    [[lights]]
    kind = 'point'
    position = [0, 0, 0]
    power = 10";
const IN_ROOM: &str = "position = [0.1, 0, 0.3]\nlook_at = [0, 0, -1]";

#[test]
fn an_integrating_sphere() {
    // Irradiance is the same everywhere, so that no kernel blurs it: P/(4πR²)/(1 − ρ).
    let scene = scene(IN_ROOM, ROOM);
    let expected = |c: usize| REFLECTANCE[c] / PI * 10.0 / (4.0 * PI) / (1.0 - REFLECTANCE[c]);
    let mut figures = Figures::within(0.01);
    for walks in [0, 4] {
        let map = PhotonMap::new()
            .paths(5000)
            .radius(0.15)
            .final_gather(walks);
        let photons = estimate(&scene, &[map], 100, 4, sensor(&scene));
        figures.add_channels(&format!("photons, {walks} walks"), &photons[0], expected);
        let map = PhotonMap::sampling_lights().paths(5000).nearest(40);
        let map = map.final_gather(walks);
        let sampled = estimate(&scene, &[map], 100, 4, sensor(&scene));
        figures.add_channels(&format!("sampled, {walks} walks"), &sampled[0], expected);
    }
    figures.check();
}

#[test]
fn milk_in_a_room_with_final_gathering() {
    let scene = scene(&format!("{IN_ROOM}\nmedium = 'milk'"), ROOM);
    let reference = measure(&scene, &Path::new(), 100_000, 1);
    let radii = [0.06, 0.12].map(|radius| {
        let map = PhotonMap::sampling_lights().paths(3000).radius(radius);
        map.final_gather(4)
    });
    let estimates = estimate(&scene, &radii, 60, 20, sensor(&scene));
    let mut figures = Figures::within(0.02);
    for channel in 0..3 {
        // Kernels lose what reaches into the wall, ∝ r.
        let [fine, coarse, path] =
            [&estimates[0], &estimates[1], &reference].map(|e: &Vec<Estimate>| e[channel]);
        let extrapolated = Estimate {
            mean: 2.0 * fine.mean - coarse.mean,
            standard_error: 2.0 * fine.standard_error + coarse.standard_error,
            ..fine
        };
        let difference = extrapolated.difference(&path);
        let shifted = Estimate {
            mean: difference.mean + path.mean,
            ..difference
        };
        figures.add(format!("channel {channel}"), shifted, path.mean);
    }
    figures.check();
}
