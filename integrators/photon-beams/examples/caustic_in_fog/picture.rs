//! The three beside each other.

use crate::{methods, scene};
use std::error::Error;
use std::path::Path;
use std::time::Duration;
use tyndall_core::Rgb;
use tyndall_driver::{Budget, Render};
use tyndall_scene_io::{Metadata, RenderOutput, write_png};

/// For each, in seconds.
const TIME: f64 = 30.0;
/// The middle of the picture.
const CROP: (&str, &str) = ("film.crop", "[132, 0, 216, 270]");
/// Powers of two by which radiance is brightened.
const EXPOSURE: f32 = 5.5;

/// Beams, points and paths, from left to right.
pub(crate) fn write(png: &Path) -> Result<(), Box<dyn Error>> {
    let host = scene(&[CROP])?;
    let mut films = Vec::new();
    for (_, method) in methods() {
        let budget = Budget::Time(Duration::from_secs_f64(TIME));
        films.push(Render::new(&host, method.as_ref()).run(budget, |_| {})?);
    }
    let [width, height] = films[0].resolution();
    let row = |y: usize| {
        let length = 3 * width as usize;
        films
            .iter()
            .flat_map(move |film| film.mean()[y * length..][..length].chunks_exact(3))
    };
    let pixel = |c: &[f64]| Rgb::new(c[0] as f32, c[1] as f32, c[2] as f32);
    let radiance: Vec<Rgb> = (0..height as usize).flat_map(row).map(pixel).collect();
    let output = RenderOutput {
        width: width * films.len() as u32,
        height,
        radiance: &radiance,
        variance: &vec![Rgb::default(); radiance.len()],
        features: None,
        view: None,
        metadata: &Metadata::default(),
    };
    Ok(write_png(png, &output, Some(EXPOSURE))?)
}
