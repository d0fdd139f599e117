//! What goes wrong, how it is said and which exit code it has.

use crate::checkpoint::CheckpointError;
use crate::diff::Mismatch;
use crate::integrators::INTEGRATORS;
use crate::merge::Refusal;
use crate::progress::{line, message};
use miette::{Diagnostic, MietteHandlerOpts};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tyndall_core::PassError;
use tyndall_driver::{DifferentResolution, RenderError};

/// Why a command failed.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub(crate) enum Error {
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] tyndall_scene_io::Error),
    #[error("{0}")]
    CommandLine(String),
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    #[error("{}: `integrator.kind`: no integrator is called `{name}`: choose one of {}", scene.display(), INTEGRATORS.join(", "))]
    UnknownIntegrator { scene: PathBuf, name: String },
    #[error("{}: `integrator.memory`: a pass needs more than the {} MiB granted: raise it, or lower `integrator.paths`", scene.display(), allowed >> 20)]
    Memory { scene: PathBuf, allowed: u64 },
    #[error("{}: {why}", scene.display())]
    Unsupported { scene: PathBuf, why: String },
    #[error(
        "{}: `integrator.statistics`: radii by statistics begin anew in every part of a render: remove it, or --first-pass",
        scene.display()
    )]
    Statistics { scene: PathBuf },
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error(transparent)]
    Mismatch(#[from] Mismatch),
    #[error(transparent)]
    Refusal(#[from] Refusal),
    #[error(transparent)]
    Merge(#[from] DifferentResolution),
    #[error("the threads could not be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    #[error("Ctrl-C could not be watched for: {0}")]
    Interrupt(#[from] ctrlc::Error),
    #[error("the standard output cannot be written: {0}")]
    Output(#[from] std::io::Error),
}

impl Error {
    /// Why a render of a scene file failed.
    pub(crate) fn render(scene: &Path, error: RenderError) -> Self {
        let scene = scene.to_owned();
        match error {
            RenderError::Pass(PassError::Memory { allowed, .. }) => Self::Memory { scene, allowed },
            RenderError::Pass(PassError::Unsupported(why)) => Self::Unsupported { scene, why },
            error => error.into(),
        }
    }

    /// Says it: on a terminal with the line of the scene file, elsewhere in one line.
    pub(crate) fn report(self) -> ExitCode {
        let code = self.code();
        if std::io::stderr().is_terminal() {
            // Messages name their causes themselves. A hook that is set already is as good.
            let _ = miette::set_hook(Box::new(|_| {
                Box::new(MietteHandlerOpts::new().without_cause_chain().build())
            }));
            message(&format!("{:?}", miette::Report::new(self)));
        } else {
            line(&format!("error: {self}"));
        }
        code
    }

    fn code(&self) -> ExitCode {
        use tyndall_scene_io::Error as Scene;
        ExitCode::from(match self {
            Self::Scene(Scene::Write { .. }) | Self::Output(_) => 4,
            Self::Scene(_)
            | Self::UnknownIntegrator { .. }
            | Self::Memory { .. }
            | Self::Unsupported { .. }
            | Self::Statistics { .. } => 3,
            Self::CommandLine(_) => 2,
            Self::Checkpoint(_) => 5,
            _ => 1,
        })
    }
}
