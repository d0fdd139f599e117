//! Beam × point, 2D.

use super::{Estimator, Meeting, Pair};

/// A point takes a beam where the beam passes it: every point of the beam is blurred over a disc
/// across the beam (Jarosz et al. 2011a). Points are marched along the ray of sight.
///
/// weight = K₂(d, r).
#[derive(Clone, Copy, Debug)]
pub struct BeamPoint2D;

impl Estimator for BeamPoint2D {
    const BY_RAYS: bool = false;
    const BLUR: u8 = 2;

    fn meet(pair: &Pair<'_>, _: [f32; 2]) -> Option<Meeting> {
        let [start, end] = pair.piece;
        let v = pair.lines.beam_foot(0.0);
        if !(start..end).contains(&v) {
            return None;
        }
        let distance_squared = pair.lines.distance_squared(0.0, v) as f32;
        let radius = pair.cone.radius(v) as f32;
        let weight = f64::from(pair.kernel.weight_2d(distance_squared, radius));
        (weight > 0.0).then_some(Meeting { t: 0.0, v, weight })
    }
}
