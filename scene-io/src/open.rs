//! Opens the files that a scene or a command names.

use crate::Error;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// A file and its length in bytes.
///
/// # Errors
/// [`Error::Read`], also for what is no regular file: a pipe waits for who writes into it, and a
/// device may never end.
pub(crate) fn open(path: &Path) -> Result<(File, u64), Error> {
    let opened = || {
        let about = fs::metadata(path)?;
        if about.is_dir() {
            return Err(ErrorKind::IsADirectory.into());
        }
        if !about.is_file() {
            return Err(io::Error::other("is a device or a pipe; name a file"));
        }
        Ok((File::open(path)?, about.len()))
    };
    opened().map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })
}

/// The bytes of a file.
///
/// # Errors
/// As of [`open`].
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Error> {
    let (mut file, _) = open(path)?;
    let mut bytes = Vec::new();
    let read = file.read_to_end(&mut bytes);
    read.map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })?;
    Ok(bytes)
}
