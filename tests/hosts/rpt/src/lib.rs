//! `rpt`, a renderer made by others, borrows Tyndall's integrators.
//!
//! The published crate `rpt` is a path tracer in `f64` over `nalgebra`, with shapes, a microfacet
//! material, lights that no ray can hit, and no media. [`RptHost`] lends it fog: one homogeneous
//! medium around all objects, vacuum inside transparent ones.
//!
//! Its planes turn their normals towards the viewer, so a transparent plane would have no inside;
//! opaque ones, closed shapes and meshes are fine.
//!
//! What `rpt` does not tell, it cannot lend: its materials keep the density of their samples to
//! themselves, so there is no `ShadingPdf` here. Asking for it is an error of the compiler (see
//! `tests/compile_fail`).
//!
//! Its lights only tell how they light a given point. That is enough to start photons: see
//! [`RptHost::sample_emission`](tyndall_core::LightEmission::sample_emission). What shines from
//! infinity, or from an object that rays can hit, starts none;
//! [`RptHost::check_photons`] tells.
#![forbid(unsafe_code)]

mod emission;

use glam::{DVec3, Vec3};
use rand::{SeedableRng, rngs::StdRng};
use rpt::{Camera, HitRecord, Light, Material, Object, Scene, glm};
use tyndall_core::{
    Aabb, Anchor, BsdfSample, DirectSample, EmissionPdf, Geometry, HostTypes, LightDirect,
    LightKind, Media, MediumId, PathFrom, Ray, Rgb, Sensor, SensorRay, Shading, Spectrum, Surface,
    SurfaceKind,
};
use tyndall_media::Homogeneous;

/// The medium around the objects.
const FOG: MediumId = MediumId(1);

/// One of rpt's scenes, seen by one of its cameras, in fog.
pub struct RptHost {
    /// Objects, lights and environment.
    pub scene: Scene,
    /// The view.
    pub camera: Camera,
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// What fills the space between the objects; `None` is rpt as it was.
    pub fog: Option<Homogeneous<Rgb>>,
    /// How far rays start from the surface that they leave: larger than the rounding of `f32` at
    /// the scene's coordinates, smaller than its details.
    pub skin: f64,
}

/// A hit as rpt computes it.
#[derive(Clone, Debug)]
pub struct RptHit {
    object: usize,
    position: glm::DVec3,
    normal: glm::DVec3,
}

impl RptHost {
    fn object(&self, hit: &RptHit) -> &Object {
        &self.scene.objects[hit.object]
    }

    fn material(&self, hit: &RptHit) -> &Material {
        &self.object(hit).material
    }

    fn anchor_position(&self, anchor: &Anchor<RptHit>, towards: Vec3) -> Vec3 {
        match anchor {
            Anchor::Point(p) => *p,
            Anchor::Surface(hit) => {
                let side = f64::from(towards.dot(to_vec3(&hit.normal))).signum();
                to_vec3(&(hit.position + side * self.skin * hit.normal))
            }
            Anchor::Direction(_) => panic!("a direction is nowhere"),
        }
    }
}

impl HostTypes for RptHost {
    type Spectrum = Rgb;
    type Hit = RptHit;
    type Medium = Homogeneous<Rgb>;
}

impl Geometry for RptHost {
    /// rpt knows infinite planes and keeps no bounds.
    fn bounds(&self) -> Aabb {
        Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        }
    }

    fn intersect(&self, ray: &Ray, _: MediumId) -> Option<(f32, RptHit)> {
        let ray64 = rpt::Ray {
            origin: to_glm(ray.origin),
            dir: to_glm(ray.direction),
        };
        let mut record = HitRecord::new();
        record.time = f64::from(ray.t_max);
        let mut nearest = None;
        for (i, object) in self.scene.objects.iter().enumerate() {
            if object.shape.intersect(&ray64, 0.0, &mut record) {
                nearest = Some(i);
            }
        }
        nearest.map(|object| {
            let hit = RptHit {
                object,
                position: ray64.at(record.time),
                normal: record.normal,
            };
            (record.time as f32, hit)
        })
    }

    fn surface(&self, hit: &RptHit) -> Surface {
        Surface {
            position: to_vec3(&hit.position),
            geometric_normal: to_vec3(&hit.normal),
            shading_normal: to_vec3(&hit.normal),
        }
    }

    fn spawn(&self, from: &Anchor<RptHit>, direction: Vec3) -> Ray {
        Ray::new(self.anchor_position(from, direction), direction)
    }

    fn connect(&self, from: &Anchor<RptHit>, to: &Anchor<RptHit>) -> Ray {
        let start = match from {
            Anchor::Surface(hit) => to_vec3(&hit.position),
            _ => self.anchor_position(from, Vec3::ZERO),
        };
        let target = match to {
            Anchor::Direction(direction) => return self.spawn(from, *direction),
            Anchor::Point(p) => *p,
            Anchor::Surface(hit) => self.anchor_position(to, start - to_vec3(&hit.position)),
        };
        let origin = self.anchor_position(from, target - start);
        let length = (target - origin).length();
        Ray::new(origin, (target - origin) / length).up_to(length)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.intersect(ray, FOG).is_some()
    }
}

impl Shading for RptHost {
    fn surface_kind(&self, _: &RptHit) -> SurfaceKind {
        SurfaceKind::Finite
    }

    /// rpt only knows paths from the viewer; light sees the same with both ends exchanged.
    fn bsdf_eval(&self, hit: &RptHit, wo: Vec3, wi: Vec3, from: PathFrom) -> Rgb {
        let (viewer, light) = match from {
            PathFrom::Sensor => (to_glm(wo), to_glm(wi)),
            PathFrom::Light => (to_glm(wi), to_glm(wo)),
        };
        to_rgb(&self.material(hit).bsdf(&hit.normal, &viewer, &light))
    }

    fn bsdf_sample(
        &self,
        hit: &RptHit,
        wo: Vec3,
        u: [f32; 3],
        from: PathFrom,
    ) -> Option<BsdfSample<Rgb>> {
        let material = self.material(hit);
        let (wi, pdf_w) = material.sample_f(&hit.normal, &to_glm(wo), &mut rng(u))?;
        let eta = match wi.dot(&hit.normal) * to_glm(wo).dot(&hit.normal) < 0.0 {
            false => 1.0,
            true if wi.dot(&hit.normal) < 0.0 => material.index,
            true => material.index.recip(),
        };
        let cosine = wi.dot(&hit.normal).abs();
        let wi = to_vec3(&wi);
        let weight = self.bsdf_eval(hit, wo, wi, from) * (cosine / pdf_w) as f32;
        // Its samples may fall below the horizon, where its densities are 0 or NaN.
        (weight.is_finite() && !weight.is_black()).then_some(BsdfSample {
            wi,
            weight,
            pdf_w: pdf_w as f32,
            delta: false,
            eta: eta as f32,
        })
    }

    fn emitted(&self, hit: &RptHit, _: Vec3) -> Rgb {
        let material = self.material(hit);
        to_rgb(&(material.color * material.emittance))
    }

    fn background(&self, direction: Vec3) -> Rgb {
        to_rgb(&self.scene.environment.get_color(&to_glm(direction)))
    }
}

impl Media for RptHost {
    fn medium(&self, id: MediumId) -> Option<&Homogeneous<Rgb>> {
        self.fog.as_ref().filter(|_| id == FOG)
    }

    fn medium_across(&self, hit: &RptHit, direction: Vec3, _: MediumId) -> MediumId {
        if self.material(hit).transparent && to_glm(direction).dot(&hit.normal) < 0.0 {
            MediumId::VACUUM
        } else {
            FOG
        }
    }

    fn has_null_surfaces(&self) -> bool {
        false
    }
}

impl LightDirect for RptHost {
    /// One light of all, with equal probability; none of them can be hit. Ambient lights, which
    /// rpt adds to every surface, are not light that arrives from anywhere and stay dark.
    fn sample_direct(&self, from: Vec3, u: [f32; 4]) -> Option<DirectSample<Rgb, RptHit>> {
        let lights = &self.scene.lights;
        let light = lights.get((u[0] * lights.len() as f32) as usize)?;
        if matches!(light, Light::Ambient(_)) {
            return None;
        }
        let (intensity, wi, distance) =
            light.illuminate(&to_glm(from), &mut rng([u[1], u[2], u[3]]));
        let wi = to_vec3(&wi);
        let target = match light {
            Light::Directional(..) => Anchor::Direction(wi),
            _ => Anchor::Point(from + distance as f32 * wi),
        };
        Some(DirectSample {
            target,
            wi,
            weight: to_rgb(&intensity) * lights.len() as f32,
            pdf_w: 0.0,
            emission: EmissionPdf::default(),
            cos_theta: 1.0,
            kind: match light {
                Light::Directional(..) => LightKind::Parallel,
                _ => LightKind::Point,
            },
        })
    }

    fn pivot(&self, _: &Ray, u: [f32; 4]) -> Option<Vec3> {
        let lights = &self.scene.lights;
        match lights.get((u[0] * lights.len() as f32) as usize)? {
            Light::Point(_, position) => Some(to_vec3(position)),
            Light::Object(object) => {
                let (p, ..) = object
                    .shape
                    .sample(&glm::zero(), &mut rng([u[1], u[2], u[3]]));
                Some(to_vec3(&p))
            }
            Light::Ambient(_) | Light::Directional(..) => None,
        }
    }
}

impl Sensor for RptHost {
    fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    fn sensor_ray(&self, px: [u32; 2], u: [f32; 4]) -> SensorRay<Rgb> {
        let [width, height] = self.resolution.map(f64::from);
        let half = 0.5 * width.max(height);
        let x = (f64::from(px[0]) + f64::from(u[0]) - 0.5 * width) / half;
        let y = (0.5 * height - f64::from(px[1]) - f64::from(u[1])) / half;
        let ray = self.camera.cast_ray(x, y, &mut rng([u[2], u[3], 0.0]));
        SensorRay::new(Ray::new(to_vec3(&ray.origin), to_vec3(&ray.dir)), FOG)
    }
}

/// rpt draws from a generator where Tyndall hands out numbers: the numbers seed the generator.
fn rng(u: [f32; 3]) -> StdRng {
    let mut seed = [0; 32];
    for (bytes, u) in seed.chunks_exact_mut(4).zip(u) {
        bytes.copy_from_slice(&u.to_le_bytes());
    }
    StdRng::from_seed(seed)
}

fn to_glm(v: Vec3) -> glm::DVec3 {
    let v = v.as_dvec3();
    glm::vec3(v.x, v.y, v.z)
}

fn to_vec3(v: &glm::DVec3) -> Vec3 {
    DVec3::new(v.x, v.y, v.z).as_vec3()
}

fn to_rgb(c: &rpt::Color) -> Rgb {
    Rgb(to_vec3(c))
}
