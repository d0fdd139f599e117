//! All estimators against each other, on the same photons, and against the path tracer.

use crate::{FALSE_ALARM, fixed, fog};
use tyndall_core::Rgb;
use tyndall_media::Homogeneous;
use tyndall_path::Path;
use tyndall_photon_beams::{Estimate, Extent};
use tyndall_testkit::conformance::{lamp, view};
use tyndall_testkit::hosts::{AnalyticHost, Interface};
use tyndall_testkit::stats::{self, Figures, Moments};
use tyndall_testkit::{Run, Tier, in_both_tiers};

in_both_tiers! {
    all_estimators_and_the_path_tracer,
    short_beams_and_long_ones,
}

fn ball(g: f32) -> AnalyticHost<Homogeneous<Rgb>> {
    let medium = fog(Rgb::new(0.1, 0.2, 0.3), Rgb::new(1.2, 0.8, 0.6), g);
    AnalyticHost::sphere(medium, 1.0, Interface::Matched, lamp(1.0), view(1.0))
}

/// Pass by pass.
fn difference(a: &[f64], b: &[f64]) -> stats::Estimate {
    let moments: Moments = a.iter().zip(b).map(|(a, b)| a - b).collect();
    moments.estimate()
}

/// An estimator at a radius and at half of it.
struct Found {
    name: String,
    narrow: Vec<Vec<f64>>,
    /// What is gone of the bias.
    gone: Vec<stats::Estimate>,
}

impl Found {
    /// The least and the most of the bias that may be left: a third where it is ∝ r², all where it
    /// is ∝ r.
    fn left(&self, c: usize) -> [f64; 2] {
        let [a, b] = [1.0 / 3.0, 1.0].map(|share| share * self.gone[c].mean);
        [a.min(b), a.max(b)]
    }
}

#[allow(clippy::print_stderr)] // a table for whoever runs it by hand
fn all_estimators_and_the_path_tracer(tier: Tier) {
    let host = ball(0.5);
    let path = Run {
        passes: tier.passes([40, 1_000]),
        samples: 40,
        seed: 1,
    };
    let path = path.measure(&host, &Path::new());
    let wide = 0.1_f32;
    let run = Run {
        passes: tier.passes([100, 2_000]),
        samples: 1,
        seed: 2,
    };
    let found = Estimate::ALL.map(|estimate| {
        let at = |radius: f32| run.means(&host, &fixed(estimate, radius).paths(2_000));
        let (wide, narrow) = (at(wide), at(0.5 * wide));
        let gone = (0..3).map(|c| difference(&wide[c], &narrow[c])).collect();
        let name = estimate.to_string();
        Found { name, narrow, gone }
    });
    let each = stats::sidak(FALSE_ALARM, 3 * 45);
    let mut wrong = Vec::new();
    let mut check = |name: String, d: stats::Estimate, [least, most]: [f64; 2], of: f64| {
        let allowed = most - least + 4.0 * d.standard_error;
        if allowed > tier.passes([50, 15]) as f64 / 100.0 * of {
            wrong.push(format!("{name}: {allowed} of {of} would be allowed"));
        }
        let nearest = d.mean.clamp(least, most);
        wrong.extend(stats::check_mean(&name, d, nearest, each).err());
    };
    for (c, path) in path.iter().enumerate() {
        for (i, a) in found.iter().enumerate() {
            let [least, most] = a.left(c);
            let moments: Moments = a.narrow[c].iter().copied().collect();
            let mean = moments.estimate();
            // What is gone is uncertain as well.
            let widened = |d: stats::Estimate, gone: f64| stats::Estimate {
                standard_error: d.standard_error + gone,
                ..d
            };
            let against = mean.difference(path);
            eprintln!(
                "{:>18} channel {c}: bias {:+.4} ± {:.4}, gone {:+.4} ± {:.4}, relative variance of a pass {:.4}",
                a.name,
                against.mean / path.mean,
                against.standard_error / path.mean,
                a.gone[c].mean / path.mean,
                a.gone[c].standard_error / path.mean,
                moments.variance() / mean.mean.powi(2),
            );
            let against = widened(against, a.gone[c].standard_error);
            let of = path.mean;
            let name = format!("{} against path, channel {c}", a.name);
            check(name, against, [least, most], of);
            for b in &found[..i] {
                let other = b.left(c);
                let name = format!("{} against {}, channel {c}", a.name, b.name);
                let d = difference(&a.narrow[c], &b.narrow[c]);
                let d = widened(d, a.gone[c].standard_error + b.gone[c].standard_error);
                check(name, d, [least - other[1], most - other[0]], of);
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// No bias between them at all, at any radius.
fn short_beams_and_long_ones(tier: Tier) {
    let host = ball(-0.3);
    let run = Run {
        passes: tier.passes([50, 1_500]),
        samples: 1,
        seed: 1,
    };
    let mut figures = Figures::default();
    for estimate in Estimate::ALL {
        let marched = matches!(estimate, Estimate::BeamPoint2D | Estimate::BeamPoint3D);
        if !estimate.takes_beams() || (tier == Tier::Short && marched) {
            continue;
        }
        let means = |light, sight| {
            let method = fixed(estimate, 0.1).light(light).sight(sight).paths(1_000);
            run.means(&host, &method)
        };
        let long = means(Extent::Long, Extent::Long);
        for (light, sight) in [
            (Extent::Short, Extent::Long),
            (Extent::Long, Extent::Short),
            (Extent::Short, Extent::Short),
        ] {
            let short = means(light, sight);
            for c in 0..3 {
                let d = difference(&short[c], &long[c]);
                let of: Moments = long[c].iter().copied().collect();
                let name = format!("{estimate}, {light} and {sight}, channel {c}");
                figures.none(name, d, of.estimate().mean, tier.precision(0.04));
            }
        }
    }
    figures.check(FALSE_ALARM);
}
