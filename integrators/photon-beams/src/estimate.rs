//! Which estimator takes the light of media.

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
    /// [`BeamPoint2D`](crate::estimators::BeamPoint2D), at points marched along the ray.
    BeamPoint2D,
    /// [`BeamPoint3D`](crate::estimators::BeamPoint3D), at points marched along the ray.
    BeamPoint3D,
    /// [`BeamBeam1D`](crate::estimators::BeamBeam1D), and
    /// [`BeamBeam2DRay`](crate::estimators::BeamBeam2DRay) for beams almost parallel to the ray:
    /// the shares of the two are a smooth function of the angle, and sum to one.
    #[default]
    BeamBeam1D,
    /// [`BeamBeam2DRay`](crate::estimators::BeamBeam2DRay): 2D₁.
    BeamBeam2DRay,
    /// [`BeamBeam2DBeam`](crate::estimators::BeamBeam2DBeam): 2D₂.
    BeamBeam2DBeam,
    /// [`BeamBeam3D`](crate::estimators::BeamBeam3D).
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

/// How far a beam goes, of light or of sight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Extent {
    /// To the next surface, attenuated by the transmittance on the way: the less noise.
    Long,
    /// No farther than light flies until it collides, and as bright all along: a free flight is an
    /// estimate of the transmittance, to all distances at once.
    Short,
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Long => "long",
            Self::Short => "short",
        })
    }
}
