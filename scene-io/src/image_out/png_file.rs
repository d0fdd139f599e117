//! PNG, tone-mapped to look at.

use super::{RenderOutput, write_whole};
use crate::{Error, srgb_encode};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::path::Path;
use tyndall_core::Spectrum;

/// Writes a picture of 8 bits a channel in sRGB.
///
/// Each channel L becomes 1 − exp(−k·L), which never clips, then the sRGB curve. k is
/// 2^`exposure`; without it, the picture's own: that which shows the 95th percentile of the pixels
/// that are not black as 0.8. What is not finite is shown black.
///
/// # Errors
/// [`Error::Write`]; a file that was there before is untouched then.
pub fn write_png<S: Spectrum>(
    path: &Path,
    output: &RenderOutput<'_, S>,
    exposure: Option<f32>,
) -> Result<(), Error> {
    output.check(path)?;
    let k = exposure.map_or_else(|| own_exposure(output.radiance), f32::exp2);
    let bytes: Vec<u8> = (output.radiance.iter())
        .flat_map(|s| (0..S::CHANNELS).map(|i| encode(k * s.channel(i))))
        .collect();
    let colour = if S::CHANNELS == 1 {
        ExtendedColorType::L8
    } else {
        ExtendedColorType::Rgb8
    };
    write_whole(path, |file| {
        let encoder = PngEncoder::new(file);
        let written = encoder.write_image(&bytes, output.width, output.height, colour);
        written.map_err(|e| e.to_string())
    })
}

fn own_exposure<S: Spectrum>(radiance: &[S]) -> f32 {
    let means = radiance.iter().map(|s| s.mean());
    let mut lit: Vec<_> = means.filter(|&l| l > 0.0 && l.is_finite()).collect();
    if lit.is_empty() {
        return 1.0;
    }
    let rank = (lit.len() - 1) * 95 / 100;
    let (_, bright, _) = lit.select_nth_unstable_by(rank, f32::total_cmp);
    // 1 − exp(−k·bright) = 0.8
    5.0_f32.ln() / *bright
}

/// The curve of sRGB after the exponential one.
fn encode(x: f32) -> u8 {
    let y = if x.is_finite() {
        -(-x.max(0.0)).exp_m1()
    } else {
        0.0
    };
    (255.0 * srgb_encode(y.into())).round() as u8
}
