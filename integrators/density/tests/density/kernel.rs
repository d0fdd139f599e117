//! Kernels.

use std::f64::consts::PI;
use tyndall_density::Kernel;

const KERNELS: [Kernel; 5] = [
    Kernel::Constant,
    Kernel::Epanechnikov,
    Kernel::Biweight,
    Kernel::Cone,
    Kernel::Gaussian,
];

type Weight = fn(Kernel, f32, f32) -> f32;
const WEIGHTS: [Weight; 3] = [Kernel::weight_1d, Kernel::weight_2d, Kernel::weight_3d];

/// The midpoint rule errs by h²/24 times the difference of the slopes at the ends, which is below
/// 20: 5e-8 for 4,000 panels. The weights are rounded to `f32` some eight times, 6e-8 each.
#[test]
fn weights_integrate_to_one_over_segment_disc_and_ball() {
    let panels = 4000;
    for kernel in KERNELS {
        for radius in [1e-12_f32, 3e-5, 1.0, 7e3, 1e12] {
            for (i, weight) in WEIGHTS.iter().enumerate() {
                let r = f64::from(radius);
                let integral: f64 = (0..panels)
                    .map(|panel| {
                        let u = (f64::from(panel) + 0.5) / f64::from(panels);
                        let shell = [2.0, 2.0 * PI * u, 4.0 * PI * u * u][i];
                        let weight = weight(kernel, (u * r).powi(2) as f32, radius);
                        f64::from(weight) * r.powi(i as i32 + 1) * shell / f64::from(panels)
                    })
                    .sum();
                assert!(
                    (integral - 1.0).abs() < 1e-6,
                    "{kernel:?} of radius {radius} in {}D: {integral}",
                    i + 1
                );
            }
        }
    }
}

#[test]
fn shapes_are_those_of_their_names() {
    let halfway = [1.0, 0.75, 0.5625, 0.5, (-1.125_f32).exp()];
    for (kernel, shape) in KERNELS.into_iter().zip(halfway) {
        for weight in WEIGHTS {
            let ratio = weight(kernel, 2.25, 3.0) / weight(kernel, 0.0, 3.0);
            assert!((ratio - shape).abs() < 1e-6, "{kernel:?}: {ratio}, {shape}");
        }
    }
}

#[test]
fn at_the_radius_weights_end_with_their_step() {
    let step = [1.0, 0.0, 0.0, 0.0, (-4.5_f32).exp()];
    let radius = 0.3_f32;
    for (kernel, step) in KERNELS.into_iter().zip(step) {
        for weight in WEIGHTS {
            // No slope exceeds 2 in u: 1e-6 within the radius a shape is within 2e-6 of its end.
            let inside = (radius * (1.0 - 1e-6)).powi(2);
            let shape = weight(kernel, inside, radius) / weight(kernel, 0.0, radius);
            assert!((shape - step).abs() < 4e-6, "{kernel:?}: {shape}, {step}");
            assert!(shape >= 0.0);
            assert_eq!(weight(kernel, radius * radius * 1.000_001, radius), 0.0);
        }
    }
}

#[test]
fn radii_beyond_those_promised_weigh_nothing() {
    let distances = [0.0, 1e-30, 1.0, f32::MAX, f32::INFINITY, f32::NAN];
    for kernel in KERNELS {
        for weight in WEIGHTS {
            let radii = [0.0, -0.0, -1.0, 1e-38, 1e-13, 1e13, f32::MAX];
            for radius in radii.into_iter().chain([f32::INFINITY, f32::NAN]) {
                for distance in distances {
                    assert_eq!(weight(kernel, distance, radius), 0.0, "{kernel:?} {radius}");
                }
            }
            assert_eq!(weight(kernel, f32::NAN, 1.0), 0.0);
            for radius in [1e-12, 1e12] {
                let peak = weight(kernel, 0.0, radius);
                assert!(peak.is_normal(), "{kernel:?} {radius}: {peak}");
            }
        }
    }
}
