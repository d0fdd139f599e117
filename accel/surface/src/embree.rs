//! The backend over Embree 3.

use crate::error::SurfaceError;
use crate::instance::{self, Shared};
use crate::meet::{Line, into_triangle};
use crate::shape::{Mesh, Shape, cross, quad_corners};
use crate::surfaces::Met;
use embree3::{
    BufferUsage, Device, Error, Format, Geometry, GeometryBuilder, GeometryKind, INVALID_ID,
    IntersectContext, RayHit, Scene, SceneFlags,
};
use glam::{DAffine3, DVec2, DVec3, Vec3};
use tyndall_core::Ray;

/// A committed scene; the name of a geometry is the index of its shape. Instances keep the scenes of
/// their meshes alive.
pub(crate) struct Embree(Scene<'static>);

impl Embree {
    pub(crate) fn build(shapes: &[Shape]) -> Result<Self, SurfaceError> {
        build(shapes)
            .map(Self)
            .map_err(|error| SurfaceError::Embree {
                message: error.to_string(),
            })
    }

    /// The nearest hit.
    #[inline]
    pub(crate) fn intersect(&self, shapes: &[Shape], ray: &Ray) -> Option<(f32, Met)> {
        let mut query = RayHit::from_ray(segment(ray));
        // What is no hit is passed by one step of `f32`, then by two, by four: 31 reach the end.
        let mut steps = 1;
        loop {
            self.0
                .intersect(&mut IntersectContext::incoherent(), &mut query);
            if !query.hit.is_valid() {
                return None;
            }
            if let Some(hit) = read(shapes, ray, &query) {
                return Some(hit);
            }
            let beyond = query.ray.tfar.max(0.0).to_bits() + steps;
            query = RayHit::from_ray(embree3::Ray {
                tnear: f32::from_bits(beyond.min(f32::INFINITY.to_bits())),
                ..segment(ray)
            });
            steps *= 2;
        }
    }

    /// Whether any primitive is met.
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        self.0
            .occluded(&mut IntersectContext::incoherent(), &mut segment(ray))
    }
}

/// The hit that Embree reports; `None` if it is far from the ray, as happens for rays along the
/// plane of a primitive.
#[inline]
fn read(shapes: &[Shape], ray: &Ray, query: &RayHit) -> Option<(f32, Met)> {
    let (met, t) = (&query.hit, query.ray.tfar);
    let [instance] = met.instID;
    let name = if instance == INVALID_ID {
        met.geomID
    } else {
        instance
    };
    let shape = &shapes[name as usize];
    let hit = |uv| Met {
        shape: name,
        primitive: met.primID,
        uv,
    };
    if matches!(shape, Shape::Mesh(_)) && is_precise(ray.direction, t, met.normal().into()) {
        let uv = into_triangle(DVec2::new(met.u.into(), met.v.into()));
        return Some((t, hit(uv.as_vec2())));
    }
    let (t, uv) = shape.meet(met.primID, &Line::from(ray), t.into());
    let (t, hit) = ((t as f32).clamp(0.0, ray.t_max), hit(uv));
    let apart = ray.at(t).distance(shape.position(hit.primitive, hit.uv));
    let rounding = 1e-6 * extent(shape, hit.primitive);
    (apart <= 1e-3 * (t + ray.origin.length()) + rounding).then_some((t, hit))
}

/// A length that no two points of a primitive are much farther apart than.
fn extent(shape: &Shape, primitive: u32) -> f32 {
    let sides = |[p0, p1, p2]: [DVec3; 3]| ((p1 - p0).length() + (p2 - p0).length()) as f32;
    match *shape {
        Shape::Mesh(ref mesh) => sides(mesh.corners(primitive).map(|p| p.as_dvec3())),
        Shape::Instance {
            ref mesh,
            ref to_world,
        } => sides(instance::corners(mesh, to_world, primitive)),
        Shape::Quad { edge_u, edge_v, .. } => edge_u.length() + edge_v.length(),
        Shape::Sphere { radius, .. } | Shape::Disk { radius, .. } => 2.0 * radius,
    }
}

/// Whether Embree's distance is good to about 2e-6. Its error is a few 2⁻²⁴ of the distance and of
/// the triangle's size √|n|, over the cosine. Where it is not, the triangle is worth its two cache
/// misses.
#[inline]
fn is_precise(direction: Vec3, t: f32, normal: Vec3) -> bool {
    let length = normal.length();
    t * direction.dot(normal).abs() > length * (0.1 * t + 0.05 * length.sqrt())
}

fn segment(ray: &Ray) -> embree3::Ray {
    let Ray {
        origin,
        direction,
        t_max,
    } = *ray;
    embree3::Ray::segment(origin.to_array(), direction.to_array(), 0.0, t_max)
}

fn build(shapes: &[Shape]) -> Result<Scene<'static>, Error> {
    let device = Device::new()?;
    let mut scene = device.create_scene()?;
    scene.set_flags(SceneFlags::ROBUST);
    let shared = Shared::of(shapes);
    let meshes = (shared.meshes.iter().map(|mesh| scene_of(&device, mesh)))
        .collect::<Result<Vec<_>, _>>()?;
    for (i, (shape, placed)) in shapes.iter().zip(shared.of_shape).enumerate() {
        let geometry = match placed {
            Some((mesh, to_world)) => Some(place(&device, &meshes[mesh], to_world)?),
            None => geometry(&device, shape)?,
        };
        if let Some(geometry) = geometry {
            scene.attach_geometry_by_id(&geometry, i as u32);
        }
    }
    scene.commit(); // builds on all of Embree's threads
    match device.get_error() {
        Error::NONE => Ok(scene),
        error => Err(error),
    }
}

/// A scene of one mesh in its own coordinates.
fn scene_of(device: &Device, mesh: &Mesh) -> Result<Scene<'static>, Error> {
    let mut scene = device.create_scene()?;
    scene.set_flags(SceneFlags::ROBUST);
    if !mesh.triangles.is_empty() {
        scene.attach_geometry(&triangles(device, mesh, |p| p)?.commit());
    }
    scene.commit();
    Ok(scene)
}

fn place(
    device: &Device,
    mesh: &Scene<'static>,
    to_world: &DAffine3,
) -> Result<Geometry<'static>, Error> {
    let mut geometry = device.create_geometry(GeometryKind::INSTANCE)?;
    geometry.set_instanced_scene(mesh);
    let [x, y, z, w] = to_world.to_cols_array_2d().map(|c| c.map(|v| v as f32));
    let rows = [x.as_slice(), &[0.0], &y, &[0.0], &z, &[0.0], &w, &[1.0]].concat();
    let mut columns = [0.0; 16];
    columns.copy_from_slice(&rows);
    geometry.set_transform(0, &columns);
    Ok(geometry.commit())
}

/// The geometry of a shape; `None` for a mesh without triangles, which Embree refuses.
fn geometry(device: &Device, shape: &Shape) -> Result<Option<Geometry<'static>>, Error> {
    let geometry = match *shape {
        Shape::Mesh(ref mesh) if mesh.triangles.is_empty() => return Ok(None),
        Shape::Mesh(ref mesh) => triangles(device, mesh, |p| p)?,
        Shape::Instance { ref mesh, .. } if mesh.triangles.is_empty() => return Ok(None),
        Shape::Instance {
            ref mesh,
            ref to_world,
        } => triangles(device, mesh, |p| {
            to_world.transform_point3(p.as_dvec3()).as_vec3()
        })?,
        Shape::Sphere { center, radius } => {
            let mut sphere = device.create_geometry(GeometryKind::SPHERE_POINT)?;
            fill(
                &mut sphere,
                BufferUsage::VERTEX,
                Format::FLOAT4,
                [ball(center, radius)],
            )?;
            sphere
        }
        Shape::Quad {
            corner,
            edge_u,
            edge_v,
        } => {
            let mut quad = device.create_geometry(GeometryKind::QUAD)?;
            let corners = quad_corners(corner, edge_u, edge_v).map(|p| p.to_array());
            fill(&mut quad, BufferUsage::VERTEX, Format::FLOAT3, corners)?;
            fill(
                &mut quad,
                BufferUsage::INDEX,
                Format::UINT4,
                [[0_u32, 1, 2, 3]],
            )?;
            quad
        }
        Shape::Disk {
            center,
            normal,
            radius,
        } => {
            let mut disk = device.create_geometry(GeometryKind::ORIENTED_DISC_POINT)?;
            let normal = normal.normalize().to_array();
            fill(
                &mut disk,
                BufferUsage::VERTEX,
                Format::FLOAT4,
                [ball(center, radius)],
            )?;
            fill(&mut disk, BufferUsage::NORMAL, Format::FLOAT3, [normal])?;
            disk
        }
    };
    Ok(Some(geometry.commit()))
}

/// A mesh in which triangles without area are shrunk to a point: Embree never meets a point, but
/// rounding may give a needle an area.
fn triangles(
    device: &Device,
    mesh: &Mesh,
    place: impl Fn(Vec3) -> Vec3,
) -> Result<GeometryBuilder<'static>, Error> {
    let mut geometry = device.create_geometry(GeometryKind::TRIANGLE)?;
    let positions = mesh.positions.iter().map(|&p| place(p).to_array());
    fill(
        &mut geometry,
        BufferUsage::VERTEX,
        Format::FLOAT3,
        positions,
    )?;
    let indices = (0..mesh.triangles.len()).map(|i| {
        let flat = cross(mesh.corners(i as u32)).length_squared() == 0.0;
        let corners = mesh.triangles[i];
        if flat { [corners[0]; 3] } else { corners }
    });
    fill(&mut geometry, BufferUsage::INDEX, Format::UINT3, indices)?;
    Ok(geometry)
}

fn ball(center: Vec3, radius: f32) -> [f32; 4] {
    center.extend(radius).to_array()
}

fn fill<T: embree3::BufferData>(
    geometry: &mut GeometryBuilder<'static>,
    usage: BufferUsage,
    format: Format,
    elements: impl IntoIterator<Item = T, IntoIter: ExactSizeIterator>,
) -> Result<(), Error> {
    let elements = elements.into_iter();
    let mut buffer =
        geometry.set_new_buffer::<T>(usage, 0, format, size_of::<T>(), elements.len())?;
    for (slot, element) in buffer.iter_mut().zip(elements) {
        *slot = element;
    }
    Ok(())
}
