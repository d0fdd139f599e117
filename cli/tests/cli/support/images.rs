//! Images as `tyndall render` writes them, and the command to feed them to.

use assert_cmd::Command;
use std::process::Output;
use tempfile::TempDir;
use tyndall_core::Spectrum;
use tyndall_scene_io::{Metadata, RenderOutput, write_exr};

/// Runs the command in a folder.
pub(crate) fn tyndall(folder: &TempDir, arguments: &[&str]) -> Output {
    Command::cargo_bin("tyndall")
        .expect("the command is built")
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the command runs")
}

pub(crate) fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// All of an image but its radiance.
#[derive(Clone)]
pub(crate) struct Picture {
    pub(crate) size: [u32; 2],
    pub(crate) variance: Vec<f32>,
    pub(crate) metadata: Metadata,
}

impl Picture {
    pub(crate) fn new(size: [u32; 2]) -> Self {
        Self {
            size,
            variance: vec![0.0; (size[0] * size[1]) as usize],
            metadata: Metadata {
                scene: "mist.toml".into(),
                fingerprint: "0123".into(),
                integrator: "path".into(),
                seconds: 1.5,
                ..Metadata::default()
            },
        }
    }

    /// With passes `first` to `first + count − 1` of a seed.
    pub(crate) fn passes(mut self, seed: u64, first: u64, count: u64) -> Self {
        let metadata = &mut self.metadata;
        (metadata.seed, metadata.first_pass, metadata.passes) = (seed, first, count);
        self
    }

    /// With this variance of the mean in every channel.
    pub(crate) fn variance(mut self, variance: &[f32]) -> Self {
        self.variance = variance.to_vec();
        self
    }

    pub(crate) fn write<S: Spectrum>(&self, folder: &TempDir, name: &str, radiance: &[S]) {
        let variance: Vec<S> = self.variance.iter().map(|&v| S::splat(v)).collect();
        let output = RenderOutput {
            width: self.size[0],
            height: self.size[1],
            radiance,
            variance: &variance,
            features: None,
            view: None,
            metadata: &self.metadata,
        };
        write_exr(&folder.path().join(name), &output).expect("the folder is writable");
    }
}
