//! What lies along a ray through an exponential density.

/// A density e^(start − slope·t) at distance t, in logarithms: it may be e^(±1e12), H being 1e-6.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    /// Logarithm of the density at the origin of the ray.
    pub(super) start: f64,
    /// How fast it falls, 1/scene unit; negative downwards.
    pub(super) slope: f64,
}

impl Column {
    /// The logarithm of the density; NaN at ∞ on a horizontal ray.
    #[inline]
    pub(super) fn log_density(&self, t: f64) -> f64 {
        self.start - self.slope * t
    }

    /// ∫₀ᵗ density: the density at the denser end, times (1 − e^{−|slope·t|})/|slope|.
    #[inline]
    pub(super) fn mass(&self, t: f64) -> f64 {
        let length = if self.slope == 0.0 {
            t
        } else {
            -(-(self.slope * t).abs()).exp_m1() / self.slope.abs()
        };
        if length == 0.0 || length.is_infinite() {
            return length;
        }
        self.start.max(self.log_density(t)).exp() * length
    }

    /// The distance with this much mass before it; ∞ if there is not so much.
    #[inline]
    pub(super) fn distance(&self, mass: f64) -> f64 {
        let relative = mass.ln() - self.start;
        if self.slope == 0.0 {
            return relative.exp();
        }
        let rate = self.slope.abs();
        let relative = relative + rate.ln();
        if self.slope < 0.0 {
            return log_1p_exp(relative) / rate;
        }
        if relative >= 0.0 {
            return f64::INFINITY;
        }
        -(-relative.exp()).ln_1p() / rate
    }
}

/// ln(1 + eˣ), for any x.
#[inline]
fn log_1p_exp(x: f64) -> f64 {
    if x > 40.0 { x } else { x.exp().ln_1p() }
}
