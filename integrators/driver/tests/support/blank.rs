//! A host of the driver that has no scene.

use glam::Vec3;
use tyndall_core::{HostTypes, MediumId, Ray, Rgb, Sensor, SensorRay, Vacuum};

/// A sensor that looks nowhere.
pub(crate) struct Blank(pub(crate) [u32; 2]);

impl HostTypes for Blank {
    type Spectrum = Rgb;
    type Hit = ();
    type Medium = Vacuum<Rgb>;
}

impl Sensor for Blank {
    fn resolution(&self) -> [u32; 2] {
        self.0
    }

    fn sensor_ray(&self, _: [u32; 2], _: [f32; 4]) -> SensorRay<Rgb> {
        SensorRay {
            ray: Ray::new(Vec3::ZERO, Vec3::Z),
            weight: Rgb::new(1.0, 2.0, 0.5),
            medium: MediumId::VACUUM,
            pdf_w: 0.0,
        }
    }
}
