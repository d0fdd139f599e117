//! glTF files, written by the tests themselves, seen through the traits of the host.

mod broken;
mod builder;
mod cameras;
mod faults;
mod geometry;
mod includes;
mod lights;
mod materials;
mod nodes;
mod notices;
