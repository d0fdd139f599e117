//! The path tracer against light in closed form.
//!
//! False alarms: every figure is a t-test at 0.27 % (three standard errors of a normal
//! distribution), Šidák-corrected within a test; the seeds are fixed. Every figure also asserts a
//! relative standard error of at most 0.3 %, so that three of them are 1 %.

use glam::Vec3;
use tyndall_core::{AnyIntegrator, Coefficients, Medium, Ray, Rgb, Sensor, Spectrum};
use tyndall_driver::PassStreams;
use tyndall_media::{Homogeneous, Phase};
use tyndall_path::{Path, Scattering};
use tyndall_testkit::closed_form::{
    HFunction, LaserRow, SLABS, Slab, airlight, emission_only, laser_row_sum, point_source_fluence,
};
use tyndall_testkit::hosts::{AnalyticHost, Exitant, Interface, Laser, Light, View};
use tyndall_testkit::stats::{Estimate, check_means};
use tyndall_testkit::{measure, measure_mean};

const FALSE_ALARM: f64 = 0.0027;
const PRECISION: f64 = 0.003;

fn medium<S: Spectrum>(sigma_a: S, sigma_s: S, g: f32) -> Homogeneous<S> {
    let phase = match g {
        0.0 => Phase::Isotropic,
        g => Phase::henyey_greenstein(g).expect("a valid mean cosine"),
    };
    let coefficients = Coefficients {
        sigma_a,
        sigma_s,
        emission: S::default(),
    };
    Homogeneous::new(coefficients, phase).expect("valid coefficients")
}

/// Named figures, all tested together.
#[derive(Default)]
struct Figures(Vec<(String, Estimate, f64)>);

impl Figures {
    fn add(&mut self, name: String, estimate: Estimate, expected: f64) {
        let precision = estimate.relative_standard_error();
        assert!(
            precision <= PRECISION,
            "{name}: {precision:.4} is too noisy"
        );
        self.0.push((name, estimate, expected));
    }

    fn check(self) {
        let cases: Vec<_> = self
            .0
            .iter()
            .map(|(n, e, x)| (n.as_str(), *e, *x))
            .collect();
        if let Err(why) = check_means(&cases, FALSE_ALARM) {
            panic!("{why}");
        }
    }
}

/// The first pixel, per channel.
fn pixel<H: Sensor>(
    host: &H,
    integrator: &dyn AnyIntegrator<H, PassStreams>,
    passes: u64,
) -> Vec<Estimate> {
    measure(host, integrator, passes, 1)
}

#[test]
fn slab_reflectance_and_transmittance() {
    slabs(&SLABS[..3]);
}

#[test]
#[ignore = "four million walks: cargo test -p tyndall-path --tests -- --ignored"]
fn thick_forward_slab() {
    slabs(&SLABS[3..]);
}

fn slabs(slabs: &[Slab]) {
    let mut figures = Figures::default();
    for slab in slabs {
        // σt = 2.5, so that the slab is τ/2.5 thick.
        let sigma_t = 2.5;
        let sigma_s = slab.albedo as f32 * sigma_t;
        let medium = medium(sigma_t - sigma_s, sigma_s, slab.mean_cosine as f32);
        let thickness = slab.optical_thickness as f32 / sigma_t;
        let extent = if slab.albedo > 0.99 { 100.0 } else { 50.0 } / sigma_t;
        for (exitant, expected) in [
            (Exitant::Reflectance, slab.reflectance),
            (Exitant::Transmittance, slab.diffuse_transmittance()),
        ] {
            let host = AnalyticHost::slab(medium.clone(), thickness, extent, 1.0, exitant);
            // A peaked phase function makes direct sampling of one direction noisy.
            let passes = match slab.mean_cosine {
                0.0 => 400_000,
                0.75 => 1_500_000,
                _ => 4_000_000,
            };
            let estimate = pixel(&host, &Path::new(), passes)[0];
            figures.add(format!("{slab:?} {exitant:?}"), estimate, expected);
        }
    }
    figures.check();
}

#[test]
fn half_space_albedo_and_radiance() {
    let mut figures = Figures::default();
    // One render for three albedos: chromatic σt, one albedo a channel.
    let albedos = [0.5, 0.9, 0.99];
    let sigma_t = Rgb::new(0.7, 2.0, 3.0);
    let sigma_s = Rgb::new(0.7 * albedos[0], 2.0 * albedos[1], 3.0 * albedos[2]);
    let medium = medium(sigma_t - sigma_s, sigma_s, 0.0);
    let host = |exitant| AnalyticHost::slab(medium.clone(), f32::INFINITY, 70.0, 1.0, exitant);
    let albedo = pixel(&host(Exitant::Reflectance), &Path::new(), 1_000_000);
    let mu = 0.4;
    let radiance = pixel(&host(Exitant::Radiance(mu)), &Path::new(), 1_000_000);
    for (i, a) in albedos.into_iter().enumerate() {
        let h = HFunction::new(f64::from(a));
        figures.add(
            format!("plane albedo, a = {a}"),
            albedo[i],
            h.plane_albedo(1.0),
        );
        let expected = h.radiance(1.0, f64::from(mu));
        figures.add(format!("radiance, a = {a}"), radiance[i], expected);
    }
    figures.check();
}

#[test]
fn point_source_fluence_in_an_infinite_medium() {
    let mut figures = Figures::default();
    let (sigma_t, r) = (2.0_f32, 0.5_f32);
    for albedo in [0.5, 0.9] {
        let medium = medium((1.0 - albedo) * sigma_t, albedo * sigma_t, 0.0);
        let view = View::Fluence {
            position: Vec3::new(3.0, -2.0, 1.0 + r),
        };
        let host = AnalyticHost::infinite_medium(medium, Vec3::new(3.0, -2.0, 1.0), 1.0, view);
        let estimate = pixel(&host, &Path::new(), 2_000_000)[0];
        let depth = f64::from(sigma_t * r);
        let uncollided = (-depth).exp() / (4.0 * std::f64::consts::PI * f64::from(r * r));
        let expected = point_source_fluence(f64::from(albedo), f64::from(sigma_t), f64::from(r));
        figures.add(
            format!("fluence, a = {albedo}"),
            estimate,
            expected - uncollided,
        );
    }
    figures.check();
}

#[test]
fn airlight_of_a_point_light() {
    let mut figures = Figures::default();
    for (sigma_s, sigma_t, h, t_0, s) in [(0.5, 0.6, 1.0, 2.0, 4.0), (2.0, 2.5, 0.3, 1.0, 2.0)] {
        // The medium is infinite and a ray cannot be cut short: two rays, one from where the
        // segment starts and one from where it ends, differ by the segment, attenuated.
        let ray = |start: f64| Ray::new(Vec3::new(start as f32, 0.0, 0.0), Vec3::X);
        let light = Vec3::new(t_0 as f32, h as f32, 0.0);
        let host = AnalyticHost::infinite_medium(
            medium((sigma_t - sigma_s) as f32, sigma_s as f32, 0.0),
            light,
            1.0,
            View::Rays(vec![ray(0.0), ray(s)]),
        );
        let path = Path::new().scattering(Scattering::Single);
        let values = measure(&host, &path, 400_000, 1);
        let infinite = airlight(sigma_s, sigma_t, h, t_0, f64::INFINITY);
        figures.add(format!("airlight from 0, h = {h}"), values[0], infinite);
        let behind = airlight(sigma_s, sigma_t, h, t_0 - s, f64::INFINITY);
        figures.add(format!("airlight from {s}, h = {h}"), values[1], behind);
    }
    figures.check();
}

#[test]
fn the_furnace_is_white() {
    let view = |distance: f32| View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -distance),
        forward: Vec3::Z,
        half_width: 0.4,
        pixels: 4,
    };
    let mut figures = Figures::default();
    let media = [
        medium(Rgb::default(), Rgb::new(0.3, 1.5, 4.0), 0.0),
        medium(Rgb::default(), Rgb::new(2.0, 2.0, 0.1), -0.6),
        medium(Rgb::default(), Rgb::new(0.5, 3.0, 9.0), 0.9),
    ];
    for (i, medium) in media.into_iter().enumerate() {
        for (name, interface, inside) in [
            ("matched", Interface::Matched, 1.0),
            ("glass", Interface::Dielectric(1.5), 2.25),
        ] {
            for (distance, expected) in [(2.0, 1.0), (0.3, inside)] {
                let host = AnalyticHost::furnace(medium.clone(), 1.0, interface, view(distance));
                let mean = measure_mean(&host, &Path::new(), 20_000, 1);
                for (channel, estimate) in mean.into_iter().enumerate() {
                    let name = format!("furnace {i} {name} {distance} channel {channel}");
                    figures.add(name, estimate, expected);
                }
            }
        }
    }
    figures.check();
}

#[test]
fn emission_alone() {
    let mut figures = Figures::default();
    let sigma_a = Rgb::new(0.2, 1.3, 4.0);
    let coefficients = Coefficients {
        sigma_a,
        sigma_s: Rgb::default(),
        emission: sigma_a,
    };
    let medium = Homogeneous::new(coefficients, Phase::Isotropic).expect("valid coefficients");
    let rays = vec![Ray::new(Vec3::new(0.6, 0.0, -5.0), Vec3::Z)];
    let host = AnalyticHost::sphere(
        medium,
        1.0,
        Interface::Matched,
        Light::None,
        View::Rays(rays),
    );
    for scattering in [Scattering::None, Scattering::Single, Scattering::Multiple] {
        let values = measure(&host, &Path::new().scattering(scattering), 1000, 1);
        for (channel, estimate) in values.into_iter().enumerate() {
            // A chord 0.6 from the middle of the unit sphere is 1.6 long.
            let expected = emission_only(1.6 * f64::from(sigma_a.channel(channel)));
            figures.add(
                format!("{scattering:?} channel {channel}"),
                estimate,
                expected,
            );
        }
    }
    figures.check();
}

#[test]
fn the_row_sum_of_a_laser() {
    let mut figures = Figures::default();
    let g = 0.5;
    for (radius, cos_theta) in [(0.01, 0.0), (0.1, 0.6), (0.3, -0.5)] {
        let laser = Laser {
            flux: 3.0,
            radius,
            cos_theta,
            distance: 1.2,
            along: 1.5,
            half_width: 1.1 * radius,
            pixels: 8,
        };
        let medium = medium(0.3, 0.5, g);
        let phase = {
            use tyndall_core::PhaseFunction;
            // Light travels along +x, wi = −x; the sensor looks along e, wo = −e.
            let e = Vec3::new(cos_theta, 0.0, (1.0 - cos_theta * cos_theta).sqrt());
            medium.phase(Vec3::ZERO).eval(-e, Vec3::NEG_X)
        };
        let host = AnalyticHost::laser(medium, laser);
        let path = Path::new().scattering(Scattering::Single);
        let pixels = measure(&host, &path, 100_000, 1);
        let width = f64::from(laser.pixel_width());
        let sum = Estimate {
            mean: pixels.iter().map(|p| p.mean).sum::<f64>() * width,
            standard_error: width
                * pixels
                    .iter()
                    .map(|p| p.standard_error.powi(2))
                    .sum::<f64>()
                    .sqrt(),
            count: pixels[0].count,
        };
        let expected = laser_row_sum(&LaserRow {
            sigma_s: 0.5,
            sigma_t: 0.8,
            phase: f64::from(phase),
            flux: f64::from(laser.flux),
            radius: f64::from(radius),
            cos_theta: f64::from(cos_theta),
            distance: f64::from(laser.distance),
            along: f64::from(laser.along),
        });
        figures.add(
            format!("row sum, r = {radius}, cos θ = {cos_theta}"),
            sum,
            expected,
        );
    }
    figures.check();
}
