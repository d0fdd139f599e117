//! What buffers and images are called: data in place, or files beside the glTF.

use crate::files::Files;
use base64::Engine;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, PAD};
use percent_encoding::percent_decode_str;

/// Some exporters leave out what pads base64.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    PAD.with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The bytes behind a URI, relative to `files`; or what is wrong with it.
pub(super) fn read(files: &Files, uri: &str) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = (data.split_once(";base64,"))
            .ok_or("is a data URI that is not base64: export again")?;
        let decoded = BASE64.decode(text);
        return decoded.map_err(|e| format!("is no base64 ({e}): export again"));
    }
    if has_scheme(uri) {
        let start: String = uri.chars().take(40).collect();
        return Err(format!(
            "{start:?} is not beside this file: download it and name it relative to this file"
        ));
    }
    let decoded = percent_decode_str(uri).decode_utf8();
    let name = decoded.map_err(|_| "is not UTF-8: rename the file, and export again")?;
    let path = files.named(&*name);
    let cannot = |why: String| {
        let path = path.display();
        format!("{path} cannot be read ({why}): put it there, or export with embedded data")
    };
    // A device or a pipe may never end.
    let about = std::fs::metadata(&path).map_err(|e| cannot(e.to_string()))?;
    if !about.is_file() {
        return Err(cannot("it is no file".into()));
    }
    std::fs::read(&path).map_err(|e| cannot(e.to_string()))
}

/// Whether it starts as `http:` does; one letter is a drive of Windows.
fn has_scheme(uri: &str) -> bool {
    let Some((scheme, _)) = uri.split_once(':') else {
        return false;
    };
    scheme.len() > 1
        && scheme
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
}
