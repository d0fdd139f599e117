//! How wide the light is that a path stands for: differentials by rays beside it.

use glam::{DVec3, Vec3};
use tyndall_core::{EmissionSample, Frame, Geometry, LightKind, MediumId, Ray, Spectrum};

/// Photon differentials of a stretch of a light path (Igehy 1999, "Tracing Ray Differentials";
/// Schjøth et al. 2007, "Photon Differentials"): the area across it that its light fills.
///
/// Over how much of a light's area and of its directions a path was chosen, its density tells.
/// Four rays beside the path, two moved over the area and two turned, follow it through specular and
/// null surfaces. Of what fills the light wholly, displaced by aᵢ + v bᵢ at distance v, the area
/// across the unit direction d is the root of the sum of the squares of
///
/// ```text
/// (aᵢ + v bᵢ) × (aⱼ + v bⱼ) · d
/// ```
///
/// over all pairs: 4πv² for a point that shines evenly, the disc for parallel light, and nothing
/// where a lens focuses it. Of n paths each has an n-th.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Of the powers of v in the sum of the squares.
    coefficients: [f64; 5],
}

impl Footprint {
    /// The area at distance `v` from the start of the stretch, in square scene units: of all paths
    /// together, if all were like this one.
    ///
    /// ```
    /// use glam::{DVec3, Vec3};
    /// use tyndall_walk::Footprint;
    /// // Fans out by 0.1 and 0.2 per unit.
    /// let turned = [0.1 * DVec3::X, 0.2 * DVec3::Y].map(|d| [DVec3::ZERO, d]);
    /// let area = Footprint::new(Vec3::Z, turned.into_iter()).area(10.0);
    /// assert!((area - 2.0).abs() < 1e-12);
    /// ```
    pub fn area(&self, v: f64) -> f64 {
        let square = (self.coefficients.iter().rev()).fold(0.0, |sum, c| sum * v + c);
        square.max(0.0).sqrt()
    }

    /// Of displacements at the start and how they grow by unit of distance.
    pub fn new(direction: Vec3, displacements: impl Iterator<Item = [DVec3; 2]> + Clone) -> Self {
        let d = direction.as_dvec3();
        let mut coefficients = [0.0; 5];
        for (i, [a, b]) in displacements.clone().enumerate() {
            for [e, f] in displacements.clone().take(i) {
                let minor = [a.cross(e), a.cross(f) + b.cross(e), b.cross(f)].map(|n| n.dot(d));
                for (i, x) in minor.iter().enumerate() {
                    for (j, y) in minor.iter().enumerate() {
                        coefficients[i + j] += x * y;
                    }
                }
            }
        }
        Self { coefficients }
    }
}

/// Over the extent of a light, by how much rays are moved: far more than places are rounded.
const MOVED: f64 = 1.0 / 16.0;
/// Over the extent of its directions, by how much they are turned: little against what lenses bend.
const TURNED: f64 = 1e-3;

/// The rays beside a path, each with how much it is beside; none where the light has no extent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beside([Option<(Ray, f64)>; 4]);

impl Beside {
    /// Those of a path at its start.
    pub(crate) fn of<S: Spectrum, Hit>(start: &EmissionSample<S, Hit>) -> Self {
        let (pdf, cos_theta) = (start.pdf, f64::from(start.cos_theta));
        let [pdf_a, pdf_w] = [pdf.pdf_a, pdf.pdf_w].map(f64::from);
        // Where one of them is the probability of a choice, the other has it.
        let (area, angle) = match start.kind {
            LightKind::Point => (0.0, 1.0 / (pdf_a * pdf_w)),
            LightKind::Parallel => (1.0 / (pdf_a * pdf_w), 0.0),
            _ => (cos_theta / pdf_a, 1.0 / pdf_w),
        };
        let frame = Frame::around(start.ray.direction);
        let beside = |axis: Vec3, extent: f64, part: f64, moved: bool| {
            let by = frame.to_world(axis) * (part * extent.sqrt()) as f32;
            let Ray {
                origin, direction, ..
            } = start.ray;
            let ray = if moved {
                Ray::new(origin + by, direction)
            } else {
                Ray::new(origin, (direction + by).normalize())
            };
            (extent > 0.0 && by.is_finite()).then_some((ray, part))
        };
        Self([
            beside(Vec3::X, area, MOVED, true),
            beside(Vec3::Y, area, MOVED, true),
            beside(Vec3::X, angle, TURNED, false),
            beside(Vec3::Y, angle, TURNED, false),
        ])
    }

    /// What they tell of the path's own `ray`.
    pub(crate) fn footprint(&self, ray: &Ray) -> Footprint {
        let displacement = |(beside, part): &(Ray, f64)| {
            let moved = beside.origin.as_dvec3() - ray.origin.as_dvec3();
            let turned = beside.direction.as_dvec3() - ray.direction.as_dvec3();
            [moved / *part, turned / *part]
        };
        Footprint::new(ray.direction, self.0.iter().flatten().map(displacement))
    }

    /// Those behind the next surface, where `onward` sends on what arrives at a hit along a
    /// direction; nothing if one of them misses, or is not sent on.
    pub(crate) fn through<H: Geometry>(
        self,
        host: &H,
        medium: MediumId,
        onward: impl Fn(&H::Hit, Vec3) -> Option<Ray>,
    ) -> Option<Self> {
        let mut rays = self.0;
        for (ray, _) in rays.iter_mut().flatten() {
            let (_, hit) = host.intersect(ray, medium)?;
            *ray = onward(&hit, ray.direction)?;
        }
        Some(Self(rays))
    }
}
