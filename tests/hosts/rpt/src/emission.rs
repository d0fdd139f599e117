//! Photons from rpt's lights.

use crate::{FOG, RptHit, RptHost, rng, to_glm, to_rgb, to_vec3};
use rpt::{Environment, Light};
use std::f32::consts::PI;
use tyndall_core::{
    Anchor, EmissionPdf, EmissionSample, LightEmission, LightKind, Ray, Rgb, Spectrum,
    warp::uniform_sphere,
};

/// Of a uniform direction.
const PDF_W: f32 = 0.25 / PI;

/// From so far away all that faces a direction is seen along it.
const FAR: f64 = 1e12;

impl RptHost {
    /// Whether photons bring all the light of the scene.
    ///
    /// # Errors
    /// What starts none, and the mend.
    pub fn check_photons(&self) -> Result<(), &'static str> {
        let dark = match &self.scene.environment {
            Environment::Color(color) => to_rgb(color).is_black(),
            Environment::Hdri(_) => false,
        };
        let glows = |object: &rpt::Object| object.material.emittance > 0.0;
        let parallel = |light: &Light| matches!(light, Light::Directional(..));
        if !dark {
            Err("the environment starts no photons: make it black, or trace paths")
        } else if self.scene.lights.iter().any(parallel) {
            Err("directional lights start no photons: put a lamp far away, or trace paths")
        } else if self.scene.objects.iter().any(glows) {
            Err("objects that glow start no photons: make them lights, or trace paths")
        } else {
            Ok(())
        }
    }
}

impl LightEmission for RptHost {
    /// One light of all, with equal probability, in a uniform direction.
    ///
    /// A lamp (an invisible object) is asked for the point from which it would light one far away in
    /// that direction: whatever its shape, rpt then tells the density of the point and the normal.
    /// Light from infinity would need bounds, which rpt does not keep, and objects that glow may be
    /// planes, which it cannot sample. Ambient light is no light, as in
    /// [`sample_direct`](tyndall_core::LightDirect::sample_direct).
    fn sample_emission(&self, u: [f32; 6]) -> Option<EmissionSample<Rgb, RptHit>> {
        let lights = &self.scene.lights;
        let light = lights.get((u[0] * lights.len() as f32) as usize)?;
        let pmf = (lights.len() as f32).recip();
        let direction = uniform_sphere([u[1], u[2]]);
        let (radiance, from, pdf_a, cos_theta, kind) = match light {
            Light::Ambient(_) | Light::Directional(..) => return None,
            Light::Point(intensity, position) => {
                (*intensity, *position, pmf, 1.0, LightKind::Point)
            }
            Light::Object(object) => {
                let towards = to_glm(direction);
                let mut rng = rng([u[3], u[4], u[5]]);
                let (point, normal, pdf_a) = object.shape.sample(&(FAR * towards), &mut rng);
                let cosine = normal.dot(&towards) as f32;
                let radiance = object.material.color * object.material.emittance;
                let pdf_a = pmf * pdf_a as f32;
                // No ray hits it, but its densities are those of a surface.
                (radiance, point, pdf_a, cosine, LightKind::Area)
            }
        };
        let from = to_vec3(&from);
        (cos_theta > 0.0 && pdf_a > 0.0).then(|| EmissionSample {
            source: Anchor::Point(from),
            ray: Ray::new(from, direction),
            flux: to_rgb(&radiance) * (cos_theta / (pdf_a * PDF_W)),
            pdf: EmissionPdf {
                pdf_a,
                pdf_w: PDF_W,
            },
            cos_theta,
            kind,
            medium: FOG,
        })
    }
}
