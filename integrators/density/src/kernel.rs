//! Kernels that smooth a photon over the space around it.

use crate::exponential;
use fearless_simd::{Level, dispatch};
use std::fmt;
use std::ops::RangeInclusive;

/// The radii for which weights are promised, in scene units. Their cubes and the inverses of these
/// stay in the range of `f32`.
pub const RADII: RangeInclusive<f32> = 1e-12..=1e12;

/// σ = r/3: exp(−d²/2σ²) = exp(−4.5 u²). The cut at r then leaves a step of 1.1 % of the peak.
const GAUSSIAN: f32 = 4.5;

/// A density that falls with the distance from its centre, within a radius.
///
/// Of the shape s(u), u = d/r, and normalised in one, two and three dimensions: the weight is
/// s(u)·c/rⁿ inside the radius, 0 outside, and its integral over the segment of length 2r, the disc
/// or the ball is 1. The constants c:
///
/// | kernel | s(u) | 1D | 2D | 3D |
/// |---|---|---|---|---|
/// | `Constant` | 1 | 1/2 | 1/π | 3/(4π) |
/// | `Epanechnikov` | 1 − u² | 3/4 | 2/π | 15/(8π) |
/// | `Biweight` | (1 − u²)² | 15/16 | 3/π | 105/(32π) |
/// | `Cone` | 1 − u | 1 | 3/π | 3/π |
/// | `Gaussian` | exp(−u²/(2/9)), σ = r/3 | 1.200067 | 1.448486 | 1.766058 |
///
/// Weights are in 1/unit, 1/unit² and 1/unit³. The distance enters squared, since searches find it
/// so: `Cone` takes a root of it, `Gaussian` an exponential, the others neither.
///
/// Radii outside [`RADII`] have weight 0: within a radius of 0 there is nothing, over an infinite
/// one the density is 0. What is not a number has weight 0 too.
///
/// Sources: Silverman (1986), "Density Estimation for Statistics and Data Analysis", for the
/// family of (1 − u²)ᵏ; Jensen (2001), "Realistic Image Synthesis Using Photon Mapping", for
/// cone and Gaussian. Deviations: the cone reaches 0 at the radius (Jensen's k = 1), and the
/// Gaussian is normalised for its cut at the radius, which Jensen's constants (0.918, 1.953) are
/// not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// The least variance for a radius, and the sharpest edges of blur.
    Constant,
    /// The least error at the best radius.
    #[default]
    Epanechnikov,
    /// Smooth at the radius, where it is 0 with its slope.
    Biweight,
    /// Falls linearly.
    Cone,
    /// A bell of σ = r/3, cut at the radius.
    Gaussian,
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Constant => "constant",
            Self::Epanechnikov => "epanechnikov",
            Self::Biweight => "biweight",
            Self::Cone => "cone",
            Self::Gaussian => "gaussian",
        })
    }
}

impl Kernel {
    /// The weight along a line, 1/unit.
    ///
    /// ```
    /// use tyndall_density::Kernel;
    /// assert_eq!(Kernel::Constant.weight_1d(0.0, 2.0), 0.25);
    /// assert_eq!(Kernel::Constant.weight_1d(4.1, 2.0), 0.0);
    /// ```
    #[inline]
    pub fn weight_1d(self, distance_squared: f32, radius: f32) -> f32 {
        let inverse = inverse(radius);
        let constant = match self {
            Self::Constant => 0.5,
            Self::Epanechnikov => 0.75,
            Self::Biweight => 15.0 / 16.0,
            Self::Cone => 1.0,
            Self::Gaussian => 1.200_066_8,
        };
        self.shape(distance_squared, inverse) * constant * inverse
    }

    /// The weight on a disc, 1/unit².
    ///
    /// ```
    /// use tyndall_density::Kernel;
    /// let weight = Kernel::Epanechnikov.weight_2d(0.0, 0.5);
    /// assert!((weight - 8.0 / std::f32::consts::PI).abs() < 1e-6);
    /// ```
    #[inline]
    pub fn weight_2d(self, distance_squared: f32, radius: f32) -> f32 {
        use std::f32::consts::FRAC_1_PI;
        let inverse = inverse(radius);
        let constant = match self {
            Self::Constant => FRAC_1_PI,
            Self::Epanechnikov => 2.0 * FRAC_1_PI,
            Self::Biweight | Self::Cone => 3.0 * FRAC_1_PI,
            Self::Gaussian => 1.448_485_7,
        };
        self.shape(distance_squared, inverse) * constant * (inverse * inverse)
    }

    /// Replaces every u² = d²/r² by its weight on a disc of radius 1: many at once.
    ///
    /// ```
    /// use tyndall_density::Kernel;
    /// let mut squared = [0.25, 1.1, f32::INFINITY];
    /// Kernel::Epanechnikov.weights_2d(&mut squared);
    /// assert_eq!(squared, [Kernel::Epanechnikov.weight_2d(0.25, 1.0), 0.0, 0.0]);
    /// ```
    #[inline]
    pub fn weights_2d(self, squared: &mut [f32]) {
        dispatch!(Level::new(), _ => self.replace(squared));
    }

    #[inline(always)] // into code for the level of the machine
    fn replace(self, squared: &mut [f32]) {
        // A loop for each kernel, or the compiler would take them one by one.
        match self {
            Self::Gaussian => {
                for u in &mut *squared {
                    *u = if *u <= 1.0 {
                        GAUSSIAN * *u
                    } else {
                        f32::INFINITY
                    };
                }
                exponential::replace(squared);
                squared.iter_mut().for_each(|weight| *weight *= 1.448_485_7);
            }
            Self::Constant => each(squared, |u| Self::Constant.weight_2d(u, 1.0)),
            Self::Epanechnikov => each(squared, |u| Self::Epanechnikov.weight_2d(u, 1.0)),
            Self::Biweight => each(squared, |u| Self::Biweight.weight_2d(u, 1.0)),
            Self::Cone => each(squared, |u| Self::Cone.weight_2d(u, 1.0)),
        }
    }

    /// The weight in a ball, 1/unit³.
    ///
    /// ```
    /// use tyndall_density::Kernel;
    /// let weight = Kernel::Constant.weight_3d(0.0, 2.0);
    /// assert!((weight * 32.0 * std::f32::consts::PI / 3.0 - 1.0).abs() < 1e-6);
    /// ```
    #[inline]
    pub fn weight_3d(self, distance_squared: f32, radius: f32) -> f32 {
        use std::f32::consts::FRAC_1_PI;
        let inverse = inverse(radius);
        let constant = match self {
            Self::Constant => 0.75 * FRAC_1_PI,
            Self::Epanechnikov => 1.875 * FRAC_1_PI,
            Self::Biweight => 105.0 / 32.0 * FRAC_1_PI,
            Self::Cone => 3.0 * FRAC_1_PI,
            Self::Gaussian => 1.766_057_6,
        };
        self.shape(distance_squared, inverse) * constant * (inverse * inverse * inverse)
    }

    /// s(u); 0 beyond the radius.
    #[inline]
    fn shape(self, distance_squared: f32, inverse: f32) -> f32 {
        let u_squared = distance_squared * (inverse * inverse);
        if u_squared.is_nan() || u_squared > 1.0 {
            return 0.0;
        }
        match self {
            Self::Constant => 1.0,
            Self::Epanechnikov => 1.0 - u_squared,
            Self::Biweight => (1.0 - u_squared) * (1.0 - u_squared),
            // A squared distance found by subtraction may be less than 0.
            Self::Cone => 1.0 - u_squared.max(0.0).sqrt(),
            Self::Gaussian => (-GAUSSIAN * u_squared).exp(),
        }
    }
}

#[inline(always)]
fn each(values: &mut [f32], f: impl Fn(f32) -> f32) {
    for value in values {
        *value = f(*value);
    }
}

/// 1/r; 0 for radii that are not promised, so that their weights are.
#[inline]
fn inverse(radius: f32) -> f32 {
    if RADII.contains(&radius) {
        1.0 / radius
    } else {
        0.0
    }
}
