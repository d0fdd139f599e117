//! One level of the tree.

use super::placed::Placed;
use crate::bounds;
use crate::meet::{Line, sphere_roots};
use crate::node::BoxRay;
use crate::watertight::Shear;
use glam::{UVec2, Vec3};
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh};
use obvhs::ploc::PlocBuilder;
use obvhs::{Boundable, BvhBuildParams, traverse};
use tyndall_core::{Aabb, Ray};

/// A tree over primitives of all kinds.
pub(super) struct Tree {
    tree: CwBvh,
    /// In the order of the leaves.
    leaves: Vec<Leaf>,
}

/// A primitive and whose it is.
#[derive(Clone, Copy)]
pub(super) struct Leaf {
    pub(super) form: Form,
    pub(super) shape: u32,
    pub(super) primitive: u32,
}

#[derive(Clone, Copy)]
pub(super) enum Form {
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
    /// By its number among those that share their meshes.
    Instance(u32),
}

/// What a ray meets: at which distance, and which primitive of a leaf.
pub(super) struct Met<'a> {
    pub(super) t: f32,
    pub(super) leaf: &'a Leaf,
    pub(super) primitive: u32,
}

impl Tree {
    /// Builds over `leaves`; `placed` are the instances among them.
    pub(super) fn build(leaves: &[Leaf], placed: &[Placed]) -> Self {
        let boxes: Vec<_> = leaves
            .iter()
            .map(|leaf| {
                let Aabb { min, max } = leaf.form.bounds(placed);
                obvhs::aabb::Aabb::new(min.into(), max.into())
            })
            .collect();
        let tree = build_tree(&boxes);
        let leaves = tree
            .primitive_indices
            .iter()
            .map(|&i| leaves[i as usize])
            .collect();
        Self { tree, leaves }
    }

    /// The nearest hit. Of two primitives at the same distance it is that of the smaller name, so
    /// that the answer does not depend on the tree.
    pub(super) fn nearest(&self, ray: &Ray, placed: &[Placed]) -> Option<Met<'_>> {
        let prepared = Prepared::new(ray);
        let mut t_max = ray.t_max;
        let mut nearest: Option<(&Leaf, u32)> = None;
        let mut state = self.tree.new_traversal(prepared.boxes.direction);
        let mut node;
        traverse!(
            self.tree,
            node,
            state,
            prepared.boxes.children(node, t_max, state.oct_inv4),
            {
                let leaf = &self.leaves[state.primitive_id as usize];
                let met = match leaf.form {
                    Form::Instance(i) => placed[i as usize].nearest(&prepared.line, t_max),
                    ref form => prepared.meet(form, t_max).map(|t| (t, leaf.primitive)),
                };
                if let Some((t, primitive)) = met
                    && (t < t_max
                        || nearest
                            .is_none_or(|(other, p)| (leaf.shape, primitive) < (other.shape, p)))
                {
                    t_max = t;
                    nearest = Some((leaf, primitive));
                }
            }
        );
        nearest.map(|(leaf, primitive)| Met {
            t: t_max,
            leaf,
            primitive,
        })
    }

    /// Whether any primitive is met.
    pub(super) fn any(&self, ray: &Ray, placed: &[Placed]) -> bool {
        let prepared = Prepared::new(ray);
        let t_max = ray.t_max;
        let mut state = self.tree.new_traversal(prepared.boxes.direction);
        let mut node;
        traverse!(
            self.tree,
            node,
            state,
            prepared.boxes.children(node, t_max, state.oct_inv4),
            {
                let met = match self.leaves[state.primitive_id as usize].form {
                    Form::Instance(i) => placed[i as usize].any(&prepared.line, t_max),
                    ref form => prepared.meet(form, t_max).is_some(),
                };
                if met {
                    return true;
                }
            }
        );
        false
    }

    #[cfg(test)]
    pub(super) fn leaf_count(&self) -> usize {
        self.leaves.len()
    }
}

impl Form {
    fn bounds(&self, placed: &[Placed]) -> Aabb {
        match *self {
            Self::Triangle(corners) => Aabb::of_points(corners),
            Self::Sphere { center, radius } => bounds::of_sphere(center, radius),
            Self::Disk {
                center,
                normal,
                radius,
            } => bounds::of_disk(center, normal, radius),
            Self::Instance(i) => placed[i as usize].bounds(),
        }
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
            Form::Instance(_) => None,
        }
    }
}

/// What `obvhs` does for its own triangles, without the checks that it adds to debug builds.
fn build_tree(boxes: &[impl Boundable]) -> CwBvh {
    let how = BvhBuildParams::medium_build();
    let mut pairs = PlocBuilder::with_capacity(boxes.len()).build(
        how.ploc_search_distance,
        boxes,
        (0..boxes.len() as u32).collect(),
        how.sort_precision,
        how.search_depth_threshold,
    );
    ReinsertionOptimizer::default().run(&mut pairs, how.reinsertion_batch_ratio, None);
    bvh2_to_cwbvh(&pairs, how.max_prims_per_leaf.clamp(1, 3), true, false)
}
