//! The tyndall command: renders scenes with participating media.

fn main() {}
