//! A phase function from a table.

use super::exact;
use crate::MediumError;
use glam::Vec3;
use std::cmp::Ordering::Greater;
use std::f32::consts::TAU;
use tyndall_core::{Frame, PhaseFunction, PhaseSample, warp};

/// A phase function that is piecewise linear in cos θ, scaled to 1 over the sphere.
///
/// Directions near a pole resolve cos θ to 1e-7, hence a lobe down to a thousandth of a radian.
#[derive(Clone, Debug)]
pub struct Tabulated {
    nodes: Vec<Node>,
    mean_cosine: f32,
}

/// A node of the table; `cdf` is that of cos θ, `density` is per unit of cos θ.
#[derive(Clone, Copy, Debug)]
struct Node {
    cos_theta: f32,
    density: f32,
    cdf: f32,
}

impl Tabulated {
    /// Takes `values` at `cosines` of the angle between the directions of travel (1 is straight
    /// on); any common factor of the values is dropped.
    ///
    /// # Errors
    /// [`MediumError::TableCosines`] unless the cosines rise strictly from −1 to 1 and are as many
    /// as the values; [`MediumError::TableValue`] if a value is negative or not finite, or if all
    /// are zero.
    pub fn new(cosines: &[f32], values: &[f32]) -> Result<Self, MediumError> {
        check_cosines(cosines, values.len())?;
        let bad = |v: &f32| !(v.is_finite() && *v >= 0.0);
        let peak = values.iter().copied().fold(0.0, f32::max);
        let node = values.iter().position(bad).or((peak == 0.0).then_some(0));
        if let Some(node) = node {
            let value = values[node];
            return Err(MediumError::TableValue { node, value });
        }
        let point = |i: usize| (f64::from(cosines[i]), f64::from(values[i] / peak));
        let mut area = vec![0.0];
        let mut moment = 0.0;
        for i in 1..cosines.len() {
            let ((c0, v0), (c1, v1)) = (point(i - 1), point(i));
            area.push(area[i - 1] + 0.5 * (c1 - c0) * (v0 + v1));
            moment += (c1 - c0) / 6.0 * (c0 * (2.0 * v0 + v1) + c1 * (v0 + 2.0 * v1));
        }
        let total = area[cosines.len() - 1];
        let nodes = (0..cosines.len())
            .map(|i| Node {
                cos_theta: cosines[i],
                density: (point(i).1 / total) as f32,
                cdf: (area[i] / total) as f32,
            })
            .collect();
        Ok(Self {
            nodes,
            mean_cosine: (moment / total) as f32,
        })
    }

    /// Density per unit of cos θ.
    fn density(&self, cos_theta: f32) -> f32 {
        let [a, b] = self.segment(|node| node.cos_theta <= cos_theta);
        let x = ((cos_theta - a.cos_theta) / (b.cos_theta - a.cos_theta)).clamp(0.0, 1.0);
        a.density + x * (b.density - a.density)
    }

    /// The segment that starts at the last node which is `before`.
    fn segment(&self, before: impl Fn(&Node) -> bool) -> [Node; 2] {
        let end = self.nodes.partition_point(before);
        let end = end.clamp(1, self.nodes.len() - 1);
        [self.nodes[end - 1], self.nodes[end]]
    }
}

impl PhaseFunction for Tabulated {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.density(-wo.dot(wi)) / TAU
    }

    /// Inverts the piecewise quadratic cumulative distribution of cos θ in the form of its root
    /// that does not subtract.
    fn sample(&self, wo: Vec3, u: [f32; 2]) -> PhaseSample {
        let [a, b] = self.segment(|node| node.cdf <= u[0]);
        let width = b.cos_theta - a.cos_theta;
        let area = ((u[0] - a.cdf) / width).max(f32::MIN_POSITIVE);
        let slope = b.density - a.density;
        let root = (a.density * a.density + 2.0 * area * slope).max(0.0).sqrt();
        let x = (2.0 * area / (a.density + root)).min(1.0);
        let cos_theta = (a.cos_theta + x * width).clamp(-1.0, 1.0);
        let wi = Frame::around(-wo).to_world(warp::polar(cos_theta, u[1]));
        exact(wi, (a.density + x * slope) / TAU)
    }

    fn mean_cosine(&self) -> f32 {
        self.mean_cosine
    }
}

fn check_cosines(cosines: &[f32], values: usize) -> Result<(), MediumError> {
    let last = cosines.len().saturating_sub(1);
    let bad = if cosines.len() < 2 || cosines.len() != values {
        Some(cosines.len().min(values))
    } else if cosines[0] != -1.0 {
        Some(0)
    } else if cosines[last] != 1.0 {
        Some(last)
    } else {
        (1..=last).find(|&i| cosines[i].partial_cmp(&cosines[i - 1]) != Some(Greater))
    };
    bad.map_or(Ok(()), |node| Err(MediumError::TableCosines { node }))
}
