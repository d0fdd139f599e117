//! Beam × beam, 1D.

use super::{Estimator, Meeting, Pair};

/// A ray takes a beam where their lines are closest, blurred across both: the least bias for its
/// noise, and no integral is left (Jarosz et al. 2011a).
///
/// weight = K₁(d, r) / sin θ, with r the radius where they meet. Lines that are parallel never do:
/// their light is left to another estimator.
#[derive(Clone, Copy, Debug)]
pub struct BeamBeam1D;

impl Estimator for BeamBeam1D {
    const BY_RAYS: bool = true;
    const BLUR: u8 = 1;

    #[inline]
    fn meet(pair: &Pair<'_>, _: [f32; 2]) -> Option<Meeting> {
        let [t, v] = pair.lines.closest()?;
        let [start, end] = pair.piece;
        let within = (0.0..=pair.t_max).contains(&t) && (start..end).contains(&v);
        if !within {
            return None;
        }
        let radius = pair.cone.radius(v);
        let distance = pair.lines.distance();
        let kernel = pair
            .kernel
            .weight_1d((distance * distance) as f32, radius as f32);
        let weight = f64::from(kernel) / pair.lines.sin_theta();
        (weight > 0.0).then_some(Meeting { t, v, weight })
    }
}
