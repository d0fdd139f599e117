//! What the materials of MTL files mean.
//!
//! With the keys of its extension for physically based rendering (`Pr`, `Pm`), as Blender writes
//! them, a material is one of glTF; `Tf` is then the share that is transmitted. Without, it is
//! diffuse, under a clear coat if it has a highlight.

use super::material::Material;
use super::texture::Textures;
use crate::Error;
use crate::files::Files;
use crate::material::{AlphaMode, Bsdf, FLIP, Map, MetallicRoughness, NormalMap, ScalarMap};
use crate::texture::{ColourSpace, Filter, Wrap};
use glam::{Affine2, Vec2};
use tyndall_core::{Rgb, Spectrum};

/// Reads one material; its textures are named relative to `files`. `notices` gets what was left
/// out.
///
/// # Errors
/// A sentence for a value out of range, or a texture that cannot be read.
pub(super) fn read(
    mtl: &tobj::Material,
    files: &Files,
    textures: &mut Textures<'_>,
    notices: &mut Vec<String>,
) -> Result<Material, String> {
    let mut load = |text: &str, space| load(text, space, files, textures);
    let base_color = mtl.diffuse_texture.as_deref();
    let base_color = base_color.map(|t| load(t, ColourSpace::Srgb)).transpose()?;
    let emission = unknown(mtl, &["map_Ke", "map_ke"]);
    let emission = emission.map(|t| load(t, ColourSpace::Srgb)).transpose()?;
    let kd = colour("Kd", mtl.diffuse, base_color.is_some(), 1.0)?;
    let ke = colour("Ke", mtl.emissive, emission.is_some(), f32::INFINITY)?;
    let mut material = Material::opaque(bsdf(mtl, kd)?, ke);
    let maps = &mut material.maps;
    maps.base_color = base_color.map(|t| t.map);
    maps.emission = emission.map(|t| t.map);
    for (keys, slot) in [
        (["map_Pr", "map_pr"], &mut maps.roughness),
        (["map_Pm", "map_pm"], &mut maps.metallic),
    ] {
        if let Some(text) = unknown(mtl, &keys) {
            let map = load(text, ColourSpace::Linear)?.map;
            *slot = Some(ScalarMap { map, channel: 0 });
        }
    }
    if let Some(text) = &mtl.dissolve_texture {
        let map = load(text, ColourSpace::Linear)?.map;
        let channel = if map.texture.has_alpha() { 3 } else { 0 };
        maps.alpha_map = Some(ScalarMap { map, channel });
        maps.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
    } else if is_pbr(mtl) || !is_glass(mtl) {
        // Of glass, `d` says what the index of refraction says better.
        let opaque = number(mtl, "Tr").map(|tr| 1.0 - tr);
        maps.alpha = (mtl.dissolve.map(|d| d as f32).or(opaque))
            .unwrap_or(1.0)
            .clamp(0.0, 1.0);
        maps.alpha_mode = AlphaMode::Blend;
    }
    let relief = unknown(mtl, &["norm"]).or(mtl.normal_texture.as_deref());
    if let Some(text) = relief {
        let Loaded { map, strength } = load(text, ColourSpace::Linear)?;
        if map.texture.holds_normals() {
            maps.normal = Some(NormalMap {
                map,
                scale: strength,
            });
        } else {
            notices.push(format!(
                "material {:?}: {text} holds heights, not normals, and is left out: bake a normal map",
                mtl.name
            ));
        }
    }
    Ok(material)
}

fn bsdf(mtl: &tobj::Material, kd: Rgb) -> Result<Bsdf<Rgb>, String> {
    let ior = mtl.optical_density.map(|x| x as f32);
    let ior = ior.filter(|ior| (1.0..=10.0).contains(ior)).unwrap_or(1.5);
    let (pr, pm) = (number(mtl, "Pr"), number(mtl, "Pm"));
    let model = MetallicRoughness {
        base_color: kd,
        metallic: 0.0,
        roughness: 0.0,
        ior,
        transmission: 0.0,
        thin: false,
    };
    let model = if is_pbr(mtl) {
        let filter = unknown(mtl, &["Tf"]).and_then(|t| t.split_whitespace().next()?.parse().ok());
        MetallicRoughness {
            metallic: pm.unwrap_or(0.0).clamp(0.0, 1.0),
            roughness: pr.unwrap_or(0.5).clamp(0.0, 1.0),
            transmission: filter.unwrap_or(0.0_f32).clamp(0.0, 1.0),
            ..model
        }
    } else if is_glass(mtl) {
        MetallicRoughness {
            base_color: Rgb::new(1.0, 1.0, 1.0),
            roughness: 0.0,
            transmission: 1.0,
            ..model
        }
    } else {
        let ks = colour("Ks", mtl.specular, false, f32::INFINITY)?;
        // Illumination models 0 and 1 have no highlight.
        if ks.is_black() || mtl.illumination_model.is_some_and(|illum| illum < 2) {
            return Ok(Bsdf::Diffuse(kd));
        }
        // Blinn's exponent n is GGX's α = √(2/(n + 2)) (Walter et al. 2007).
        let shininess = mtl.shininess.unwrap_or(10.0).max(0.0);
        let is_metal = kd.is_black();
        MetallicRoughness {
            base_color: if is_metal { ks.map(|c| c.min(1.0)) } else { kd },
            metallic: if is_metal { 1.0 } else { 0.0 },
            roughness: (2.0 / (shininess + 2.0)).powf(0.25) as f32,
            ..model
        }
    };
    Ok(if model.is_clear() {
        Bsdf::Dielectric { ior }
    } else {
        Bsdf::MetallicRoughness(model)
    })
}

/// Whether it has keys of the extension for physically based rendering.
fn is_pbr(mtl: &tobj::Material) -> bool {
    number(mtl, "Pr").or(number(mtl, "Pm")).is_some()
}

/// Whether the illumination model is one of refraction, which counts without those keys.
fn is_glass(mtl: &tobj::Material) -> bool {
    matches!(mtl.illumination_model, Some(4 | 6 | 7 | 9))
}

fn unknown<'m>(mtl: &'m tobj::Material, keys: &[&str]) -> Option<&'m str> {
    let found = keys.iter().find_map(|key| mtl.unknown_param.get(*key));
    found.map(String::as_str)
}

fn number(mtl: &tobj::Material, key: &str) -> Option<f32> {
    let x: f32 = unknown(mtl, &[key])?
        .split_whitespace()
        .next()?
        .parse()
        .ok()?;
    x.is_finite().then_some(x)
}

/// A colour; if it is not there, white where a texture is and black elsewhere.
fn colour(key: &str, value: Option<[f64; 3]>, textured: bool, max: f32) -> Result<Rgb, String> {
    let [r, g, b] = value.unwrap_or([f64::from(u8::from(textured)); 3]);
    let valid = |x: f64| x >= 0.0 && (x as f32).is_finite() && x as f32 <= max;
    if [r, g, b].into_iter().all(valid) {
        return Ok(Rgb::new(r as f32, g as f32, b as f32));
    }
    let range = if max == 1.0 {
        "from 0 to 1"
    } else {
        "≥ 0 and finite"
    };
    Err(format!("has {key} {r} {g} {b}, which must be {range}"))
}

/// A texture, and the strength of relief.
struct Loaded {
    map: Map,
    strength: f32,
}

/// `[-s u v w] [-o u v w] [-clamp on] [-bm x] … FILE`: the file comes last and may hold spaces.
fn load(
    text: &str,
    space: ColourSpace,
    files: &Files,
    textures: &mut Textures<'_>,
) -> Result<Loaded, String> {
    let (mut scale, mut offset) = (Vec2::ONE, Vec2::ZERO);
    let (mut wrap, mut strength) = (Wrap::Repeat, 1.0);
    let mut rest = text.trim();
    while let Some((option, after)) = next_option(rest) {
        let (arguments, after) = arguments(option, after);
        let number = |i: usize, default: f32| {
            let argument = arguments.get(i).and_then(|a| a.parse().ok());
            argument.filter(|x: &f32| x.is_finite()).unwrap_or(default)
        };
        match option {
            "-s" => scale = Vec2::new(number(0, 1.0), number(1, 1.0)),
            "-o" => offset = Vec2::new(number(0, 0.0), number(1, 0.0)),
            "-bm" => strength = number(0, 1.0),
            "-clamp" if arguments == ["on"] => wrap = Wrap::Clamp,
            _ => {}
        }
        rest = after;
    }
    let path = files.named(rest.replace('\\', "/"));
    let texture = textures.get(path, space, [wrap; 2], Filter::Bilinear);
    let transform = Affine2::from_scale_angle_translation(scale, 0.0, offset);
    Ok(Loaded {
        map: Map {
            texture: texture.map_err(|e: Error| format!("names a texture: {e}"))?,
            transform: FLIP * transform,
        },
        strength,
    })
}

fn next_option(text: &str) -> Option<(&str, &str)> {
    let is_option = text.starts_with('-') && text[1..].starts_with(char::is_alphabetic);
    is_option.then(|| text.split_once(char::is_whitespace))?
}

/// The arguments of an option and what comes after them: up to three numbers for `-s`, `-o` and
/// `-t`, two for `-mm`, one word for the others.
fn arguments<'t>(option: &str, text: &'t str) -> (Vec<&'t str>, &'t str) {
    let count = match option {
        "-s" | "-o" | "-t" => 3,
        "-mm" => 2,
        _ => 1,
    };
    let mut arguments = Vec::new();
    let mut rest = text.trim_start();
    while arguments.len() < count {
        let Some((word, after)) = rest.split_once(char::is_whitespace) else {
            break;
        };
        if count > 1 && word.parse::<f32>().is_err() {
            break;
        }
        arguments.push(word);
        rest = after.trim_start();
    }
    (arguments, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_come_before_names_with_spaces() {
        let mut rest = "-s 3 2 -bm 0.5 -clamp on my wood.png";
        let mut seen = Vec::new();
        while let Some((option, after)) = next_option(rest) {
            let (given, after) = arguments(option, after);
            seen.push((option, given));
            rest = after;
        }
        let expected = [
            ("-s", vec!["3", "2"]),
            ("-bm", vec!["0.5"]),
            ("-clamp", vec!["on"]),
        ];
        assert_eq!((seen.as_slice(), rest), (&expected[..], "my wood.png"));
    }
}
