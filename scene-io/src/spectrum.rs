//! From the colours of a file to the channels of a scene.

use tyndall_core::{Rgb, Spectrum};

/// The same colour in other channels: the mean if there is but one.
pub(crate) fn convert<S: Spectrum>(colour: Rgb) -> S {
    if S::CHANNELS == Rgb::CHANNELS {
        S::from_channels(|i| colour.channel(i))
    } else if is_grey(colour) {
        // Without a sum, which may overflow.
        S::splat(colour.channel(0))
    } else {
        S::splat(colour.mean())
    }
}

/// Whether all channels are equal.
pub(crate) fn is_grey(colour: Rgb) -> bool {
    let Rgb(c) = colour;
    c.x == c.y && c.y == c.z
}
