//! Which closed surfaces a point is inside of, and what fills it.
//!
//! A *boundary* is a shape that light can enter. Where boundaries overlap, the one of highest
//! priority holds; among equals the one with the smaller box, which is the inner one of two that
//! are nested. The others are not there: their interfaces inside it are false, and light passes
//! them unchanged (Schmidt & Budge 2002, "Simple Nested Dielectrics in Ray Traced Images"). One
//! without an index of refraction fills the others of its priority and leaves their interfaces.
//!
//! A [`MediumId`] names a *state*: the set of boundaries around a point, and the medium that fills
//! space outside all of them. All states and the steps between them are known at load, so that
//! crossing a surface is one look into a table.

use crate::material::nearly_equal;
use std::collections::HashMap;
use tyndall_core::{Aabb, MediumId};

/// A shape that light can enter.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    /// The shape whose surface it is.
    pub(crate) shape: usize,
    pub(crate) bounds: Aabb,
    /// Index of the medium inside; `None` is vacuum.
    pub(crate) inside: Option<usize>,
    /// The medium around it where nothing else is, if that is said.
    pub(crate) outside: Option<Option<usize>>,
    /// Index of refraction inside; `None` if it is that of whatever is around.
    pub(crate) ior: Option<f32>,
    pub(crate) priority: i32,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct State {
    /// Medium outside all boundaries.
    base: Option<usize>,
    /// Boundaries around the point, the one that holds last.
    members: Vec<u32>,
}

/// All boundaries of a scene, in order of rank.
#[derive(Clone, Debug)]
pub(crate) struct Boundaries {
    ranked: Vec<Boundary>,
    of_shape: Vec<Option<u32>>,
    states: Vec<State>,
    /// State after entering and after leaving boundary b in state s: at s·n + b.
    enter: Vec<MediumId>,
    leave: Vec<MediumId>,
    ambient: MediumId,
}

/// Steps between states that are kept at most (64 MB).
const MAX_STEPS: usize = 1 << 23;

impl Boundaries {
    /// The table of all states that can be, `ambient` being the medium outside of everything;
    /// `None` if there are too many.
    pub(crate) fn new(mut boundaries: Vec<Boundary>, ambient: Option<usize>) -> Option<Self> {
        boundaries.sort_by(|a, b| {
            let volume = |b: &Boundary| b.bounds.size().as_dvec3().element_product();
            (a.priority.cmp(&b.priority)).then(volume(b).total_cmp(&volume(a)))
        });
        let shapes = boundaries.iter().map(|b| b.shape + 1).max();
        let mut of_shape = vec![None; shapes.unwrap_or(0)];
        for (rank, b) in boundaries.iter().enumerate() {
            of_shape[b.shape] = Some(rank as u32);
        }
        let mut table = Self {
            ranked: boundaries,
            of_shape,
            states: Vec::new(),
            enter: Vec::new(),
            leave: Vec::new(),
            ambient: MediumId::VACUUM,
        };
        table.fill(ambient).then_some(table)
    }

    /// Finds all states by walking from one to the next, and the steps with them.
    fn fill(&mut self, ambient: Option<usize>) -> bool {
        let mut ids = HashMap::new();
        // The first state is vacuum outside of everything: `MediumId::VACUUM`.
        self.intern(&mut ids, outside_all(None));
        self.ambient = self.intern(&mut ids, outside_all(ambient));
        let mut next = 0;
        while next < self.states.len() {
            if self.states.len() * self.ranked.len() > MAX_STEPS {
                return false;
            }
            for b in 0..self.ranked.len() as u32 {
                let entered = self.entered(&self.states[next], b);
                let left = self.left(&self.states[next], b);
                let entered = self.intern(&mut ids, entered);
                let left = self.intern(&mut ids, left);
                self.enter.push(entered);
                self.leave.push(left);
            }
            next += 1;
        }
        true
    }

    fn intern(&mut self, ids: &mut HashMap<State, MediumId>, state: State) -> MediumId {
        let states = &mut self.states;
        *ids.entry(state).or_insert_with_key(|state| {
            states.push(state.clone());
            MediumId(states.len() as u32 - 1)
        })
    }

    /// Boundaries whose boxes do not meet that of `b` cannot hold a point of its surface: what
    /// rounding let a path carry along is dropped here.
    fn entered(&self, state: &State, b: u32) -> State {
        let meets = |other: u32| other != b && self.overlap(other, b);
        let kept = state.members.iter().copied().filter(|&m| meets(m));
        let mut members: Vec<_> = kept.chain([b]).collect();
        members.sort_unstable();
        let base = state.base;
        State { base, members }
    }

    fn left(&self, state: &State, b: u32) -> State {
        let others = state.members.iter().copied().filter(|&m| m != b);
        let members: Vec<_> = others.collect();
        let base = match self.ranked[b as usize].outside {
            Some(outside) if members.is_empty() => outside,
            _ => state.base,
        };
        State { base, members }
    }

    fn overlap(&self, a: u32, b: u32) -> bool {
        let (a, b) = (
            self.ranked[a as usize].bounds,
            self.ranked[b as usize].bounds,
        );
        a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
    }

    /// All boundaries.
    pub(crate) fn all(&self) -> impl Iterator<Item = u32> + use<> {
        0..self.ranked.len() as u32
    }

    /// The boundary that a shape is, if it is one.
    pub(crate) fn of_shape(&self, shape: u32) -> Option<u32> {
        self.of_shape.get(shape as usize).copied().flatten()
    }

    /// The box of a boundary.
    pub(crate) fn bounds(&self, b: u32) -> Aabb {
        self.ranked[b as usize].bounds
    }

    /// The state outside of everything.
    pub(crate) fn ambient(&self) -> MediumId {
        self.ambient
    }

    /// The state inside of these boundaries.
    pub(crate) fn state(&self, around: &[u32]) -> MediumId {
        let enter = |here, &b: &u32| self.across(b, true, here);
        around.iter().fold(self.ambient, enter)
    }

    /// Index of the medium that fills a state; `None` is vacuum.
    pub(crate) fn medium(&self, state: MediumId) -> Option<usize> {
        let state = self.states.get(state.0 as usize)?;
        match state.members.last() {
            Some(&top) => self.ranked[top as usize].inside,
            None => state.base,
        }
    }

    /// The state on the side of `b` that is entered or left.
    pub(crate) fn across(&self, b: u32, entering: bool, here: MediumId) -> MediumId {
        let step = here.0 as usize * self.ranked.len() + b as usize;
        let steps = if entering { &self.enter } else { &self.leave };
        steps.get(step).copied().unwrap_or(self.ambient)
    }

    /// Index of refraction inside `b` over that outside, in a path that is in state `here`; 1 if
    /// the interface is false, or the boundary has no index of its own.
    pub(crate) fn relative_ior(&self, b: u32, here: MediumId) -> f32 {
        let Some(inside) = self.ranked[b as usize].ior else {
            return 1.0;
        };
        let members = (self.states.get(here.0 as usize)).map_or(&[][..], |s| &s.members);
        if members.iter().any(|&m| self.hides(m, b)) {
            return 1.0;
        }
        let mut around = members.iter().rev().filter(|&&m| m != b);
        let outside = around.find_map(|&m| self.ranked[m as usize].ior);
        inside / outside.unwrap_or(1.0)
    }

    /// Whether the surface of `b` is not there inside of `a`.
    fn hides(&self, a: u32, b: u32) -> bool {
        let [over, under] = [a, b].map(|i| &self.ranked[i as usize]);
        a > b && (over.ior.is_some() || over.priority > under.priority)
    }

    /// Whether light may pass the surface of `b` unchanged, in some state: it has no index of its
    /// own, (nearly) that of vacuum, that of another, or another outranks it.
    pub(crate) fn may_be_null(&self, b: u32) -> bool {
        let Some(ior) = self.ranked[b as usize].ior else {
            return true;
        };
        let mut others = self.all().filter(|&o| o != b && self.overlap(o, b));
        let matches = |other: Option<f32>| other.is_some_and(|other| nearly_equal(ior / other));
        let hidden = others.any(|o| self.hides(o, b) || matches(self.ranked[o as usize].ior));
        nearly_equal(ior) || hidden
    }
}

fn outside_all(base: Option<usize>) -> State {
    let members = Vec::new();
    State { base, members }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn boundary(shape: usize, half: f32, ior: Option<f32>, priority: i32) -> Boundary {
        Boundary {
            shape,
            bounds: Aabb {
                min: Vec3::splat(-half),
                max: Vec3::splat(half),
            },
            inside: Some(shape),
            outside: None,
            ior,
            priority,
        }
    }

    /// Glass (shape 0, priority 2) full of water (shape 1, priority 1) that overlaps its wall.
    fn glass_of_water() -> Boundaries {
        let glass = boundary(0, 1.0, Some(1.5), 2);
        let water = boundary(1, 0.9, Some(1.33), 1);
        Boundaries::new(vec![glass, water], None).unwrap()
    }

    #[test]
    fn the_higher_priority_holds_and_hides_the_other() {
        let table = glass_of_water();
        let [glass, water] = [0, 1].map(|s| table.of_shape(s).unwrap());
        let air = table.ambient();
        assert_eq!(air, MediumId::VACUUM);
        assert_eq!(table.relative_ior(glass, air), 1.5);
        let in_glass = table.across(glass, true, air);
        assert_eq!(table.medium(in_glass), Some(0));
        // Inside the wall, the surface of the water is not there.
        assert_eq!(table.relative_ior(water, in_glass), 1.0);
        let in_both = table.across(water, true, in_glass);
        assert_eq!(table.medium(in_both), Some(0));
        // Leaving the wall into the water: glass against water.
        assert_eq!(table.relative_ior(glass, in_both), 1.5 / 1.33);
        let in_water = table.across(glass, false, in_both);
        assert_eq!(table.medium(in_water), Some(1));
        assert_eq!(table.across(water, false, in_water), air);
    }

    #[test]
    fn of_equal_priority_the_inner_holds() {
        let fog = boundary(0, 10.0, None, 0);
        let ball = boundary(1, 1.0, Some(1.5), 0);
        let table = Boundaries::new(vec![ball, fog], None).unwrap();
        let [fog, ball] = [0, 1].map(|s| table.of_shape(s).unwrap());
        let in_fog = table.across(fog, true, table.ambient());
        let in_ball = table.across(ball, true, in_fog);
        assert_eq!(table.medium(in_ball), Some(1));
        assert_eq!(table.relative_ior(ball, in_fog), 1.5);
        assert!(!table.may_be_null(ball) && table.may_be_null(fog));
    }

    /// A small box of smoke half in a big block of glass.
    #[test]
    fn smoke_fills_glass_and_does_not_hide_it() {
        let glass = boundary(0, 10.0, Some(1.5), 0);
        let mut smoke = boundary(1, 1.0, None, 0);
        smoke.bounds.min.x += 10.0;
        smoke.bounds.max.x += 10.0;
        let table = |smoke| Boundaries::new(vec![glass.clone(), smoke], None).unwrap();
        let into_glass = |table: &Boundaries| {
            let [glass, smoke] = [0, 1].map(|s| table.of_shape(s).unwrap());
            let in_smoke = table.across(smoke, true, table.ambient());
            let in_both = table.across(glass, true, in_smoke);
            (table.relative_ior(glass, in_smoke), table.medium(in_both))
        };
        let tied = table(smoke.clone());
        assert_eq!(into_glass(&tied), (1.5, Some(1)));
        assert!(!tied.may_be_null(tied.of_shape(0).unwrap()));
        let first = table(Boundary {
            priority: 1,
            ..smoke
        });
        assert_eq!(into_glass(&first), (1.0, Some(1)));
    }

    #[test]
    fn outside_replaces_what_is_around() {
        let sea = Boundary {
            outside: Some(None),
            ..boundary(0, 1.0, None, 0)
        };
        let table = Boundaries::new(vec![sea], Some(7)).unwrap();
        let sea = table.of_shape(0).unwrap();
        assert_eq!(table.medium(table.ambient()), Some(7));
        assert_eq!(table.across(sea, false, table.ambient()), MediumId::VACUUM);
    }

    #[test]
    fn many_separate_boundaries_make_few_states() {
        let balls = (0..200).map(|i| {
            let mut ball = boundary(i + 1, 0.4, Some(1.5), 0);
            ball.bounds.min.x += i as f32;
            ball.bounds.max.x += i as f32;
            ball
        });
        let fog = boundary(0, 1e3, None, 0);
        let table = Boundaries::new(balls.chain([fog]).collect(), None).unwrap();
        assert_eq!(table.states.len(), 2 * 201);
        let crowd = (0..40).map(|i| boundary(i, 1.0, Some(1.5), 0));
        assert!(Boundaries::new(crowd.collect(), None).is_none());
    }
}
