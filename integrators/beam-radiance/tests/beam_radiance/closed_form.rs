//! Light in closed form.

use crate::{FALSE_ALARM, fixed, fog};
use glam::Vec3;
use std::f64::consts::PI;
use tyndall_beam_radiance::{BeamRadiance, Blur};
use tyndall_core::{Medium, PhaseFunction, Ray, Rgb, Sampler, Sensor, Spectrum, warp};
use tyndall_density::Kernel;
use tyndall_media::Homogeneous;
use tyndall_testkit::closed_form::{
    LaserRow, SLABS, airlight, laser_row_sum, point_source_fluence,
};
use tyndall_testkit::hosts::{AnalyticHost, Exitant, Interface, Laser, View};
use tyndall_testkit::rng;
use tyndall_testkit::stats::{Estimate, Moments};
use tyndall_testkit::stats::{Figures, extrapolated};
use tyndall_testkit::{Run, Tier, in_both_tiers};

/// What scatters so rarely that twice is never: single scattering is in closed form.
const RARELY: f32 = 1e-4;

in_both_tiers! {
    the_row_sum_of_a_laser_for_any_radius,
    airlight_of_a_point_light_and_its_bias,
    fluence_of_a_point_light,
    the_furnace_is_white_away_from_the_boundary,
    reflectance_and_transmittance_of_slabs,
}

/// The mean of e^(x·g) over a ball of radius 1, of |g| = `g`: 3 (g cosh g − sinh g)/g³.
fn over_ball(g: f64) -> f64 {
    3.0 * (g * g.cosh() - g.sinh()) / g.powi(3)
}

fn the_row_sum_of_a_laser_for_any_radius(tier: Tier) {
    let sigma_t = Rgb::new(0.4, 0.8, 1.6);
    let mut figures = Figures::default();
    for (seed, cos_theta) in [(1, 0.6), (2, -0.5)] {
        let laser = Laser {
            flux: 3.0,
            radius: 0.1,
            cos_theta,
            distance: 1.2,
            along: 1.5,
            half_width: 0.5,
            pixels: 40,
        };
        let medium = fog(sigma_t * (1.0 - RARELY), sigma_t * RARELY, 0.5);
        let ahead = Vec3::new(cos_theta, 0.0, (1.0 - cos_theta * cos_theta).sqrt());
        let phase = medium.phase(Vec3::ZERO).eval(-ahead, Vec3::NEG_X);
        let host = AnalyticHost::laser(medium, laser);
        for blur in [Blur::Disc, Blur::Ball] {
            for radius in [0.05, 0.15, 0.4] {
                let method = fixed(radius)
                    .kernel(Kernel::Constant)
                    .blur(blur)
                    .paths(4_000);
                let run = Run {
                    passes: tier.passes([30, 700]),
                    samples: 1,
                    seed,
                };
                for (c, mean) in run.measure(&host, &method).into_iter().enumerate() {
                    let sigma_t = f64::from(sigma_t.channel(c));
                    let row = |radius: f64| {
                        laser_row_sum(&LaserRow {
                            sigma_s: sigma_t * f64::from(RARELY),
                            sigma_t,
                            phase: f64::from(phase),
                            flux: 3.0,
                            radius,
                            cos_theta: f64::from(cos_theta),
                            distance: 1.2,
                            along: 1.5,
                        })
                    };
                    // A disc attenuates as a beam of its radius, a ball along the ray as well.
                    let radius = f64::from(radius);
                    let (sine, cosine) = (f64::from(ahead.z), f64::from(cos_theta));
                    let blurred = match blur {
                        Blur::Disc => row(radius) / row(0.0),
                        Blur::Ball => {
                            over_ball(sigma_t * radius * ((1.0 + cosine) / sine).hypot(1.0))
                        }
                    };
                    let sum = mean.scaled(f64::from(2.0 * laser.half_width));
                    let name = format!("{blur:?} {radius} cos θ {cos_theta} channel {c}");
                    figures.add(name, sum, row(0.1) * blurred, tier.precision(0.045));
                }
            }
        }
    }
    figures.check(FALSE_ALARM);
}

/// The difference of two airlights, one from where the ray starts and one from where it ends.
fn point_light(sigma_t: f32, ray: Ray) -> AnalyticHost<Homogeneous<f32>> {
    let medium = fog(sigma_t * (1.0 - RARELY), sigma_t * RARELY, 0.0);
    AnalyticHost::infinite_medium(medium, Vec3::new(0.5, 1.0, 0.0), 1.0, View::Rays(vec![ray]))
}

fn airlight_of_a_point_light_and_its_bias(tier: Tier) {
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let sigma_t = 0.6;
    let host = point_light(sigma_t, ray);
    let expected = airlight(
        f64::from(sigma_t * RARELY),
        f64::from(sigma_t),
        1.0,
        0.5,
        f64::INFINITY,
    );
    let mut figures = Figures::default();
    for blur in [Blur::Disc, Blur::Ball] {
        let mean = |radius: f32, seed| {
            let run = Run {
                passes: tier.passes([80, 3_000]),
                samples: 1,
                seed,
            };
            let method = fixed(radius).blur(blur).paths(4_000);
            run.measure(&host, &method)[0]
        };
        let [small, large] = [mean(0.25, 1), mean(0.5, 2)];
        // The bias is ∝ r²: without it light is right.
        let without = extrapolated(small, large, 2);
        figures.add(format!("{blur:?}"), without, expected, tier.precision(0.06));
    }
    figures.check(FALSE_ALARM);
}

fn fluence_of_a_point_light(tier: Tier) {
    let (sigma_t, distance) = (2.0_f32, 0.5_f32);
    let mut figures = Figures::default();
    for (albedo, blur) in [(0.5, Blur::Disc), (0.9, Blur::Ball)] {
        let medium = fog((1.0 - albedo) * sigma_t, albedo * sigma_t, 0.0);
        let light = Vec3::new(3.0, -2.0, 1.0);
        let position = light + distance * Vec3::Z;
        let host = AnalyticHost::infinite_medium(medium, light, 1.0, View::Fluence { position });
        let run = Run {
            passes: tier.passes([70, 1_500]),
            samples: 200,
            seed: 1,
        };
        let mean = run.measure(&host, &fixed(0.02).blur(blur).paths(5_000))[0];
        let depth = f64::from(sigma_t * distance);
        let uncollided = (-depth).exp() / (4.0 * PI * f64::from(distance * distance));
        let all = point_source_fluence(f64::from(albedo), f64::from(sigma_t), f64::from(distance));
        figures.add(
            format!("{blur:?}"),
            mean,
            all - uncollided,
            tier.precision(0.045),
        );
    }
    figures.check(FALSE_ALARM);
}

/// From around the middle of a ball: rays leave it almost straight.
fn inside() -> View {
    View::Row {
        first: Ray::new(Vec3::new(-0.1, 0.0, 0.0), Vec3::Z),
        edge: 0.2 * Vec3::X,
        pixels: 16,
    }
}

/// As [`inside`], in all directions: where light goes on ahead, few photons are seen in any of them.
fn outwards() -> View {
    let mut sampler = rng(1);
    let mut ray = || {
        let middle = 0.1 * warp::uniform_sphere(sampler.next());
        Ray::new(middle, warp::uniform_sphere(sampler.next()))
    };
    View::Rays((0..64).map(|_| ray()).collect())
}

fn the_furnace_is_white_away_from_the_boundary(tier: Tier) {
    let mut figures = Figures::default();
    let view = outwards();
    let radius = 0.1;
    let sigma_s = Rgb::new(0.5, 1.0, 2.0);
    for (i, medium) in [
        fog(Rgb::default(), Rgb::new(0.3, 1.5, 4.0), 0.0),
        fog(Rgb::default(), sigma_s, 0.5),
        fog(Rgb::default(), sigma_s, 0.9),
    ]
    .into_iter()
    .enumerate()
    {
        for (interface, expected) in [
            (Interface::Matched, 1.0),
            (Interface::Dielectric(1.5), 2.25),
        ] {
            for blur in [Blur::Disc, Blur::Ball] {
                let host = AnalyticHost::furnace(medium.clone(), 1.0, interface, view.clone());
                let run = Run {
                    passes: tier.passes([30, 1_000]),
                    samples: 1,
                    seed: 1,
                };
                let method = fixed(radius).blur(blur).paths(4_000);
                for (c, mean) in run.measure(&host, &method).into_iter().enumerate() {
                    let sigma_s = f64::from(medium.coefficients(Vec3::ZERO).sigma_s.channel(c));
                    // A ball around a point s·r from the boundary lacks (1 − s)²(2 + s)/4 of its
                    // photons, 3/16 in the mean over s: that share of what scatters there.
                    let lost = match blur {
                        Blur::Disc => 0.0,
                        Blur::Ball => 3.0 / 16.0 * f64::from(radius) * sigma_s * (-sigma_s).exp(),
                    };
                    let name = format!("medium {i} {interface:?} {blur:?} channel {c}");
                    figures.add(name, mean, expected * (1.0 - lost), tier.precision(0.05));
                }
            }
        }
    }
    figures.check(FALSE_ALARM);
}

/// Reflectance or diffuse transmittance of a slab. A wide beam and a point that measures are the
/// same, by superposition, as a pencil and all the plane: there all photons count.
fn slab(tier: Tier, index: usize, exitant: Exitant, (radius, seed): (f32, u64)) -> Estimate {
    let slab = &SLABS[index];
    let sigma_t = 2.5;
    let sigma_s = slab.albedo as f32 * sigma_t;
    let medium = fog(sigma_t - sigma_s, sigma_s, slab.mean_cosine as f32);
    let thickness = slab.optical_thickness as f32 / sigma_t;
    let pencil = 0.1;
    let host = AnalyticHost::slab(medium, thickness, pencil, 1.0, exitant);
    let run = Run {
        passes: tier.passes([60, 3_000]),
        samples: 1,
        seed,
    };
    let method = fixed(radius).paths(3_000);
    let mut moments = Moments::new();
    for pass in 0..run.passes {
        let count = 2_000;
        let flux = run.pass(&host, &method, pass, |estimate, sampler| {
            let sample = |_| {
                let mut ray = host.sensor_ray([0, 0], sampler.next());
                let [u, angle] = sampler.next();
                // Places at a distance of density e^(−x/s)/s from the axis.
                let spread = 1.0;
                let x = -spread * (1.0 - u).ln();
                let (sin, cos) = (2.0 * std::f32::consts::PI * angle).sin_cos();
                ray.ray.origin += x * Vec3::new(cos, sin, 0.0);
                let area = 2.0 * PI * f64::from(x * spread * (x / spread).exp());
                f64::from(estimate(&ray, sampler) * ray.weight) * area
            };
            (0..count).map(sample).sum::<f64>()
        });
        moments.push(flux / f64::from(count) / (PI * f64::from(pencil).powi(2)));
    }
    moments.estimate()
}

/// Kernels that reach out of the slab lose light: the bias is ∝ r.
fn reflectance_and_transmittance_of_slabs(tier: Tier) {
    let mut figures = Figures::default();
    for index in [1, 2] {
        for (exitant, expected) in [
            (Exitant::Reflectance, SLABS[index].reflectance),
            (Exitant::Transmittance, SLABS[index].diffuse_transmittance()),
        ] {
            let [small, large] =
                [(0.04, 1), (0.08, 2)].map(|case| slab(tier, index, exitant, case));
            let without = extrapolated(small, large, 1);
            figures.add(
                format!("{index} {exitant:?}"),
                without,
                expected,
                tier.precision(0.05),
            );
        }
    }
    figures.check(FALSE_ALARM);
}

#[test]
fn sampled_light_is_counted_once() {
    // Most of the light has been scattered once at the most: it is found by samples or by photons.
    let medium = fog(Rgb::new(0.1, 0.2, 0.4), Rgb::new(0.9, 1.0, 0.6), 0.4);
    let host = AnalyticHost::furnace(medium, 1.0, Interface::Matched, inside());
    let run = |seed| Run {
        passes: 200,
        samples: 2,
        seed,
    };
    let by_photons = run(1).measure(&host, &fixed(0.1).paths(4_000));
    let by_samples = BeamRadiance::sampling_lights()
        .radius(0.1)
        .alpha(1.0)
        .paths(4_000);
    let by_samples = run(2).measure(&host, &by_samples);
    let mut figures = Figures::default();
    for (c, (a, b)) in by_photons.iter().zip(by_samples).enumerate() {
        figures.same(format!("channel {c}"), *a, b, 0.012);
    }
    figures.check(FALSE_ALARM);
}
