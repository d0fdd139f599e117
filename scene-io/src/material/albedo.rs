//! How much light facets send on at their first bounce, tabulated by quadrature.
//!
//! The rest bounces between facets. Kulla & Conty (2017), "Revisiting Physically Based Shading at
//! Imageworks", give it back as a lobe (1 − E(μo))(1 − E(μi))/(π(1 − Ē)), where E(μ) is the share
//! of light arriving at cosine μ that leaves at once, and Ē = 2∫E(μ)μdμ. What the lobe sends is
//! 1 − E(μo) exactly, and the same both ways.
//!
//! Tables are linear in log α, for dielectrics in √|(η − 1)/(η + 1)|, and in a function of μ. Means
//! are those of the interpolated tables, so that the error of a furnace is that of the tables.

use super::fresnel::{fresnel_dielectric, refracted_cosine};
use super::ggx;
use glam::Vec3;
use std::sync::{LazyLock, OnceLock};
use tyndall_core::Spectrum;

const COSINES: usize = 32;
const ALPHAS: usize = 32;
const INDICES: usize = 20;
/// α of the first row; that of the last is 1.
const MIN_ALPHA: f32 = 1e-3;
/// (η − 1)/(η + 1) at the last index.
const LAST_INDEX: f32 = 0.98;
/// Points of the quadrature over facets, which is Roberts' sequence R₂ (2018), and its steps.
const POINTS: u16 = 512;
const STEPS: [f32; 2] = [0.754_877_7, 0.569_840_3];
/// Points of a mean over cosines.
const MEAN_POINTS: u16 = 1024;

/// Light that arrives at a cosine or, as a mean, from everywhere.
#[derive(Clone, Copy, Default)]
struct Shares {
    /// Reflected by the first facet.
    reflected: f32,
    /// Neither reflected nor transmitted by it.
    trapped: f32,
}

/// Facets of one α.
struct Row {
    alpha: f32,
    /// At equal steps of √μ: reflectance changes with the angle.
    reflected: [f32; COSINES],
    /// At equal steps of √(μ(1 + α)/(μ + α)): shadows depend on the slope over α.
    trapped: [f32; COSINES],
    mean: Shares,
}

/// Facets of one index.
type Table = Vec<Row>;

/// Facets that reflect all.
static MIRRORS: LazyLock<Table> = LazyLock::new(|| table(None));
/// Facets of dielectrics, seen from the thinner and from the denser side; made when first needed.
static DIELECTRICS: [[OnceLock<Table>; INDICES]; 2] =
    [const { [const { OnceLock::new() }; INDICES] }; 2];

/// What facets of one α and index do to light.
#[derive(Clone, Copy)]
pub(super) struct Albedo {
    tables: [&'static Table; 2],
    /// Weight of the second table.
    table_weight: f32,
    row: usize,
    row_weight: f32,
}

impl Albedo {
    /// Facets that reflect all light.
    pub(super) fn mirrors(alpha: f32) -> Self {
        Self::new([&MIRRORS; 2], 0.0, alpha)
    }

    /// Facets between media of relative index `eta`, that behind over that before.
    pub(super) fn dielectric(eta: f32, alpha: f32) -> Self {
        let t = (eta - 1.0) / (eta + 1.0);
        let side = usize::from(t < 0.0);
        let (i, weight) = between((t.abs() / LAST_INDEX).sqrt(), INDICES);
        let of_index = |i: usize| {
            DIELECTRICS[side][i].get_or_init(|| {
                let t = LAST_INDEX * (i as f32 / (INDICES - 1) as f32).powi(2);
                let eta = (1.0 + t) / (1.0 - t);
                table(Some(if side == 0 { eta } else { 1.0 / eta }))
            })
        };
        Self::new([of_index(i), of_index(i + 1)], weight, alpha)
    }

    fn new(tables: [&'static Table; 2], table_weight: f32, alpha: f32) -> Self {
        let decades = alpha.max(MIN_ALPHA).ln() / MIN_ALPHA.ln();
        let (row, row_weight) = between(1.0 - decades, ALPHAS);
        Self {
            tables,
            table_weight,
            row,
            row_weight,
        }
    }

    fn interpolate(&self, at: impl Fn(&Row) -> f32) -> f32 {
        let in_table = |table: &Table| {
            let rows = [&table[self.row], &table[self.row + 1]];
            mix(at(rows[0]), at(rows[1]), self.row_weight)
        };
        let first = in_table(self.tables[0]);
        if self.table_weight == 0.0 {
            return first;
        }
        mix(first, in_table(self.tables[1]), self.table_weight)
    }

    /// The share of light arriving at this cosine that the first facet reflects.
    pub(super) fn reflected(&self, cosine: f32) -> f32 {
        self.interpolate(|row| row.reflected(cosine))
    }

    /// The share that it neither reflects nor transmits.
    pub(super) fn trapped(&self, cosine: f32) -> f32 {
        self.interpolate(|row| row.trapped(cosine))
    }

    /// The share of light from everywhere that a smooth surface transmits.
    pub(super) fn smooth_transmittance(&self) -> f32 {
        let smooth = Self {
            row: 0,
            row_weight: 0.0,
            ..*self
        };
        1.0 - smooth.interpolate(|row| row.mean.reflected)
    }
}

/// The node before `x` in \[0, 1] and the weight of the next.
fn between(x: f32, nodes: usize) -> (usize, f32) {
    let x = x.clamp(0.0, 1.0) * (nodes - 1) as f32;
    let i = (x as usize).min(nodes - 2);
    (i, x - i as f32)
}

fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + t * (b - a)
}

fn look_up(values: &[f32; COSINES], x: f32) -> f32 {
    let (i, weight) = between(x, COSINES);
    mix(values[i], values[i + 1], weight)
}

/// Of dielectric facets, or of mirrors.
fn table(eta: Option<f32>) -> Table {
    let alpha = |i: usize| MIN_ALPHA.powf(1.0 - i as f32 / (ALPHAS - 1) as f32);
    (0..ALPHAS).map(|i| Row::new(alpha(i), eta)).collect()
}

impl Row {
    fn new(alpha: f32, eta: Option<f32>) -> Self {
        let node = |i: usize| (i as f32 / (COSINES - 1) as f32).powi(2);
        let at = |cosine: f32| shares(cosine.clamp(1e-6, 1.0), alpha, eta);
        let mut row = Self {
            alpha,
            reflected: std::array::from_fn(|i| at(node(i)).reflected),
            trapped: std::array::from_fn(|i| {
                let x = node(i);
                at(x * alpha / (1.0 + alpha - x)).trapped
            }),
            mean: Shares::default(),
        };
        row.mean = row.mean();
        row
    }

    fn reflected(&self, cosine: f32) -> f32 {
        look_up(&self.reflected, cosine.sqrt())
    }

    fn trapped(&self, cosine: f32) -> f32 {
        let x = cosine * (1.0 + self.alpha) / (cosine + self.alpha);
        look_up(&self.trapped, x.sqrt())
    }

    /// 2∫(…)μdμ.
    fn mean(&self) -> Shares {
        let step = 1.0 / f32::from(MEAN_POINTS);
        let cosines = (0..MEAN_POINTS).map(|i| (f32::from(i) + 0.5) * step);
        let [mut reflected, mut trapped] = [0.0_f64; 2];
        for cosine in cosines {
            reflected += f64::from(2.0 * cosine * step * self.reflected(cosine));
            trapped += f64::from(2.0 * cosine * step * self.trapped(cosine));
        }
        Shares {
            reflected: reflected as f32,
            trapped: trapped as f32,
        }
    }
}

/// The mean over visible normals of G₂/G₁ times the reflectance, and what remains of 1.
fn shares(cosine: f32, alpha: f32, eta: Option<f32>) -> Shares {
    let wo = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let g1 = ggx::g1(wo, alpha);
    let passes = |wi: Vec3| f64::from(ggx::g2(wo, wi, alpha) / g1);
    let [mut reflected, mut transmitted, mut all] = [0.0_f64; 3];
    for i in 0..POINTS {
        let [x, y] = STEPS.map(|step| (f32::from(i) * step + 0.5).fract());
        // Dense at the rim, where the steepest facets are.
        let inward = 1.0 - x;
        let weight = f64::from(inward);
        all += weight;
        // Half of the facets: the others are their mirror images.
        let turn = 0.5 * y - 0.25;
        let h = ggx::sample_visible(wo, alpha, [1.0 - inward * inward, turn]);
        let cos = wo.dot(h).clamp(0.0, 1.0);
        let reflectance = eta.map_or(1.0, |eta| fresnel_dielectric(cos, eta));
        let mirrored = 2.0 * cos * h - wo;
        if mirrored.z > 0.0 {
            reflected += weight * f64::from(reflectance) * passes(mirrored);
        }
        if let Some((eta, cos_t)) = eta.and_then(|eta| Some((eta, refracted_cosine(cos, eta)?))) {
            let refracted = (cos / eta - cos_t) * h - wo / eta;
            if refracted.z < 0.0 {
                transmitted += weight * f64::from(1.0 - reflectance) * passes(refracted);
            }
        }
    }
    Shares {
        reflected: (reflected / all) as f32,
        trapped: (1.0 - (reflected + transmitted) / all).max(0.0) as f32,
    }
}

/// The light of a lobe (1 − E(μo))(1 − E(μi))/(1 − Ē), seen from one `wo`.
#[derive(Clone, Copy)]
pub(super) struct Rest {
    albedo: Albedo,
    /// Whether E counts what the first facet transmits.
    trapped: bool,
    /// 1 − E(μo): all that the lobe sends.
    pub(super) sent: f32,
    /// 1 − Ē.
    mean: f32,
}

impl Rest {
    /// What is not reflected by the first facet.
    pub(super) fn unreflected(albedo: Albedo, cosine: f32) -> Self {
        let mean = 1.0 - albedo.interpolate(|row| row.mean.reflected);
        Self::new(albedo, false, mean, cosine)
    }

    /// What is neither reflected nor transmitted by the first facet.
    pub(super) fn trapped(albedo: Albedo, cosine: f32) -> Self {
        let mean = albedo.interpolate(|row| row.mean.trapped);
        Self::new(albedo, true, mean, cosine)
    }

    fn new(albedo: Albedo, trapped: bool, mean: f32, cosine: f32) -> Self {
        let rest = Self {
            albedo,
            trapped,
            sent: 0.0,
            mean,
        };
        Self {
            sent: rest.at(cosine),
            ..rest
        }
    }

    /// 1 − E, or 0 everywhere if its mean is nothing but rounding.
    fn at(&self, cosine: f32) -> f32 {
        match self.trapped {
            _ if self.mean < 1e-6 => 0.0,
            true => self.albedo.trapped(cosine),
            false => 1.0 - self.albedo.reflected(cosine),
        }
    }

    /// π times the lobe.
    pub(super) fn lobe(&self, cosine: f32) -> f32 {
        if self.sent > 0.0 {
            self.sent * self.at(cosine) / self.mean
        } else {
            0.0
        }
    }

    /// Kulla & Conty's colour of light that mirrors of this mean reflectance bounce between them:
    /// F̄²Ē/(1 − F̄(1 − Ē)), by Hill (2018), "A multi-faceted exploration".
    pub(super) fn colour<S: Spectrum>(&self, reflectance: S) -> S {
        reflectance.map(|f| f * f * (1.0 - self.mean) / (1.0 - f * self.mean))
    }

    /// What is trapped on this side of facets of relative index `eta` and leaves on the other side,
    /// where `behind` is trapped: the lobe there, and the share of what is trapped that it gets.
    ///
    /// The share is that of transmitted light, less where the two sides trap unequally: both
    /// directions of a path must agree, up to the square of the index.
    pub(super) fn transmitted(&self, behind: Self, eta: f32) -> (Self, f32) {
        let thinner = if eta > 1.0 { self } else { &behind };
        let transmittance = thinner.albedo.smooth_transmittance();
        let scale = if eta > 1.0 { 1.0 } else { eta * eta };
        let coupled = scale * transmittance * self.mean.min(behind.mean);
        let share = if self.mean > 0.0 {
            coupled / self.mean
        } else {
            0.0
        };
        let sent = self.sent;
        (Self { sent, ..behind }, share)
    }
}
