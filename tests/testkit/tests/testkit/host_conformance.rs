//! Right hosts pass the conformance checks; each defect is found by the check that is for it.

use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};
use tyndall_core::{
    Aabb, Anchor, BsdfSample, Coefficients, DirectSample, EmissionPdf, EmissionSample, Frame,
    Geometry, HostTypes, LightDirect, LightEmission, LightKind, LightPdf, Media, MediumId,
    PathFrom, Ray, Rgb, Sensor, SensorConnection, SensorImportance, SensorRay, Shading, ShadingPdf,
    Spectrum, Surface, SurfaceKind, warp,
};
use tyndall_media::{Homogeneous, Phase};
use tyndall_testkit::hosts::{
    AnalyticHost, Boundary, BoundaryHit, Exitant, Interface, Laser, Light, View,
};
use tyndall_testkit::{conformance, host_conformance};

fn fog<S: Spectrum>() -> Homogeneous<S> {
    let coefficients = Coefficients {
        sigma_a: S::splat(0.1),
        sigma_s: S::splat(0.7),
        emission: S::default(),
    };
    Homogeneous::new(coefficients, Phase::henyey_greenstein(0.5).unwrap()).unwrap()
}

fn camera() -> View {
    View::Pinhole {
        eye: Vec3::new(0.0, 0.0, -3.0),
        forward: Vec3::Z,
        half_width: 0.5,
        pixels: 20,
    }
}

fn glass_ball(light: Light<f32>) -> AnalyticHost<Homogeneous<f32>> {
    AnalyticHost::sphere(fog(), 1.0, Interface::Dielectric(1.5), light, camera())
}

host_conformance! {
    name: infinite_medium,
    host: AnalyticHost::infinite_medium(fog(), Vec3::X, Rgb::new(1.0, 2.0, 3.0), camera()),
    power: Rgb::new(1.0, 2.0, 3.0),
}
host_conformance! {
    name: slab,
    host: AnalyticHost::slab(fog::<f32>(), 2.0, 30.0, 0.5, Exitant::Reflectance),
    power: PI * 30.0 * 30.0 / 0.5,
}
host_conformance! {
    name: half_space,
    host: AnalyticHost::slab(fog::<f32>(), f32::INFINITY, 30.0, 1.0, Exitant::Radiance(0.3)),
}
host_conformance! {
    name: furnace,
    host: AnalyticHost::furnace(fog::<f32>(), 1.0, Interface::Matched, camera()),
    power: 4.0 * PI * PI * 1.01 * 1.01,
}
host_conformance! {
    name: glass_furnace,
    host: glass_ball(Light::Background { radiance: 2.0, reach: 1.5 }),
    power: 2.0 * 4.0 * PI * PI * 1.5 * 1.5,
}
host_conformance! {
    name: glass_ball_and_point,
    host: glass_ball(Light::Point { position: Vec3::new(0.0, 2.0, 0.0), power: 7.0 }),
    power: 7.0,
}
host_conformance! {
    name: laser,
    host: AnalyticHost::laser(fog::<f32>(), Laser {
        flux: 2.0,
        radius: 0.1,
        cos_theta: 0.3,
        distance: 1.0,
        along: 1.0,
        half_width: 0.2,
        pixels: 8,
    }),
    power: 2.0,
}
host_conformance! {
    name: pinhole,
    host: AnalyticHost::infinite_medium(fog::<f32>(), Vec3::X, 1.0, View::Pinhole {
        eye: Vec3::new(1.0, 20.0, -3.0),
        forward: Vec3::new(0.6, -0.8, 0.0),
        half_width: 1.5,
        pixels: 7,
    }),
    checks: [importance],
}
host_conformance! { name: glowing_ball, host: Ball::new(Fault::None), power: 4.0 * PI * PI * GLOW }

/// A flaw planted in the ball.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// Both densities of directions 2 % too large.
    ScatteringDensity,
    /// Directions uniform, stated as by the cosine.
    ScatteringSamples,
    /// f depends on wo alone.
    NotReciprocal,
    /// Albedo 1.02.
    Amplifies,
    /// Rays start below the surface.
    SpawnsBelow,
    /// Connections end beyond their target.
    ConnectsBeyond,
    /// Both densities of direct light 2 % too large, weights with them.
    DirectDensity,
    /// Direct light 2 % too bright.
    DirectWeight,
    /// Emission 2 % too strong, stated densities right.
    Flux,
    /// Emission and its densities 2 % off, in agreement.
    Power,
    /// `pdf_emission` 2 % off.
    EmissionDensity,
    /// Sensor rays of length 1.01.
    Sensor,
    /// Densities of sensor rays 2 % too large.
    SensorDensity,
    /// Connections to the sensor 2 % too bright.
    Importance,
    /// Connections to the sensor as if the film were a sphere, of the same area.
    ImportanceShape,
    /// Emission of direct light 2 % too dense.
    DirectEmission,
    /// Emitted light claims to come from the opposite side of the ball.
    Source,
    /// None, but a point light takes the place of the glow.
    Lamp,
    /// A point light of which direct light states an emission 2 % too dense.
    LampDensity,
    /// A point light that emits into z > 0 only, stated as into all directions.
    LampHemisphere,
}

/// A diffuse ball of radius 1 and albedo 1/2 that glows: area light and finite surface.
struct Ball {
    space: AnalyticHost<Homogeneous<f32>>,
    fault: Fault,
    bounds: Aabb,
}

const GLOW: f32 = 2.0;
/// Per area of the ball.
const PDF_A: f32 = 0.25 * FRAC_1_PI;

impl Ball {
    fn new(fault: Fault) -> Self {
        let position = Vec3::new(0.0, 2.0, 0.0);
        let space = glass_ball(match fault {
            Fault::Lamp | Fault::LampDensity | Fault::LampHemisphere => Light::Point {
                position,
                power: 7.0,
            },
            _ => Light::None,
        });
        assert!(matches!(space.boundary, Boundary::Sphere { .. }));
        Self {
            bounds: space.bounds(),
            space,
            fault,
        }
    }

    /// The same in a space that claims to be infinite.
    fn unbounded(fault: Fault) -> Self {
        let bounds = Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        };
        Self {
            bounds,
            ..Self::new(fault)
        }
    }

    fn has_lamp(&self) -> bool {
        self.space.light != Light::None
    }

    /// 1.02 if the ball has this fault.
    fn off(&self, fault: Fault) -> f32 {
        if self.fault == fault { 1.02 } else { 1.0 }
    }

    fn pdf_direct(&self, from: Vec3, hit: &BoundaryHit) -> f32 {
        let across = hit.position - from;
        let cosine = -across.normalize().dot(hit.normal);
        if cosine <= 0.0 {
            return 0.0;
        }
        2.0 * PDF_A * across.length_squared() / cosine * self.off(Fault::DirectDensity)
    }

    fn emission_pdf(&self, hit: &BoundaryHit, direction: Vec3) -> EmissionPdf {
        EmissionPdf {
            pdf_a: PDF_A / self.off(Fault::Power) * self.off(Fault::EmissionDensity),
            pdf_w: warp::cosine_hemisphere_pdf_w(direction.dot(hit.normal)),
        }
    }
}

impl HostTypes for Ball {
    type Spectrum = f32;
    type Hit = BoundaryHit;
    type Medium = Homogeneous<f32>;
}

impl Geometry for Ball {
    fn bounds(&self) -> Aabb {
        self.bounds
    }
    fn intersect(&self, ray: &Ray, here: MediumId) -> Option<(f32, BoundaryHit)> {
        self.space.intersect(ray, here)
    }
    fn surface(&self, hit: &BoundaryHit) -> Surface {
        self.space.surface(hit)
    }
    fn spawn(&self, from: &Anchor<BoundaryHit>, direction: Vec3) -> Ray {
        match from {
            Anchor::Surface(hit) if self.fault == Fault::SpawnsBelow => {
                Ray::new(hit.position - 1e-5 * direction, direction)
            }
            _ => self.space.spawn(from, direction),
        }
    }
    fn connect(&self, from: &Anchor<BoundaryHit>, to: &Anchor<BoundaryHit>) -> Ray {
        let ray = self.space.connect(from, to);
        if self.fault == Fault::ConnectsBeyond {
            return ray.up_to(ray.t_max * 1.0001);
        }
        ray
    }
    fn occluded(&self, ray: &Ray) -> bool {
        self.space.occluded(ray)
    }
}

impl Media for Ball {
    fn medium(&self, _: MediumId) -> Option<&Homogeneous<f32>> {
        None
    }
    fn medium_across(&self, _: &BoundaryHit, _: Vec3, here: MediumId) -> MediumId {
        here
    }
    fn has_null_surfaces(&self) -> bool {
        false
    }
}

impl Shading for Ball {
    fn surface_kind(&self, _: &BoundaryHit) -> SurfaceKind {
        SurfaceKind::Finite
    }
    fn bsdf_eval(&self, hit: &BoundaryHit, wo: Vec3, wi: Vec3, _: PathFrom) -> f32 {
        if wo.dot(hit.normal) * wi.dot(hit.normal) <= 0.0 {
            return 0.0;
        }
        match self.fault {
            Fault::NotReciprocal => 0.5 * FRAC_1_PI * wo.dot(hit.normal).abs(),
            Fault::Amplifies => 1.02 * FRAC_1_PI,
            _ => 0.5 * FRAC_1_PI,
        }
    }
    fn bsdf_sample(
        &self,
        hit: &BoundaryHit,
        wo: Vec3,
        u: [f32; 3],
        from: PathFrom,
    ) -> Option<BsdfSample<f32>> {
        let local = match self.fault {
            Fault::ScatteringSamples => warp::uniform_cone(1.0, [u[0], u[1]]),
            _ => warp::cosine_hemisphere([u[0], u[1]]),
        };
        let side = wo.dot(hit.normal).signum();
        let wi = Frame::around(side * hit.normal).to_world(local).normalize();
        let pdf_w = self.bsdf_pdf_w(hit, wo, wi, from);
        let value = self.bsdf_eval(hit, wo, wi, from) * wi.dot(hit.normal).abs();
        (pdf_w > 0.0).then_some(BsdfSample {
            wi,
            weight: value / pdf_w,
            pdf_w,
            delta: false,
            eta: 1.0,
        })
    }
    fn emitted(&self, hit: &BoundaryHit, wo: Vec3) -> f32 {
        if wo.dot(hit.normal) > 0.0 { GLOW } else { 0.0 }
    }
    fn background(&self, _: Vec3) -> f32 {
        0.0
    }
}

impl ShadingPdf for Ball {
    fn bsdf_pdf_w(&self, hit: &BoundaryHit, wo: Vec3, wi: Vec3, _: PathFrom) -> f32 {
        let side = wo.dot(hit.normal).signum();
        warp::cosine_hemisphere_pdf_w(side * wi.dot(hit.normal))
            * self.off(Fault::ScatteringDensity)
    }
}

impl LightDirect for Ball {
    fn sample_direct(&self, from: Vec3, u: [f32; 4]) -> Option<DirectSample<f32, BoundaryHit>> {
        if self.has_lamp() {
            let mut sample = self.space.sample_direct(from, u)?;
            sample.emission.pdf_w *= self.off(Fault::LampDensity);
            return Some(sample);
        }
        // The half that faces the point.
        let local = warp::uniform_cone(1.0, [u[1], u[2]]);
        let normal = Frame::around(from.normalize()).to_world(local).normalize();
        let hit = BoundaryHit {
            position: normal,
            normal,
        };
        let pdf_w = self.pdf_direct(from, &hit);
        let wi = (normal - from).normalize();
        let mut emission = self.emission_pdf(&hit, -wi);
        emission.pdf_a *= self.off(Fault::DirectEmission);
        (pdf_w > 0.0).then_some(DirectSample {
            target: Anchor::Surface(hit),
            wi,
            weight: GLOW / pdf_w * self.off(Fault::DirectWeight),
            pdf_w,
            emission,
            cos_theta: -wi.dot(normal),
            kind: LightKind::Area,
        })
    }
}

impl LightEmission for Ball {
    fn sample_emission(&self, u: [f32; 6]) -> Option<EmissionSample<f32, BoundaryHit>> {
        if self.has_lamp() {
            let mut sample = self.space.sample_emission(u)?;
            if self.fault == Fault::LampHemisphere {
                sample.ray.direction.z = sample.ray.direction.z.abs();
            }
            return Some(sample);
        }
        let normal = warp::uniform_sphere([u[1], u[2]]);
        let local = warp::cosine_hemisphere([u[3], u[4]]);
        let hit = BoundaryHit {
            position: normal,
            normal,
        };
        let direction = Frame::around(normal).to_world(local).normalize();
        let cos_theta = direction.dot(normal);
        let pdf = EmissionPdf {
            pdf_a: PDF_A / self.off(Fault::Power),
            pdf_w: warp::cosine_hemisphere_pdf_w(cos_theta),
        };
        let source = match self.fault {
            Fault::Source => BoundaryHit {
                position: -hit.position,
                normal: -hit.normal,
            },
            _ => hit,
        };
        (cos_theta > 0.0).then(|| EmissionSample {
            source: Anchor::Surface(source),
            ray: self.space.spawn(&Anchor::Surface(hit), direction),
            flux: GLOW * cos_theta / (pdf.pdf_a * pdf.pdf_w) * self.off(Fault::Flux),
            pdf,
            cos_theta,
            kind: LightKind::Area,
            medium: MediumId::VACUUM,
        })
    }
}

impl LightPdf for Ball {
    fn pdf_direct_w(&self, from: Vec3, to: &Anchor<BoundaryHit>) -> f32 {
        match to {
            Anchor::Surface(hit) => self.pdf_direct(from, hit),
            Anchor::Point(_) | Anchor::Direction(_) => 0.0,
        }
    }
    fn pdf_emission(&self, at: &Anchor<BoundaryHit>, direction: Vec3) -> EmissionPdf {
        match at {
            Anchor::Surface(hit) => self.emission_pdf(hit, direction),
            Anchor::Point(_) | Anchor::Direction(_) => EmissionPdf::default(),
        }
    }
}

impl Sensor for Ball {
    fn resolution(&self) -> [u32; 2] {
        self.space.resolution()
    }
    fn sensor_ray(&self, px: [u32; 2], u: [f32; 4]) -> SensorRay<f32> {
        let mut start = self.space.sensor_ray(px, u);
        if self.fault == Fault::Sensor {
            start.ray.direction *= 1.01;
        }
        start.pdf_w *= self.off(Fault::SensorDensity);
        start
    }
}

impl SensorImportance for Ball {
    fn connect_sensor(&self, from: Vec3, u: [f32; 2]) -> Option<SensorConnection<f32>> {
        let mut connection = self.space.connect_sensor(from, u)?;
        connection.weight *= self.off(Fault::Importance);
        if self.fault == Fault::ImportanceShape {
            connection.weight *= 1.22 * (-connection.wi.z).powi(3).abs();
        }
        Some(connection)
    }
}

#[test]
fn every_defect_is_found_by_its_check() {
    type Check = fn(&Ball) -> Result<(), String>;
    let power: Check = |ball| conformance::power(ball, 4.0 * PI * PI * GLOW);
    let cases: [(Fault, Check, &str); 19] = [
        (
            Fault::ScatteringDensity,
            conformance::shading,
            "more than 1",
        ),
        (
            Fault::ScatteringSamples,
            conformance::shading,
            "do not follow",
        ),
        (Fault::NotReciprocal, conformance::shading, "not reciprocal"),
        (Fault::Amplifies, conformance::shading, "more light leaves"),
        (Fault::SpawnsBelow, conformance::geometry, "meets it again"),
        (
            Fault::ConnectsBeyond,
            conformance::geometry,
            "meets a surface",
        ),
        (Fault::DirectDensity, conformance::direct, "fluence"),
        (Fault::DirectWeight, conformance::direct, "not the radiance"),
        (Fault::Flux, conformance::emission, "/ density is"),
        (Fault::Power, power, "emitted power"),
        (
            Fault::EmissionDensity,
            conformance::emission,
            "pdf_emission is",
        ),
        (Fault::Sensor, conformance::sensor, "unit direction"),
        (
            Fault::SensorDensity,
            conformance::importance,
            "both pdf_w must",
        ),
        (Fault::Importance, conformance::importance, "splatted image"),
        (Fault::ImportanceShape, conformance::importance, "tile"),
        (
            Fault::DirectEmission,
            conformance::direct,
            "pdf_emission is",
        ),
        (
            Fault::Source,
            conformance::emission,
            "the source is another",
        ),
        (
            Fault::LampDensity,
            conformance::emission,
            "another emission",
        ),
        (
            Fault::LampHemisphere,
            conformance::emission,
            "light from [0, 2, 0] does not follow",
        ),
    ];
    for (fault, check, words) in cases {
        check(&Ball::new(Fault::None)).unwrap();
        match check(&Ball::new(fault)) {
            Ok(()) => panic!("{fault:?} was not found"),
            Err(why) => assert!(why.contains(words), "{fault:?}: {why}"),
        }
    }
}

#[test]
fn a_lamp_has_no_defect() {
    conformance::emission(&Ball::new(Fault::Lamp)).unwrap();
}

#[test]
fn infinite_bounds_hide_no_defect() {
    conformance::geometry(&Ball::unbounded(Fault::None)).unwrap();
    let why = conformance::geometry(&Ball::unbounded(Fault::SpawnsBelow)).unwrap_err();
    assert!(why.contains("meets it again"), "{why}");
}
