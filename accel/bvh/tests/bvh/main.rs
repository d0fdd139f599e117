//! Discs against brute force in `f64`, and trees over other boxes.

mod boxes;
mod discs;
mod oracle;
mod scenes;
