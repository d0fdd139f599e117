//! Orthonormal frames.

use glam::Vec3;

/// A right-handed orthonormal frame around a unit vector `n`, which is its z axis.
///
/// ```
/// use glam::Vec3;
/// use tyndall_core::Frame;
/// let frame = Frame::around(Vec3::X);
/// assert!((frame.to_world(Vec3::Z) - Vec3::X).length() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    s: Vec3,
    t: Vec3,
    n: Vec3,
}

impl Frame {
    /// The frame of Duff et al. (2017), "Building an Orthonormal Basis, Revisited": continuous
    /// but at `n.z = −0`, exact to the rounding of `f32`.
    #[inline]
    pub fn around(n: Vec3) -> Self {
        let (s, t) = n.any_orthonormal_pair();
        Self { s, t, n }
    }

    /// From coordinates in the frame to the world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }

    /// From the world to coordinates in the frame.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }
}
