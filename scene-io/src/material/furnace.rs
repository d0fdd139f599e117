//! White furnaces: materials that absorb nothing send on all light, from wherever it comes.

use super::{Bsdf, MetallicRoughness, RoughConductor};
use glam::Vec3;
use tyndall_core::PathFrom;

/// What tables may be wrong by, as the README says.
const TABLES: f64 = 0.01;
/// The same where part of the light inside of a body meets its diffuse base.
const INSIDE: f64 = 0.02;
/// The same where indices differ by less than 0.05.
const NEARLY_EQUAL: f64 = 0.05;
/// Points of the quadrature, which is Roberts' sequence R₃ (2018), and an error far above its own.
const POINTS: u32 = 1 << 17;
const QUADRATURE: f64 = 0.001;
/// Powers of 1/1.22074…, the root of x⁴ = x + 1.
const STEPS: [f64; 3] = [
    0.819_172_513_396_164_5,
    0.671_043_606_703_789_2,
    0.549_700_477_901_970_3,
];

/// Mean weight of samples of a path from a light over all random numbers: the share of light
/// from cosine `mu` (below the surface if negative) that goes on.
fn albedo(bsdf: &Bsdf<f32>, mu: f32, eta: f32) -> f64 {
    let wo = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
    let weights = (1..=POINTS).map(|i| {
        let u = STEPS.map(|step| (f64::from(i) * step).fract() as f32);
        let sample = bsdf.sample(wo, u, eta, PathFrom::Light);
        sample.map_or(0.0, |s| f64::from(s.weight))
    });
    weights.sum::<f64>() / f64::from(POINTS)
}

fn check(name: &str, bsdf: &Bsdf<f32>, eta: f32, cosines: &[f32], bound: f64) {
    let albedos: Vec<_> = cosines
        .iter()
        .map(|&mu| (mu, albedo(bsdf, mu, eta)))
        .collect();
    let far = albedos
        .iter()
        .filter(|(_, albedo)| (albedo - 1.0).abs() > bound + QUADRATURE);
    assert_eq!(far.count(), 0, "{name}: {albedos:?}");
}

const ABOVE: [f32; 4] = [0.05, 0.3, 0.7, 1.0];
const BOTH: [f32; 6] = [-1.0, -0.6, -0.2, 0.05, 0.4, 1.0];
const ROUGHNESS: [f32; 6] = [0.0, 0.17, 0.33, 0.5, 0.77, 1.0];

fn white(roughness: f32) -> MetallicRoughness<f32> {
    MetallicRoughness {
        base_color: 1.0,
        metallic: 0.0,
        roughness,
        ior: 1.5,
        transmission: 0.0,
        thin: false,
    }
}

#[test]
fn metal_and_paint_send_on_all_light() {
    for roughness in ROUGHNESS {
        for metallic in [0.0, 0.4, 1.0] {
            let model = MetallicRoughness {
                metallic,
                ..white(roughness)
            };
            let name = format!("roughness {roughness}, metallic {metallic}");
            check(&name, &Bsdf::MetallicRoughness(model), 1.0, &ABOVE, TABLES);
        }
        if roughness > 0.0 {
            let metal = RoughConductor::new(0.0, 1.0, roughness * roughness);
            let name = format!("conductor of roughness {roughness}");
            check(&name, &Bsdf::RoughConductor(metal), 1.0, &ABOVE, TABLES);
        }
    }
}

#[test]
fn glass_sends_on_all_light_from_both_sides() {
    for roughness in ROUGHNESS {
        for (transmission, metallic, thin) in
            [(1.0, 0.0, false), (1.0, 0.0, true), (0.4, 0.2, true)]
        {
            let model = MetallicRoughness {
                metallic,
                transmission,
                thin,
                ..white(roughness)
            };
            check(
                &format!("{model:?}"),
                &Bsdf::MetallicRoughness(model),
                1.5,
                &BOTH,
                TABLES,
            );
        }
    }
}

#[test]
fn glass_of_any_index_sends_on_all_light() {
    for ior in [0.4, 0.75, 1.05, 1.2, 2.4, 8.0] {
        for roughness in [0.3, 1.0] {
            let glass = Bsdf::MetallicRoughness(MetallicRoughness::glass(ior, roughness));
            check(
                &format!("ior {ior}, roughness {roughness}"),
                &glass,
                ior,
                &BOTH,
                TABLES,
            );
        }
    }
}

#[test]
fn glass_of_nearly_the_same_index_sends_on_all_light() {
    for ior in [0.96, 0.99, 1.002, 1.01, 1.03] {
        for roughness in [0.1, 0.3, 0.6, 1.0] {
            let glass = Bsdf::MetallicRoughness(MetallicRoughness::glass(ior, roughness));
            let name = format!("ior {ior}, roughness {roughness}");
            check(&name, &glass, ior, &BOTH, NEARLY_EQUAL);
        }
    }
}

/// Equal index: nothing is reflected, the tint and the diffuse share stay.
#[test]
fn the_boundary_of_an_equal_index_is_straight() {
    let model = MetallicRoughness {
        base_color: 0.5,
        transmission: 0.5,
        ..white(0.5)
    };
    let bsdf = Bsdf::MetallicRoughness(model);
    assert!((albedo(&bsdf, 0.6, 1.0) - 0.5).abs() < 1e-3);
    let wo = Vec3::new(0.8, 0.0, 0.6);
    let sample = bsdf.sample(wo, [0.5, 0.5, 0.1], 1.0, PathFrom::Sensor);
    assert_eq!(sample.map(|s| (s.wi, s.delta)), Some((-wo, true)));
}

#[test]
fn cloudy_glass_sends_on_all_light() {
    for roughness in ROUGHNESS {
        for (transmission, metallic) in [(0.6, 0.0), (0.5, 0.5)] {
            let model = MetallicRoughness {
                metallic,
                transmission,
                ..white(roughness)
            };
            let bsdf = Bsdf::MetallicRoughness(model);
            check(&format!("{model:?}"), &bsdf, 1.5, &ABOVE, TABLES);
            check(
                &format!("{model:?}"),
                &bsdf,
                1.5,
                &[-1.0, -0.6, -0.2],
                INSIDE,
            );
        }
    }
}
