//! The backend without a system library: eight-wide compressed trees by `obvhs`, in two levels
//! where meshes are instanced.

mod placed;
mod tree;

use crate::instance::{self, Shared};
use crate::meet::{Line, triangle};
use crate::shape::{Mesh, Shape, cross, quad_corners};
use crate::surfaces::Met;
use glam::Vec3;
use placed::Placed;
use std::sync::Arc;
use tree::{Form, Leaf, Tree};
use tyndall_core::{Aabb, Ray};

/// A tree over primitives and instances, whose meshes have trees of their own.
pub(crate) struct Embedded {
    tree: Tree,
    placed: Vec<Placed>,
}

impl Embedded {
    /// Builds over `shapes`, the boxes around which are `bounds`.
    pub(crate) fn build(shapes: &[Shape], bounds: &[Aabb]) -> Self {
        let shared = Shared::of(shapes);
        let trees: Vec<Arc<Tree>> = (shared.meshes.iter())
            .map(|mesh| Arc::new(tree_of(mesh)))
            .collect();
        let (mut leaves, mut placed) = (Vec::new(), Vec::new());
        for (i, (shape, instance)) in shapes.iter().zip(shared.of_shape).enumerate() {
            let mut add = |primitive, form| {
                leaves.push(Leaf {
                    form,
                    shape: i as u32,
                    primitive,
                });
            };
            match instance {
                None => for_each_form(shape, add),
                Some(_) if bounds[i].is_empty() => {}
                Some((tree, to_world)) => {
                    add(0, Form::Instance(placed.len() as u32));
                    placed.push(Placed::new(trees[tree].clone(), to_world, bounds[i]));
                }
            }
        }
        Self {
            tree: Tree::build(&leaves, &placed),
            placed,
        }
    }

    /// The nearest hit.
    pub(crate) fn intersect(&self, shapes: &[Shape], ray: &Ray) -> Option<(f32, Met)> {
        let met = self.tree.nearest(ray, &self.placed)?;
        let (line, t) = (Line::from(ray), met.t.into());
        let shape = &shapes[met.leaf.shape as usize];
        let (t, uv) = match (shape, met.leaf.form) {
            (Shape::Mesh(_), Form::Triangle(corners)) => {
                triangle(&line, corners.map(|p| p.as_dvec3()), t)
            }
            _ => shape.meet(met.primitive, &line, t),
        };
        let hit = Met {
            shape: met.leaf.shape,
            primitive: met.primitive,
            uv,
        };
        Some(((t as f32).clamp(0.0, ray.t_max), hit))
    }

    /// Whether any primitive is met.
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        self.tree.any(ray, &self.placed)
    }
}

/// The tree of a mesh, in its own coordinates.
fn tree_of(mesh: &Mesh) -> Tree {
    let mut leaves = Vec::new();
    for (primitive, corners) in triangles(mesh) {
        leaves.push(Leaf {
            form: Form::Triangle(corners),
            shape: 0,
            primitive,
        });
    }
    Tree::build(&leaves, &[])
}

/// The triangles of a mesh that have an area.
fn triangles(mesh: &Mesh) -> impl Iterator<Item = (u32, [Vec3; 3])> {
    let all = (0..mesh.triangles.len() as u32).map(|i| (i, mesh.corners(i)));
    all.filter(|&(_, corners)| cross(corners).length_squared() > 0.0)
}

/// Visits the primitives of a shape; a quad is two triangles of one name, an instance is copied.
fn for_each_form(shape: &Shape, mut visit: impl FnMut(u32, Form)) {
    match *shape {
        Shape::Mesh(ref mesh) => {
            for (i, corners) in triangles(mesh) {
                visit(i, Form::Triangle(corners));
            }
        }
        Shape::Instance {
            ref mesh,
            ref to_world,
        } => {
            for (i, _) in triangles(mesh) {
                let corners = instance::corners(mesh, to_world, i);
                visit(i, Form::Triangle(corners.map(|p| p.as_vec3())));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::boxes;
    use glam::{DAffine3, DVec3};

    #[test]
    fn instances_of_one_mesh_share_one_tree() {
        const COUNT: usize = 10_000;
        let mut mesh = Mesh::default();
        for i in 0..1_000 {
            let p = Vec3::splat(i as f32);
            mesh.positions.extend([p, p + Vec3::X, p + Vec3::Y]);
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        let mesh = Arc::new(mesh);
        let shapes: Vec<Shape> = (0..COUNT)
            .map(|i| Shape::Instance {
                mesh: mesh.clone(),
                to_world: DAffine3::from_translation(DVec3::X * i as f64),
            })
            .collect();
        assert_eq!(Shared::of(&shapes).meshes.len(), 1);
        let built = Embedded::build(&shapes, &boxes(&shapes));
        assert_eq!(built.tree.leaf_count(), COUNT);
        assert_eq!(built.placed.len(), COUNT);
        let first = built.placed[0].tree();
        assert_eq!(first.leaf_count(), 1_000);
        assert!(built.placed.iter().all(|p| Arc::ptr_eq(p.tree(), first)));
        // The list of shapes, and the instances within the two of them.
        assert_eq!(Arc::strong_count(&mesh), COUNT + 1);
        assert_eq!(Arc::strong_count(first), COUNT);
    }
}
