//! The backend without a system library: an eight-wide compressed tree by `obvhs`.

use crate::instance;
use crate::meet::{Line, sphere_roots, triangle};
use crate::node::BoxRay;
use crate::shape::{Shape, cross, quad_corners};
use crate::surfaces::ShapeHit;
use crate::watertight::Shear;
use glam::{UVec2, Vec3};
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh};
use obvhs::ploc::PlocBuilder;
use obvhs::{Boundable, BvhBuildParams, traverse};
use tyndall_core::{Aabb, Ray};

/// A tree over primitives of all kinds.
pub(crate) struct Embedded {
    tree: CwBvh,
    /// In the order of the leaves.
    leaves: Vec<Leaf>,
}

/// A primitive and whose it is.
#[derive(Clone, Copy)]
struct Leaf {
    form: Form,
    shape: u32,
    primitive: u32,
}

#[derive(Clone, Copy)]
enum Form {
    Triangle([Vec3; 3]),
    Sphere {
        center: Vec3,
        radius: f32,
    },
    Disk {
        center: Vec3,
        normal: Vec3,
        radius: f32,
    },
}

impl Leaf {
    fn name(&self) -> (u32, u32) {
        (self.shape, self.primitive)
    }
}

impl Embedded {
    pub(crate) fn build(shapes: &[Shape]) -> Self {
        let mut leaves = Vec::new();
        for (i, shape) in shapes.iter().enumerate() {
            for_each_form(shape, |primitive, form| {
                leaves.push(Leaf {
                    form,
                    shape: i as u32,
                    primitive,
                });
            });
        }
        let tree = build_tree(&leaves);
        let leaves = tree
            .primitive_indices
            .iter()
            .map(|&i| leaves[i as usize])
            .collect();
        Self { tree, leaves }
    }

    /// The nearest hit. Of two primitives at the same distance it is that of the smaller name, so
    /// that the answer does not depend on the tree.
    pub(crate) fn intersect(&self, shapes: &[Shape], ray: &Ray) -> Option<(f32, ShapeHit)> {
        let prepared = Prepared::new(ray);
        let mut t_max = ray.t_max;
        let mut nearest: Option<&Leaf> = None;
        let mut state = self.tree.new_traversal(prepared.boxes.direction);
        let mut node;
        traverse!(
            self.tree,
            node,
            state,
            prepared.boxes.children(node, t_max, state.oct_inv4),
            {
                let leaf = &self.leaves[state.primitive_id as usize];
                if let Some(t) = prepared.meet(&leaf.form, t_max)
                    && (t < t_max || nearest.is_none_or(|other| leaf.name() < other.name()))
                {
                    t_max = t;
                    nearest = Some(leaf);
                }
            }
        );
        let leaf = nearest?;
        let shape = &shapes[leaf.shape as usize];
        let (t, uv) = match (shape, leaf.form) {
            (Shape::Mesh(_), Form::Triangle(corners)) => {
                triangle(&prepared.line, corners.map(|p| p.as_dvec3()), t_max.into())
            }
            _ => shape.meet(leaf.primitive, &prepared.line, t_max.into()),
        };
        let hit = ShapeHit {
            shape: leaf.shape,
            primitive: leaf.primitive,
            uv,
        };
        Some(((t as f32).clamp(0.0, ray.t_max), hit))
    }

    /// Whether any primitive is met.
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        let prepared = Prepared::new(ray);
        let mut state = self.tree.new_traversal(prepared.boxes.direction);
        let mut node;
        traverse!(
            self.tree,
            node,
            state,
            prepared.boxes.children(node, ray.t_max, state.oct_inv4),
            {
                let leaf = &self.leaves[state.primitive_id as usize];
                if prepared.meet(&leaf.form, ray.t_max).is_some() {
                    return true;
                }
            }
        );
        false
    }
}

/// A ray in the forms that the tests want.
struct Prepared {
    boxes: BoxRay,
    shear: Shear,
    line: Line,
}

impl Prepared {
    fn new(ray: &Ray) -> Self {
        Self {
            boxes: BoxRay::new(ray),
            shear: Shear::new(ray),
            line: ray.into(),
        }
    }

    /// The distance in (0, `t_max`] at which a primitive is met.
    #[inline]
    fn meet(&self, form: &Form, t_max: f32) -> Option<f32> {
        let within = |t: f64| 0.0 < t && t <= t_max.into();
        match *form {
            Form::Triangle(ref corners) => self.shear.meet(corners, t_max),
            Form::Sphere { center, radius } => {
                let roots = sphere_roots(&self.line, center.as_dvec3(), radius.into())?;
                roots.into_iter().find(|&t| within(t)).map(|t| t as f32)
            }
            Form::Disk {
                center,
                normal,
                radius,
            } => {
                let (center, n) = (center.as_dvec3(), normal.as_dvec3());
                let Line { origin, direction } = self.line;
                let t = (center - origin).dot(n) / direction.dot(n);
                let apart = origin + t * direction - center;
                let met = within(t) && apart.length() <= radius.into();
                met.then_some(t as f32)
            }
        }
    }
}

/// Visits the primitives of a shape; a quad is two triangles of one name. Triangles without area
/// are left out.
fn for_each_form(shape: &Shape, mut visit: impl FnMut(u32, Form)) {
    match *shape {
        Shape::Mesh(ref mesh) => {
            for i in 0..mesh.triangles.len() as u32 {
                let corners = mesh.corners(i);
                if cross(corners).length_squared() > 0.0 {
                    visit(i, Form::Triangle(corners));
                }
            }
        }
        Shape::Instance {
            ref mesh,
            ref to_world,
        } => {
            for i in 0..mesh.triangles.len() as u32 {
                if cross(mesh.corners(i)).length_squared() > 0.0 {
                    let corners = instance::corners(mesh, to_world, i).map(|p| p.as_vec3());
                    visit(i, Form::Triangle(corners));
                }
            }
        }
        Shape::Sphere { center, radius } => visit(0, Form::Sphere { center, radius }),
        Shape::Quad {
            corner,
            edge_u,
            edge_v,
        } => {
            let [a, b, c, d] = quad_corners(corner, edge_u, edge_v);
            visit(0, Form::Triangle([a, b, d]));
            visit(0, Form::Triangle([c, d, b]));
        }
        Shape::Disk {
            center,
            normal,
            radius,
        } => visit(
            0,
            Form::Disk {
                center,
                normal,
                radius,
            },
        ),
    }
}

impl Boundable for Leaf {
    fn aabb(&self) -> obvhs::aabb::Aabb {
        let Aabb { min, max } = match self.form {
            Form::Triangle(corners) => Aabb::of_points(corners),
            Form::Sphere { center, radius } => Shape::Sphere { center, radius }.bounds(),
            Form::Disk {
                center,
                normal,
                radius,
            } => Shape::Disk {
                center,
                normal,
                radius,
            }
            .bounds(),
        };
        obvhs::aabb::Aabb::new(min.into(), max.into())
    }
}

/// What `obvhs` does for its own triangles, without the checks that it adds to debug builds.
fn build_tree(leaves: &[Leaf]) -> CwBvh {
    let how = BvhBuildParams::medium_build();
    let mut pairs = PlocBuilder::with_capacity(leaves.len()).build(
        how.ploc_search_distance,
        leaves,
        (0..leaves.len() as u32).collect(),
        how.sort_precision,
        how.search_depth_threshold,
    );
    ReinsertionOptimizer::default().run(&mut pairs, how.reinsertion_batch_ratio, None);
    bvh2_to_cwbvh(&pairs, how.max_prims_per_leaf.clamp(1, 3), true, false)
}
