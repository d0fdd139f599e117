//! `tyndall inspect` of volumes, and `tyndall volume convert`.

mod convert;
mod inspect;
mod peer;
mod sample;
