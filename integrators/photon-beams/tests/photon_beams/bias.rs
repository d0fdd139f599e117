//! Bias and variance of all estimators at equal radius: the powers of the radius.

use crate::{FALSE_ALARM, fixed, fog};
use glam::Vec3;
use std::f32::consts::TAU;
use std::f64::consts::PI;
use tyndall_core::{Frame, Ray, Sampler, Sensor, warp};
use tyndall_media::Homogeneous;
use tyndall_photon_beams::Estimate;
use tyndall_testkit::hosts::{AnalyticHost, View};
use tyndall_testkit::stats::{self, Moments};
use tyndall_testkit::{Run, Tier, in_both_tiers};

in_both_tiers! { powers_of_bias_and_variance }

const SIGMA_T: f32 = 0.6;
/// What scatters so rarely that twice is never: single scattering is all there is.
const ALBEDO: f32 = 1e-4;
const G: f32 = 0.5;
/// Of the rays from the light, and how far before it they start.
const HEIGHT: f32 = 1.0;
const BEFORE: f32 = 3.0;
/// Steps of a march: of optical depth ½.
const MARCHED: f64 = 0.5 / SIGMA_T as f64;

fn host() -> AnalyticHost<Homogeneous<f32>> {
    let medium = fog(SIGMA_T * (1.0 - ALBEDO), SIGMA_T * ALBEDO, G);
    let view = View::Rays(vec![Ray::new(Vec3::ZERO, Vec3::X)]);
    AnalyticHost::infinite_medium(medium, Vec3::ZERO, 1.0, view)
}

/// A ray that passes the light, in any direction: the radiance along all is the same.
fn passing(sampler: &mut impl Sampler) -> Ray {
    let direction = warp::uniform_sphere(sampler.next());
    let (sin, cos) = (TAU * sampler.next_1d()).sin_cos();
    let across = Frame::around(direction).to_world(Vec3::new(cos, sin, 0.0));
    Ray::new(HEIGHT * across - BEFORE * direction, direction)
}

/// The radiance along them, by the midpoint rule.
fn truth() -> f64 {
    const STEP: f64 = 1e-3;
    let [sigma_t, height, before, g] = [SIGMA_T, HEIGHT, BEFORE, G].map(f64::from);
    let at = |i: u32| {
        let t = (f64::from(i) + 0.5) * STEP;
        let across = (t - before).hypot(height);
        let cosine = (before - t) / across; // of the angle by which light turns towards the eye
        let phase = (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5));
        phase * (-sigma_t * (t + across)).exp() / (4.0 * PI * across * across)
    };
    sigma_t * f64::from(ALBEDO) * (0..40_000).map(at).sum::<f64>() * STEP
}

/// Over how many dimensions what is kept and what is asked for can miss each other.
///
/// If it is m, a light path meets with a probability ∝ rᵐ, and what it then brings is ∝ r^−m: the
/// second moment of a path is ∝ r^−m. Points miss points in three dimensions, beams and points miss
/// each other in two, beams miss beams in one (Jarosz et al. 2011a; Křivánek et al. 2014, of the
/// variances). Blur over more dimensions than m changes nothing of that: what is lost to r² or r³ in
/// its kernel is won by a chord ∝ r or r². Points of a march are points as long as its steps are
/// longer than diameters.
fn missing(estimate: Estimate) -> i32 {
    match estimate {
        Estimate::PointPoint3D => 3,
        Estimate::PointBeam2D
        | Estimate::PointBeam3D
        | Estimate::BeamPoint2D
        | Estimate::BeamPoint3D => 2,
        _ => 1,
    }
}

/// Means over rays of a function of their radiance over the truth, pass by pass.
fn over_passes(
    (estimate, radius): (Estimate, f32),
    (paths, rays, passes): (u64, u32, u64),
    of: impl Fn(f64) -> f64,
) -> stats::Estimate {
    let (host, truth) = (host(), truth());
    let method = fixed(estimate, radius).paths(paths);
    let run = Run {
        passes,
        samples: 1,
        seed: (1e3 * radius).round() as u64,
    };
    let one = |pass| {
        run.pass(&host, &method, pass, |radiance, sampler| {
            let sum: f64 = (0..rays)
                .map(|_| {
                    let mut sight = host.sensor_ray([0, 0], [0.5; 4]);
                    sight.ray = passing(sampler);
                    of(f64::from(radiance(&sight, sampler)) / truth)
                })
                .sum();
            sum / f64::from(rays)
        })
    };
    (0..passes).map(one).collect::<Moments>().estimate()
}

/// A figure of an estimator at two radii, the first the larger.
struct AtRadii {
    radii: [f32; 2],
    figures: [stats::Estimate; 2],
}

impl AtRadii {
    /// The power of the radius that the figure is ∝ to.
    fn power(&self) -> stats::Estimate {
        let [wide, narrow] = self.radii.map(f64::from);
        let [a, b] = self.figures;
        let factor = (wide / narrow).ln();
        let error = a
            .relative_standard_error()
            .hypot(b.relative_standard_error());
        stats::Estimate {
            mean: (a.mean / b.mean).abs().ln() / factor,
            standard_error: error / factor,
            count: a.count.min(b.count),
        }
    }

    /// How far that may be from the power of radii → 0, if other terms of the figure are smaller than
    /// `first` r + ¾ (r/h)².
    fn off(&self, first: f64) -> f64 {
        let [wide, narrow] = self.radii.map(f64::from);
        let second = 0.75 / f64::from(HEIGHT * HEIGHT);
        let terms = |r: f64| first * r + second * r * r;
        (terms(wide) - terms(narrow)) / (wide / narrow).ln()
    }
}

/// The bias, relative to the truth.
fn bias(estimate: Estimate, tier: Tier) -> AtRadii {
    let passes = match (missing(estimate), estimate.takes_beams()) {
        (3, _) => [4_000, 40_000],
        (_, false) => [2_000, 12_000],
        (2, _) => [200, 1_200],
        _ => [20, 200].map(|passes| tier.passes([passes, 4 * passes])),
    };
    let at = |radius, passes| over_passes((estimate, radius), (2_000, 200, passes), |l| l - 1.0);
    let radii = [0.4, 0.2];
    AtRadii {
        radii,
        figures: [at(radii[0], passes[0]), at(radii[1], passes[1])],
    }
}

/// The mean square of what one light path brings, over that of the truth: the variance of a pass
/// times its paths, and 1.
///
/// Beams come one a pass, for those of a pass are stratified. Photons hardly ever meet a ray: it
/// makes no difference, nor does where a march has its points.
fn second_moment(estimate: Estimate, tier: Tier) -> AtRadii {
    let radii = [0.2, 0.05];
    let (paths, passes) = match (missing(estimate), estimate.takes_beams()) {
        (3, _) => (300, [2_000, 40_000]),
        (_, false) => (300, [400, 20_000]),
        (2, _) => (1, [3_000, 50_000]),
        _ => (1, [1_500, 40_000]),
    };
    let moment = |radius| {
        let what = (paths, 64, tier.passes(passes));
        let squares = over_passes((estimate, radius), what, |l| (l - 1.0).powi(2));
        stats::Estimate {
            mean: paths as f64 * squares.mean + 1.0,
            standard_error: paths as f64 * squares.standard_error,
            ..squares
        }
    };
    AtRadii {
        radii,
        figures: radii.map(moment),
    }
}

#[allow(clippy::print_stderr)] // a table for whoever runs it by hand
fn powers_of_bias_and_variance(tier: Tier) {
    let mut wrong = Vec::new();
    let mut check = |name: String, at: AtRadii, expected: i32, first: f64| {
        for (radius, figure) in at.radii.iter().zip(at.figures) {
            let (mean, error) = (figure.mean, figure.standard_error);
            eprintln!("{name} at radius {radius}: {mean:.4} ± {error:.4}");
        }
        let (power, off) = (at.power(), at.off(first));
        let (mean, error) = (power.mean, power.standard_error);
        eprintln!("{name} ∝ r^({mean:.3} ± {error:.3}), to be {expected}");
        if error > tier.passes([20, 10]) as f64 / 100.0 {
            wrong.push(format!("{name}: the power ± {error:.3} is too noisy"));
        }
        let expected = f64::from(expected);
        let nearest = mean.clamp(expected - off, expected + off);
        let each = stats::sidak(FALSE_ALARM, 2 * Estimate::ALL.len());
        wrong.extend(stats::check_mean(&name, power, nearest, each).err());
    };
    for estimate in Estimate::ALL {
        let marched = matches!(estimate, Estimate::BeamPoint2D | Estimate::BeamPoint3D);
        // A beam that grazes the ray meets two points of a march.
        let first = if marched { 2.0 / MARCHED } else { 0.0 };
        let moment = second_moment(estimate, tier);
        check(
            format!("variance of {estimate}"),
            moment,
            -missing(estimate),
            first,
        );
        if tier == Tier::Long || estimate == Estimate::BeamBeam1D {
            check(format!("bias of {estimate}"), bias(estimate, tier), 2, 0.0);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
