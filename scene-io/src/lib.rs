#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod boundary;
mod camera;
mod environment_image;
mod error;
mod features;
mod file;
mod files;
mod gltf;
mod host;
mod image_out;
mod light;
mod locate;
mod look;
mod mapping;
mod material;
mod media;
mod obj;
mod open;
mod rendered;
mod scene;
mod spectrum;
mod srgb;
mod summary;
mod texture;
mod vol;
mod volume;

pub use error::{Error, Place};
pub use features::Features;
pub use file::{IntegratorConfig, PhotonConfig, Scattering, SceneFile};
pub use host::{Hit, Presence};
pub use image_out::{
    Metadata, PassRange, RenderOutput, TooManyPasses, View, check_writable, write_exr, write_png,
};
pub use material::{fresnel_conductor, fresnel_dielectric};
pub use rendered::{RenderedImage, read_exr};
pub use scene::Scene;
pub use srgb::srgb_encode;
pub use summary::{
    CameraSummary, Caustics, GeometrySummary, GridSummary, LightSummary, MediumSummary, Needed,
    Summary, TransportSummary, VolumeSummary, VoxelSummary,
};
pub use tyndall_surface::Backend;
pub use vol::{Volume, read_vol, write_vol};
pub use volume::{
    ConversionError, GridClass, NanoCodec, VolumeFormat, VolumeGrid, Voxels, read_grids,
    read_volume, write_nano_vdb, write_open_vdb,
};
