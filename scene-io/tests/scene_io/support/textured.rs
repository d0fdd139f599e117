//! Scenes whose textures the tests write themselves.

use glam::Vec3;
use image::{ImageBuffer, Rgba};
use std::f32::consts::PI;
use std::path::{Path, PathBuf};
use tyndall_core::{Geometry, MediumId, PathFrom, Ray, Rgb, Shading, Spectrum};
use tyndall_scene_io::{Hit, Scene, SceneFile};

/// A file among those that the test of this name wrote.
pub(crate) fn path(test: &str, name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("textures")
        .join(test);
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

pub(crate) fn write8(test: &str, name: &str, width: u32, texels: &[[u8; 4]]) {
    let height = texels.len() as u32 / width;
    let pixel = |x, y| Rgba(texels[(y * width + x) as usize]);
    let image = ImageBuffer::from_fn(width, height, pixel);
    image.save(path(test, name)).unwrap();
}

pub(crate) fn load(test: &str, text: &str) -> Result<SceneFile, String> {
    let head = "
        [film]
        width = 8
        height = 8
        [camera]
        position = [0, 0, 5]
        look_at = [0, 0, 0]
        fov = 60
    ";
    SceneFile::parse(&format!("{head}{text}"), &path(test, "scene.toml"), &[])
        .map_err(|e| e.to_string())
}

pub(crate) fn scene<S: Spectrum>(test: &str, text: &str) -> Scene<S> {
    let file = load(test, text).unwrap_or_else(|e| panic!("{e}"));
    file.build().unwrap_or_else(|e| panic!("{e}"))
}

/// The unit square in z = 0 that faces +z, of this material.
pub(crate) fn square(material: &str) -> String {
    format!(
        "
        [materials.it]
        {material}
        [[shapes]]
        kind = 'quad'
        corner = [0, 0, 0]
        edge_u = [1, 0, 0]
        edge_v = [0, 1, 0]
        material = 'it'
        "
    )
}

/// What is met on the way from +z to the point (x, y).
pub(crate) fn hit<S: Spectrum>(scene: &Scene<S>, x: f32, y: f32) -> Hit {
    let ray = Ray::new(Vec3::new(x, y, 3.0), Vec3::NEG_Z);
    scene
        .intersect(&ray, MediumId::VACUUM)
        .expect("the ray aims at it")
        .1
}

/// π times the scattering function straight up: the reflectance of what is diffuse.
pub(crate) fn reflectance<S: Spectrum>(scene: &Scene<S>, hit: &Hit) -> S {
    let n = scene.surface(hit).shading_normal;
    scene.bsdf_eval(hit, n, n, PathFrom::Sensor) * PI
}

pub(crate) const WHITE: [u8; 4] = [255; 4];
pub(crate) const RED: [u8; 4] = [255, 0, 0, 255];
pub(crate) const GREEN: [u8; 4] = [0, 255, 0, 255];
pub(crate) const BLUE: [u8; 4] = [0, 0, 255, 255];
pub(crate) const GONE: [u8; 4] = [255, 255, 255, 0];

pub(crate) fn close(a: Rgb, b: [f32; 3]) -> bool {
    (a.0 - Vec3::from(b)).abs().max_element() < 1e-5
}
