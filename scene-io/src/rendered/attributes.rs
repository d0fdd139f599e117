//! How an image came to be, from the attributes of an EXR file.

use crate::{Metadata, PassRange};
use exr::meta::attribute::AttributeValue;
use exr::meta::header::Header;
use std::str::FromStr;
use tyndall_core::Figure;

/// Attributes `tyndall.*`; what is not there stays as [`Metadata::default`] has it.
pub(super) fn read(header: &Header) -> Result<Metadata, String> {
    let text = |key: &str| attribute(header, &format!("tyndall.{key}"));
    let metadata = Metadata {
        scene: text("scene"),
        fingerprint: text("fingerprint"),
        integrator: text("integrator"),
        seed: number("seed", &text("seed"))?,
        first_pass: number("first_pass", &text("first_pass"))?,
        passes: number("passes", &text("passes"))?,
        parts: parts(&text("parts"))?,
        seconds: number("seconds", &text("seconds"))?,
        version: text("version"),
        non_finite: number("non_finite", &text("non_finite"))?,
        figures: figures(&text("figures"))?,
        notes: text("notes").lines().map(str::to_owned).collect(),
    };
    let checked = metadata.check_passes();
    checked.map_err(|what| format!("{what}: render the image again"))?;
    Ok(metadata)
}

/// The text of an attribute; empty if there is none.
fn attribute(header: &Header, name: &str) -> String {
    let own = header.own_attributes.other.iter();
    let attributes = own.chain(&header.shared_attributes.other);
    let mut found = attributes.filter(|(key, _)| **key == *name);
    match found.next() {
        // EXR texts are bytes; ours are UTF-8.
        Some((_, AttributeValue::Text(text))) => {
            String::from_utf8_lossy(text.as_slice()).into_owned()
        }
        _ => String::new(),
    }
}

fn number<T: FromStr + Default>(key: &str, text: &str) -> Result<T, String> {
    if text.is_empty() {
        return Ok(T::default());
    }
    text.parse().map_err(|_| {
        format!("its attribute `tyndall.{key}` is {text:?}, no number: render the image again")
    })
}

fn parts(text: &str) -> Result<Vec<PassRange>, String> {
    let parts: Result<_, String> = text.lines().map(str::parse).collect();
    parts.map_err(|e| format!("its attribute `tyndall.parts` is damaged: {e}"))
}

fn figures(text: &str) -> Result<Vec<Figure>, String> {
    let figures: Result<_, _> = text.lines().map(str::parse).collect();
    figures.map_err(|e| {
        format!("its attribute `tyndall.figures` is damaged: {e}: render the image again")
    })
}
