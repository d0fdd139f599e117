//! Places of discs, and rays through them.

use glam::Vec3;
use tyndall_core::{Ray, Sampler};
use tyndall_testkit::TestSampler;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Places {
    Uniform,
    Clustered,
    Plane,
    Coincident,
}

pub(crate) const PLACES: [Places; 4] = [
    Places::Uniform,
    Places::Clustered,
    Places::Plane,
    Places::Coincident,
];

/// Centres in the unit cube about 0.
pub(crate) fn centers(places: Places, count: usize, random: &mut TestSampler) -> Vec<Vec3> {
    let mut cube = || Vec3::from_array(random.next()) - 0.5;
    let seeds = [(); 5].map(|()| cube());
    (0..count)
        .map(|i| match places {
            Places::Uniform => cube(),
            Places::Clustered => seeds[i % 5] + 10_f32.powi(-(i as i32 % 5)) * cube(),
            Places::Plane => cube() * Vec3::new(1.0, 0.0, 1.0),
            Places::Coincident => seeds[0],
        })
        .collect()
}

/// Radii between 1e-12 and 1 of `scale`, or all `scale`.
pub(crate) fn radii(scale: f32, decades: f32, count: usize, random: &mut TestSampler) -> Vec<f32> {
    (0..count)
        .map(|_| scale * 10_f32.powf(-decades * random.next_1d()))
        .collect()
}

/// A unit vector; one in three along an axis.
pub(crate) fn direction(random: &mut TestSampler) -> Vec3 {
    let [a, b] = random.next();
    let axis = Vec3::AXES[(a * 3.0) as usize];
    match (b * 6.0) as usize {
        0 => axis,
        1 => -axis,
        _ => loop {
            let v = Vec3::from_array(random.next()) * 2.0 - 1.0;
            if (0.01..1.0).contains(&v.length_squared()) {
                break v.normalize();
            }
        },
    }
}

/// A ray near a point of `targets`, about `radius` away from it; it may start behind, in the
/// middle or beyond, exactly at the target or in the plane of a face of its box.
pub(crate) fn ray(targets: &[(Vec3, f32)], size: f32, random: &mut TestSampler) -> Ray {
    let [pick, aside, back, end] = random.next();
    let (target, radius) = targets
        .get((pick * targets.len() as f32) as usize)
        .copied()
        .unwrap_or_default();
    let direction = direction(random);
    let through = match (aside * 5.0) as usize {
        0 => target,
        1 => target + radius * Vec3::AXES[(back * 3.0) as usize],
        2 => target + 0.5 * size * (Vec3::from_array(random.next()) - 0.5),
        _ => target + radius * (Vec3::from_array(random.next()) * 2.0 - 1.0),
    };
    let distance = size * (3.0 * back - 1.0);
    let t_max = match (end * 6.0) as usize {
        0 => 0.0,
        1 => 2.0 * size * random.next_1d(),
        2 => distance.max(0.0),
        _ => f32::INFINITY,
    };
    Ray::new(through - distance * direction, direction).up_to(t_max)
}

/// Rays without a place, without a direction, or that end before they start.
pub(crate) fn no_rays() -> [Ray; 5] {
    [
        Ray::new(Vec3::NAN, Vec3::Z),
        Ray::new(Vec3::ZERO, Vec3::NAN),
        Ray::new(Vec3::INFINITY, Vec3::Z),
        Ray::new(Vec3::ZERO, Vec3::Z).up_to(f32::NAN),
        Ray::new(Vec3::ZERO, Vec3::Z).up_to(-1.0),
    ]
}
