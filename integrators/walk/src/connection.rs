//! What lies between two given points.

use tyndall_core::SurfaceKind;
use tyndall_core::{Anchor, Geometry, Media, Medium, MediumId, Ray, Sampler, Shading, Spectrum};

/// A straight connection between two anchors: a shadow ray, or the link of a virtual light.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// From one end to just before the other.
    pub ray: Ray,
    /// The medium in which it starts.
    pub medium: MediumId,
}

impl Connection {
    /// Between `from` and `to`, leaving `from` in `medium`.
    pub fn new<H: Geometry>(
        host: &H,
        from: &Anchor<H::Hit>,
        to: &Anchor<H::Hit>,
        medium: MediumId,
    ) -> Self {
        Self {
            ray: host.connect(from, to),
            medium,
        }
    }

    /// An unbiased estimate of the share of light that arrives: zero behind a surface, the product
    /// of the transmittances of all media on the way otherwise. Null surfaces let light pass, and
    /// change the medium.
    pub fn transmittance<H: Geometry + Shading + Media>(
        self,
        host: &H,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        let one = H::Spectrum::splat(1.0);
        if !host.has_null_surfaces() {
            return if host.occluded(&self.ray) {
                H::Spectrum::default()
            } else {
                host.medium(self.medium)
                    .map_or(one, |m| m.transmittance(&self.ray, sampler))
            };
        }
        let Self {
            mut ray,
            mut medium,
        } = self;
        let end = ray.t_max.is_finite().then(|| ray.at(ray.t_max));
        let mut product = one;
        loop {
            let hit = host.intersect(&ray, medium);
            if let Some((_, hit)) = &hit
                && host.surface_kind(hit) != SurfaceKind::Null
            {
                return H::Spectrum::default();
            }
            let reached = hit.as_ref().map_or(ray.t_max, |(t, _)| *t);
            if let Some(m) = host.medium(medium) {
                product *= m.transmittance(&ray.up_to(reached), sampler);
            }
            let Some((_, hit)) = hit else {
                return product;
            };
            if product.is_black() {
                return product;
            }
            medium = host.medium_across(&hit, ray.direction, medium);
            let next = host.spawn(&Anchor::Surface(hit), ray.direction);
            ray = match end {
                None => next,
                // It starts beside the line: aimed at the same end again, it does not reach what lies
                // behind that.
                Some(end) => {
                    let (direction, distance) = (end - next.origin).normalize_and_length();
                    if direction.dot(ray.direction) <= 0.0 {
                        return product;
                    }
                    Ray::new(next.origin, direction).up_to(distance)
                }
            };
        }
    }
}
