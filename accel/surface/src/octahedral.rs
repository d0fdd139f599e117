//! Unit vectors as points of the unit square.

use glam::{DVec3, Vec2, Vec2Swizzles};

/// The point of the unit square of a unit vector: the octahedral map of Meyer et al. (2010), "On
/// Floating-Point Normal Vectors". It keeps a direction to 2⁻²³ in any orientation.
pub(crate) fn encode(n: DVec3) -> Vec2 {
    let n = n / (n.x.abs() + n.y.abs() + n.z.abs());
    let p = if n.z >= 0.0 {
        n.truncate()
    } else {
        (1.0 - n.truncate().yx().abs()) * n.truncate().map(|x| 1_f64.copysign(x))
    };
    (0.5 + 0.5 * p).as_vec2()
}

/// The unit vector of a point of the unit square; the inverse of [`encode`].
pub(crate) fn decode(uv: Vec2) -> DVec3 {
    let p = 2.0 * uv.as_dvec2() - 1.0;
    let z = 1.0 - p.x.abs() - p.y.abs();
    let p = if z >= 0.0 {
        p
    } else {
        (1.0 - p.yx().abs()) * p.map(|x| 1_f64.copysign(x))
    };
    p.extend(z).normalize()
}
