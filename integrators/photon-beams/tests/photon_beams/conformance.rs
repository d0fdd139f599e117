//! What every integrator must hold. Beams have a radius in scene units: here it grows with the host.

use crate::fog;
use tyndall_core::{
    Geometry, Integrator, LightEmission, Media, PassContext, PassError, Rgb, Sampler, SensorRay,
    Shading, Spectrum, Streams,
};
use tyndall_media::Homogeneous;
use tyndall_photon_beams::{Estimate, Pass, PhotonBeams};
use tyndall_testkit::conformance::{lamp, view};
use tyndall_testkit::hosts::{AnalyticHost, Interface};
use tyndall_testkit::integrator_conformance;
use tyndall_walk::DirectLight;

/// With radii that are a share of the diagonal of the host.
#[derive(Clone, Copy)]
struct OfDiagonal<D>(PhotonBeams<D>, f32);

impl<D> OfDiagonal<D> {
    fn on<H: Geometry>(self, host: &H) -> PhotonBeams<D> {
        let bounds = host.bounds();
        self.0.beam_radius(self.1 * bounds.min.distance(bounds.max))
    }
}

impl<H, D> Integrator<H> for OfDiagonal<D>
where
    H: Geometry + Shading + Media + LightEmission,
    D: DirectLight<H> + Copy,
{
    type Pass = Pass<H::Spectrum>;
    type Pixel = ();

    fn begin_pass<R: Streams>(
        &self,
        host: &H,
        cx: &PassContext<'_, R>,
        previous: Option<Self::Pass>,
    ) -> Result<Self::Pass, PassError> {
        self.on(host).begin_pass(host, cx, previous)
    }

    fn estimate(
        &self,
        host: &H,
        pass: &Self::Pass,
        pixel: &mut (),
        ray: &SensorRay<H::Spectrum>,
        sampler: &mut impl Sampler,
    ) -> H::Spectrum {
        self.on(host).estimate(host, pass, pixel, ray, sampler)
    }
}

fn haze<S: Spectrum>(scale: f32, g: f32) -> Homogeneous<S> {
    let sigma_a = S::from_channels(|i| 0.3 / scale * (1.0 + i as f32));
    fog(sigma_a, S::splat(1.2 / scale), g)
}

integrator_conformance! {
    name: one_dimension,
    integrator: OfDiagonal(PhotonBeams::new().paths(300), 0.02),
    host: |scale: f32| AnalyticHost::furnace(haze::<Rgb>(scale, 0.5), scale, Interface::Matched, view(scale)),
}

integrator_conformance! {
    name: two_dimensions_behind_glass,
    integrator: OfDiagonal(PhotonBeams::new().estimator(Estimate::BeamBeam2DRay).paths(300), 0.02),
    host: |scale: f32| AnalyticHost::furnace(haze::<f32>(scale, -0.3), scale, Interface::Dielectric(1.4), view(scale)),
}

integrator_conformance! {
    name: lights_sampled,
    integrator: OfDiagonal(PhotonBeams::sampling_lights().paths(300), 0.02),
    host: |scale: f32| AnalyticHost::sphere(haze::<Rgb>(scale, 0.7), scale, Interface::Matched, lamp(scale), view(scale)),
}
