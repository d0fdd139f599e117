//! Photons on surfaces.

use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_1_PI;
use std::f64::consts::{PI, TAU};
use tyndall_core::{
    Aabb, Anchor, BsdfSample, Geometry, HostTypes, MediumId, PathFrom, Ray, Rgb, Shading, Surface,
    SurfaceKind, Vacuum,
};
use tyndall_density::SurfacePoint;

/// A white wall facing +z, whose shading normal is turned towards +x.
struct Wall(Surface);

impl Wall {
    fn tilted(angle: f32) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self(Surface {
            position: Vec3::new(1.0, 2.0, 3.0),
            geometric_normal: Vec3::Z,
            shading_normal: Vec3::new(sin, 0.0, cos),
        })
    }
}

impl HostTypes for Wall {
    type Spectrum = Rgb;
    type Hit = ();
    type Medium = Vacuum<Rgb>;
}

impl Geometry for Wall {
    fn bounds(&self) -> Aabb {
        unreachable!("not asked by a surface point")
    }
    fn intersect(&self, _: &Ray, _: MediumId) -> Option<(f32, ())> {
        unreachable!("not asked by a surface point")
    }
    fn surface(&self, _: &()) -> Surface {
        self.0
    }
    fn spawn(&self, _: &Anchor<()>, _: Vec3) -> Ray {
        unreachable!("not asked by a surface point")
    }
    fn connect(&self, _: &Anchor<()>, _: &Anchor<()>) -> Ray {
        unreachable!("not asked by a surface point")
    }
    fn occluded(&self, _: &Ray) -> bool {
        unreachable!("not asked by a surface point")
    }
}

impl Shading for Wall {
    fn surface_kind(&self, _: &()) -> SurfaceKind {
        SurfaceKind::Finite
    }
    /// Lambert's law where both normals see both directions; brighter for paths of light, so that
    /// the wrong question is noticed.
    fn bsdf_eval(&self, _: &(), wo: Vec3, wi: Vec3, from: PathFrom) -> Rgb {
        let sees = |v: Vec3| v.z >= 0.0 && v.dot(self.0.shading_normal) >= 0.0;
        if !(sees(wo) && sees(wi)) {
            return Rgb::default();
        }
        Rgb(Vec3::splat(match from {
            PathFrom::Sensor => FRAC_1_PI,
            PathFrom::Light => 7.0,
        }))
    }
    fn bsdf_sample(&self, _: &(), _: Vec3, _: [f32; 3], _: PathFrom) -> Option<BsdfSample<Rgb>> {
        unreachable!("not asked by a surface point")
    }
    fn emitted(&self, _: &(), _: Vec3) -> Rgb {
        unreachable!("not asked by a surface point")
    }
    fn background(&self, _: Vec3) -> Rgb {
        unreachable!("not asked by a surface point")
    }
}

/// Photons of radiance L arrive with the density L·|wi·n|, and a white wall turned by δ scatters
/// ∫ L |wi·nₛ|/π over the lune that both normals see: (1 + cos δ)/2 for L = 1, and
/// (2(π − δ) + sin 2δ)/(3π) for L = wi·nₛ. The bound of the ratio may cost sin²δ/400, and the
/// midpoint rule over 1000 × 1000 directions errs by 1e-5 at the edge of the lune.
#[test]
fn photons_scatter_the_light_that_the_shading_normal_sees() {
    let steps = 1000;
    for degrees in [0.0_f32, 10.0, 40.0] {
        let angle = degrees.to_radians();
        let wall = Wall::tilted(angle);
        let point = SurfacePoint::new(&wall, &(), Vec3::Z);
        let mut sum = DVec3::ZERO;
        for i in 0..steps {
            let cos = (i as f32 + 0.5) / steps as f32;
            let sin = (1.0 - cos * cos).sqrt();
            for j in 0..steps {
                let phi = std::f32::consts::TAU * (j as f32 + 0.5) / steps as f32;
                let wi = Vec3::new(sin * phi.cos(), sin * phi.sin(), cos);
                let arriving = Rgb::new(1.0, wi.dot(wall.0.shading_normal), 0.0) * cos;
                sum += point.radiance(-wi, arriving).0.as_dvec3();
            }
        }
        // The measure of the hemisphere is 2π.
        let radiance = sum * TAU / f64::from(steps * steps);
        let delta = f64::from(angle);
        let tilted = (2.0 * (PI - delta) + (2.0 * delta).sin()) / (3.0 * PI);
        let expected = DVec3::new(0.5 * (1.0 + delta.cos()), tilted, 0.0);
        let bound = delta.sin().powi(2) / 400.0 + 1e-4;
        assert!(
            (radiance - expected).abs().max_element() < bound,
            "{degrees}°: {radiance} instead of {expected}"
        );
    }
}

#[test]
fn grazing_photons_stay_bounded() {
    let grazing = |z: f32| -Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
    let flux = Rgb::new(1.0, 1.0, 1.0);
    // Both normals alike: the ratio is 1 at any angle but along the surface itself.
    let flat = Wall::tilted(0.0);
    let point = SurfacePoint::new(&flat, &(), Vec3::Z);
    assert_eq!(point.position(), Vec3::new(1.0, 2.0, 3.0));
    for z in [1e-3, 1e-8, 1e-30] {
        assert_eq!(point.radiance(grazing(z), flux).0.x, FRAC_1_PI);
    }
    assert_eq!(point.radiance(grazing(0.0), flux), Rgb::default());
    let tilted = Wall::tilted(0.5);
    let point = SurfacePoint::new(&tilted, &(), Vec3::Z);
    for z in [1e-3, 1e-8, 1e-30] {
        assert!((point.radiance(grazing(z), flux).0.x - 100.0 * FRAC_1_PI).abs() < 1e-4);
    }
}

#[test]
fn photons_of_another_wall_are_not_near() {
    let wall = Wall::tilted(0.5);
    let point = SurfacePoint::new(&wall, &(), Vec3::Z);
    assert!(point.is_near(Vec3::new(0.9, 0.0, 0.0), 1.0));
    assert!(point.is_near(Vec3::new(0.9, 0.0, -0.29), 1.0));
    assert!(!point.is_near(Vec3::new(0.0, 0.3, 0.31), 1.0));
    assert!(!point.is_near(Vec3::new(0.0, 0.3, -0.31), 1.0));
    // On a sphere of 5/3 radii the whole disc is near: its edge, a chord of 1, lies 0.3 r lower.
    let edge = Vec3::new(0.0, (1.0 - 0.3_f32.powi(2)).sqrt(), -0.3);
    assert!(point.is_near(edge, 1.001) && (edge + 5.0 / 3.0 * Vec3::Z).length() < 1.6667);
}

#[test]
fn rounding_does_not_lose_photons_of_a_plane() {
    // Two points of a tilted plane a hundred units away, and a radius of ten units in the last
    // place of their coordinates.
    let normal = Vec3::new(0.3, 0.5, 0.8).normalize();
    let wall = Wall(Surface {
        position: 100.0 * normal,
        geometric_normal: normal,
        shading_normal: normal,
    });
    let point = SurfacePoint::new(&wall, &(), normal);
    let across = normal.any_orthonormal_vector();
    for i in 0..100 {
        let photon = 100.0 * normal + 1e-6 * i as f32 * across;
        assert!(point.is_near(photon - point.position(), 1e-4));
    }
}
