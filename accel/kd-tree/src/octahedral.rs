//! Directions in four bytes.

use glam::{Vec2, Vec2Swizzles, Vec3};

/// Half the number of steps along an edge of the square.
const STEPS: f32 = i16::MAX as f32;

/// Packs a unit vector by the octahedral map of Meyer et al. (2010), "On Floating-Point Normal
/// Vectors", rounded to 2 × 16 bits.
///
/// Rounding moves a point of the octahedron |x| + |y| + |z| = 1 by at most h(±1, ±1, ∓2), with
/// h = 1/65534; seen from the origin that is largest in the middle of a face, which lies at 1/√3:
/// √6 h √3 = 6.48e-5 rad. The axes are points of the grid and stay exact.
pub(crate) fn pack(direction: Vec3) -> [i16; 2] {
    let n = direction / direction.abs().element_sum();
    let p = if n.z >= 0.0 {
        n.truncate()
    } else {
        fold(n.truncate())
    };
    (STEPS * p).round().to_array().map(|x| x as i16)
}

/// The unit vector of [`pack`].
#[inline]
pub(crate) fn unpack(packed: [i16; 2]) -> Vec3 {
    let p = Vec2::from_array(packed.map(f32::from)) / STEPS;
    let z = 1.0 - p.x.abs() - p.y.abs();
    let p = if z >= 0.0 { p } else { fold(p) };
    p.extend(z).normalize()
}

/// Swaps the inner diamond of the square, which is the upper half, with the four corners.
#[inline]
fn fold(p: Vec2) -> Vec2 {
    (1.0 - p.yx().abs()) * Vec2::ONE.copysign(p)
}
