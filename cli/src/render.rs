//! `tyndall render`.

use crate::arguments::RenderArguments;
use crate::checkpoint::{Checkpoint, Identity, fingerprint};
use crate::failure::Error;
use crate::image;
use crate::integrators::{biases, describe, integrator, unheeded};
use crate::keeper::Keeper;
use crate::preview::Preview;
use crate::progress::{Bar, line, message};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tyndall_core::{Rgb, Spectrum};
use tyndall_driver::{Budget, Render, Snapshot};
use tyndall_scene_io::{Metadata, Scene, SceneFile, check_writable};

/// Passes where neither the command line nor the scene says how many.
const PASSES: u64 = 64;

/// Exit code of a second Ctrl-C, which does not wait for the pass: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Renders and writes.
pub(crate) fn run(arguments: &RenderArguments) -> Result<(), Error> {
    let file = SceneFile::load(&arguments.scene, &arguments.set)?;
    tell_notices(&file);
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
            render::<f32>(arguments, &file, &cancelled)
        } else {
            render::<Rgb>(arguments, &file, &cancelled)
        }
    })
}

/// Says what of the scene's files was left out.
pub(crate) fn tell_notices(file: &SceneFile) {
    for notice in file.notices() {
        line(&format!("notice: {notice}"));
    }
}

/// With the channels that the scene has.
fn render<S: Spectrum>(
    arguments: &RenderArguments,
    file: &SceneFile,
    cancelled: &AtomicBool,
) -> Result<(), Error> {
    let config = file.integrator();
    let name = arguments.integrator.as_ref().unwrap_or(&config.name);
    let integrator = integrator(name, config).ok_or_else(|| Error::UnknownIntegrator {
        scene: arguments.scene.clone(),
        name: name.clone(),
    })?;
    let begins_anew = |(key, value): &(_, String)| *key == "statistics" && value == "true";
    if arguments.first_pass > 0 && integrator.options_any().iter().any(begins_anew) {
        let scene = arguments.scene.clone();
        return Err(Error::Statistics { scene });
    }
    for sentence in unheeded(name, integrator.as_ref(), config) {
        line(&format!("note: {sentence}"));
    }
    let checkpoint = Checkpoint::beside(
        &arguments.output,
        Identity {
            version: env!("CARGO_PKG_VERSION").into(),
            scene: fingerprint(file, &arguments.set)?,
            integrator: describe(name, integrator.as_ref()),
            seed: arguments.seed,
            first_pass: arguments.first_pass,
        },
    );
    let earlier = earlier(arguments, &checkpoint)?;
    let scene = file.build::<S>()?;
    let mut render = Render::new(&scene, integrator.as_ref())
        .seed(arguments.seed)
        .first_pass(arguments.first_pass)
        .cancelled_by(cancelled);
    if let Some(snapshot) = earlier {
        render = render.resume(snapshot);
    }
    let budget = arguments
        .budget()
        .unwrap_or(Budget::Passes(config.passes.unwrap_or(PASSES)));
    let mut keeper = Keeper::new(&checkpoint, arguments.checkpoint_interval);
    let snapshot = passes(arguments, render, budget, &mut keeper)?;
    let interrupted = cancelled.load(Ordering::Relaxed);
    let metadata = Metadata {
        scene: arguments.scene.display().to_string(),
        notes: image::notes(biases(name, config), snapshot.film(), interrupted),
        ..metadata(&checkpoint, &snapshot)
    };
    let written = image::write(arguments, &scene, snapshot.film(), &metadata);
    if !interrupted && written.is_ok() {
        keeper.finish(message);
    } else if keeper.keep(&snapshot, message) {
        let path = checkpoint.path().display();
        message(&format!("note: {path} holds the passes: --resume goes on"));
    }
    written?;
    message(&format!(
        "{}: {} passes in {:.1} s, relative error {:.2} %",
        arguments.output.display(),
        metadata.passes,
        metadata.seconds,
        100.0 * snapshot.film().relative_error(),
    ));
    image::tell(&metadata);
    Ok(())
}

/// How the image of a render came to be.
fn metadata<S: Spectrum>(checkpoint: &Checkpoint, snapshot: &Snapshot<S>) -> Metadata {
    let Identity {
        version,
        integrator,
        seed,
        first_pass,
        ..
    } = checkpoint.identity().clone();
    Metadata {
        fingerprint: checkpoint.fingerprint(),
        integrator,
        seed,
        first_pass,
        passes: snapshot.film().passes(),
        seconds: snapshot.elapsed().as_secs_f64(),
        version,
        non_finite: snapshot.film().non_finite(),
        figures: snapshot.figures().to_vec(),
        ..Metadata::default()
    }
}

/// What an earlier render of the same image left, if it is to be continued.
fn earlier<S: Spectrum>(
    arguments: &RenderArguments,
    checkpoint: &Checkpoint,
) -> Result<Option<Snapshot<S>>, Error> {
    let path = checkpoint.path().display();
    if !arguments.resume {
        if checkpoint.path().exists() {
            message(&format!(
                "note: {path} of an earlier render is replaced; --resume would have continued it"
            ));
        }
        return Ok(None);
    }
    let snapshot = checkpoint.read()?;
    match &snapshot {
        None => message(&format!("note: {path} is not there: starting afresh")),
        Some(snapshot) => message(&format!(
            "{path}: going on after {} passes",
            snapshot.film().passes()
        )),
    }
    Ok(snapshot)
}

/// Renders until the budget is spent, with a bar, checkpoints, and tev if it is asked for.
fn passes<S: Spectrum>(
    arguments: &RenderArguments,
    render: Render<'_, Scene<S>>,
    budget: Budget,
    keeper: &mut Keeper<'_>,
) -> Result<Snapshot<S>, Error> {
    let bar = Bar::new();
    let mut preview = arguments.tev.as_ref().map(|address| {
        let name = arguments.output.display().to_string();
        Preview::start::<S>(address.clone(), name, bar.speaker())
    });
    let watch = |share| bar.within(share);
    let snapshot = render.watched_by(&watch).advance(budget, |progress| {
        bar.report(progress);
        if let Some(preview) = &mut preview {
            preview.show(progress.snapshot.film());
        }
        keeper.after_pass(progress.snapshot, bar.speaker());
    });
    let snapshot = snapshot.map_err(|error| Error::render(&arguments.scene, error))?;
    if let Some(preview) = preview {
        preview.finish(snapshot.film());
    }
    Ok(snapshot)
}
