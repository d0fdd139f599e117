//! Light of lamps that a medium scatters along a segment.

use crate::Segment;
use crate::equiangular::Equiangular;
use glam::Vec3;
use tyndall_core::{
    Coefficients, HostTypes, LightDirect, Medium, MediumId, Ray, Sampler, Spectrum,
};

/// One segment in a medium with one point of a light, for which two ways to sample a distance are
/// weighted against each other: free flight, and equiangular sampling where the light is somewhere.
/// Conditional on that point their weights (the power heuristic; Veach 1997, eq. 9.13) sum to one.
///
/// The points, and with them the lights, are chosen by the host's own direct sampling.
pub struct Line<'h, H: HostTypes> {
    medium: &'h H::Medium,
    id: MediumId,
    ray: Ray,
    /// What the walk carries into the segment.
    carried: H::Spectrum,
    /// Names the light point.
    u: [f32; 4],
    /// `None` for light from infinity, which free flight finds alone.
    equiangular: Option<Equiangular>,
}

/// Where a flight along the line collided.
#[derive(Clone, Copy, Debug)]
pub struct Collided<S> {
    /// Distance along the line.
    pub t: f32,
    /// What arrives there of what is carried into the line, over the density of the flight.
    pub arriving: S,
    /// Coefficients of the medium there.
    pub coefficients: Coefficients<S>,
}

/// A point of the line at which to gather.
#[derive(Clone, Copy, Debug)]
pub struct LinePoint {
    /// Where it is.
    pub position: Vec3,
    /// Unit vector back along the line.
    pub wo: Vec3,
    /// The medium there.
    pub medium: MediumId,
    /// Names the light point to [`LightDirect::sample_direct`].
    pub u: [f32; 4],
}

impl<'h, H: LightDirect> Line<'h, H> {
    /// For a segment in `medium` into which a walk carries `carried`.
    pub fn new(
        host: &H,
        medium: &'h H::Medium,
        segment: &Segment<H>,
        carried: H::Spectrum,
        sampler: &mut impl Sampler,
    ) -> Self {
        let u = sampler.next();
        Self {
            medium,
            id: segment.medium,
            ray: segment.ray,
            carried,
            u,
            equiangular: host
                .pivot(&segment.ray, u)
                .map(|p| Equiangular::new(&segment.ray, p)),
        }
    }

    /// An estimate of ∫ `carried` Tr(t) σs(t) L(t) dt, for `light` L per steradian and unit of σs
    /// (phase function times light that arrives, with visibility), after a flight along the line.
    ///
    /// Two points are there to gather at, each at the cost of a connection: the equiangular one
    /// and the collision. Where both are, one is chosen by what it promises: the noise that this
    /// adds is cheaper than a second connection.
    pub fn gather<T: Sampler>(
        &self,
        collided: Option<Collided<H::Spectrum>>,
        sampler: &mut T,
        light: impl Fn(LinePoint, &mut T) -> H::Spectrum,
    ) -> H::Spectrum {
        let t = (self.equiangular.as_ref()).map(|e| e.sample(sampler.next_1d()));
        match (t, collided) {
            (None, None) => H::Spectrum::default(),
            (Some(t), None) => self.along(t, sampler, light),
            (None, Some(collided)) => self.at_collision(&collided, sampler, light),
            (Some(t), Some(collided)) => {
                let pmf = self.preference(t, collided.t);
                if sampler.next_1d() < pmf {
                    self.along(t, sampler, light) / pmf
                } else {
                    self.at_collision(&collided, sampler, light) / (1.0 - pmf)
                }
            }
        }
    }

    fn point(&self, t: f32) -> LinePoint {
        LinePoint {
            position: self.ray.at(t),
            wo: -self.ray.direction,
            medium: self.id,
            u: self.u,
        }
    }

    /// Light scattered at the equiangular distance `t`.
    fn along<T: Sampler>(
        &self,
        t: f32,
        sampler: &mut T,
        light: impl Fn(LinePoint, &mut T) -> H::Spectrum,
    ) -> H::Spectrum {
        let point = self.point(t);
        let sigma_s = self.medium.coefficients(point.position).sigma_s;
        let (free_flight, pdf_t) = self.pdfs_t(t);
        if sigma_s.is_black() || pdf_t <= 0.0 {
            return H::Spectrum::default();
        }
        let light = light(point, sampler);
        if light.is_black() {
            return light;
        }
        let arriving = self.medium.transmittance(&self.ray.up_to(t), sampler);
        let weight = power_heuristic(pdf_t, free_flight) / pdf_t;
        self.carried * light * sigma_s * arriving * weight
    }

    /// Light scattered where the flight collided.
    fn at_collision<T: Sampler>(
        &self,
        collided: &Collided<H::Spectrum>,
        sampler: &mut T,
        light: impl Fn(LinePoint, &mut T) -> H::Spectrum,
    ) -> H::Spectrum {
        let (free_flight, equiangular) = self.pdfs_t(collided.t);
        let weight = power_heuristic(free_flight, equiangular);
        if weight == 0.0 {
            return H::Spectrum::default();
        }
        let light = light(self.point(collided.t), sampler);
        collided.arriving * collided.coefficients.albedo() * light * weight
    }

    /// The probability with which to gather at the equiangular distance `t` rather than at the
    /// collision: by the contributions to be expected, if σs·Tr is as the density of free flight
    /// and 1/d² as the other. Phase function and shadows are not known yet, which the limits allow
    /// for.
    fn preference(&self, t: f32, collision: f32) -> f32 {
        let [(free_flight, pdf_t), (flown, other)] = [t, collision].map(|t| self.pdfs_t(t));
        let here = power_heuristic(pdf_t, free_flight) * free_flight;
        let there = power_heuristic(flown, other) * other;
        let share = here / (here + there);
        if share.is_finite() {
            share.clamp(0.1, 0.9)
        } else {
            0.5
        }
    }

    /// Densities at distance `t` of free flight and of equiangular sampling.
    fn pdfs_t(&self, t: f32) -> (f32, f32) {
        match &self.equiangular {
            None => (1.0, 0.0),
            Some(e) => (
                self.medium.pdf_free_flight(&self.ray, t, self.carried),
                e.pdf_t(t),
            ),
        }
    }
}

/// p²/(p² + q²), the power heuristic with exponent 2 (Veach 1997, eq. 9.13): the weight of a sample
/// of density `p` that another technique finds with density `q`. 0 for p = 0.
///
/// ```
/// assert_eq!(tyndall_walk::power_heuristic(2.0, 1.0), 0.8);
/// ```
pub fn power_heuristic(p: f32, q: f32) -> f32 {
    if p == 0.0 {
        return 0.0;
    }
    let ratio = q / p;
    1.0 / (1.0 + ratio * ratio)
}
