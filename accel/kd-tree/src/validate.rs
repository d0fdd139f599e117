//! Every invariant of the structure.

use crate::photon::BuildError;
use crate::photons::Photons;
use crate::tree::{LANES, Layout, Tree};
use std::ops::Range;
use thiserror::Error;
use tyndall_core::{Aabb, Spectrum};

/// What is wrong with a tree.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BrokenTree {
    /// An array does not have one element a photon, or as many as the tree needs.
    #[error("the array of {array} has {found} elements, not {expected}")]
    Length {
        /// The array.
        array: &'static str,
        /// Its length.
        found: usize,
        /// The right one.
        expected: usize,
    },
    /// The box of the tree is not the smallest around its photons.
    #[error("the bounds of the tree are not those of its photons")]
    Bounds,
    /// A node does not divide the photons below it.
    #[error("node {node} does not divide the photons below it where it says")]
    Node {
        /// The node.
        node: usize,
    },
    /// What follows the last photon would be found.
    #[error("a place after the last photon holds a position")]
    Padding,
    /// A photon could not have been stored.
    #[error("in the order of slots, {0}")]
    Photon(#[from] BuildError),
}

impl<S: Spectrum> Photons<S> {
    /// Checks every invariant of the structure, in time that grows as n log n. A tree that was
    /// built passes.
    ///
    /// # Errors
    /// What is wrong, as a sentence.
    pub fn validate(&self) -> Result<(), BrokenTree> {
        let len = self.len();
        check_length("directions", self.directions.len(), len)?;
        check_length("flux", self.flux.len(), len)?;
        self.tree.validate()?;
        (0..len).try_for_each(|slot| Ok(self.get(slot).check(slot)?))
    }
}

impl Tree {
    fn validate(&self) -> Result<(), BrokenTree> {
        let layout = Layout::new(self.len);
        check_length("leaves", self.layout.leaves(), layout.leaves())?;
        check_length("nodes", self.nodes.len(), layout.leaves() - 1)?;
        check_length("positions", self.blocks.len(), self.len.div_ceil(LANES))?;
        if self.bounds_of(0..self.len) != self.bounds {
            return Err(BrokenTree::Bounds);
        }
        self.validate_nodes(0, 0, layout.leaves())?;
        let padding = self.len..LANES * self.blocks.len();
        if !padding.into_iter().all(|slot| self.lanes(slot).is_nan()) {
            return Err(BrokenTree::Padding);
        }
        Ok(())
    }

    /// Checks `node` over `span` leaves, and all below it.
    fn validate_nodes(&self, node: usize, leaf: usize, span: usize) -> Result<(), BrokenTree> {
        if span == 1 {
            return Ok(());
        }
        let half = span / 2;
        let [start, middle, end] = [leaf, leaf + half, leaf + span]
            .map(|leaf| self.len.min(LANES * self.layout.start(leaf)));
        let split = self.nodes[node];
        let axis = split.axis as usize;
        let divides = axis < 3
            && split.lower_max <= split.upper_min
            && self.bounds_of(start..middle).max[axis] == split.lower_max
            && self.bounds_of(middle..end).min[axis] == split.upper_min;
        if !divides {
            return Err(BrokenTree::Node { node });
        }
        self.validate_nodes(node + 1, leaf, half)?;
        self.validate_nodes(node + half, leaf + half, half)
    }

    fn bounds_of(&self, slots: Range<usize>) -> Aabb {
        Aabb::of_points(slots.map(|slot| self.position(slot)))
    }
}

fn check_length(array: &'static str, found: usize, expected: usize) -> Result<(), BrokenTree> {
    if found == expected {
        return Ok(());
    }
    Err(BrokenTree::Length {
        array,
        found,
        expected,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Photon;
    use crate::tree::Block;
    use glam::Vec3;

    fn photons() -> Photons<f32> {
        let photon = |i: u32| Photon {
            position: Vec3::new(i as f32, (7 * i % 101) as f32, (13 * i % 31) as f32),
            direction: Vec3::Z,
            flux: 1.0,
        };
        Photons::build(&(0..101).map(photon).collect::<Vec<_>>()).unwrap()
    }

    /// What is said of a tree that `damage` has changed.
    fn verdict(damage: impl Fn(&mut Photons<f32>)) -> String {
        let mut photons = photons();
        damage(&mut photons);
        photons.validate().unwrap_err().to_string()
    }

    #[test]
    fn what_is_built_is_whole() {
        assert_eq!(photons().validate(), Ok(()));
        assert_eq!(Photons::<f32>::default().validate(), Ok(()));
    }

    #[test]
    fn arrays_that_are_too_short_are_caught() {
        let short = |array| format!("the array of {array}");
        assert!(verdict(|p| p.flux.truncate(9)).starts_with(&short("flux")));
        assert!(verdict(|p| p.directions.truncate(9)).starts_with(&short("directions")));
        assert!(verdict(|p| p.tree.nodes.truncate(2)).starts_with(&short("nodes")));
        assert!(verdict(|p| p.tree.blocks.truncate(2)).starts_with(&short("positions")));
        assert!(verdict(|p| p.tree.layout = Layout::default()).starts_with(&short("leaves")));
    }

    #[test]
    fn a_wrong_tree_is_caught() {
        for node in 0..photons().tree.nodes.len() {
            let sentence = format!("node {node} does not divide");
            let said = verdict(|p| p.tree.nodes[node].lower_max += 0.5);
            assert!(said.starts_with(&sentence), "{said}");
            let said = verdict(|p| p.tree.nodes[node].upper_min -= 0.5);
            assert!(said.starts_with(&sentence), "{said}");
            let said = verdict(|p| p.tree.nodes[node].axis = 3);
            assert!(said.starts_with(&sentence), "{said}");
        }
        assert!(verdict(|p| p.tree.blocks.swap(0, 20)).starts_with("node"));
        assert!(verdict(|p| p.tree.bounds.min.x -= 1.0).contains("bounds"));
        let padded = verdict(|p| {
            let Block { x, y, z } = &mut p.tree.blocks[25];
            (x[3], y[3], z[3]) = (0.5, 0.5, 0.5);
        });
        assert!(padded.contains("after the last"));
    }

    #[test]
    fn a_wrong_photon_is_caught() {
        assert!(verdict(|p| p.flux[4] = f32::NAN).contains("photon 4: the flux"));
    }
}
