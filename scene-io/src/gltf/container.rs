//! The binary container, `.glb`: a header, a chunk of JSON, a chunk of bytes.

use super::document::error;
use crate::Error;
use std::path::Path;

const JSON: &[u8] = b"JSON";
const BIN: &[u8] = b"BIN\0";

/// The JSON of a file, and the bytes that come with it in a `.glb`.
pub(super) fn split<'a>(
    path: &Path,
    bytes: &'a [u8],
) -> Result<(&'a [u8], Option<&'a [u8]>), Error> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let fault = |problem: String| error(path, "GLB", problem);
    let cut_off = || fault("the file is cut off: copy or export it again".into());
    let version = number(bytes, 4).ok_or_else(cut_off)?;
    if version != 2 {
        return Err(fault(format!(
            "is of version {version}: export as glTF 2.0"
        )));
    }
    let length = number(bytes, 8).ok_or_else(cut_off)? as usize;
    let mut rest = bytes.get(12..length).ok_or_else(cut_off)?;
    let (kind, json) = chunk(&mut rest).ok_or_else(cut_off)?;
    if kind != JSON {
        return Err(fault("its first chunk is not JSON: export again".into()));
    }
    let bin = match rest {
        [] => None,
        _ => Some(chunk(&mut rest).ok_or_else(cut_off)?),
    };
    Ok((
        json,
        bin.filter(|(kind, _)| *kind == BIN).map(|(_, bin)| bin),
    ))
}

/// The kind and the data of the next chunk.
fn chunk<'a>(rest: &mut &'a [u8]) -> Option<(&'a [u8], &'a [u8])> {
    let length = number(rest, 0)? as usize;
    let (head, after) = rest.split_at_checked(8)?;
    let (data, after) = after.split_at_checked(length)?;
    *rest = after;
    Some((&head[4..], data))
}

fn number(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at + 4)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}
