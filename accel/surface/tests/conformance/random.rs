//! Random numbers and directions.

use glam::{Vec2, Vec3};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use tyndall_core::{Ray, warp};

pub(crate) struct Random(Xoshiro256PlusPlus);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// Uniform in [0, 1).
    pub(crate) fn number(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1 << 24) as f32
    }

    pub(crate) fn square(&mut self) -> [f32; 2] {
        [self.number(), self.number()]
    }

    pub(crate) fn index(&mut self, count: usize) -> usize {
        self.0.next_u64() as usize % count
    }

    pub(crate) fn direction(&mut self) -> Vec3 {
        warp::uniform_sphere(self.square()).normalize()
    }

    /// Uniform in the cube [−1, 1]³.
    pub(crate) fn cube(&mut self) -> Vec3 {
        2.0 * Vec2::from(self.square()).extend(self.number()) - 1.0
    }

    /// From a point of the cube of half width `size` around `center`; half of the rays go to
    /// another such point, half anywhere.
    pub(crate) fn ray(&mut self, center: Vec3, size: f32) -> Ray {
        let origin = center + size * self.cube();
        let direction = match self.number() < 0.5 {
            true => self.direction(),
            false => (center + size * self.cube() - origin).normalize(),
        };
        Ray::new(origin, direction)
    }
}
