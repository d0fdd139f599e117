//! The geometry of a scene.

use crate::bounds;
use crate::embedded::Embedded;
#[cfg(feature = "embree")]
use crate::embree::Embree;
use crate::error::SurfaceError;
use crate::instance;
use crate::meet::Line;
use crate::shape::Shape;
use crate::validate::{check_range, validate};
use glam::{Vec2, Vec3};
use tyndall_core::{Aabb, Ray, Surface};

/// What finds the primitive that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Backend {
    /// `obvhs`: needs no system library.
    #[cfg_attr(not(feature = "embree"), default)]
    Embedded,
    /// Embree 3: the default where the feature `embree` is on.
    #[cfg(feature = "embree")]
    #[default]
    Embree,
}

/// A point on a shape, made by [`Surfaces::intersect`], [`Surfaces::sample`] or [`Surfaces::hit`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShapeHit {
    /// Index of the shape in the list given to [`Surfaces::build`].
    pub shape: u32,
    /// The triangle of a mesh or an instance, 0 for any other shape.
    pub primitive: u32,
    /// Where on the primitive, in the unit square. Triangle: barycentric, the weights of p1 and
    /// p2. Quad: along `edge_u` and `edge_v`. Sphere: the octahedral map of the normal. Disc: its
    /// bounding square, in axes that depend on the normal.
    pub uv: Vec2,
    /// Where in space.
    pub position: Vec3,
    /// Unit normal of the true geometry there; zero for a triangle without area.
    pub geometric_normal: Vec3,
}

/// What a backend finds: the names of [`ShapeHit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Met {
    pub(crate) shape: u32,
    pub(crate) primitive: u32,
    pub(crate) uv: Vec2,
}

/// All shapes of a scene, ready for rays.
pub struct Surfaces {
    shapes: Vec<Shape>,
    bounds: Aabb,
    engine: Engine,
}

enum Engine {
    Embedded(Embedded),
    #[cfg(feature = "embree")]
    Embree(Embree),
}

impl Surfaces {
    /// Builds over `shapes`.
    ///
    /// # Errors
    /// See [`SurfaceError`]; it names the shape and what to do.
    pub fn build(shapes: Vec<Shape>, backend: Backend) -> Result<Self, SurfaceError> {
        validate(&shapes)?;
        let boxes = bounds::boxes(&shapes);
        check_range(&shapes, &boxes)?;
        let engine = match backend {
            Backend::Embedded => Engine::Embedded(Embedded::build(&shapes, &boxes)),
            #[cfg(feature = "embree")]
            Backend::Embree => Engine::Embree(Embree::build(&shapes)?),
        };
        let bounds = boxes.into_iter().fold(Aabb::EMPTY, Aabb::union);
        Ok(Self {
            shapes,
            bounds,
            engine,
        })
    }

    /// What finds the primitives.
    pub(crate) fn backend(&self) -> Backend {
        match self.engine {
            Engine::Embedded(_) => Backend::Embedded,
            #[cfg(feature = "embree")]
            Engine::Embree(_) => Backend::Embree,
        }
    }

    /// A box around all shapes; empty if there are none. An instance counts with the box around the
    /// placed box of its mesh, which may be larger than itself.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The nearest point within the ray, and its distance.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<(f32, ShapeHit)> {
        if self.bounds.is_empty() {
            return None;
        }
        let (t, met) = if self.is_far(ray) {
            let near = self.approach(ray)?;
            let (t, met) = self.intersect_nearby(&near)?;
            let t = (near.at(t).as_dvec3() - ray.origin.as_dvec3()).length();
            let shape = self.shape(met.shape);
            let (t, uv) = shape.meet(met.primitive, &ray.into(), t);
            ((t as f32).min(ray.t_max), Met { uv, ..met })
        } else {
            self.intersect_nearby(ray)?
        };
        Some((t, self.hit(met.shape, met.primitive, met.uv)))
    }

    /// Whether a shape lies within the ray.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        if self.bounds.is_empty() {
            return false;
        }
        let occluded = |ray: &Ray| match &self.engine {
            Engine::Embedded(tree) => tree.occluded(ray),
            #[cfg(feature = "embree")]
            Engine::Embree(scene) => scene.occluded(ray),
        };
        if self.is_far(ray) {
            self.approach(ray).is_some_and(|near| occluded(&near))
        } else {
            occluded(ray)
        }
    }

    #[inline]
    fn intersect_nearby(&self, ray: &Ray) -> Option<(f32, Met)> {
        match &self.engine {
            Engine::Embedded(tree) => tree.intersect(&self.shapes, ray),
            #[cfg(feature = "embree")]
            Engine::Embree(scene) => scene.intersect(&self.shapes, ray),
        }
    }

    /// Whether a ray starts farther from the shapes than twice their size.
    #[inline]
    fn is_far(&self, ray: &Ray) -> bool {
        let away = self.bounds.center() - ray.origin;
        away.length_squared() > 4.0 * self.bounds.size().length_squared()
    }

    /// The same ray started at that distance, so that `f32` still resolves the shapes; `None` if it
    /// ends before.
    #[cold]
    fn approach(&self, ray: &Ray) -> Option<Ray> {
        let Line { origin, direction } = ray.into();
        let away = self.bounds.center().as_dvec3() - origin;
        let skip = away.dot(direction) - 2.0 * self.bounds.size().as_dvec3().length();
        if skip <= 0.0 {
            return Some(*ray);
        }
        let t_max = f64::from(ray.t_max) - skip;
        (t_max > 0.0).then(|| Ray {
            origin: (origin + skip * direction).as_vec3(),
            direction: ray.direction,
            t_max: (t_max as f32).next_up(),
        })
    }

    /// The point of a primitive at coordinates `uv`, see [`ShapeHit::uv`].
    ///
    /// # Panics
    /// If there is no such primitive.
    pub fn hit(&self, shape: u32, primitive: u32, uv: Vec2) -> ShapeHit {
        let of = self.shape(shape);
        ShapeHit {
            shape,
            primitive,
            uv,
            position: of.position(primitive, uv),
            geometric_normal: of.normal(primitive, uv),
        }
    }

    /// Position and normals of a hit. The shading normal is interpolated over a mesh that has
    /// normals, placed as the geometric one is ([`Shape::Instance`]), and turned to its side.
    #[inline]
    pub fn surface(&self, hit: &ShapeHit) -> Surface {
        let ShapeHit {
            position,
            geometric_normal,
            ..
        } = *hit;
        let smooth = match self.shape(hit.shape) {
            Shape::Mesh(mesh) if !mesh.normals.is_empty() => mesh
                .interpolate(&mesh.normals, hit.primitive, hit.uv)
                .normalize_or(geometric_normal),
            Shape::Instance { mesh, to_world } if !mesh.normals.is_empty() => {
                let normal = mesh.interpolate(&mesh.normals, hit.primitive, hit.uv);
                (instance::of_normals(to_world) * normal.as_dvec3())
                    .normalize_or(geometric_normal.as_dvec3())
                    .as_vec3()
            }
            _ => geometric_normal,
        };
        let side = 1_f32.copysign(smooth.dot(geometric_normal));
        Surface {
            position,
            geometric_normal,
            shading_normal: side * smooth,
        }
    }

    /// Texture coordinates of a hit: those of the mesh if it has any, `hit.uv` otherwise.
    pub fn uv(&self, hit: &ShapeHit) -> Vec2 {
        match self.shape(hit.shape).mesh() {
            Some(mesh) if !mesh.uvs.is_empty() => {
                mesh.interpolate(&mesh.uvs, hit.primitive, hit.uv)
            }
            _ => hit.uv,
        }
    }

    /// A shape by its index.
    ///
    /// # Panics
    /// If there is none.
    pub fn shape(&self, shape: u32) -> &Shape {
        &self.shapes[shape as usize]
    }

    /// How many shapes there are.
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// How many primitives a shape has.
    ///
    /// # Panics
    /// If there is no such shape.
    pub fn primitive_count(&self, shape: u32) -> usize {
        self.shape(shape).primitive_count()
    }
}
