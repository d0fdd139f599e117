//! HDR-FLIP: the difference that people see.

use super::pair::{Pair, plane};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, flip};
use serde::Serialize;
use std::fmt;
use tyndall_scene_io::{RenderedImage, srgb_encode};

/// Display luminance that the brightest and the median pixel are exposed to.
const EXPOSED: f64 = 0.85;

/// Narkowicz's (2016) fit of ACES, as FLIP has it: y = (0.6²·2.51·x² + 0.6·0.03·x) / (0.6²·2.43·x² + 0.6·0.59·x + 0.14).
const ACES: [f64; 5] = [0.9036, 0.018, 0.8748, 0.354, 0.14];

/// Exposures beyond this are stretched over it.
const MAX_EXPOSURES: usize = 40;

/// HDR-FLIP (Andersson et al. 2021): the largest LDR-FLIP of every pixel over exposures.
///
/// Both images are tone-mapped by ACES at exposures one stop apart, from the one at which the
/// reference's brightest pixel maps to 0.85 to the one at which its median lit pixel does, rounded to
/// 8 bits in sRGB, and compared at 67 pixels a degree. What is not finite is black.
#[derive(Debug, Serialize)]
pub(crate) struct Flip {
    pub(crate) mean: f64,
    pub(crate) max: f64,
    /// First and last exposure in stops, and their number.
    pub(crate) exposures: [f64; 2],
    pub(crate) count: usize,
    pub(crate) pixels_per_degree: f32,
}

pub(crate) fn compare(pair: &Pair<'_>) -> Flip {
    let exposures = exposures(pair.reference);
    let count = ((exposures[1] - exposures[0]).ceil() as usize).clamp(2, MAX_EXPOSURES);
    let step = (exposures[1] - exposures[0]) / (count - 1) as f64;
    let mut worst = vec![0.0_f32; pair.image.radiance[0].len()];
    for i in 0..count {
        let scale = (exposures[0] + step * i as f64).exp2();
        let [image, reference] = [pair.image, pair.reference].map(|i| shown(i, scale));
        let map = flip(reference, image, DEFAULT_PIXELS_PER_DEGREE).to_vec();
        for (worst, error) in worst.iter_mut().zip(map) {
            *worst = worst.max(error);
        }
    }
    let sum: f64 = worst.iter().map(|&e| f64::from(e)).sum();
    Flip {
        mean: sum / worst.len() as f64,
        max: f64::from(worst.into_iter().fold(0.0, f32::max)),
        exposures,
        count,
        pixels_per_degree: DEFAULT_PIXELS_PER_DEGREE,
    }
}

/// The exposures at which the brightest and the median pixel that is lit map to [`EXPOSED`].
fn exposures(reference: &RenderedImage) -> [f64; 2] {
    let weights = [0.2126, 0.7152, 0.0722];
    let luminance = |i: usize| -> f64 {
        let channel = |c: usize| f64::from(plane(&reference.radiance, c)[i]);
        (0..3).map(|c| weights[c] * channel(c)).sum()
    };
    let all = (0..reference.radiance[0].len()).map(luminance);
    let mut lit: Vec<_> = all.filter(|&y| y > 0.0 && y.is_finite()).collect();
    if lit.is_empty() {
        return [0.0, 0.0];
    }
    lit.sort_unstable_by(f64::total_cmp);
    let (brightest, median) = (lit[lit.len() - 1], lit[lit.len() / 2]);
    let x = exposed();
    [(x / brightest).log2(), (x / median).log2()]
}

/// The x that [`ACES`] maps to [`EXPOSED`].
fn exposed() -> f64 {
    let [a, b, c, d, e] = ACES;
    let (a, b, c) = (a - EXPOSED * c, b - EXPOSED * d, -EXPOSED * e);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

fn shown(image: &RenderedImage, scale: f64) -> FlipImageRgb8 {
    let pixels = 0..image.radiance[0].len();
    let bytes: Vec<u8> = pixels
        .flat_map(|i| (0..3).map(move |c| encode(scale * f64::from(plane(&image.radiance, c)[i]))))
        .collect();
    FlipImageRgb8::with_data(image.width, image.height, &bytes)
}

/// [`ACES`], then the curve of sRGB.
fn encode(x: f64) -> u8 {
    let x = if x.is_finite() {
        x.clamp(0.0, 1e6)
    } else {
        0.0
    };
    let [a, b, c, d, e] = ACES;
    let y = ((a * x * x + b * x) / (c * x * x + d * x + e)).clamp(0.0, 1.0);
    (255.0 * srgb_encode(y)).round() as u8
}

impl fmt::Display for Flip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([first, last], count) = (self.exposures, self.count);
        write!(
            f,
            "{:.4}, at most {:.4} (HDR-FLIP, ACES, {count} exposures from {first:+.1} to {last:+.1} stops, {:.0} pixels a degree)",
            self.mean, self.max, self.pixels_per_degree
        )
    }
}
