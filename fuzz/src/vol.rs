//! Mitsuba's `.vol` files, as densities.
#![no_main]

use glam::Vec3;
use libfuzzer_sys::fuzz_target;
use std::{fs, sync::LazyLock};
use tempfile::NamedTempFile;
use tyndall_core::{Aabb, Coefficients};
use tyndall_media::{DenseGrid, GridMedium, MediumError, Phase};
use tyndall_scene_io::{Volume, read_vol};

static FILE: LazyLock<NamedTempFile> = LazyLock::new(|| NamedTempFile::new().expect("a file"));

fn seed(channels: i32) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend(
        [1, 3, 2, 2, channels]
            .into_iter()
            .flat_map(i32::to_le_bytes),
    );
    bytes.extend(
        [-1.0_f32, -2.0, -3.0, 1.0, 2.0, 3.0]
            .into_iter()
            .flat_map(f32::to_le_bytes),
    );
    bytes.extend((0..12 * channels).flat_map(|i| (i as f32).to_le_bytes()));
    bytes
}

fn medium(volume: Volume) -> Result<GridMedium<f32>, MediumError> {
    let [min, max] = volume.bounds.map(|corner| corner.as_vec3());
    let density = DenseGrid::new(volume.resolution, Aabb { min, max }, volume.values)?;
    let coefficients = Coefficients {
        sigma_a: 0.5_f32,
        sigma_s: 0.5,
        emission: 0.0,
    };
    GridMedium::new(density, coefficients, Phase::Isotropic)
}

fuzz_target!(init: tyndall_fuzz::start("vol", &[seed(1), seed(3)]), |bytes: &[u8]| {
    fs::write(FILE.path(), bytes).expect("the file is writable");
    let Ok(volume) = read_vol(FILE.path()) else {
        return;
    };
    if let Ok(medium) = medium(volume) {
        let ray = tyndall_core::Ray::new(Vec3::splat(-3.0), Vec3::ONE.normalize());
        assert!(medium.optical_depth(&ray) >= 0.0);
    }
});
