//! Beam × beam, 3D.

use super::{Estimator, Meeting, Pair, overlap, place};

/// A ray takes all pairs of its points with those of a beam that are closer than the radius: every
/// point of the beam is blurred over a ball (Jarosz et al. 2011a).
///
/// weight = K₃(d, r) × length of the stretch of the beam that comes near the ray × length of the
/// ray's chord in the ball around a place v of it.
#[derive(Clone, Copy, Debug)]
pub struct BeamBeam3D;

impl Estimator for BeamBeam3D {
    const BY_RAYS: bool = true;
    const BLUR: u8 = 3;

    fn meet(pair: &Pair<'_>, u: [f32; 2]) -> Option<Meeting> {
        let Pair { lines, piece, .. } = *pair;
        let reach = pair.cone.largest(piece);
        let near = overlap(lines.beam_chord(reach)?, piece)?;
        let near = overlap(near, lines.beam_between([-reach, pair.t_max + reach])?)?;
        let [of_ray, of_beam] = pair.sigma_t;
        let rate = of_beam + of_ray * lines.cos_theta();
        let [v, beam] = place(near, rate, u[0]);
        let radius = pair.cone.radius(v);
        let foot = lines.ray_foot(v);
        let half = (radius * radius - lines.distance_squared(foot, v)).sqrt();
        if half.is_nan() {
            return None;
        }
        let chord = overlap([foot - half, foot + half], [0.0, pair.t_max])?;
        let [t, ray] = place(chord, of_ray, u[1]);
        let kernel = pair
            .kernel
            .weight_3d(lines.distance_squared(t, v) as f32, radius as f32);
        let weight = f64::from(kernel) * beam * ray;
        (weight > 0.0).then_some(Meeting { t, v, weight })
    }
}
