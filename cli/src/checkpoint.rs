//! `OUT.exr.checkpoint`: what a render leaves behind to be continued.
//!
//! The file: 8 bytes of magic, the format's number (`u32`), the length of the body (`u64`), its
//! BLAKE3 checksum (32 bytes), all little-endian; then the body in postcard: an [`Identity`] and a
//! [`Snapshot`]. It is written beside itself and renamed, so that there is a whole one at any time.

use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use tyndall_core::Spectrum;
use tyndall_driver::Snapshot;
use tyndall_scene_io::{Backend, SceneFile};

const MAGIC: &[u8; 8] = b"TYNDALL\x1a";
const FORMAT: u32 = 2;
const HEADER: usize = 8 + 4 + 8 + 32;

/// All that determines the bits of a render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Identity {
    pub(crate) version: String,
    /// Of the scene, see [`fingerprint`].
    pub(crate) scene: [u8; 32],
    /// The integrator and its options.
    pub(crate) integrator: String,
    pub(crate) seed: u64,
    pub(crate) first_pass: u64,
}

/// A checksum of the bytes of all files of a scene, its overrides, and what traces its rays.
pub(crate) fn fingerprint(
    scene: &SceneFile,
    overrides: &[(String, String)],
) -> Result<[u8; 32], tyndall_scene_io::Error> {
    let mut hasher = blake3::Hasher::new();
    for path in scene.sources() {
        let hashed = match File::open(path) {
            // A scene may do without the MTL files that it names.
            Err(e) if e.kind() == ErrorKind::NotFound => {
                hasher.update(&u64::MAX.to_le_bytes());
                Ok(())
            }
            opened => opened.and_then(|file| {
                hasher.update(&file.metadata()?.len().to_le_bytes());
                hasher.update_reader(file).map(drop)
            }),
        };
        hashed.map_err(|source| tyndall_scene_io::Error::Read {
            path: path.clone(),
            source,
        })?;
    }
    let backend = format!("{:?}", Backend::default());
    let pairs = overrides.iter().flat_map(|(key, value)| [key, value]);
    for text in pairs.chain([&backend]) {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    }
    Ok(hasher.finalize().into())
}

/// Why there is no going on from a checkpoint.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub(crate) struct CheckpointError {
    path: PathBuf,
    problem: String,
}

/// The checkpoint of a render.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    path: PathBuf,
    identity: Identity,
}

impl Checkpoint {
    /// That of the render that writes `output`.
    pub(crate) fn beside(output: &Path, identity: Identity) -> Self {
        let path = with_suffix(output, ".checkpoint");
        Self { path, identity }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Of the scene, as text.
    pub(crate) fn fingerprint(&self) -> String {
        blake3::Hash::from_bytes(self.identity.scene).to_string()
    }

    /// What was left there by this same render; `None` if nothing was.
    pub(crate) fn read<S: Spectrum>(&self) -> Result<Option<Snapshot<S>>, CheckpointError> {
        let error = |problem: String| CheckpointError {
            path: self.path.clone(),
            problem,
        };
        let body = match File::open(&self.path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
            opened => opened.and_then(read_body),
        };
        let body = body
            .map_err(|e| {
                error(format!(
                    "cannot be read: {e}: remove it, or render without --resume"
                ))
            })?
            .map_err(|what| error(format!("{what}: remove it, or render without --resume")))?;
        let damaged = |_| error("is damaged: remove it, or render without --resume".into());
        let (identity, rest) = postcard::take_from_bytes::<Identity>(&body).map_err(damaged)?;
        if let Some(mend) = self.identity.difference(&identity) {
            return Err(error(mend));
        }
        postcard::from_bytes(rest).map_err(damaged).map(Some)
    }

    /// Replaces what is there.
    pub(crate) fn write<S: Spectrum>(&self, snapshot: &Snapshot<S>) -> io::Result<()> {
        let partial = with_suffix(&self.path, ".partial");
        let written = self.write_to(&partial, snapshot);
        let renamed = written.and_then(|()| fs::rename(&partial, &self.path));
        if renamed.is_err() {
            // It may not be there; the first error is the one to tell.
            let _ = fs::remove_file(&partial);
        }
        renamed?;
        sync_folder(&self.path)
    }

    fn write_to<S: Spectrum>(&self, path: &Path, snapshot: &Snapshot<S>) -> io::Result<()> {
        let mut file = BufWriter::new(File::create(path)?);
        file.write_all(&[0; HEADER])?;
        let mut body = Hashing {
            inner: &mut file,
            hasher: blake3::Hasher::new(),
            length: 0,
            failure: None,
        };
        let body = match postcard::to_io(&(&self.identity, snapshot), &mut body) {
            Ok(_) => body,
            Err(e) => return Err(body.failure.unwrap_or_else(|| io::Error::other(e))),
        };
        let mut header = Vec::with_capacity(HEADER);
        header.extend(MAGIC);
        header.extend(FORMAT.to_le_bytes());
        header.extend(body.length.to_le_bytes());
        header.extend(body.hasher.finalize().as_bytes());
        file.rewind()?;
        file.write_all(&header)?;
        file.flush()?;
        file.get_ref().sync_all()
    }

    /// The render is done.
    pub(crate) fn remove(&self) -> io::Result<()> {
        match fs::remove_file(&self.path) {
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
            removed => removed,
        }
    }
}

impl Identity {
    /// In what the render that left `other` differs from this, and the mend.
    fn difference(&self, other: &Self) -> Option<String> {
        if self.version != other.version {
            return Some(format!(
                "was left by tyndall {}, and this is {}: finish it with that version, or render \
                 without --resume",
                other.version, self.version
            ));
        }
        if self.scene != other.scene {
            return Some(
                "is of another scene, or the scene's files or overrides (--set) have changed since: \
                 restore them, or render without --resume"
                    .into(),
            );
        }
        if self.integrator != other.integrator {
            return Some(format!(
                "is of a render by {}, and this is by {}: ask for that, or render without --resume",
                other.integrator, self.integrator
            ));
        }
        let numbers = [
            ("seed", self.seed, other.seed),
            ("first-pass", self.first_pass, other.first_pass),
        ];
        let different = numbers.into_iter().find(|(_, ours, theirs)| ours != theirs);
        different.map(|(flag, ours, theirs)| {
            format!(
                "is of a render with --{flag} {theirs}, and this has {ours}: add --{flag} {theirs}, \
                 or render without --resume"
            )
        })
    }
}

/// The body of a checkpoint, or what is wrong with it.
fn read_body(mut file: File) -> io::Result<Result<Vec<u8>, &'static str>> {
    let length = file.metadata()?.len();
    let mut header = [0; HEADER];
    if length < HEADER as u64 {
        return Ok(Err("is no checkpoint, or cut off"));
    }
    file.read_exact(&mut header)?;
    let (magic, rest) = header.split_at(8);
    let (format, rest) = rest.split_at(4);
    let (body_length, checksum) = rest.split_at(8);
    if magic != MAGIC {
        return Ok(Err("is no checkpoint"));
    }
    if format != FORMAT.to_le_bytes() {
        return Ok(Err("is a checkpoint of another version of tyndall"));
    }
    if body_length != (length - HEADER as u64).to_le_bytes() {
        return Ok(Err("is cut off"));
    }
    let mut body = Vec::new();
    file.read_to_end(&mut body)?;
    if blake3::hash(&body).as_bytes() != checksum {
        return Ok(Err("is damaged: its checksum is wrong"));
    }
    Ok(Ok(body))
}

/// Counts and hashes what passes through it.
struct Hashing<W> {
    inner: W,
    hasher: blake3::Hasher,
    length: u64,
    /// Why writing failed, which postcard does not tell.
    failure: Option<io::Error>,
}

impl<W: Write> Write for Hashing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.inner.write(bytes) {
            Ok(n) => {
                self.hasher.update(&bytes[..n]);
                self.length += n as u64;
                Ok(n)
            }
            Err(e) => {
                let kind = e.kind();
                self.failure = Some(e);
                Err(kind.into())
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

/// Makes a renaming last through a loss of power, where folders can be synchronised.
fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) {
        let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
        File::open(folder.unwrap_or(Path::new(".")))?.sync_all()?;
    }
    Ok(())
}
