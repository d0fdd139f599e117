//! Beam × point, 3D.

use super::{Estimator, Meeting, Pair, overlap, place};

/// A point takes a beam all along its chord in the ball around the point (Jarosz et al. 2011a).
/// Points are marched along the ray of sight.
///
/// weight = K₃(d, r) × length of the chord, at a place v of it.
#[derive(Clone, Copy, Debug)]
pub struct BeamPoint3D;

impl Estimator for BeamPoint3D {
    const BY_RAYS: bool = false;
    const BLUR: u8 = 3;

    fn meet(pair: &Pair<'_>, u: [f32; 2]) -> Option<Meeting> {
        let Pair { lines, piece, .. } = *pair;
        let reach = pair.cone.largest(piece);
        let foot = lines.beam_foot(0.0);
        let half = (reach * reach - lines.distance_squared(0.0, foot)).sqrt();
        if half.is_nan() {
            return None;
        }
        let chord = overlap([foot - half, foot + half], piece)?;
        let [v, length] = place(chord, pair.sigma_t[1], u[0]);
        let distance_squared = lines.distance_squared(0.0, v) as f32;
        let radius = pair.cone.radius(v) as f32;
        let weight = f64::from(pair.kernel.weight_3d(distance_squared, radius)) * length;
        (weight > 0.0).then_some(Meeting { t: 0.0, v, weight })
    }
}
