//! What can go wrong between a file and a scene, and between an image and a file.

use miette::{Diagnostic, LabeledSpan, SourceCode};
use std::fmt;
use std::io::{self, ErrorKind};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a scene could not be loaded or an image not be written: one message that names the place, the
/// field and the mend. As a [`Diagnostic`] it also shows the line of the scene file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene file, or an override of one of its keys, asks for what cannot be.
    #[error("{place}: `{field}`: {problem}")]
    Scene {
        /// Where it is written.
        place: Place,
        /// The key, with dots from the root of the file.
        field: String,
        /// What is wrong and how to mend it.
        problem: String,
    },
    /// The scene file is no TOML.
    #[error("{place}: is not TOML: {problem}")]
    Syntax {
        /// Where reading stopped.
        place: Place,
        /// What was expected.
        problem: String,
    },
    /// A file could not be read.
    #[error("{}: cannot be read: {source}{}", path.display(), mend(source))]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A glTF file is broken, or asks for what cannot be.
    #[error("{}: `{field}`: {problem}", path.display())]
    Gltf {
        /// The file.
        path: PathBuf,
        /// Where in its JSON, as `meshes[2].primitives[0].indices`.
        field: String,
        /// What is wrong and how to mend it.
        problem: String,
    },
    /// A volume file is broken, or of a kind that is not read.
    #[error("{}: {problem}", path.display())]
    Volume {
        /// The file.
        path: PathBuf,
        /// What is wrong with which grid, and how to mend it.
        problem: String,
    },
    /// A file could not be written; what was there before is untouched.
    #[error("{}: cannot be written: {reason}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// The geometry as a whole cannot be rendered.
    #[error("{}: {problem}", path.display())]
    Build {
        /// The scene file.
        path: PathBuf,
        /// What is wrong and how to mend it.
        problem: String,
    },
}

/// What to do about a file that cannot be read, where that is known.
fn mend(reason: &io::Error) -> &'static str {
    match reason.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => "; check the name",
        ErrorKind::IsADirectory => "; name a file",
        ErrorKind::InvalidData => "; save it as UTF-8",
        ErrorKind::PermissionDenied => "; allow reading it",
        _ => "",
    }
}

impl Error {
    pub(crate) fn write(path: &Path, reason: impl fmt::Display) -> Self {
        Self::Write {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }

    /// Where in the scene file, if there.
    fn place(&self) -> Option<&Place> {
        match self {
            Self::Scene { place, .. } | Self::Syntax { place, .. } => Some(place),
            _ => None,
        }
    }
}

impl Diagnostic for Error {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        match self.place()? {
            Place::File { text, .. } => Some(text),
            Place::Override(_) => None,
        }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let Place::File { text, span, .. } = self.place()? else {
            return None;
        };
        // A table runs over many lines: the first one says which.
        let line = text.get(span.clone())?.lines().next().unwrap_or("");
        let label = LabeledSpan::new(None, span.start, line.len());
        Some(Box::new(std::iter::once(label)))
    }
}

/// Where a value is written.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// In a file; lines and columns count from 1.
    File {
        /// The scene file.
        path: Arc<str>,
        /// Line.
        line: usize,
        /// Column, in characters.
        column: usize,
        /// The whole file.
        text: Arc<str>,
        /// The bytes of the value, or of its key.
        span: Range<usize>,
    },
    /// In an override, as `key=value`.
    Override(Arc<str>),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File {
                path, line, column, ..
            } => write!(f, "{path}:{line}:{column}"),
            Self::Override(text) => write!(f, "override {text}"),
        }
    }
}
