//! Scenes, the files that they are made of, and images to files and back.

mod conformance;
mod demos;
mod environment;
mod errors;
mod excerpts;
mod features;
mod film;
mod gltf;
mod images;
mod lights;
mod limits;
mod mtl;
mod nano_vdb;
mod open_vdb;
mod rendered;
mod scenes;
mod sources;
mod support {
    pub(crate) mod sky;
    pub(crate) mod textured;
}
mod textures;
mod volume_written;
mod volumes;
