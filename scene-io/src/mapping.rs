//! Texture coordinates of shapes, and what is derived from them.

use crate::material::{Map, NormalMap};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};
use tyndall_core::Surface;
use tyndall_surface::{Shape, ShapeHit, Surfaces};

/// Texture coordinates of a hit. Those of a sphere are longitude, from −z over −x, z and x, and
/// latitude, from −y to y, both from 0 to 1; else those of [`Surfaces::uv`].
pub(crate) fn uv(surfaces: &Surfaces, hit: &ShapeHit) -> Vec2 {
    match surfaces.shape(hit.shape) {
        Shape::Sphere { .. } => {
            let n = surfaces.surface(hit).geometric_normal;
            let longitude = 0.5 + n.x.atan2(n.z) / TAU;
            Vec2::new(longitude, 0.5 + n.y.clamp(-1.0, 1.0).asin() * FRAC_1_PI)
        }
        _ => surfaces.uv(hit),
    }
}

/// ∂p/∂u and ∂p/∂v of [`uv`]; `None` where they span no area.
fn tangents(surfaces: &Surfaces, hit: &ShapeHit) -> Option<[Vec3; 2]> {
    match surfaces.shape(hit.shape) {
        Shape::Sphere { radius, .. } => {
            let n = surfaces.surface(hit).geometric_normal;
            let across = Vec3::new(n.z, 0.0, -n.x);
            let up = n.cross(across).try_normalize()?;
            Some([TAU * radius * across, PI * radius * up])
        }
        _ => surfaces.tangents(hit),
    }
}

/// The surface with its shading normal bent as a normal map says.
///
/// The map's axes are the directions on the surface of right and up in the image, made
/// perpendicular to the shading normal. Where there are none the surface stays as it is; a normal
/// that would lean behind the surface is brought back to just before it.
pub(crate) fn bend(
    surface: Surface,
    normal_map: &NormalMap,
    surfaces: &Surfaces,
    hit: &ShapeHit,
) -> Surface {
    let bent = axes(&surface, &normal_map.map, surfaces, hit).and_then(|[right, up]| {
        let texel = normal_map.map.lookup(uv(surfaces, hit)).truncate();
        let n = 2.0 * texel - 1.0;
        let across = normal_map.scale * (n.x * right + n.y * up);
        (across + n.z * surface.shading_normal).try_normalize()
    });
    let Some(bent) = bent else { return surface };
    let height = bent.dot(surface.geometric_normal);
    let lift = (MIN_HEIGHT - height).max(0.0);
    Surface {
        shading_normal: (bent + lift * surface.geometric_normal)
            .normalize_or(surface.shading_normal),
        ..surface
    }
}

/// The least cosine between the bent and the geometric normal, about.
const MIN_HEIGHT: f32 = 0.01;

/// Right and up in the image, unit and perpendicular to the shading normal.
fn axes(surface: &Surface, map: &Map, surfaces: &Surfaces, hit: &ShapeHit) -> Option<[Vec3; 2]> {
    let [du, dv] = tangents(surfaces, hit)?;
    let inverse = map.transform.matrix2.inverse();
    let along = |w: Vec2| w.x * du + w.y * dv;
    let (right, down) = (along(inverse.x_axis), along(inverse.y_axis));
    let n = surface.shading_normal;
    let right = right.reject_from_normalized(n).try_normalize()?;
    let up = n.cross(right);
    Some([right, up * -1_f32.copysign(up.dot(down))])
}

/// How many texels of the map's image a primitive covers, `uv` being the coordinates over its unit
/// square: an image that is repeated counts once.
pub(crate) fn covered_texels(map: &Map, uv: impl Fn([f32; 2]) -> Vec2) -> f64 {
    let probes = (0..16).map(|i| [i / 4, i % 4].map(|i| i as f32 / 3.001));
    let at = |u| map.transform.transform_point2(uv(u));
    let empty = [Vec2::INFINITY, Vec2::NEG_INFINITY];
    let [min, max] = probes
        .map(at)
        .fold(empty, |[min, max], p| [min.min(p), max.max(p)]);
    let size = (max - min).min(Vec2::ONE).as_dvec2();
    let [width, height] = map.texture.size().map(f64::from);
    (size.x * width).max(1.0) * (size.y * height).max(1.0)
}

/// A number in \[0, 1) that is as good as random from one point to the next, and the same for the
/// same point (the finaliser of MurmurHash3, Appleby 2011).
pub(crate) fn hash(hit: &ShapeHit) -> f32 {
    let words = [
        hit.shape,
        hit.primitive,
        hit.uv.x.to_bits(),
        hit.uv.y.to_bits(),
    ];
    let mixed = words.into_iter().fold(0x9e37_79b9_u32, |h, word| {
        let h = (h ^ word).wrapping_mul(0x85eb_ca6b);
        let h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
        (h ^ h >> 16).wrapping_add(0x9e37_79b9)
    });
    (mixed >> 8) as f32 / (1 << 24) as f32
}
