//! Optical depth along a ray, in a table.

use std::ops::ControlFlow::{self, Break, Continue};
use tyndall_core::{Majorant, Medium, Ray, Spectrum};

/// Optical depth from which on the transmittance counts as 0: e^−87 is about the least normal `f32`.
pub const OPAQUE: f32 = 87.0;
/// Halvings of a piece.
const LEVELS: u32 = 16;
/// Knots of a table.
const KNOTS: usize = 1 << 14;

/// Optical depth up to every distance of a ray, a parabola between knots.
///
/// σt is sampled along the stretches that have any by their majorant, at least four times a mean
/// free path of that; pieces are halved until the parabola through three samples agrees in both
/// halves with Simpson's rule (Press et al. 2007, §4.2), and until σt is almost linear in them.
///
/// # Error
/// For a transmittance off by no more than ε, a piece of depth Δτ on the share s of the ray may be
/// off by ε/2·(Δτ + s), for those that are almost empty need no relative precision, and the depth
/// between two knots by ε/(2 Tr): together |ΔTr| ≤ Tr·(ε/2·(τ + 1) + ε/(2 Tr)) ≤ ε, for
/// (τ + 1)·e^−τ ≤ 1.
/// What is reported is the largest such sum of the estimates, where halving ended. Estimates are
/// differences of two rules, doubled, since at kinks they may agree by chance; and no less than ε/2
/// is ever reported where anything was sampled, since below what was asked for they mean little. What lies
/// between two samples and shows in none of them is not seen.
///
/// Where all channels are beyond a depth of 87 the table ends: no `f32` sees farther.
#[derive(Clone, Debug)]
pub struct DepthTable<S> {
    knots: Vec<Knot<S>>,
    /// For even steps along the ray, the knot from where to look on.
    guide: Vec<u32>,
    /// Steps a unit.
    steps: f32,
    is_grey: bool,
    /// Of the ray.
    length: f64,
    /// Depth of every channel up to the last knot, and the error of that.
    depth: Vec<[f64; 2]>,
    error: f64,
}

/// A distance.
#[derive(Clone, Copy, Debug)]
struct Knot<S> {
    t: f32,
    /// Optical depth.
    depth: S,
    /// σt here, and half of what it grows by per unit up to the next: of the line that has the mean
    /// σt between them.
    sigma_t: S,
    growth: S,
}

/// A piece of the ray with σt at its ends and in the middle.
#[derive(Clone, Copy)]
struct Piece<S> {
    ends: [f64; 2],
    sigma_t: [S; 3],
}

// Not derived: that would ask the same of `S`.
impl<S> Default for DepthTable<S> {
    fn default() -> Self {
        Self {
            knots: Vec::new(),
            guide: Vec::new(),
            steps: 0.0,
            is_grey: true,
            length: 0.0,
            depth: Vec::new(),
            error: 0.0,
        }
    }
}

impl<S: Spectrum> DepthTable<S> {
    /// Measures a ray of finite length for a transmittance within `max_error`, and returns the error
    /// of what it came to: more if knots ran out, or halvings.
    pub fn measure<M: Medium<Spectrum = S>>(
        &mut self,
        medium: &M,
        ray: &Ray,
        max_error: f32,
    ) -> f32 {
        self.knots.clear();
        self.depth.clear();
        self.depth.resize(S::CHANNELS, [0.0; 2]);
        (self.is_grey, self.error) = (true, 0.0);
        self.length = f64::from(ray.t_max);
        medium.majorants(ray, |stretch| self.stretch(medium, ray, stretch, max_error));
        if self.knots.is_empty() {
            self.knot(0.0, S::default(), S::default());
        } else {
            self.error = self.error.max(0.5 * f64::from(max_error));
        }
        self.index();
        self.error as f32
    }

    fn stretch<M: Medium<Spectrum = S>>(
        &mut self,
        medium: &M,
        ray: &Ray,
        Majorant {
            t_min,
            t_max,
            sigma_bar,
        }: Majorant,
        max_error: f32,
    ) -> ControlFlow<()> {
        if sigma_bar <= 0.0 || t_max <= t_min {
            return Continue(());
        }
        let sigma_t = |t: f64| medium.coefficients(ray.at(t as f32)).sigma_t();
        let (mut start, end) = (f64::from(t_min), f64::from(t_max.min(ray.t_max)));
        let mut first = sigma_t(start);
        while start < end {
            let least = f64::from((start as f32).next_up());
            let next = (start + 1.0 / f64::from(sigma_bar)).max(least).min(end);
            let last = sigma_t(next);
            let piece = Piece {
                ends: [start, next],
                sigma_t: [first, sigma_t(0.5 * (start + next)), last],
            };
            self.refine(&sigma_t, piece, f64::from(max_error), LEVELS);
            if self.is_opaque() {
                return Break(());
            }
            if self.knots.len() >= KNOTS {
                // Nothing is known of what comes: the transmittance may be anything up to this.
                let [depth, error] = self.least();
                self.error = self.error.max((error - depth).exp());
                return Break(());
            }
            (start, first) = (next, last);
        }
        Continue(())
    }

    /// The channel of least depth.
    fn least(&self) -> [f64; 2] {
        let least = |a: [f64; 2], b: &[f64; 2]| if b[0] < a[0] { *b } else { a };
        self.depth.iter().fold([f64::INFINITY, 0.0], least)
    }

    fn is_opaque(&self) -> bool {
        self.least()[0] > f64::from(OPAQUE)
    }

    fn refine(
        &mut self,
        sigma_t: &impl Fn(f64) -> S,
        whole: Piece<S>,
        max_error: f64,
        levels: u32,
    ) {
        let Piece {
            ends: [start, end],
            sigma_t: [a, c, e],
        } = whole;
        let middle = 0.5 * (start + end);
        let [b, d] = [0.5 * (start + middle), 0.5 * (middle + end)].map(sigma_t);
        let halves = [
            Piece {
                ends: [start, middle],
                sigma_t: [a, b, c],
            },
            Piece {
                ends: [middle, end],
                sigma_t: [c, d, e],
            },
        ];
        let off = |i| {
            let [before, behind] = whole.halves(i);
            let [first, second] = halves.map(|half| half.depth(i));
            [before - first, behind - second].map(|off| 2.0 * off.abs())
        };
        let share = (end - start) / self.length;
        let fine = self.depth.iter().enumerate().all(|(i, [depth, _])| {
            let [first, second] = halves.map(|half| half.depth(i));
            let bend = halves[0].bend(i).max(halves[1].bend(i));
            off(i).iter().sum::<f64>() <= 0.5 * max_error * (first + second + share)
                && bend * (-depth).exp() <= 0.5 * max_error
        });
        let [from, half, to] = [start, middle, end].map(|t| t as f32);
        let is_shortest = from == half || half == to;
        if fine || is_shortest || levels == 0 || self.knots.len() >= KNOTS {
            for (k, half) in halves.into_iter().enumerate() {
                self.add(half, |i| off(i)[k]);
            }
        } else {
            for half in halves {
                self.refine(sigma_t, half, max_error, levels - 1);
            }
        }
    }
}

impl<S: Spectrum> DepthTable<S> {
    /// Adds a piece whose depth may be off by `error` of each channel.
    fn add(&mut self, piece: Piece<S>, error: impl Fn(usize) -> f64) {
        let [start, end] = piece.ends;
        let rise = piece.sigma_t[2] - piece.sigma_t[0];
        let mean = S::from_channels(|i| (piece.depth(i) / (end - start)) as f32);
        // The end of the piece before, unless there is a gap between.
        self.knots.pop_if(|before| before.t == start as f32);
        self.knot(
            start as f32,
            mean - rise * 0.5,
            rise * (0.5 / (end - start)) as f32,
        );
        for i in 0..S::CHANNELS {
            let [depth, off] = &mut self.depth[i];
            let here = (-*depth).exp();
            *off += error(i);
            // Of depths, and of distances in `f32`.
            let sigma_t = piece.depth(i) / (end - start);
            let rounding = f64::from(f32::EPSILON) * (1.0 + *depth + sigma_t * end);
            self.error = self.error.max(here * (*off + piece.bend(i) + rounding));
            *depth += piece.depth(i);
        }
        self.knot(end as f32, S::default(), S::default());
    }

    fn knot(&mut self, t: f32, sigma_t: S, growth: S) {
        let depth = S::from_channels(|i| self.depth[i][0] as f32);
        self.is_grey &= depth == S::splat(depth.channel(0));
        self.is_grey &= growth == S::splat(growth.channel(0));
        self.knots.push(Knot {
            t,
            depth,
            sigma_t,
            growth,
        });
    }

    /// Makes the guide.
    fn index(&mut self) {
        let count = self.knots.len();
        let end = self.knots[count - 1].t;
        self.steps = (count as f32 / end).min(f32::MAX);
        self.guide.clear();
        let mut knot = 0;
        for step in 0..count {
            while knot + 1 < count && self.step(self.knots[knot + 1].t) < step {
                knot += 1;
            }
            self.guide.push(knot as u32);
        }
    }

    #[inline]
    fn step(&self, t: f32) -> usize {
        ((t * self.steps) as usize).min(self.knots.len() - 1)
    }

    /// The optical depth up to `t`, within the ray that was measured.
    ///
    /// # Panics
    /// None was.
    #[inline]
    pub fn depth(&self, t: f32) -> S {
        let mut index = self.guide[self.step(t)] as usize;
        while self.knots.get(index + 1).is_some_and(|next| next.t <= t) {
            index += 1;
        }
        let knot = &self.knots[index];
        let x = (t - knot.t).max(0.0);
        // Rounding may bend a parabola below 0.
        (knot.depth + (knot.sigma_t + knot.growth * x) * x).map(|depth| depth.max(0.0))
    }

    /// Whether all channels are the same.
    #[inline]
    pub fn is_grey(&self) -> bool {
        S::CHANNELS == 1 || self.is_grey
    }
}

impl<S: Spectrum> Piece<S> {
    fn channels(&self, i: usize) -> [f64; 3] {
        self.sigma_t.map(|s| f64::from(s.channel(i)))
    }

    /// Optical depth by Simpson's rule.
    fn depth(&self, i: usize) -> f64 {
        let [a, b, c] = self.channels(i);
        (self.ends[1] - self.ends[0]) / 6.0 * (a + 4.0 * b + c)
    }

    /// Optical depth of its halves by the parabola through the samples.
    fn halves(&self, i: usize) -> [f64; 2] {
        let [a, b, c] = self.channels(i);
        let share = (self.ends[1] - self.ends[0]) / 24.0;
        [
            share * (5.0 * a + 8.0 * b - c),
            share * (5.0 * c + 8.0 * b - a),
        ]
    }

    /// How far the depth may be from the parabola, doubled: the line of σt has its mean and its rise,
    /// what is left is h·curvature/15, for the integral of 4x(1−x) − 2/3 reaches 0.0642.
    fn bend(&self, i: usize) -> f64 {
        let [a, b, c] = self.channels(i);
        (self.ends[1] - self.ends[0]) * (b - 0.5 * (a + c)).abs() / 7.5
    }
}
