//! How much light facets send on at their first bounce, tabulated by quadrature.
//!
//! The rest bounces between facets. Kulla & Conty (2017), "Revisiting Physically Based Shading at
//! Imageworks", give it back as a lobe (1 − E(μo))(1 − E(μi))/(π(1 − Ē)), where E(μ) is the share
//! of light arriving at cosine μ that leaves at once, and Ē = 2∫E(μ)μdμ. What the lobe sends is
//! 1 − E(μo) exactly, and the same both ways.
//!
//! Tables are linear in √μ and √α, and for dielectrics in (η − 1)/(η + 1); means are those of the
//! interpolated table, so that the error of a furnace is that of the table.

use super::fresnel::{fresnel_dielectric, refracted_cosine};
use super::ggx;
use glam::Vec3;
use std::sync::{LazyLock, OnceLock};
use tyndall_core::Spectrum;

const COSINES: usize = 32;
const ALPHAS: usize = 16;
const INDICES: usize = 15;
/// (η − 1)/(η + 1) at the last index.
const LAST_INDEX: f32 = 0.98;
/// Points of the quadrature along both random numbers of a facet.
const POINTS: [usize; 2] = [32, 16];
const MIN_ALPHA: f32 = 1e-3;

/// Shares of reflection and transmission.
type Shares = [f32; 2];

/// For one index: rows of equal α.
struct Table {
    rows: Vec<[Shares; COSINES]>,
    means: Vec<Shares>,
}

/// Facets that reflect all.
static MIRRORS: LazyLock<Table> = LazyLock::new(|| Table::new(None));
/// Facets of dielectrics, seen from the thinner and from the denser side; made when first needed.
static DIELECTRICS: [[OnceLock<Table>; INDICES]; 2] =
    [const { [const { OnceLock::new() }; INDICES] }; 2];

/// Shares at one roughness and index.
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
        let (i, weight) = between(t.abs() / LAST_INDEX, INDICES);
        let table = |i: usize| {
            DIELECTRICS[side][i].get_or_init(|| {
                let t = LAST_INDEX * i as f32 / (INDICES - 1) as f32;
                let eta = (1.0 + t) / (1.0 - t);
                Table::new(Some(if side == 0 { eta } else { 1.0 / eta }))
            })
        };
        Self::new([table(i), table(i + 1)], weight, alpha)
    }

    fn new(tables: [&'static Table; 2], table_weight: f32, alpha: f32) -> Self {
        let (row, row_weight) = between(alpha.sqrt(), ALPHAS);
        Self {
            tables,
            table_weight,
            row,
            row_weight,
        }
    }

    fn interpolate(&self, at: impl Fn(&Table, usize) -> Shares) -> Shares {
        let [first, second] = self.tables.map(|table| {
            mix(
                at(table, self.row),
                at(table, self.row + 1),
                self.row_weight,
            )
        });
        mix(first, second, self.table_weight)
    }

    /// Light that arrives at this cosine.
    pub(super) fn shares(&self, cosine: f32) -> Shares {
        let (i, weight) = between(cosine.sqrt(), COSINES);
        self.interpolate(|table, row| mix(table.rows[row][i], table.rows[row][i + 1], weight))
    }

    /// Light that arrives from everywhere: 2∫E(μ)μdμ.
    pub(super) fn means(&self) -> Shares {
        self.interpolate(|table, row| table.means[row])
    }

    /// The same if the surface were smooth.
    fn smooth_means(&self) -> Shares {
        let [first, second] = self.tables.map(|table| table.means[0]);
        mix(first, second, self.table_weight)
    }
}

/// The node before `x` in \[0, 1] and the weight of the next.
fn between(x: f32, nodes: usize) -> (usize, f32) {
    let x = x.clamp(0.0, 1.0) * (nodes - 1) as f32;
    let i = (x as usize).min(nodes - 2);
    (i, x - i as f32)
}

fn mix(a: Shares, b: Shares, t: f32) -> Shares {
    [0, 1].map(|i| a[i] + t * (b[i] - a[i]))
}

impl Table {
    /// Of dielectric facets, or of mirrors.
    fn new(eta: Option<f32>) -> Self {
        let node = |i: usize, nodes: usize| (i as f32 / (nodes - 1) as f32).powi(2);
        let rows = (0..ALPHAS).map(|a| {
            let alpha = node(a, ALPHAS).max(MIN_ALPHA);
            std::array::from_fn(|i| shares(node(i, COSINES).max(1e-6), alpha, eta))
        });
        let rows: Vec<_> = rows.collect();
        Self {
            means: rows.iter().map(mean).collect(),
            rows,
        }
    }
}

/// 2∫E(μ)μdμ = 4∫E s³ds, s = √μ, of a row that is linear in s between its nodes.
fn mean(row: &[Shares; COSINES]) -> Shares {
    let h = 1.0 / (COSINES - 1) as f64;
    [0, 1].map(|share| {
        let pieces = row.windows(2).enumerate().map(|(i, ends)| {
            let [a, b] = [0, 1].map(|e| f64::from(ends[e][share]));
            let [s, t] = [h * i as f64, h * (i + 1) as f64];
            let slope = (b - a) / h;
            let cubic = (t.powi(4) - s.powi(4)) * (a - slope * s);
            cubic + 0.8 * slope * (t.powi(5) - s.powi(5))
        });
        pieces.sum::<f64>() as f32
    })
}

/// The mean over visible normals of G₂/G₁ times the reflectance or transmittance.
fn shares(cosine: f32, alpha: f32, eta: Option<f32>) -> Shares {
    let wo = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let g1 = ggx::g1(wo, alpha);
    let passes = |wi: Vec3| f64::from(ggx::g2(wo, wi, alpha) / g1);
    let [rings, spokes] = POINTS;
    let mut sums = [0.0_f64; 2];
    for i in 0..rings * spokes {
        // Half of the facets: the others are their mirror images.
        let u = [
            ((i / spokes) as f32 + 0.5) / rings as f32,
            ((i % spokes) as f32 + 0.5) / (2 * spokes) as f32 - 0.25,
        ];
        let h = ggx::sample_visible(wo, alpha, u);
        let cos = wo.dot(h).clamp(0.0, 1.0);
        let reflectance = eta.map_or(1.0, |eta| fresnel_dielectric(cos, eta));
        let reflected = 2.0 * cos * h - wo;
        if reflected.z > 0.0 {
            sums[0] += f64::from(reflectance) * passes(reflected);
        }
        if let Some((eta, cos_t)) = eta.and_then(|eta| Some((eta, refracted_cosine(cos, eta)?))) {
            let refracted = (cos / eta - cos_t) * h - wo / eta;
            if refracted.z < 0.0 {
                sums[1] += f64::from(1.0 - reflectance) * passes(refracted);
            }
        }
    }
    sums.map(|sum| (sum / (rings * spokes) as f64) as f32)
}

/// The light of a lobe (1 − E(μo))(1 − E(μi))/(1 − Ē), seen from one `wo`.
#[derive(Clone, Copy)]
pub(super) struct Rest {
    albedo: Albedo,
    /// Which shares E is the sum of.
    counted: Shares,
    /// 1 − E(μo): all that the lobe sends.
    pub(super) sent: f32,
    /// 1 − Ē.
    mean: f32,
}

impl Rest {
    /// What is not reflected by the first facet.
    pub(super) fn unreflected(albedo: Albedo, cosine: f32) -> Self {
        Self::new(albedo, [1.0, 0.0], cosine)
    }

    /// What is neither reflected nor transmitted by the first facet.
    pub(super) fn trapped(albedo: Albedo, cosine: f32) -> Self {
        Self::new(albedo, [1.0, 1.0], cosine)
    }

    fn new(albedo: Albedo, counted: Shares, cosine: f32) -> Self {
        let mean = rest(counted, albedo.means());
        let mut this = Self {
            albedo,
            counted,
            sent: 1.0,
            mean,
        };
        this.sent = this.at(cosine);
        this
    }

    /// 1 − E, or 0 everywhere if its mean is nothing but rounding.
    fn at(&self, cosine: f32) -> f32 {
        if self.mean > 1e-6 {
            rest(self.counted, self.albedo.shares(cosine))
        } else {
            0.0
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
        let [_, transmittance] = thinner.albedo.smooth_means();
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

fn rest(counted: Shares, shares: Shares) -> f32 {
    (1.0 - counted[0] * shares[0] - counted[1] * shares[1]).max(0.0)
}
