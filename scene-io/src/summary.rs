//! What a scene holds, for people and programs.

mod geometry;
mod lights;
mod media;
mod transport;
mod volume;

pub use geometry::GeometrySummary;
pub use lights::LightSummary;
pub use media::MediumSummary;
pub use transport::{Caustics, Needed, TransportSummary};
pub use volume::{GridSummary, VolumeSummary, VoxelSummary};

use crate::{Scene, SceneFile};
use glam::{DVec3, Vec3};
use serde::Serialize;
use tyndall_core::{Aabb, Spectrum};

/// What a scene holds and which transport it needs. Points are those of the scene file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Summary {
    /// Channels that it is rendered with: 1 if every colour is grey, else 3.
    pub channels: usize,
    /// Smallest and largest corner of all surfaces and lamps; `None` if there are none.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Surfaces.
    pub geometry: GeometrySummary,
    /// Lights by kind.
    pub lights: Vec<LightSummary>,
    /// Media by name.
    pub media: Vec<MediumSummary>,
    /// The camera.
    pub camera: CameraSummary,
    /// Bytes of grids, as the file has them.
    pub grid_bytes: u64,
    /// Bytes of textures.
    pub texture_bytes: u64,
    /// What an integrator has to do.
    pub transport: TransportSummary,
    /// What of the files was left out, see [`SceneFile::notices`].
    pub notices: Vec<String>,
}

/// The camera of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CameraSummary {
    /// Where it is.
    pub position: [f64; 3],
    /// Width and height of the picture, in pixels.
    pub resolution: [u32; 2],
    /// Names of the media around it, with ` + ` between; `None` in vacuum.
    pub medium: Option<String>,
}

impl Summary {
    /// Of a scene and the file that it was built from.
    pub fn new<S: Spectrum>(file: &SceneFile, scene: &Scene<S>) -> Self {
        let around = scene.boundaries.filling(scene.camera_medium);
        let camera = CameraSummary {
            position: (file.camera.position().as_dvec3() + file.origin).to_array(),
            resolution: file.camera.resolution(),
            medium: (!around.is_empty()).then(|| file.filling_name(around)),
        };
        let lights = lights::summarise(scene);
        let media = media::summarise(file, scene);
        let geometry = geometry::summarise(file);
        let transport = transport::judge(file, scene, &media, &geometry);
        Self {
            channels: if file.is_grey() { 1 } else { 3 },
            bounds: corners(scene.bounds, file.origin),
            geometry,
            lights,
            camera,
            grid_bytes: media.iter().map(|m| m.grid_bytes).sum(),
            texture_bytes: geometry::texture_bytes(file),
            media,
            transport,
            notices: file.notices().to_vec(),
        }
    }
}

fn corners(bounds: Aabb, origin: DVec3) -> Option<[[f64; 3]; 2]> {
    let corner = |p: Vec3| (p.as_dvec3() + origin).to_array();
    (!bounds.is_empty()).then(|| [corner(bounds.min), corner(bounds.max)])
}
