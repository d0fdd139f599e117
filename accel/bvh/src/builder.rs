//! The builder: blocks of eight slots, nodes of eight children.

mod split;

use crate::node::{Child, Node};
use crate::{BuildError, LANES, LIMIT};
use rayon::prelude::*;
use split::{by_cost, evenly};
use tyndall_core::Aabb;

/// How much a tree should cost to build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Halves along the widest axis: for what is rebuilt every pass. Good where neighbours are of
    /// similar size.
    #[default]
    Fast,
    /// Binned surface area heuristic over the three axes and size: for structures that live, and
    /// for primitives of very different size.
    High,
}

/// A primitive while it is sorted.
#[derive(Clone, Copy)]
pub(crate) struct Item {
    pub(crate) bounds: Aabb,
    pub(crate) index: u32,
}

/// Items below which a task is not worth its start.
pub(crate) const TASK: usize = 4096;
/// Levels after which even `High` splits evenly, so that no tree is deeper than [`MAX_DEPTH`].
const LEVELS_BY_COST: usize = 20;
/// 2³² slots evenly are 8 · 8¹⁰.
pub(crate) const MAX_DEPTH: usize = LEVELS_BY_COST + 11;

/// Nodes, the root first, and the primitive of each slot.
pub(crate) fn build(
    bounds: &[Aabb],
    quality: Quality,
) -> Result<(Vec<Node>, Vec<u32>), BuildError> {
    let mut items = check(bounds)?;
    let mut nodes = Vec::new();
    if !items.is_empty() {
        grow(&mut items, 0, quality, 0, &mut nodes);
    }
    nodes.shrink_to_fit();
    let order = items.par_iter().map(|item| item.index).collect();
    Ok((nodes, order))
}

fn check(bounds: &[Aabb]) -> Result<Vec<Item>, BuildError> {
    if bounds.len() > u32::MAX as usize {
        return Err(BuildError::TooMany {
            count: bounds.len(),
        });
    }
    let item = |(index, bounds): (usize, &Aabb)| {
        let within = |v: glam::Vec3| v.abs().cmple(glam::Vec3::splat(LIMIT)).all();
        if bounds.is_empty() && !bounds.min.is_nan() && !bounds.max.is_nan() {
            Err(BuildError::Empty { index })
        } else if !(within(bounds.min) && within(bounds.max)) {
            Err(BuildError::NotFinite { index })
        } else {
            Ok(Item {
                bounds: *bounds,
                index: index as u32,
            })
        }
    };
    bounds.par_iter().enumerate().map(item).collect()
}

/// Appends the subtree over `items`, the first of which is in slot `first`; returns its box.
fn grow(
    items: &mut [Item],
    first: usize,
    quality: Quality,
    depth: usize,
    nodes: &mut Vec<Node>,
) -> Aabb {
    let (ends, count) = match quality {
        Quality::High if depth < LEVELS_BY_COST => by_cost(items),
        _ => evenly(items),
    };
    let root = nodes.len();
    nodes.push(Node::EMPTY);
    let mut parts = Vec::with_capacity(count);
    let (mut rest, mut start) = (items, 0);
    for &end in &ends[..count] {
        let (part, behind) = rest.split_at_mut(end - start);
        parts.push((first + start, part));
        (rest, start) = (behind, end);
    }
    let parallel = first_len(&parts) > TASK;
    let subtree = |(first, part): (usize, &mut [Item])| {
        let mut nodes = Vec::new();
        let bounds = grow(part, first, quality, depth + 1, &mut nodes);
        (bounds, nodes)
    };
    if parallel {
        let grown: Vec<_> = parts
            .into_par_iter()
            .map(|(first, part)| match part.len() {
                0..=LANES => (union(part), Err(first / LANES)),
                _ => {
                    let (bounds, nodes) = subtree((first, part));
                    (bounds, Ok(nodes))
                }
            })
            .collect();
        let mut whole = Aabb::EMPTY;
        for (lane, (bounds, below)) in grown.into_iter().enumerate() {
            let child = match below {
                Ok(mut below) => {
                    let offset = nodes.len() - root;
                    nodes.append(&mut below);
                    Child::Node(offset as u32)
                }
                Err(block) => Child::Block(block as u32),
            };
            nodes[root].set(lane, bounds, child);
            whole = whole.union(bounds);
        }
        return whole;
    }
    let mut whole = Aabb::EMPTY;
    for (lane, (first, part)) in parts.into_iter().enumerate() {
        let (bounds, child) = if part.len() <= LANES {
            (union(part), Child::Block((first / LANES) as u32))
        } else {
            let offset = nodes.len() - root;
            let bounds = grow(part, first, quality, depth + 1, nodes);
            (bounds, Child::Node(offset as u32))
        };
        nodes[root].set(lane, bounds, child);
        whole = whole.union(bounds);
    }
    whole
}

fn first_len(parts: &[(usize, &mut [Item])]) -> usize {
    parts.iter().map(|(_, part)| part.len()).sum()
}

fn union(items: &[Item]) -> Aabb {
    items
        .iter()
        .fold(Aabb::EMPTY, |all, item| all.union(item.bounds))
}
