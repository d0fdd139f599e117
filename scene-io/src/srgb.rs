//! The transfer function of sRGB (IEC 61966-2-1).

/// The encoded value, from 0 to 1, of a linear one from 0 to 1:
/// 12.92·x up to 0.0031308, then 1.055·x^(1/2.4) − 0.055.
///
/// ```
/// // Photographers' grey.
/// let encoded = tyndall_scene_io::srgb_encode(0.18);
/// assert!((encoded - 0.4614).abs() < 1e-4);
/// ```
#[must_use]
pub fn srgb_encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// The inverse of [`srgb_encode`].
pub(crate) fn decode(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_curve_undoes_the_other() {
        for i in 0..=255 {
            let encoded = f64::from(i) / 255.0;
            let again = srgb_encode(f64::from(decode(encoded as f32)));
            // Where its pieces meet, the standard's rounded constants are 3e-8 apart.
            assert!((again - encoded).abs() < 1e-6, "{i}: {again}");
        }
    }
}
