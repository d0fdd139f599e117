//! The sensor.

use super::{ensure, is_unit, valid};
use crate::rng;
use tyndall_core::{Sampler, Sensor, Spectrum};

/// Rays of the sensor are finite and of unit direction, their weights finite (a reconstruction
/// filter may have negative ones), their densities finite and not negative, for 10,000 random pixels
/// and the corners of `u`.
///
/// # Errors
/// A sentence with the first ray that is not.
pub fn sensor<H: Sensor>(host: &H) -> Result<(), String> {
    let resolution = host.resolution();
    ensure(!resolution.contains(&0), || {
        format!("the sensor has {resolution:?} pixels")
    })?;
    let mut sampler = rng(1);
    for i in 0..10_000 {
        let px = resolution.map(|n| ((sampler.next_1d() * n as f32) as u32).min(n - 1));
        let corner = |bit: u32| {
            if i >> bit & 1 == 0 {
                0.0
            } else {
                1.0 - f32::EPSILON
            }
        };
        let u = if i < 16 {
            [0, 1, 2, 3].map(corner)
        } else {
            sampler.next()
        };
        let start = host.sensor_ray(px, u);
        let sound = start.ray.origin.is_finite()
            && is_unit(start.ray.direction)
            && start.ray.t_max > 0.0
            && start.weight.is_finite()
            && valid(start.pdf_w);
        ensure(sound, || {
            format!("pixel {px:?}, u {u:?}: no ray of unit direction and finite weight: {start:?}")
        })?;
    }
    Ok(())
}
