//! Reconstruction filters: what a pixel is a mean of.

/// Steps of the table of a filter.
const STEPS: usize = 1024;

/// A filter of integral 1 in each axis, in steps of its diameter over 1024: what is evaluated is
/// exactly what is sampled.
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    /// In pixels.
    radius: f32,
    /// Per pixel, from −`radius` to `radius`.
    values: Vec<f32>,
    /// Running sums of |values|, the last being 1.
    cumulative: Vec<f32>,
    /// Integral of the modulus; 1 if no value is negative.
    magnitude: f32,
}

/// Shapes of filters, to be scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    Box,
    /// Falls linearly.
    Tent,
    /// In pixels; less its value at the radius.
    Gaussian {
        stddev: f64,
    },
    /// Mitchell & Netravali (1988); stretched to the radius.
    Mitchell {
        b: f64,
        c: f64,
    },
    /// The four terms of Harris (1978), table 1, minimum; stretched to the radius.
    BlackmanHarris,
}

impl Shape {
    /// At distance `t` from the middle, in radii.
    fn at(self, t: f64, radius: f64) -> f64 {
        match self {
            Self::Box => 1.0,
            Self::Tent => 1.0 - t,
            Self::Gaussian { stddev } => {
                let at = |x: f64| (-0.5 * (x / stddev).powi(2)).exp();
                at(t * radius) - at(radius)
            }
            Self::Mitchell { b, c } => mitchell(2.0 * t, b, c),
            Self::BlackmanHarris => {
                let phase = std::f64::consts::PI * (1.0 + t);
                let terms = [0.358_75, -0.488_29, 0.141_28, -0.011_68];
                let terms = terms.into_iter().enumerate();
                terms.map(|(k, a)| a * (k as f64 * phase).cos()).sum()
            }
        }
    }
}

/// Six times the piecewise cubic, for `x` from 0 to 2.
fn mitchell(x: f64, b: f64, c: f64) -> f64 {
    if x < 1.0 {
        ((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)
    } else {
        (((-b - 6.0 * c) * x + (6.0 * b + 30.0 * c)) * x + (-12.0 * b - 48.0 * c)) * x
            + (8.0 * b + 24.0 * c)
    }
}

impl Filter {
    /// A filter of this shape, 0 beyond `radius` pixels (a positive number); `None` if the shape
    /// has no positive integral.
    pub(crate) fn new(shape: Shape, radius: f32) -> Option<Self> {
        let step = 2.0 * f64::from(radius) / STEPS as f64;
        let at = |i: usize| {
            let t = (2 * i + 1) as f64 / STEPS as f64 - 1.0;
            shape.at(t.abs(), radius.into())
        };
        let values: Vec<f64> = (0..STEPS).map(at).collect();
        let integral = step * values.iter().sum::<f64>();
        let modulus = step * values.iter().map(|v| v.abs()).sum::<f64>();
        // Lobes that nearly cancel would blow up the noise, and what is left of the digits.
        if integral.is_nan() || integral <= 0.01 * modulus {
            return None;
        }
        let mut sum = 0.0;
        let cumulative = values.iter().map(|v| {
            sum += step * v.abs() / modulus;
            sum as f32
        });
        Some(Self {
            radius,
            cumulative: cumulative.collect(),
            values: values.iter().map(|v| (v / integral) as f32).collect(),
            magnitude: (modulus / integral) as f32,
        })
    }

    /// An offset from the pixel's centre with a density in proportion to the modulus, and the
    /// quotient of filter and density: ± the integral of the modulus.
    pub(super) fn sample(&self, u: f32) -> (f32, f32) {
        let i = self.cumulative.partition_point(|&c| c <= u).min(STEPS - 1);
        let below = i.checked_sub(1).map_or(0.0, |i| self.cumulative[i]);
        let inside = (u - below) / (self.cumulative[i] - below);
        let steps = i as f32 + inside.clamp(0.0, 1.0);
        let offset = self.radius * (2.0 * steps / STEPS as f32 - 1.0);
        (offset, self.magnitude.copysign(self.values[i]))
    }

    /// Its value, per pixel, at `offset` pixels from the pixel's centre.
    fn at(&self, offset: f32) -> f32 {
        let step = (offset / self.radius + 1.0) * (0.5 * STEPS as f32);
        if (0.0..STEPS as f32).contains(&step) {
            self.values[step as usize]
        } else {
            0.0
        }
    }

    /// Of a row of `count` pixels one that sees `place`, in proportion to the modulus of the filter
    /// there, and the quotient of filter and probability; `None` if none does.
    pub(super) fn choose(&self, place: f32, count: u32, u: f32) -> Option<(u32, f32)> {
        let first = (place - 0.5 - self.radius).ceil().max(0.0) as u32;
        let end = ((place - 0.5 + self.radius).floor() + 1.0).max(0.0) as u32;
        let pixels = first..end.min(count);
        // The filter is a mean over places seen from a pixel's centre.
        let value = |i: u32| self.at(place - (i as f32 + 0.5));
        let total: f32 = pixels.clone().map(|i| value(i).abs()).sum();
        let mut left = u * total;
        let mut chosen = None;
        for i in pixels {
            let value = value(i);
            if value == 0.0 {
                continue;
            }
            chosen = Some((i, total.copysign(value)));
            left -= value.abs();
            if left < 0.0 {
                break;
            }
        }
        chosen
    }
}
