//! What is wrong with the numbers of a medium.

use glam::Vec3;
use thiserror::Error;

/// Why a medium or a phase function could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MediumError {
    /// A coefficient is negative, not finite, or overflows with the others.
    #[error(
        "`{field}` of channel {channel} is {value}; make it finite and at least 0 (and so that extinction does not overflow)"
    )]
    Coefficient {
        /// Which coefficient.
        field: &'static str,
        /// In which channel.
        channel: usize,
        /// Its value.
        value: f32,
    },
    /// The mean cosine is out of range.
    #[error("`g` is {g}; make it at most 0.999 either way")]
    Asymmetry {
        /// The mean cosine asked for.
        g: f32,
    },
    /// The nodes of a tabulated phase function are unusable.
    #[error(
        "`cosines` of a tabulated phase function must rise strictly from -1 to 1, one for each of `values`; node {node} does not"
    )]
    TableCosines {
        /// The first bad node.
        node: usize,
    },
    /// A value of a tabulated phase function is negative or not finite, or all are zero.
    #[error(
        "`values` of a tabulated phase function must be finite, at least 0 and not all 0; node {node} is {value}"
    )]
    TableValue {
        /// The first bad node.
        node: usize,
        /// Its value.
        value: f32,
    },
    /// A weight of a blend is negative or not finite, or there is none above zero.
    #[error(
        "weights of blended phase functions must be finite, at least 0 and not all 0; number {index} is {weight}"
    )]
    BlendWeight {
        /// The first bad component.
        index: usize,
        /// Its weight.
        weight: f32,
    },
    /// The box of a grid has no volume or no end.
    #[error(
        "`bounds` of a grid must have a volume; make every edge longer than 1e-18 and shorter than 1e18"
    )]
    GridBounds,
    /// A grid so dense that tracking would take for ever.
    #[error(
        "a ray through a grid may cross up to {depth} mean free paths; make it thinner or smaller, to \
         keep them below {limit}", limit = MediumError::DENSEST
    )]
    TooDense {
        /// A bound of the optical depth along any ray.
        depth: f32,
    },
    /// The number of values is not the number of voxels, or there are none.
    #[error(
        "a grid of {} x {} x {} voxels was given {values} values; give one for each voxel, x fastest",
        .resolution[0], .resolution[1], .resolution[2]
    )]
    GridValues {
        /// Voxels in each axis.
        resolution: [usize; 3],
        /// Values given.
        values: usize,
    },
    /// The transformation of a grid has no inverse.
    #[error("the transformation of a grid has no inverse or is not finite; scale no axis by 0")]
    Transform,
    /// A sparse grid that no dense one equals.
    #[error(
        "a grid whose voxels are turned, sheared or mirrored has no dense form; keep it sparse"
    )]
    NotAligned,
    /// A block of a sparse grid is out of place.
    #[error(
        "a block of {edge} voxels an edge at {origin:?} is taken, or not at a multiple of its edge"
    )]
    Block {
        /// Its first voxel.
        origin: [i32; 3],
        /// Voxels along an edge.
        edge: i32,
    },
    /// A voxel is negative or not finite.
    #[error(
        "voxel {voxel:?} of a grid is {value} in channel {channel}; make it finite and at least 0"
    )]
    Voxel {
        /// The first bad voxel, \[x, y, z\].
        voxel: [i32; 3],
        /// The first bad channel in it.
        channel: usize,
        /// Its value.
        value: f32,
    },
    /// The background of a sparse grid is negative or not finite.
    #[error(
        "the background of a grid is {value} in channel {channel}; make it finite and at least 0"
    )]
    Background {
        /// The first bad channel.
        channel: usize,
        /// Its value.
        value: f32,
    },
    /// A density that is not zero outside of some box of finite `f32`.
    #[error("a density goes on without end; make its background 0, or scale it down")]
    Endless,
    /// A sparse grid is empty, or too large to be dense.
    #[error(
        "a sparse grid of {resolution:?} voxels (with one of background around) has no dense form of \
         at most {limit} values; keep it sparse", limit = MediumError::MOST_VALUES
    )]
    NotDense {
        /// How many along each axis; 0 if all are background.
        resolution: [usize; 3],
    },
    /// A temperature that no black body is tabulated at.
    #[error(
        "a black body of {temperature} K has no luminance to be relative to; make it 500 to 1e5 K"
    )]
    Temperature {
        /// The temperature asked for, K.
        temperature: f32,
    },
    /// The function of a mapped field falls, or has no finite value.
    #[error(
        "the function of a mapped field is {value} in channel {channel} after {before}; make it \
         finite, at least 0, and never fall where its argument rises"
    )]
    Falling {
        /// The first bad channel.
        channel: usize,
        /// Its value.
        value: f32,
        /// Its value for a smaller argument.
        before: f32,
    },
    /// An overlap of no media.
    #[error("an overlap needs a medium; give it at least one")]
    NoMedia,
    /// The scale height of an atmosphere is not a length.
    #[error("`scale_height` of an atmosphere is {scale_height}; make it positive and finite")]
    ScaleHeight {
        /// The scale height asked for.
        scale_height: f32,
    },
    /// An atmosphere is nowhere.
    #[error("`{field}` of an atmosphere is {value}; make it finite, and `up` longer than 0")]
    Placement {
        /// Which vector.
        field: &'static str,
        /// Its value.
        value: Vec3,
    },
    /// The bound of a procedural field is negative or not finite.
    #[error(
        "`majorant` of a procedural field is {value} in channel {channel}; make it finite and at least 0"
    )]
    Majorant {
        /// The first bad channel.
        channel: usize,
        /// Its value.
        value: f32,
    },
    /// A procedural field has no cells, or too many.
    #[error(
        "`resolution` of the bounds of a procedural field is {} x {} x {}; make it 1 to {limit} cells",
        .resolution[0], .resolution[1], .resolution[2], limit = MediumError::MOST_CELLS
    )]
    Cells {
        /// Cells along each axis.
        resolution: [usize; 3],
    },
    /// A procedural field leaves the bounds that are stated for it.
    #[error(
        "a procedural field is {value} in channel {channel} at {at}, where it is bounded by {least} \
         and {most}; widen its bounds (to what is finite and at least 0)"
    )]
    Overrun {
        /// The first bad channel.
        channel: usize,
        /// Its value.
        value: f32,
        /// Where.
        at: Vec3,
        /// The lower bound there.
        least: f32,
        /// The upper bound there.
        most: f32,
    },
    /// An albedo is above 1 somewhere.
    #[error("the albedo reaches {value} in channel {channel}; make it at most 1 everywhere")]
    Albedo {
        /// The first bad channel.
        channel: usize,
        /// Its largest value.
        value: f32,
    },
}

impl MediumError {
    /// Mean free paths along a ray from which on it is [`MediumError::TooDense`].
    pub const DENSEST: f32 = 1e7;
    /// Values from which on a dense grid is not made of a sparse one: [`MediumError::NotDense`].
    pub const MOST_VALUES: usize = 1 << 31;
    /// Cells of a procedural field from which on it has too many: [`MediumError::Cells`].
    pub const MOST_CELLS: usize = 1 << 24;
}
