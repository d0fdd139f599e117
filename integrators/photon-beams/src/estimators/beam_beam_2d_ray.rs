//! Beam × beam, 2D₁.

use super::{Estimator, Meeting, Pair, overlap, place};

/// A ray takes a beam all along its way through the cylinder (or cone) around it: every point of
/// the beam is blurred over a disc across the beam (Jarosz et al. 2011a).
///
/// weight = K₂(d, r) × length of the ray's chord, at a place t of it; v is the foot of t on the
/// beam. Right at any angle, the coaxial one included.
#[derive(Clone, Copy, Debug)]
pub struct BeamBeam2DRay;

impl Estimator for BeamBeam2DRay {
    const BY_RAYS: bool = true;
    const BLUR: u8 = 2;

    fn meet(pair: &Pair<'_>, u: [f32; 2]) -> Option<Meeting> {
        let Pair { lines, piece, .. } = *pair;
        let chord = lines.ray_chord(pair.cone.largest(piece))?;
        let chord = overlap(chord, [0.0, pair.t_max])?;
        let chord = overlap(chord, lines.ray_between(piece)?)?;
        // v is t cos θ and a constant.
        let [of_ray, of_beam] = pair.sigma_t;
        let rate = of_ray + of_beam * lines.cos_theta();
        let [t, length] = place(chord, rate, u[0]);
        let v = lines.beam_foot(t);
        let kernel = pair.kernel.weight_2d(
            lines.distance_squared(t, v) as f32,
            pair.cone.radius(v) as f32,
        );
        let weight = f64::from(kernel) * length;
        (weight > 0.0).then_some(Meeting { t, v, weight })
    }
}
