//! The command as a person runs it.

mod bad_inputs;
mod diff;
mod inspect;
mod merge;
mod parts;
mod photons;
mod render;
mod resume;
mod support {
    pub(crate) mod images;
    pub(crate) mod volumes;
}
mod tev;
mod volume;
