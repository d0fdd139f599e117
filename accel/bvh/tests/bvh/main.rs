//! Discs and beams against brute force in `f64`, and trees over other boxes.

mod beams;
mod boxes;
mod discs;
mod oracle;
mod scenes;
