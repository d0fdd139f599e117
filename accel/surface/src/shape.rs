//! What a scene's geometry is made of.

use crate::instance;
use crate::octahedral;
use glam::{DAffine3, DVec2, DVec3, Vec2, Vec3};
use std::sync::Arc;

/// A shape; its place in the list given to [`Surfaces::build`](crate::Surfaces::build) is its name.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles.
    Mesh(Mesh),
    /// Triangles placed elsewhere. Instances of one `Arc` share what is built over their mesh, so
    /// that ten thousand take little more memory than one.
    ///
    /// The outside of a closed mesh stays outside under any transformation: its geometric normal is
    /// |det M|·M⁻ᵀ·((p1−p0) × (p2−p0)), so that under a reflection it is on the side from which the
    /// triangle now runs clockwise (the rule of glTF 2.0, §3.7.4). An instance whose axes are
    /// sheared almost into one plane is copied, since rays would lose digits in its space.
    Instance {
        /// The mesh.
        mesh: Arc<Mesh>,
        /// From its coordinates to those of the scene. Any rotation, scale, shear and reflection
        /// that has an inverse.
        to_world: DAffine3,
    },
    /// A true sphere. Its geometric normal points outwards.
    Sphere {
        /// Centre.
        center: Vec3,
        /// Radius, positive.
        radius: f32,
    },
    /// The parallelogram `corner + u·edge_u + v·edge_v`, u and v in \[0, 1\]. Its geometric normal
    /// is along `edge_u × edge_v`.
    Quad {
        /// Where u = v = 0.
        corner: Vec3,
        /// From the corner along u.
        edge_u: Vec3,
        /// From the corner along v.
        edge_v: Vec3,
    },
    /// A flat disc.
    Disk {
        /// Centre.
        center: Vec3,
        /// Geometric normal, of any length but zero.
        normal: Vec3,
        /// Radius, positive.
        radius: f32,
    },
}

/// A triangle mesh. The geometric normal of a triangle (p0, p1, p2) is along (p1−p0) × (p2−p0).
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Shading normals, one a vertex and of any length, or none at all.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one a vertex, or none at all.
    pub uvs: Vec<Vec2>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// How many primitives it has: triangles of a mesh or an instance, one otherwise.
    pub fn primitive_count(&self) -> usize {
        self.mesh().map_or(1, |mesh| mesh.triangles.len())
    }

    /// The mesh, in its own coordinates, that it is or places.
    pub fn mesh(&self) -> Option<&Mesh> {
        match self {
            Self::Mesh(mesh) => Some(mesh),
            Self::Instance { mesh, .. } => Some(mesh),
            _ => None,
        }
    }

    /// Where in space a hit is, to the rounding of `f32`.
    pub(crate) fn position(&self, primitive: u32, uv: Vec2) -> Vec3 {
        let p = uv.as_dvec2();
        let position = match *self {
            Self::Mesh(ref mesh) => on_triangle(mesh.corners(primitive).map(|p| p.as_dvec3()), p),
            Self::Instance {
                ref mesh,
                ref to_world,
            } => on_triangle(instance::corners(mesh, to_world, primitive), p),
            Self::Quad {
                corner,
                edge_u,
                edge_v,
            } => corner.as_dvec3() + p.x * edge_u.as_dvec3() + p.y * edge_v.as_dvec3(),
            Self::Sphere { center, radius } => {
                center.as_dvec3() + f64::from(radius) * octahedral::decode(uv)
            }
            Self::Disk {
                center,
                normal,
                radius,
            } => {
                let [s, t] = disk_axes(normal);
                let q = f64::from(radius) * (2.0 * p - 1.0);
                center.as_dvec3() + q.x * s + q.y * t
            }
        };
        position.as_vec3()
    }

    /// The unit normal of the true geometry; zero for a triangle without area.
    pub(crate) fn normal(&self, primitive: u32, uv: Vec2) -> Vec3 {
        let normal = match *self {
            Self::Mesh(ref mesh) => cross(mesh.corners(primitive)),
            Self::Instance {
                ref mesh,
                ref to_world,
            } => instance::of_normals(to_world) * cross(mesh.corners(primitive)),
            Self::Sphere { .. } => octahedral::decode(uv),
            Self::Quad { edge_u, edge_v, .. } => cross([Vec3::ZERO, edge_u, edge_v]),
            Self::Disk { normal, .. } => normal.as_dvec3(),
        };
        normal.normalize_or_zero().as_vec3()
    }
}

impl Mesh {
    /// The vertices of a triangle.
    pub(crate) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// A vertex attribute at barycentric coordinates `uv` of a triangle.
    pub(crate) fn interpolate<T>(&self, attribute: &[T], triangle: u32, uv: Vec2) -> T
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
    {
        let [a, b, c] = self.triangles[triangle as usize].map(|i| attribute[i as usize]);
        a * (1.0 - uv.x - uv.y) + b * uv.x + c * uv.y
    }
}

fn on_triangle([p0, p1, p2]: [DVec3; 3], uv: DVec2) -> DVec3 {
    p0 + uv.x * (p1 - p0) + uv.y * (p2 - p0)
}

/// Corners in the order of the boundary, each rounded once.
pub(crate) fn quad_corners(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> [Vec3; 4] {
    let [p, u, v] = [corner, edge_u, edge_v].map(|x| x.as_dvec3());
    [p, p + u, p + u + v, p + v].map(|x| x.as_vec3())
}

/// (p1−p0) × (p2−p0), zero for what is never met.
pub(crate) fn cross([p0, p1, p2]: [Vec3; 3]) -> DVec3 {
    let p0 = p0.as_dvec3();
    (p1.as_dvec3() - p0).cross(p2.as_dvec3() - p0)
}

/// Axes of the plane of a disc.
pub(crate) fn disk_axes(normal: Vec3) -> [DVec3; 2] {
    normal.as_dvec3().normalize().any_orthonormal_pair().into()
}
