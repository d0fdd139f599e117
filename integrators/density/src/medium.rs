//! Photons in media.

use glam::Vec3;
use tyndall_core::{PhaseFunction, Spectrum};

/// The radiance that a photon in a medium scatters towards `wo`, times volume: p(wo, wi)·Φₛ with
/// wi = −`photon_direction`, in W·sr⁻¹.
///
/// `scattered_flux` is Φₛ = (σs/σt)·Φ: photons lie at collisions and carry what arrives there.
/// `photon_direction` is that of travel, `wo` a unit vector towards the sensor. Multiplied by the
/// weight of a kernel in 3D it is radiance per unit of length along the ray; by one in 2D,
/// radiance. See the table of the crate.
///
/// Jensen & Christensen (1998), "Efficient Simulation of Light Transport in Scenes with
/// Participating Media using Photon Maps"; Jarosz, Zwicker & Jensen (2008), "The Beam
/// Radiance Estimate for Volumetric Photon Mapping".
///
/// ```
/// use glam::Vec3;
/// use tyndall_density::in_scattered;
/// use tyndall_media::Phase;
/// let isotropic = in_scattered(&Phase::Isotropic, Vec3::X, Vec3::Y, 4.0 * std::f32::consts::PI);
/// assert!((isotropic - 1.0).abs() < 1e-6);
/// ```
#[inline]
pub fn in_scattered<S: Spectrum>(
    phase: &impl PhaseFunction,
    wo: Vec3,
    photon_direction: Vec3,
    scattered_flux: S,
) -> S {
    scattered_flux * phase.eval(wo, -photon_direction)
}

/// The stretch of a ray inside the ball around a photon.
///
/// Its start and its length are kept, for the difference of two ends far along the ray would have
/// lost a small ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// Where it starts, distance along the ray.
    pub start: f32,
    /// Its length, more than 0.
    pub length: f32,
}

impl Chord {
    /// The chord of a ray that ends at `t_max` and passes the photon at `t` (negative if that is
    /// behind its origin) at the given squared distance; `None` if no part of the ray is inside, or
    /// if the radius is infinite and the photon's density 0.
    ///
    /// ```
    /// use tyndall_density::Chord;
    /// // A ball of radius 5, passed at distance 3: two halves of 4, of which the origin cuts one.
    /// let chord = Chord::new(1.0, 9.0, 5.0, f32::INFINITY).unwrap();
    /// assert_eq!((chord.start, chord.length), (0.0, 5.0));
    /// ```
    #[inline]
    pub fn new(t: f32, distance_squared: f32, radius: f32, t_max: f32) -> Option<Self> {
        let half = (radius * radius - distance_squared).sqrt(); // NaN outside
        let length = half.min(t) + half.min(t_max - t);
        let inside = half > 0.0 && half.is_finite() && length > 0.0 && t.is_finite();
        inside.then(|| Self {
            start: (t - half).max(0.0),
            length,
        })
    }
}
