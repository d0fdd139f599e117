//! The nodes of a grid, level by level.

use super::level::{LEAF_WORDS, LOWER, ROOT_EDGE, UPPER};
use glam::IVec3;
use tyndall_core::Spectrum;
use tyndall_media::{Piece, SparseGrid, Tile};

/// What a slot holds: a node of the level below, by its number there, or a value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Slot<T> {
    Child(usize),
    Tile(Tile<T>),
}

#[derive(Debug)]
pub(super) struct Node<T> {
    pub(super) origin: IVec3,
    pub(super) slots: Vec<(usize, Slot<T>)>,
}

impl<T> Node<T> {
    /// The numbers of its children, in order.
    pub(super) fn children(&self) -> impl Iterator<Item = usize> + '_ {
        self.slots.iter().filter_map(|(_, content)| match content {
            Slot::Child(child) => Some(*child),
            Slot::Tile(_) => None,
        })
    }
}

#[derive(Debug)]
pub(super) struct Leaf<'a> {
    pub(super) origin: IVec3,
    /// Its number in the grid.
    pub(super) number: u32,
    pub(super) active: &'a [u64; LEAF_WORDS],
}

/// All nodes in the order of their origins, parents' slots in that of their children.
#[derive(Debug)]
pub(super) struct Skeleton<'a, T> {
    pub(super) root: Vec<(IVec3, Slot<T>)>,
    /// Lower nodes, then upper ones.
    pub(super) nodes: [Vec<Node<T>>; 2],
    pub(super) leaves: Vec<Leaf<'a>>,
}

impl<'a, T: Spectrum> Skeleton<'a, T> {
    pub(super) fn of(grid: &'a SparseGrid<T>) -> Self {
        let mut all = Self {
            root: Vec::new(),
            nodes: [Vec::new(), Vec::new()],
            leaves: Vec::new(),
        };
        grid.visit(|origin, piece| match piece {
            Piece::Leaf { leaf, active } => {
                let child = Slot::Child(all.leaves.len());
                all.leaves.push(Leaf {
                    origin,
                    number: leaf,
                    active,
                });
                all.insert(origin, 1, child);
            }
            Piece::Tile { edge, tile } => {
                let level = match edge.ilog2() {
                    ROOT_EDGE => 3,
                    edge if edge == UPPER.edge => 2,
                    _ => 1,
                };
                all.insert(origin, level, Slot::Tile(tile));
            }
        });
        all
    }

    /// Puts something into the node of a level that is there for it, which is the last one or new.
    fn insert(&mut self, origin: IVec3, level: usize, content: Slot<T>) {
        if level == 3 {
            self.root.push((origin, content));
            return;
        }
        let kind = [LOWER, UPPER][level - 1];
        let parent = origin & !((1 << kind.node_edge()) - 1);
        let nodes = &mut self.nodes[level - 1];
        let slot = (kind.slot(origin), content);
        match nodes.last_mut() {
            Some(node) if node.origin == parent => node.slots.push(slot),
            _ => {
                let child = Slot::Child(nodes.len());
                nodes.push(Node {
                    origin: parent,
                    slots: vec![slot],
                });
                self.insert(parent, level + 1, child);
            }
        }
    }

    /// How many leaves, lower and upper nodes there are.
    pub(super) fn counts(&self) -> [usize; 3] {
        [self.leaves.len(), self.nodes[0].len(), self.nodes[1].len()]
    }

    /// How many active tiles lower nodes, upper nodes and the root hold.
    pub(super) fn tiles(&self) -> [usize; 3] {
        let active = |slot: &Slot<T>| matches!(slot, Slot::Tile(tile) if tile.active);
        let of = |nodes: &[Node<T>]| {
            let slots = nodes.iter().flat_map(|node| &node.slots);
            slots.filter(|(_, slot)| active(slot)).count()
        };
        let root = self.root.iter().filter(|(_, slot)| active(slot));
        [of(&self.nodes[0]), of(&self.nodes[1]), root.count()]
    }
}
