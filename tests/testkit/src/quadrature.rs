//! Gauss–Legendre quadrature in `f64`.

use std::f64::consts::PI;

/// Nodes and weights on \[−1, 1\] by Newton's method on the Legendre polynomial of degree
/// `order` (Press et al. 2007, §4.6.1): exact for polynomials of degree 2·`order` − 1.
pub(crate) fn gauss_legendre(order: usize) -> Vec<(f64, f64)> {
    let n = order as f64;
    (0..order)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (value, derivative) = legendre(order, x);
                slope = derivative;
                let step = value / derivative;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The Legendre polynomial of degree `order` at `x`, and its derivative.
fn legendre(order: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (1.0, x);
    for k in 2..=order {
        let k = k as f64;
        let next = ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k;
        (previous, value) = (value, next);
    }
    let derivative = order as f64 * (x * value - previous) / (x * x - 1.0);
    (value, derivative)
}

/// ∫ f over \[`a`, `b`\] by `panels` panels of 16 nodes.
pub(crate) fn integrate(a: f64, b: f64, panels: usize, f: impl Fn(f64) -> f64) -> f64 {
    let rule = gauss_legendre(16);
    let half = 0.5 * (b - a) / panels as f64;
    (0..panels)
        .map(|panel| {
            let middle = a + half * (2 * panel + 1) as f64;
            let sum: f64 = rule.iter().map(|(x, w)| w * f(middle + half * x)).sum();
            half * sum
        })
        .sum()
}
