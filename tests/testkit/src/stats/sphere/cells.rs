//! The sphere in cells of equal solid angle, and integrals over them.

use crate::quadrature::gauss_legendre;
use glam::Vec3;
use std::f64::consts::TAU;
use std::iter::Sum;

/// Of cos θ.
pub(super) const ROWS: usize = 16;
/// Of φ.
pub(super) const COLUMNS: usize = 32;
pub(super) const CELLS: usize = ROWS * COLUMNS;
/// Absolute error allowed to a rectangle of the quadrature, of a total of 1.
const TOLERANCE: f64 = 1e-7;
/// Halvings of a cell at most: 1/512 of its sides.
const DEPTH: u32 = 9;
/// Halvings of a cell at least, so that no peak wider than 0.02 rad hides between nodes.
const SURE_DEPTH: u32 = 2;

/// An integral and a bound of its error, unless something hides between the nodes.
#[derive(Clone, Copy, Default)]
pub(super) struct Integral {
    pub(super) value: f64,
    pub(super) error: f64,
}

impl Integral {
    /// The possible value that is nearest to `x`.
    pub(super) fn nearest(&self, x: f64) -> f64 {
        let least = (self.value - self.error).max(0.0);
        x.clamp(least, (self.value + self.error).max(least))
    }
}

impl Sum for Integral {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |a, b| Self {
            value: a.value + b.value,
            error: a.error + b.error,
        })
    }
}

/// The cell that holds a direction.
pub(super) fn cell(w: Vec3) -> usize {
    let row = (0.5 * (f64::from(w.z) + 1.0) * ROWS as f64) as usize;
    let phi = f64::from(w.y).atan2(f64::from(w.x)).rem_euclid(TAU);
    let column = (phi / TAU * COLUMNS as f64) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// The integral of a density over every cell.
///
/// # Errors
/// If it is negative or not finite.
pub(super) fn integrate(pdf_w: &impl Fn(Vec3) -> f32) -> Result<Vec<Integral>, String> {
    let quadrature = Quadrature {
        pdf_w,
        rule: gauss_legendre(3),
    };
    (0..CELLS).map(|i| quadrature.over_cell(i)).collect()
}

/// Adaptive quadrature over rectangles of (cos θ, φ).
struct Quadrature<'a, F> {
    pdf_w: &'a F,
    rule: Vec<(f64, f64)>,
}

impl<F: Fn(Vec3) -> f32> Quadrature<'_, F> {
    fn over_cell(&self, i: usize) -> Result<Integral, String> {
        let (row, column) = ((i / COLUMNS) as f64, (i % COLUMNS) as f64);
        let side = [2.0 / ROWS as f64, TAU / COLUMNS as f64];
        let min = [row * side[0] - 1.0, column * side[1]];
        let integral = self.adapt(min, side, self.product(min, side), 0);
        if (0.0..f64::INFINITY).contains(&integral.value) {
            return Ok(integral);
        }
        Err(format!(
            "the density integrates to {} around {}",
            integral.value,
            direction(min[0] + 0.5 * side[0], min[1] + 0.5 * side[1])
        ))
    }

    /// The product rule over one rectangle.
    fn product(&self, min: [f64; 2], side: [f64; 2]) -> f64 {
        let mut sum = 0.0;
        for (x, wx) in &self.rule {
            for (y, wy) in &self.rule {
                let cos = min[0] + 0.5 * side[0] * (1.0 + x);
                let phi = min[1] + 0.5 * side[1] * (1.0 + y);
                sum += wx * wy * f64::from((self.pdf_w)(direction(cos, phi)));
            }
        }
        0.25 * side[0] * side[1] * sum
    }

    /// Halves the sides until the halves add up to the whole; what is left of a difference is the
    /// error.
    fn adapt(&self, min: [f64; 2], side: [f64; 2], coarse: f64, depth: u32) -> Integral {
        let half = [0.5 * side[0], 0.5 * side[1]];
        let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]
            .map(|[i, j]| [min[0] + i * half[0], min[1] + j * half[1]]);
        let parts = corners.map(|corner| self.product(corner, half));
        let value: f64 = parts.iter().sum();
        let error = (value - coarse).abs();
        let done = error < TOLERANCE || !value.is_finite();
        if done && depth >= SURE_DEPTH {
            return Integral { value, error: 0.0 };
        }
        if depth >= DEPTH {
            return Integral { value, error };
        }
        corners
            .into_iter()
            .zip(parts)
            .map(|(corner, part)| self.adapt(corner, half, part, depth + 1))
            .sum()
    }
}

fn direction(cos: f64, phi: f64) -> Vec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    Vec3::new(
        (sin * phi.cos()) as f32,
        (sin * phi.sin()) as f32,
        cos as f32,
    )
}
