//! The colours of what glows with heat.

use crate::MediumError;
use std::sync::LazyLock;
use tyndall_core::{Rgb, Spectrum};

/// Planck's first constant for radiance 2hc², W·m²·sr⁻¹, and the second hc/k, m·K (CODATA 2018).
const C1: f64 = 1.191_042_972e-16;
const C2: f64 = 1.438_776_877e-2;
/// The temperatures whose colours are tabulated, K, evenly in their logarithms.
const COLDEST: f64 = 500.0;
const HOTTEST: f64 = 1e5;
const KNOTS: usize = 2048;

/// From CIE XYZ to linear sRGB (IEC 61966-2-1), and back to Y.
const TO_RGB: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];
const TO_Y: [f64; 3] = [0.212_672_9, 0.715_152_2, 0.072_175_0];

/// The light of a black body by its temperature: the source function of fire.
///
/// X, Y, Z = ∫ B(λ, T)·(x̄, ȳ, z̄)(λ) dλ, with B the spectral radiance of Planck (1901) and the CIE
/// 1931 colour matching functions by the fit of Wyman, Sloan & Shirley (2013), "Simple Analytic
/// Approximations to the CIE XYZ Color Matching Functions", eq. 4, good to 1 % of their peaks; then
/// linear sRGB. Below about 1900 K a black body is redder than sRGB can be: negative channels are
/// clipped, and the others scaled so that the luminance stays.
///
/// Looked up in a table to 2e-5, from 500 to 1e5 K; the luminance goes on as e^{−c/T} below and as T
/// above, with the colour of the end. No channel falls as the temperature rises.
///
/// ```
/// use tyndall_core::Rgb;
/// use tyndall_media::BlackBody;
/// let candle = BlackBody::relative_to(1900.0)?;
/// assert!((candle.luminance(1900.0) - 1.0).abs() < 1e-6);
/// let Rgb(colour) = candle.colour(1900.0);
/// assert!(colour.x > 2.0 * colour.y && colour.y > 10.0 * colour.z);
/// # Ok::<(), tyndall_media::MediumError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlackBody {
    scale: f64,
}

impl BlackBody {
    /// As it is: the luminance Y is in W·sr⁻¹·m⁻² as the eye weighs it; times 683 lm/W it is in
    /// cd·m⁻². It is 880 at the melting point of platinum, 2041 K, and 2.8e6 at the sun's 5772 K.
    pub fn absolute() -> Self {
        Self { scale: 1.0 }
    }

    /// Luminance 1 at a temperature in K, for scenes whose light has no unit.
    ///
    /// # Errors
    /// [`MediumError::Temperature`] if it is not between 500 and 1e5 K.
    pub fn relative_to(temperature: f32) -> Result<Self, MediumError> {
        let kelvin = f64::from(temperature);
        if !(COLDEST..=HOTTEST).contains(&kelvin) {
            return Err(MediumError::Temperature { temperature });
        }
        let (log_luminance, _) = look_up(kelvin);
        Ok(Self {
            scale: (-log_luminance).exp(),
        })
    }

    /// The luminance at a temperature in K, for a grey scene; 0 at none.
    pub fn luminance(self, temperature: f32) -> f32 {
        if temperature > 0.0 {
            self.scaled(look_up(temperature.into()).0)
        } else {
            0.0
        }
    }

    /// The colour at a temperature in K, linear sRGB; black at none.
    pub fn colour(self, temperature: f32) -> Rgb {
        if temperature > 0.0 {
            let (log_luminance, colour) = look_up(temperature.into());
            // Colours of luminance 1 are at most 5.
            colour * self.scaled(log_luminance).min(f32::MAX / 8.0)
        } else {
            Rgb::default()
        }
    }

    fn scaled(self, log_luminance: f64) -> f32 {
        ((self.scale * log_luminance.exp()) as f32).min(f32::MAX)
    }
}

/// A black body of one temperature.
struct Knot {
    /// 1/K.
    inverse: f64,
    log_luminance: f64,
    /// Of luminance 1.
    colour: Rgb,
}

static TABLE: LazyLock<Vec<Knot>> = LazyLock::new(|| {
    let step = (HOTTEST / COLDEST).ln() / (KNOTS - 1) as f64;
    (0..KNOTS)
        .map(|i| knot(COLDEST * (step * i as f64).exp()))
        .collect()
});

/// The logarithm of the luminance, and the colour of luminance 1: linear in 1/T between knots, for
/// that is how the logarithm goes (Wien).
fn look_up(kelvin: f64) -> (f64, Rgb) {
    let table = &*TABLE;
    let at = (kelvin / COLDEST).ln() / (HOTTEST / COLDEST).ln() * (KNOTS - 1) as f64;
    let [low, high] = {
        let i = (at.max(0.0) as usize).min(KNOTS - 2);
        [&table[i], &table[i + 1]]
    };
    if kelvin >= HOTTEST {
        return (high.log_luminance + (kelvin / HOTTEST).ln(), high.colour);
    }
    let share = (kelvin.recip() - low.inverse) / (high.inverse - low.inverse);
    let log_luminance = low.log_luminance + share * (high.log_luminance - low.log_luminance);
    let share = share.max(0.0) as f32;
    (
        log_luminance,
        low.colour * (1.0 - share) + high.colour * share,
    )
}

/// The integrals, by the trapezoidal rule in steps of 5 nm, of which the ends are zero.
fn knot(kelvin: f64) -> Knot {
    // Taken out of all, for it may be e^{-80}.
    let coldest = C2 / (830e-9 * kelvin);
    let mut xyz = [0.0; 3];
    for nm in (360..=830).step_by(5) {
        let metres = f64::from(nm) * 1e-9;
        let x = C2 / (metres * kelvin);
        let planck = C1 / metres.powi(5) * (coldest - x).exp() / -(-x).exp_m1();
        for (sum, weight) in xyz.iter_mut().zip(matching_functions(nm.into())) {
            *sum += planck * weight * 5e-9;
        }
    }
    let luminance = xyz[1];
    let rgb = TO_RGB.map(|row| dot(row, xyz).max(0.0));
    let kept = luminance / dot(TO_Y, rgb);
    Knot {
        inverse: kelvin.recip(),
        log_luminance: luminance.ln() - coldest,
        colour: Rgb::from_channels(|c| (rgb[c] * kept / luminance) as f32),
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// x̄, ȳ and z̄ at a wavelength in nm: Wyman, Sloan & Shirley (2013), eq. 4.
fn matching_functions(nm: f64) -> [f64; 3] {
    let lobe = |peak: f64, below: f64, above: f64| {
        let x = (nm - peak) / if nm < peak { below } else { above };
        (-0.5 * x * x).exp()
    };
    [
        1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7)
            - 0.065 * lobe(501.1, 20.4, 26.2),
        0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
        1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8),
    ]
}
