//! A procedural plume of smoke.

use crate::{DenseGrid, MediumError};
use glam::{IVec3, Vec3};
use tyndall_core::Aabb;

/// Octaves of turbulence; the finest has a wavelength of 1/48 of the height.
const OCTAVES: u32 = 5;

/// A plume of smoke that rises along +y in `bounds`: densities of 0 to 1, zero at the faces of the
/// box. The same arguments make the same smoke on every machine; a higher resolution samples the
/// same field more finely. It is a picture of smoke, not a simulation.
///
/// ```
/// use glam::Vec3;
/// use tyndall_core::Aabb;
/// let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
/// let smoke = tyndall_media::plume([16, 16, 16], bounds, 1)?;
/// assert!(smoke.max() > 0.5 && smoke.max() <= 1.0);
/// # Ok::<(), tyndall_media::MediumError>(())
/// ```
///
/// # Errors
/// As [`DenseGrid::new`].
pub fn plume(resolution: [usize; 3], bounds: Aabb, seed: u32) -> Result<DenseGrid, MediumError> {
    let [nx, ny, nz] = resolution;
    let center = |i: usize, n: usize| (i as f32 + 0.5) / n as f32;
    // A resolution that memory cannot hold fails here, for want of values.
    let voxels = nx.checked_mul(ny).and_then(|n| n.checked_mul(nz));
    let mut values = Vec::new();
    if voxels.is_none_or(|voxels| values.try_reserve_exact(voxels).is_err()) {
        return DenseGrid::new(resolution, bounds, values);
    }
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let p = Vec3::new(center(x, nx), center(y, ny), center(z, nz));
                values.push(density(p, seed));
            }
        }
    }
    DenseGrid::new(resolution, bounds, values)
}

/// The density at `p` in the unit cube: a column that widens and sways with height, whose edge
/// is frayed by turbulence.
fn density(p: Vec3, seed: u32) -> f32 {
    let height = p.y;
    let sway = |salt: u32| height * (noise(Vec3::new(0.0, 2.5 * height, 0.0), seed ^ salt) - 0.5);
    let axis = Vec3::new(0.5 + 0.4 * sway(0x51), height, 0.5 + 0.4 * sway(0x52));
    let radius = 0.08 + 0.27 * height;
    let frayed = turbulence(Vec3::new(3.0, 2.0, 3.0) * p, seed);
    let core = 1.3 - p.distance(axis) / radius + 2.0 * (frayed - 0.5);
    let rim = 2.0 * (p.x - 0.5).abs().max((p.z - 0.5).abs());
    let fade = smoothstep(0.0, 0.06, height) * smoothstep(0.0, 0.25, 1.0 - height);
    smoothstep(0.0, 1.0, core) * fade * smoothstep(0.0, 0.2, 1.0 - rim)
}

/// Fractal sum of noise, about 0.5.
fn turbulence(p: Vec3, seed: u32) -> f32 {
    let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
    for octave in 0..OCTAVES {
        let frequency = (1 << octave) as f32;
        sum += weight * noise(frequency * p, seed.wrapping_add(octave));
        total += weight;
        weight *= 0.55;
    }
    sum / total
}

/// Value noise: a random number at each integer point, smoothly interpolated; in \[0, 1\].
fn noise(p: Vec3, seed: u32) -> f32 {
    let base = p.floor();
    let s = (p - base).map(|x| smoothstep(0.0, 1.0, x));
    let base = base.as_ivec3();
    let corner = |x, y, z| hash(base + IVec3::new(x, y, z), seed);
    let lerp = |a: f32, b: f32, s: f32| a + s * (b - a);
    let along_x = |y, z| lerp(corner(0, y, z), corner(1, y, z), s.x);
    let along_y = |z| lerp(along_x(0, z), along_x(1, z), s.y);
    lerp(along_y(0), along_y(1), s.z)
}

/// A number in \[0, 1) of a lattice point: the mixer `lowbias32` of Wellons (2018) on each
/// coordinate in turn.
fn hash(p: IVec3, seed: u32) -> f32 {
    let mix = |mut h: u32| {
        h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        h ^ (h >> 16)
    };
    let h = p
        .to_array()
        .iter()
        .fold(mix(seed), |h, &x| mix(h.wrapping_add(x as u32)));
    (h >> 8) as f32 / (1 << 24) as f32
}

/// 0 below `from`, 1 above `to`, 3x² − 2x³ between.
fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let x = ((x - from) / (to - from)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
