//! The names of the estimators in media.

use std::fmt;

/// How light in media is kept, asked for and blurred: data × query, and over how many dimensions
/// (Jarosz et al. 2011a, "A Comprehensive Theory of Volumetric Radiance Estimation Using Photon
/// Points and Beams").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Estimate {
    /// Photons, at points marched along the ray: volumetric photon mapping.
    PointPoint3D,
    /// Photons as discs, along the whole ray: the beam radiance estimate.
    PointBeam2D,
    /// Photons as balls, along the whole ray.
    PointBeam3D,
    /// Beams, where a point passes them, at points marched along the ray.
    BeamPoint2D,
    /// Beams, over their chords in the ball around a point, at points marched along the ray.
    BeamPoint3D,
    /// Beams, where a ray passes them: blurred across both.
    #[default]
    BeamBeam1D,
    /// Beams as cylinders, over the chord of the ray: 2D₁.
    BeamBeam2DRay,
    /// Beams, over their chords in the cylinder around the ray: 2D₂.
    BeamBeam2DBeam,
    /// Beams, over all pairs of their places with those of the ray.
    BeamBeam3D,
}

impl Estimate {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::PointPoint3D,
        Self::PointBeam2D,
        Self::PointBeam3D,
        Self::BeamPoint2D,
        Self::BeamPoint3D,
        Self::BeamBeam1D,
        Self::BeamBeam2DRay,
        Self::BeamBeam2DBeam,
        Self::BeamBeam3D,
    ];

    /// Whether light in media is kept as beams.
    pub fn takes_beams(self) -> bool {
        !matches!(
            self,
            Self::PointPoint3D | Self::PointBeam2D | Self::PointBeam3D
        )
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PointPoint3D => "point_point_3d",
            Self::PointBeam2D => "point_beam_2d",
            Self::PointBeam3D => "point_beam_3d",
            Self::BeamPoint2D => "beam_point_2d",
            Self::BeamPoint3D => "beam_point_3d",
            Self::BeamBeam1D => "beam_beam_1d",
            Self::BeamBeam2DRay => "beam_beam_2d_ray",
            Self::BeamBeam2DBeam => "beam_beam_2d_beam",
            Self::BeamBeam3D => "beam_beam_3d",
        })
    }
}
