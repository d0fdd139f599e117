//! How wide beams are.

use crate::pass::List;
use glam::Vec3;
use rayon::prelude::*;
use std::f64::consts::PI;
use tyndall_bvh::BeamShape;
use tyndall_core::PassError;
use tyndall_density::Dimension;
use tyndall_kd_tree::{Nearest, Photon, Photons};
use tyndall_photons::{Neighbours, ensure, unsupported};
use tyndall_walk::Footprint;

/// Over the largest radius, the smallest: where light comes to a focus, and for what is parallel.
const LEAST: f32 = 1.0 / 32.0;
/// Ends that the nearest are looked for among, at least: any others are those of one beam.
const FEWEST: usize = 2;

/// How wide beams are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Width {
    /// All the same.
    #[default]
    Fixed,
    /// So many times the radius of the disc that holds the light of one path.
    Differentials(f32),
    /// As far as so many ends of other beams are near.
    Nearest(usize),
}

/// The radii of the beams of a pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Radii {
    /// The largest.
    pub(crate) most: f32,
    by: By,
}

#[derive(Clone, Copy, Debug)]
enum By {
    Fixed,
    /// The radius of the disc of an area of 1.
    Footprint(f64),
    Nearest(Neighbours),
}

impl Width {
    /// For a largest radius in this pass, which is `shrink` of that at the start; a radius is meant
    /// for so many paths at the start, of which a pass has the share `paths`.
    ///
    /// # Errors
    /// [`PassError::Unsupported`] for what makes no sense.
    pub(crate) fn in_pass(
        self,
        most: f32,
        shrink: f32,
        starting_paths: u64,
        paths: f64,
    ) -> Result<Radii, PassError> {
        let by = match self {
            Self::Fixed => By::Fixed,
            Self::Differentials(scale) => {
                ensure(scale > 0.0 && scale.is_finite(), || {
                    format!("`beam_differentials` is {scale}; name a number more than 0")
                })?;
                let disc = (PI * starting_paths as f64).sqrt();
                By::Footprint(f64::from(scale) * f64::from(shrink) / disc)
            }
            Self::Nearest(ends) => {
                ensure(ends >= FEWEST, || {
                    format!("`beam_nearest` is {ends}; name at least {FEWEST} ends of beams")
                })?;
                By::Nearest(Neighbours {
                    photons: ends as f64 * paths * f64::from(shrink).powi(3),
                    dimension: Dimension::Three,
                    max_radius: most,
                })
            }
        };
        Ok(Radii { most, by })
    }
}

impl Radii {
    /// Whether [`Radii::of`] wants to know of the light beside a path.
    pub(crate) fn by_footprints(&self) -> bool {
        matches!(self.by, By::Footprint(_))
    }

    fn limits(&self) -> [f32; 2] {
        match self.by {
            By::Fixed => BeamShape::UNLIMITED,
            _ => [LEAST * self.most, self.most],
        }
    }

    /// Those of a beam of some length, at its start and its end, and their limits. Light that was
    /// scattered into many directions is smooth: it takes the largest.
    pub(crate) fn of(&self, footprint: Option<&Footprint>, length: f32) -> ([f32; 2], [f32; 2]) {
        let radii = match (self.by, footprint) {
            (By::Footprint(scale), Some(footprint)) => {
                let radius = |v: f64| scale * footprint.area(v).sqrt();
                let length = f64::from(length);
                signed([0.0, 0.5 * length, length].map(radius)).map(|r| r as f32)
            }
            _ => [self.most; 2],
        };
        (radii, self.limits())
    }

    /// Gives beams that are all known radii by the nearest ends of others, if that is wanted.
    ///
    /// # Errors
    /// [`PassError::Unsupported`] for more ends than a map can number.
    pub(crate) fn of_all<S>(&self, list: &mut List<S>) -> Result<(), PassError> {
        let By::Nearest(neighbours) = self.by else {
            return Ok(());
        };
        let ends = |shape: &BeamShape| [0.0, shape.length].map(|v| shape.at(v.into()).as_vec3());
        let photon = |position| Photon {
            position,
            direction: Vec3::Z,
            flux: 0.0_f32,
        };
        let photons: Vec<_> = list
            .shapes
            .par_iter()
            .flat_map_iter(ends)
            .map(photon)
            .collect();
        let photons = Photons::build(&photons).map_err(unsupported)?;
        // An end is its own nearest.
        let aim = neighbours.pilot(photons.len().saturating_sub(1));
        let count = aim.count + 1;
        let radius = |room: &mut Nearest, end| {
            photons.nearest(end, aim.limit, room);
            let found = room.farthest().filter(|_| room.found().len() == count);
            let reach = found.map_or(aim.limit, |end| end.distance_squared.sqrt());
            (aim.part * reach).min(self.most)
        };
        list.shapes.par_iter_mut().for_each_init(
            || Nearest::new(count),
            |room, shape| shape.radii = ends(shape).map(|end| radius(room, end)),
        );
        Ok(())
    }
}

/// The radii at both ends, of different signs if there is a focus between: where that is nearer to
/// what the radius is in the middle.
fn signed([start, middle, end]: [f64; 3]) -> [f64; 2] {
    let [same, focus] = [end, -end].map(|end| (0.5 * (start + end).abs() - middle).abs());
    [start, if focus < same { -end } else { end }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const PATHS: u64 = 100;

    fn radii(width: Width) -> Radii {
        width.in_pass(2.0, 0.5, PATHS, 1.0).expect("a width")
    }

    /// Of two displacements, at the start and by unit of distance.
    fn footprint(start: f64, growth: f64) -> Footprint {
        let axes = [DVec3::X, DVec3::Y].into_iter();
        Footprint::new(Vec3::Z, axes.map(|axis| [start * axis, growth * axis]))
    }

    /// A path's own disc has an area of a² over the paths, and a pass the half of all radii.
    #[test]
    fn radii_follow_the_light_through_its_focus() {
        let widths = radii(Width::Differentials(3.0));
        let disc = 1.5 / (PI * PATHS as f64).sqrt();
        for (start, growth, length, expected) in [
            (1.0, 0.0, 7.0, [1.0, 1.0]),
            (0.0, 0.5, 4.0, [0.0, 2.0]),
            (1.0, 2.0, 3.0, [1.0, 7.0]),
            (1.0, -0.1, 5.0, [1.0, 0.5]),
            (1.0, -0.5, 6.0, [1.0, -2.0]),
            (0.2, -0.1, 100.0, [0.2, -9.8]),
        ] {
            let (found, limits) = widths.of(Some(&footprint(start, growth)), length);
            assert_eq!(limits, [2.0 / 32.0, 2.0]);
            for (found, expected) in found.into_iter().zip(expected) {
                let found = f64::from(found) / disc;
                assert!((found - expected).abs() < 1e-6, "{found} {expected}");
            }
        }
        // What is scattered.
        assert_eq!(widths.of(None, 1.0).0, [2.0; 2]);
    }

    #[test]
    fn radii_reach_to_the_nearest_ends() {
        let shape = |x: f32, length| BeamShape {
            origin: x * Vec3::X,
            direction: Vec3::X,
            length,
            radii: [2.0; 2],
            limits: BeamShape::UNLIMITED,
        };
        // Ends at 0, 1, 1.5, 2.75, 20 and 21. Of 17 wanted, by a half of all radii 17/8 are left;
        // looked for is the 5th, of what there is, and cut down by the root of their ratio.
        let mut list = List {
            shapes: vec![shape(0.0, 1.0), shape(1.5, 1.25), shape(20.0, 1.0)],
            flux: vec![0.0; 3],
            steps: vec![],
        };
        let widths = radii(Width::Nearest(17));
        widths.of_all(&mut list).expect("a tree");
        let part = (17.0_f32 / 8.0 / 5.0).cbrt();
        // No end is farther than 2 away, over that part.
        for (shape, expected) in list.shapes.iter().zip([[2.0; 2]; 3]) {
            assert_eq!(shape.radii, expected);
        }
        let widths = Radii {
            most: 1e3,
            by: By::Nearest(Neighbours {
                photons: 17.0 / 8.0,
                dimension: Dimension::Three,
                max_radius: 1e3,
            }),
        };
        widths.of_all(&mut list).expect("a tree");
        let fifth = [[21.0, 20.0], [19.5, 18.25], [20.0, 21.0]];
        for (shape, fifth) in list.shapes.iter().zip(fifth) {
            for (radius, fifth) in shape.radii.into_iter().zip(fifth) {
                assert!(
                    (radius / (part * fifth) - 1.0).abs() < 1e-6,
                    "{radius} {fifth}"
                );
            }
        }
    }
}
