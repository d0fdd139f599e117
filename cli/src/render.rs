//! `tyndall render`.

use crate::arguments::RenderArguments;
use crate::progress::{Bar, message};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use tyndall_core::{AnyIntegrator, Rgb, Spectrum};
use tyndall_driver::{Budget, Film, PassStreams, Render, RenderError};
use tyndall_path::{Path, Scattering};
use tyndall_scene_io::{
    IntegratorConfig, Metadata, RenderOutput, Scene, SceneFile, check_writable, write_exr,
    write_png,
};

/// Passes where neither the command line nor the scene says how many.
const PASSES: u64 = 64;

/// Exit code of a second Ctrl-C, which does not wait for the pass: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Why there is no image.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    #[error(transparent)]
    Scene(#[from] tyndall_scene_io::Error),
    #[error("no integrator is called `{0}`: choose `path`")]
    UnknownIntegrator(String),
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error("the threads could not be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    #[error("Ctrl-C could not be watched for: {0}")]
    Interrupt(#[from] ctrlc::Error),
}

/// Renders and writes.
pub(crate) fn run(arguments: &RenderArguments) -> Result<(), Error> {
    let file = SceneFile::load(&arguments.scene, &arguments.set)?;
    for notice in file.notices() {
        progress::message(&format!("notice: {notice}"));
    }
    let config = file.integrator();
    let name = arguments.integrator.as_ref().unwrap_or(&config.name);
    check_writable(&arguments.output)?;
    if let Some(png) = &arguments.png {
        check_writable(png)?;
    }
    let cancelled = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancelled);
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
    })?;
    let threads = arguments.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    pool.install(|| {
        if file.is_grey() {
            render::<f32>(arguments, &file, name, &cancelled)
        } else {
            render::<Rgb>(arguments, &file, name, &cancelled)
        }
    })
}

/// With the channels that the scene has.
fn render<S: Spectrum>(
    arguments: &RenderArguments,
    file: &SceneFile,
    name: &str,
    cancelled: &AtomicBool,
) -> Result<(), Error> {
    let config = file.integrator();
    let scene = file.build::<S>()?;
    let integrator = integrator(name, config)?;
    let budget = arguments
        .budget()
        .unwrap_or(Budget::Passes(config.passes.unwrap_or(PASSES)));
    let start = Instant::now();
    let film = {
        let bar = Bar::new();
        Render::new(&scene, integrator.as_ref())
            .seed(arguments.seed)
            .cancelled_by(cancelled)
            .run(budget, |progress| bar.report(&progress))?
    };
    let metadata = Metadata {
        scene: arguments.scene.display().to_string(),
        integrator: describe(name, config),
        fingerprint: String::new(),
        seed: arguments.seed,
        first_pass: 0,
        passes: film.passes(),
        seconds: start.elapsed().as_secs_f64(),
        version: env!("CARGO_PKG_VERSION").into(),
        notes: notes(config, &film, cancelled.load(Ordering::Relaxed)),
    };
    write(arguments, &film, &metadata)?;
    message(&format!(
        "{}: {} passes in {:.1} s, relative error {:.2} %",
        arguments.output.display(),
        film.passes(),
        metadata.seconds,
        100.0 * film.relative_error(),
    ));
    for note in &metadata.notes {
        message(&format!("note: {note}"));
    }
    Ok(())
}

/// The integrator of this name, as the scene configures it.
fn integrator<S: Spectrum>(
    name: &str,
    config: &IntegratorConfig,
) -> Result<Box<dyn AnyIntegrator<Scene<S>, PassStreams>>, Error> {
    match name {
        "path" => Ok(Box::new(
            Path::new()
                .max_depth(config.max_depth)
                .scattering(scattering(config)),
        )),
        _ => Err(Error::UnknownIntegrator(name.into())),
    }
}

fn scattering(config: &IntegratorConfig) -> Scattering {
    match config.scattering {
        tyndall_scene_io::Scattering::None => Scattering::None,
        tyndall_scene_io::Scattering::Single => Scattering::Single,
        tyndall_scene_io::Scattering::Multiple => Scattering::Multiple,
    }
}

fn describe(name: &str, config: &IntegratorConfig) -> String {
    let depth = config
        .max_depth
        .map_or("unlimited".into(), |depth| depth.to_string());
    format!(
        "{name}, max_depth {depth}, {:?} scattering in media",
        scattering(config)
    )
}

/// What a reader of the image must know.
fn notes<S: Spectrum>(config: &IntegratorConfig, film: &Film<S>, interrupted: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(depth) = config.max_depth {
        notes.push(format!(
            "biased: paths of more than {depth} scatterings are left out (max_depth)"
        ));
    }
    match scattering(config) {
        Scattering::Multiple => {}
        Scattering::Single => {
            notes.push("light that media scatter more than once is left out (scattering)".into())
        }
        Scattering::None => {
            notes.push("light that media scatter is left out (scattering)".into());
        }
    }
    if film.mean().iter().all(|value| *value == 0.0) {
        notes.push("the image is black: no light was found".into());
    }
    if film.non_finite() > 0 {
        notes.push(format!(
            "{} samples were not finite and count as black: please report the scene",
            film.non_finite()
        ));
    }
    if interrupted {
        notes.push("interrupted: the image holds the passes finished until then".into());
    }
    notes
}

/// Writes the EXR, then the PNG.
fn write<S: Spectrum>(
    arguments: &RenderArguments,
    film: &Film<S>,
    metadata: &Metadata,
) -> Result<(), Error> {
    let spectra = |values: Vec<f64>| -> Vec<S> {
        values
            .chunks_exact(S::CHANNELS)
            .map(|pixel| S::from_channels(|i| pixel[i] as f32))
            .collect()
    };
    let radiance = spectra(film.mean().to_vec());
    let variance = spectra(film.variance_of_mean().collect());
    let [width, height] = film.resolution();
    let output = RenderOutput {
        width,
        height,
        radiance: &radiance,
        variance: &variance,
        features: None,
        view: None,
        metadata,
    };
    write_exr(&arguments.output, &output)?;
    if let Some(png) = &arguments.png {
        write_png(png, &output, None)?;
    }
    Ok(())
}
