//! Beam × beam, 2D₂.

use super::{Estimator, Meeting, Pair, overlap, place};

/// A ray, thickened to a cylinder, takes a beam all along the beam's way through it: every point of
/// the beam is blurred over a disc across the ray (Jarosz et al. 2011a).
///
/// weight = K₂(d, r) × length of the beam's chord, at a place v of it; t is the foot of v on the
/// ray.
#[derive(Clone, Copy, Debug)]
pub struct BeamBeam2DBeam;

impl Estimator for BeamBeam2DBeam {
    const BY_RAYS: bool = true;
    const BLUR: u8 = 2;

    fn meet(pair: &Pair<'_>, u: [f32; 2]) -> Option<Meeting> {
        let Pair { lines, piece, .. } = *pair;
        let chord = lines.beam_chord(pair.cone.largest(piece))?;
        let chord = overlap(chord, piece)?;
        let chord = overlap(chord, lines.beam_between([0.0, pair.t_max])?)?;
        // t is v cos θ and a constant.
        let [of_ray, of_beam] = pair.sigma_t;
        let rate = of_beam + of_ray * lines.cos_theta();
        let [v, length] = place(chord, rate, u[0]);
        let t = lines.ray_foot(v);
        let kernel = pair.kernel.weight_2d(
            lines.distance_squared(t, v) as f32,
            pair.cone.radius(v) as f32,
        );
        let weight = f64::from(kernel) * length;
        (weight > 0.0).then_some(Meeting { t, v, weight })
    }
}
