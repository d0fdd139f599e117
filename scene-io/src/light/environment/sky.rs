//! An image of all directions, and directions sampled from it.
//!
//! Equirectangular, as OpenEXR and Mitsuba 3 have it: rows run from up (the first) to down, columns
//! around the up axis. Radiance is bilinear between the centres of pixels, around the seam too;
//! above the centres of the first row and below those of the last it is that of the row.
//!
//! **Sampling.** The density over rows and columns is bilinear as well: at the centre of a pixel it
//! is in proportion to the pixel's mean channel times the sine of its polar angle, and it is 0 at
//! the poles. First the row coordinate is drawn from the marginal, then the column from the
//! conditional density; both are linear in pieces and inverted exactly (Pharr et al. 2023, §A.2.5
//! and A.4.2). So the density differs from radiance × sine only where chords differ from the sine.
//!
//! Rows keep their running sums every 16 columns, in `f64`; between them pixels are summed as
//! needed. Memory is that of the image, 12 bytes a pixel, and half a byte a pixel for the sums.

use crate::environment_image::EnvironmentImage;
use glam::{DMat3, DQuat, DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use tyndall_core::Rgb;

/// Columns between kept sums.
const BLOCK: usize = 16;
/// Least distance from a pole, in radians: there the density is a quotient of zeros.
const POLE: f64 = 1e-9;

/// An environment image in its place.
#[derive(Clone, Debug)]
pub(crate) struct Sky {
    image: EnvironmentImage,
    /// From the image's axes: y up, z in the middle of the image, x to its left.
    to_world: DMat3,
    /// Running sums of each row of pixels, one a block.
    sums: Vec<f64>,
    /// Running integrals of the density over the bands, the last being that over the image.
    bands: Vec<f64>,
    fluence: Rgb,
}

/// What lies between the centres of neighbouring rows of pixels, or between those of the first or
/// the last row and the pole.
struct Band {
    /// The rows at its upper and its lower end.
    rows: [usize; 2],
    /// Sines of the polar angle at both ends.
    sines: [f64; 2],
    /// Its upper end, in rows from the centres of the first.
    start: f64,
    /// In rows.
    height: f64,
}

impl Sky {
    /// The image with y turned to the unit vector `up` the shortest way, then all of it about `up`
    /// by `angle` radians, counter-clockwise seen from above.
    pub(crate) fn new(image: EnvironmentImage, up: DVec3, angle: f64) -> Self {
        let upright = DQuat::from_rotation_arc(DVec3::Y, up);
        let mut sky = Self {
            to_world: DMat3::from_quat(DQuat::from_axis_angle(up, angle) * upright),
            sums: Vec::new(),
            bands: Vec::new(),
            fluence: image.fluence(),
            image,
        };
        let height = sky.image.height;
        sky.sums = (0..height).flat_map(|row| sky.block_sums(row)).collect();
        let mut sum = 0.0;
        let bands = (0..=height).map(|i| {
            let band = sky.band(i);
            let [upper, lower] = sky.row_densities(&band);
            sum += band.height * 0.5 * (upper + lower);
            sum
        });
        sky.bands = bands.collect();
        sky
    }

    /// Whether all pixels are grey.
    pub(crate) fn is_grey(&self) -> bool {
        self.image
            .pixels
            .iter()
            .all(|&c| crate::spectrum::is_grey(c))
    }

    /// Integral of the radiance over all directions.
    pub(super) fn fluence(&self) -> Rgb {
        self.fluence
    }

    /// Radiance from the direction `w`.
    pub(crate) fn radiance(&self, w: Vec3) -> Rgb {
        let [x, theta] = self.place(w);
        let (band, t) = self.band_at(theta);
        let (columns, across) = self.columns(x);
        let [upper, lower] = band.rows.map(|row| {
            let [a, b] = columns.map(|column| self.image.pixels[row * self.image.width + column]);
            mix(a, b, across as f32)
        });
        mix(upper, lower, t as f32)
    }

    /// Density per steradian of [`Sky::sample`].
    pub(super) fn pdf_w(&self, w: Vec3) -> f32 {
        let total = self.bands[self.image.height];
        if total <= 0.0 {
            return 0.0;
        }
        let [x, theta] = self.place(w);
        let (band, t) = self.band_at(theta);
        let ([left, right], across) = self.columns(x);
        let ends = Ends::new(&band, t);
        let density = lerp(self.cell(&ends, left), self.cell(&ends, right), across);
        let EnvironmentImage { width, height, .. } = self.image;
        let pixels = width as f64 * height as f64;
        (density / total * pixels / (TAU * PI * theta.sin())) as f32
    }

    /// A direction and its density per steradian; `None` if the image is black, or where rounding
    /// leads out of what is not. `u[2]` adds twelve digits each to `u[0]` and `u[1]`, which by
    /// themselves are too coarse for the dim pixels of a large image.
    pub(super) fn sample(&self, u: [f32; 3]) -> Option<(Vec3, f32)> {
        let [u0, u1] = refined(u);
        let total = self.bands[self.image.height];
        let target = u0 * total;
        let i = self.bands.partition_point(|&sum| sum <= target);
        let band = (i < self.bands.len()).then(|| self.band(i))?;
        let below = i.checked_sub(1).map_or(0.0, |i| self.bands[i]);
        let [upper, lower] = self.row_densities(&band);
        let t = invert(upper, lower, (target - below) / (self.bands[i] - below));
        let x = self.sample_column(&Ends::new(&band, t), u1);
        let w = self.direction(x, band.start + band.height * t);
        // Of the direction as it is rounded: what is asked for later is then the same.
        let pdf_w = self.pdf_w(w);
        (pdf_w > 0.0).then_some((w, pdf_w))
    }

    /// A column, from the centres of the first, with a density in proportion to the mix of rows.
    fn sample_column(&self, ends: &Ends, u: f64) -> f64 {
        let width = self.image.width;
        let blocks = width.div_ceil(BLOCK);
        let sums = ends.rows.map(|row| &self.sums[row * blocks..][..blocks]);
        let sum = |k: usize| ends.weights[0] * sums[0][k] + ends.weights[1] * sums[1][k];
        let target = u * sum(blocks - 1);
        let block = first(blocks - 1, |k| sum(k) > target);
        let mut left = target - block.checked_sub(1).map_or(0.0, sum);
        let cells = block * BLOCK..((block + 1) * BLOCK).min(width);
        let mut x = 0.0;
        for i in cells {
            let [a, b] = [self.cell(ends, i), self.cell(ends, (i + 1) % width)];
            let mass = 0.5 * (a + b);
            if mass <= 0.0 {
                continue;
            }
            x = i as f64 + invert(a, b, (left / mass).min(1.0));
            left -= mass;
            if left < 0.0 {
                break;
            }
        }
        x
    }

    fn mean(&self, row: usize, column: usize) -> f64 {
        let Rgb(c) = self.image.pixels[row * self.image.width + column];
        (f64::from(c.x) + f64::from(c.y) + f64::from(c.z)) / 3.0
    }

    /// The density at a column of pixels between two rows.
    fn cell(&self, ends: &Ends, column: usize) -> f64 {
        ends.weights[0] * self.mean(ends.rows[0], column)
            + ends.weights[1] * self.mean(ends.rows[1], column)
    }

    /// Running integrals over a row, from the centre of its first pixel to the end of each block.
    fn block_sums(&self, row: usize) -> Vec<f64> {
        let width = self.image.width;
        let mut sum = 0.0;
        let ends = (0..width).step_by(BLOCK).map(|start| {
            for i in start..(start + BLOCK).min(width) {
                sum += 0.5 * (self.mean(row, i) + self.mean(row, (i + 1) % width));
            }
            sum
        });
        ends.collect()
    }

    /// The density of rows at both ends of a band.
    fn row_densities(&self, band: &Band) -> [f64; 2] {
        let blocks = self.image.width.div_ceil(BLOCK);
        [0, 1].map(|i| band.sines[i] * self.sums[(band.rows[i] + 1) * blocks - 1])
    }

    /// The band `i` of `height + 1`.
    fn band(&self, i: usize) -> Band {
        let height = self.image.height;
        let rows = [i.saturating_sub(1), i.min(height - 1)];
        let angle = |row: usize| PI * (row as f64 + 0.5) / height as f64;
        Band {
            rows,
            sines: [
                if i == 0 { 0.0 } else { angle(rows[0]).sin() },
                if i == height {
                    0.0
                } else {
                    angle(rows[1]).sin()
                },
            ],
            start: if i == 0 { -0.5 } else { rows[0] as f64 },
            height: if i == 0 || i == height { 0.5 } else { 1.0 },
        }
    }

    /// The band of a polar angle, and how far it is from its upper end to its lower.
    fn band_at(&self, theta: f64) -> (Band, f64) {
        let y = theta * self.image.height as f64 / PI - 0.5;
        let i = if y < 0.0 { 0 } else { y as usize + 1 };
        let band = self.band(i.min(self.image.height));
        let t = ((y - band.start) / band.height).clamp(0.0, 1.0);
        (band, t)
    }

    /// The columns on both sides of `x`, and how far it is from the left one to the right one.
    fn columns(&self, x: f64) -> ([usize; 2], f64) {
        let width = self.image.width;
        let left = x.floor();
        let i = left.rem_euclid(width as f64) as usize % width;
        ([i, (i + 1) % width], x - left)
    }

    /// Column, from the centres of the first, and polar angle.
    fn place(&self, w: Vec3) -> [f64; 2] {
        let w = self.to_world.transpose() * w.as_dvec3();
        let theta = w.x.hypot(w.z).atan2(w.y);
        let turn = w.x.atan2(-w.z).rem_euclid(TAU) / TAU;
        [
            turn * self.image.width as f64 - 0.5,
            theta.clamp(POLE, PI - POLE),
        ]
    }

    /// The direction of a place in columns and rows.
    fn direction(&self, x: f64, y: f64) -> Vec3 {
        let (sin_phi, cos_phi) = (TAU * (x + 0.5) / self.image.width as f64).sin_cos();
        let (sin, cos) = (PI * (y + 0.5) / self.image.height as f64).sin_cos();
        let w = DVec3::new(sin * sin_phi, cos, -sin * cos_phi);
        (self.to_world * w).as_vec3()
    }
}

/// Two rows, and what each counts for in the density between them.
struct Ends {
    rows: [usize; 2],
    weights: [f64; 2],
}

impl Ends {
    fn new(band: &Band, t: f64) -> Self {
        let [upper, lower] = band.sines;
        Self {
            rows: band.rows,
            weights: [(1.0 - t) * upper, t * lower],
        }
    }
}

impl EnvironmentImage {
    /// The integral of its radiance over all directions, by closed forms in every band.
    fn fluence(&self) -> Rgb {
        let angle = |y: f64| PI * (y + 0.5) / self.height as f64;
        let mut sum = DVec3::ZERO;
        for row in 0..self.height {
            let pixels = &self.pixels[row * self.width..][..self.width];
            let mean = pixels.iter().map(|c| c.0.as_dvec3()).sum::<DVec3>() / self.width as f64;
            let middle = angle(row as f64);
            let above = match row {
                0 => 1.0 - middle.cos(),
                _ => rising(angle(row as f64 - 1.0), middle),
            };
            // The sphere from below is the sphere from above.
            let below = match self.height - 1 - row {
                0 => 1.0 + middle.cos(),
                _ => rising(PI - angle(row as f64 + 1.0), PI - middle),
            };
            sum += TAU * (above + below) * mean;
        }
        Rgb(sum.as_vec3())
    }
}

/// ∫ t sin θ dθ from `a` to `b`, where t rises from 0 to 1.
fn rising(a: f64, b: f64) -> f64 {
    (b.sin() - a.sin()) / (b - a) - b.cos()
}

/// Adds twelve digits each of `u[2]` to `u[0]` and `u[1]`, numbers of 24.
fn refined(u: [f32; 3]) -> [f64; 2] {
    let digits = 4096.0 * f64::from(u[2]);
    let fine = [digits.floor() / 4096.0, digits.fract()];
    [0, 1].map(|i| {
        let refined = f64::from(u[i]) + fine[i] / f64::from(1 << 24);
        refined.min(1.0_f64.next_down())
    })
}

/// The least number below `count` that passes the test, which all larger ones do; `count` if none.
fn first(count: usize, passes: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while low < high {
        let middle = low + (high - low) / 2;
        if passes(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// Where in \[0, 1] a density that runs linearly from `a` to `b` has the share `u` below it.
fn invert(a: f64, b: f64, u: f64) -> f64 {
    let root = lerp(a * a, b * b, u).sqrt();
    let t = u * (a + b) / (a + root);
    if t.is_nan() { u } else { t.clamp(0.0, 1.0) }
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + t * (b - a)
}

fn mix(a: Rgb, b: Rgb, t: f32) -> Rgb {
    a * (1.0 - t) + b * t
}
