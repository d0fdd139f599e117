//! Light in closed form, or by quadrature in `f64`.
//!
//! Isotropic means a phase function of 1/(4π). Figures are per channel.

mod h_function;
mod point_source;

pub use h_function::HFunction;
pub use point_source::{airlight, point_source_fluence};

/// Reflectance and transmittance of a slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Mean cosine of the Henyey–Greenstein phase function.
    pub mean_cosine: f64,
    /// Optical thickness.
    pub optical_thickness: f64,
    /// Total reflectance.
    pub reflectance: f64,
    /// Total transmittance, the uncollided part included.
    pub transmittance: f64,
}

impl Slab {
    /// Transmittance without the uncollided part exp(−τ).
    pub fn diffuse_transmittance(&self) -> f64 {
        self.transmittance - (-self.optical_thickness).exp()
    }
}

/// Slabs of matched index under normal collimated light, by adding-doubling (van de Hulst 1980,
/// ch. 4; Prahl 1995), within ± 1e-4.
pub const SLABS: [Slab; 4] = [
    slab(1.0, 0.0, 1.0, 0.34133, 0.65867),
    slab(0.9, 0.0, 2.0, 0.36165, 0.35650),
    slab(0.9, 0.75, 2.0, 0.09740, 0.66096),
    slab(0.99, 0.9, 16.0, 0.32320, 0.41096),
];

const fn slab(
    albedo: f64,
    mean_cosine: f64,
    optical_thickness: f64,
    reflectance: f64,
    transmittance: f64,
) -> Slab {
    Slab {
        albedo,
        mean_cosine,
        optical_thickness,
        reflectance,
        transmittance,
    }
}

/// Radiance of a medium that absorbs and emits with source function 1, over optical thickness τ:
/// 1 − exp(−τ) (Chandrasekhar 1960, ch. I).
///
/// ```
/// assert!((tyndall_testkit::closed_form::emission_only(1.0) - 0.632_120_558_8).abs() < 1e-10);
/// ```
pub fn emission_only(optical_thickness: f64) -> f64 {
    -(-optical_thickness).exp_m1()
}

/// A laser seen from the side, in a homogeneous medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserRow {
    /// Scattering coefficient, 1/scene unit.
    pub sigma_s: f64,
    /// Extinction coefficient, 1/scene unit.
    pub sigma_t: f64,
    /// Value of the phase function for the angle of scattering, per steradian: for light that
    /// travels along d and is seen by a ray along e, the cosine of scattering is −d·e.
    pub phase: f64,
    /// Flux of the beam, W.
    pub flux: f64,
    /// Radius of the beam.
    pub radius: f64,
    /// d·e.
    pub cos_theta: f64,
    /// Along the ray, from its origin to the axis of the beam.
    pub distance: f64,
    /// Along the beam, from its start to the ray.
    pub along: f64,
}

/// Radiance of single scattering integrated across the image of a laser, W·sr⁻¹·m⁻¹:
/// σs Φ p exp(−σt (t₀ + v₀)) / sin θ · 2 I₁(x)/x with x = σt r (1 + cos θ)/sin θ.
///
/// The last factor averages the attenuation over the section of a uniform beam and is 1 for a
/// pencil. Derivation: the single-scattering integral over y, and over the ray t = t₀ + z/sin θ,
/// within y² + z² ≤ r²; the pencil is the 1D beam-beam estimate of Jarosz et al. (2011), integrated over its kernel.
///
/// ```
/// use tyndall_testkit::closed_form::{LaserRow, laser_row_sum};
/// let row = LaserRow { sigma_s: 0.5, sigma_t: 0.8, phase: 0.08, flux: 3.0, radius: 0.0,
///     cos_theta: 0.6, distance: 1.0, along: 1.5 };
/// assert!((laser_row_sum(&row) - 0.5 * 3.0 * 0.08 * (-2.0_f64).exp() / 0.8).abs() < 1e-12);
/// ```
pub fn laser_row_sum(row: &LaserRow) -> f64 {
    let sin_theta = (1.0 - row.cos_theta * row.cos_theta).sqrt();
    let x = row.sigma_t * row.radius * (1.0 + row.cos_theta) / sin_theta;
    let attenuation = (-row.sigma_t * (row.distance + row.along)).exp();
    row.sigma_s * row.flux * row.phase * attenuation / sin_theta * bessel_ratio(x)
}

/// 2 I₁(x)/x = Σ (x²/4)^k / (k! (k+1)!) (Abramowitz & Stegun 1964, 9.6.10).
fn bessel_ratio(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..200 {
        let k = f64::from(k);
        term *= quarter / (k * (k + 1.0));
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}
