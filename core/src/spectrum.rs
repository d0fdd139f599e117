//! Quantities per channel of the spectrum.

use glam::Vec3;
use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

/// A quantity per channel: radiance, power, a coefficient or a weight.
///
/// Arithmetic is per channel. Implemented for `f32` (a grey scene carries one channel) and for
/// [`Rgb`]; a host may bring its own.
///
/// ```
/// use tyndall_core::{Rgb, Spectrum};
/// let albedo = Rgb::new(1.0, 0.0, 2.0).ratio(Rgb::new(2.0, 0.0, 2.0));
/// assert_eq!(albedo, Rgb::new(0.5, 0.0, 1.0)); // 0/0 is 0
/// assert_eq!(Spectrum::mean(0.25_f32), 0.25);
/// ```
pub trait Spectrum:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f32, Output = Self>
    + Div<f32, Output = Self>
    + AddAssign
    + MulAssign
    + MulAssign<f32>
    + Sum
{
    /// Number of channels.
    const CHANNELS: usize;

    /// The spectrum whose channel `i` is `channel(i)`.
    fn from_channels(channel: impl FnMut(usize) -> f32) -> Self;

    /// Channel `i`, with `i < CHANNELS`.
    fn channel(self, i: usize) -> f32;

    /// The same value in every channel.
    #[inline]
    fn splat(value: f32) -> Self {
        Self::from_channels(|_| value)
    }

    /// Applies `f` to every channel.
    #[inline]
    fn map(self, mut f: impl FnMut(f32) -> f32) -> Self {
        Self::from_channels(|i| f(self.channel(i)))
    }

    /// Applies `f` to every pair of channels.
    #[inline]
    fn zip(self, other: Self, mut f: impl FnMut(f32, f32) -> f32) -> Self {
        Self::from_channels(|i| f(self.channel(i), other.channel(i)))
    }

    /// Folds the channels in order.
    #[inline]
    fn fold(self, start: f32, mut f: impl FnMut(f32, f32) -> f32) -> f32 {
        (0..Self::CHANNELS).fold(start, |sum, i| f(sum, self.channel(i)))
    }

    /// Sum of the channels.
    #[inline]
    fn sum(self) -> f32 {
        self.fold(0.0, |a, b| a + b)
    }

    /// Mean of the channels.
    #[inline]
    fn mean(self) -> f32 {
        self.sum() / Self::CHANNELS as f32
    }

    /// Largest channel.
    #[inline]
    fn max_channel(self) -> f32 {
        self.fold(f32::NEG_INFINITY, f32::max)
    }

    /// Quotient per channel, with 0/0 = 0 (an albedo where nothing interacts).
    #[inline]
    fn ratio(self, divisor: Self) -> Self {
        self.zip(divisor, |a, b| if a == 0.0 { 0.0 } else { a / b })
    }

    /// Whether every channel is zero.
    #[inline]
    fn is_black(self) -> bool {
        self == Self::default()
    }

    /// Whether every channel is finite.
    #[inline]
    fn is_finite(self) -> bool {
        (0..Self::CHANNELS).all(|i| self.channel(i).is_finite())
    }
}

impl Spectrum for f32 {
    const CHANNELS: usize = 1;

    #[inline]
    fn from_channels(mut channel: impl FnMut(usize) -> f32) -> Self {
        channel(0)
    }

    #[inline]
    fn channel(self, _: usize) -> f32 {
        self
    }
}

/// Three channels, linear; the primaries are the host's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Rgb(pub Vec3);

impl Rgb {
    /// From red, green and blue.
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3::new(r, g, b))
    }
}

impl Spectrum for Rgb {
    const CHANNELS: usize = 3;

    #[inline]
    fn from_channels(mut channel: impl FnMut(usize) -> f32) -> Self {
        Self::new(channel(0), channel(1), channel(2))
    }

    #[inline]
    fn channel(self, i: usize) -> f32 {
        self.0[i]
    }
}

impl Add for Rgb {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Rgb {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self(self.0 * factor)
    }
}

impl Div<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, divisor: f32) -> Self {
        Self(self.0 / divisor)
    }
}

impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        self.0 *= other.0;
    }
}

impl MulAssign<f32> for Rgb {
    #[inline]
    fn mul_assign(&mut self, factor: f32) {
        self.0 *= factor;
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::default(), |a, b| a + b)
    }
}
