//! Which closed surfaces a point is inside of, and what fills it.
//!
//! A *boundary* is a shape that light can enter. Where boundaries overlap, the one of highest
//! priority holds; among equals the one with the smaller box, which is the inner one of two that
//! are nested. The others are not there: their interfaces inside it are false, and light passes
//! them unchanged (Schmidt & Budge 2002, "Simple Nested Dielectrics in Ray Traced Images"). One
//! without an index of refraction fills the others of its priority and leaves their interfaces; one
//! that *adds* shares its place with what holds there without it.
//!
//! A [`MediumId`] names a *state*: the set of boundaries around a point, and the medium that fills
//! space outside all of them. A point can be inside of boundaries only if their boxes meet, each with
//! each: such sets, and the steps between them, are all known at load, and crossing a surface is one
//! look into a table of those few that can be crossed there. Ten thousand separate trees of glass
//! make ten thousand states of a step or two, not a table of a hundred million.

#[cfg(test)]
mod tests;

use crate::material::nearly_equal;
use crate::media::Filling;
use std::collections::HashMap;
use tyndall_core::{Aabb, MediumId};

/// A shape that light can enter.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    /// The shape whose surface it is.
    pub(crate) shape: usize,
    pub(crate) bounds: Aabb,
    /// What fills it.
    pub(crate) inside: Filling,
    /// Whether that is there besides what would be there without it.
    pub(crate) adds: bool,
    /// What is around it where nothing else is, if that is said.
    pub(crate) outside: Option<Filling>,
    /// Index of refraction inside; `None` if it is that of whatever is around.
    pub(crate) ior: Option<f32>,
    pub(crate) priority: i32,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct State {
    /// What is outside all boundaries.
    base: Filling,
    /// Boundaries around the point, the one that holds last.
    members: Vec<u32>,
}

/// The state that crossing `boundary` leads to: out of it if the point is inside, else into it.
#[derive(Clone, Copy, Debug)]
struct Step {
    boundary: u32,
    to: MediumId,
}

/// All boundaries of a scene, in order of rank.
#[derive(Clone, Debug)]
pub(crate) struct Boundaries {
    ranked: Vec<Boundary>,
    of_shape: Vec<Option<u32>>,
    /// For each boundary those whose boxes meet its own, in order.
    meeting: Vec<Vec<u32>>,
    states: Vec<State>,
    /// For each state its steps by boundary: those of its members and of all that meet every one.
    steps: Vec<Vec<Step>>,
    /// For each state that outside of everything, of its base.
    outside: Vec<MediumId>,
    ambient: MediumId,
    /// What there is but vacuum, each once.
    fillings: Vec<Filling>,
    /// For each state the index of what fills it; `None` is vacuum.
    filled: Vec<Option<usize>>,
}

/// Steps between states that are kept at most (64 MB), and pairs of boxes that meet.
const MAX_STEPS: usize = 1 << 23;

impl Boundaries {
    /// The table of all states that can be, `ambient` being outside of everything; `None` if there
    /// are too many.
    pub(crate) fn new(mut boundaries: Vec<Boundary>, ambient: Filling) -> Option<Self> {
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
            meeting: meeting(&boundaries)?,
            ranked: boundaries,
            of_shape,
            states: Vec::new(),
            steps: Vec::new(),
            outside: Vec::new(),
            ambient: MediumId::VACUUM,
            fillings: Vec::new(),
            filled: Vec::new(),
        };
        if !table.find_states(ambient) {
            return None;
        }
        table.fill();
        Some(table)
    }

    /// Finds all states by walking from one to the next, and the steps with them.
    fn find_states(&mut self, ambient: Filling) -> bool {
        let mut ids = HashMap::new();
        // The first state is vacuum outside of everything: `MediumId::VACUUM`.
        self.intern(&mut ids, outside_all(Vec::new()));
        self.ambient = self.intern(&mut ids, outside_all(ambient));
        let mut count = 0;
        while let Some(state) = self.states.get(self.steps.len()).cloned() {
            let outside = self.intern(&mut ids, outside_all(state.base.clone()));
            self.outside.push(outside);
            let crossed = self.crossed(&state);
            count += crossed.len() + state.members.len();
            if count > MAX_STEPS {
                return false;
            }
            let steps = crossed.into_iter().map(|boundary| {
                let next = match state.members.binary_search(&boundary) {
                    Ok(_) => self.left(&state, boundary),
                    Err(_) => entered(&state, boundary),
                };
                let to = self.intern(&mut ids, next);
                Step { boundary, to }
            });
            let steps = steps.collect();
            self.steps.push(steps);
            if state.members.is_empty() {
                // Who leaves what he is not known to be in finds what is around it.
                let around: Vec<_> = self
                    .ranked
                    .iter()
                    .filter_map(|b| b.outside.clone())
                    .collect();
                for base in around {
                    self.intern(&mut ids, outside_all(base));
                }
            }
        }
        true
    }

    /// Finds what fills each state.
    fn fill(&mut self) {
        let mut indices = HashMap::new();
        for state in &self.states {
            let filling = self.filling_of(state);
            let filled = (!filling.is_empty()).then(|| {
                *indices.entry(filling).or_insert_with_key(|filling| {
                    self.fillings.push(filling.clone());
                    self.fillings.len() - 1
                })
            });
            self.filled.push(filled);
        }
    }

    /// What the boundary that holds has inside; beside that which add, and beside what is outside of
    /// all if all do.
    fn filling_of(&self, state: &State) -> Filling {
        let mut filling = Vec::new();
        for &m in state.members.iter().rev() {
            let boundary = &self.ranked[m as usize];
            filling.extend(&boundary.inside);
            if !boundary.adds {
                filling.sort_unstable();
                return filling;
            }
        }
        filling.extend(&state.base);
        filling.sort_unstable();
        filling
    }

    fn intern(&mut self, ids: &mut HashMap<State, MediumId>, state: State) -> MediumId {
        let states = &mut self.states;
        *ids.entry(state).or_insert_with_key(|state| {
            states.push(state.clone());
            MediumId(states.len() as u32 - 1)
        })
    }

    /// The boundaries that can be crossed in a state, in order: its members, and what meets all of
    /// them.
    fn crossed(&self, state: &State) -> Vec<u32> {
        let fewest = |&&m: &&u32| self.meeting[m as usize].len();
        let Some(&narrowest) = state.members.iter().min_by_key(fewest) else {
            return self.all().collect();
        };
        let meets = |b: &u32| {
            state
                .members
                .iter()
                .all(|&m| m == *b || self.overlap(m, *b))
        };
        let near = &self.meeting[narrowest as usize];
        let mut crossed: Vec<_> = near.iter().copied().filter(meets).collect();
        crossed.push(narrowest);
        crossed.sort_unstable();
        crossed
    }

    fn left(&self, state: &State, b: u32) -> State {
        let others = state.members.iter().copied().filter(|&m| m != b);
        let members: Vec<_> = others.collect();
        let base = match &self.ranked[b as usize].outside {
            Some(outside) if members.is_empty() => outside.clone(),
            _ => state.base.clone(),
        };
        State { base, members }
    }

    fn overlap(&self, a: u32, b: u32) -> bool {
        overlap(&self.ranked[a as usize], &self.ranked[b as usize])
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

    /// All that states are filled with, but vacuum.
    pub(crate) fn fillings(&self) -> &[Filling] {
        &self.fillings
    }

    /// What may be outside of all boundaries.
    pub(crate) fn outside(&self) -> impl Iterator<Item = &Filling> {
        let bare = self.states.iter().filter(|s| s.members.is_empty());
        bare.map(|s| &s.base)
    }

    /// Index of what fills a state; `None` is vacuum.
    pub(crate) fn medium(&self, state: MediumId) -> Option<usize> {
        self.filled.get(state.0 as usize).copied().flatten()
    }

    /// What fills a state.
    pub(crate) fn filling(&self, state: MediumId) -> &[usize] {
        self.medium(state).map_or(&[], |i| &self.fillings[i])
    }

    /// The state on the side of `b` that is entered or left.
    pub(crate) fn across(&self, b: u32, entering: bool, here: MediumId) -> MediumId {
        let Some(state) = self.states.get(here.0 as usize) else {
            return self.ambient;
        };
        if state.members.contains(&b) != entering {
            return match self.step(b, here) {
                Some(next) => next,
                None => self.entered_afresh(b, here),
            };
        }
        // Rounding let a path carry along, or lose, what it now meets: it is where it should be.
        match &self.ranked[b as usize].outside {
            Some(base) if !entering && state.members.is_empty() => self.outside_with(base),
            _ => here,
        }
    }

    fn step(&self, b: u32, here: MediumId) -> Option<MediumId> {
        let steps = &self.steps[here.0 as usize];
        let found = steps.binary_search_by_key(&b, |step| step.boundary);
        found.ok().map(|i| steps[i].to)
    }

    /// The state after entering `b`: boundaries whose boxes do not meet its own cannot hold a point
    /// of its surface, and what rounding let a path carry along is dropped.
    #[cold]
    fn entered_afresh(&self, b: u32, here: MediumId) -> MediumId {
        let members = &self.states[here.0 as usize].members;
        let kept = members.iter().copied().filter(|&m| self.overlap(m, b));
        let enter = |state, m| self.step(m, state).unwrap_or(state);
        kept.chain([b]).fold(self.outside[here.0 as usize], enter)
    }

    fn outside_with(&self, base: &[usize]) -> MediumId {
        let bare = |s: &State| s.members.is_empty() && s.base == base;
        let found = self
            .outside
            .iter()
            .find(|id| bare(&self.states[id.0 as usize]));
        found.copied().unwrap_or(self.ambient)
    }

    /// Index of refraction inside `b` over that outside, in a path that is in state `here`; 1 if
    /// the boundary has no index of its own. `None` if the interface is false.
    pub(crate) fn relative_ior(&self, b: u32, here: MediumId) -> Option<f32> {
        let Some(inside) = self.ranked[b as usize].ior else {
            return Some(1.0);
        };
        let members = (self.states.get(here.0 as usize)).map_or(&[][..], |s| &s.members);
        if members.iter().any(|&m| self.hides(m, b)) {
            return None;
        }
        let mut around = members.iter().rev().filter(|&&m| m != b);
        let outside = around.find_map(|&m| self.ranked[m as usize].ior);
        Some(inside / outside.unwrap_or(1.0))
    }

    /// Whether the surface of `b` is not there inside of `a`.
    fn hides(&self, a: u32, b: u32) -> bool {
        let [over, under] = [a, b].map(|i| &self.ranked[i as usize]);
        a > b && !over.adds && (over.ior.is_some() || over.priority > under.priority)
    }

    /// Whether light may pass the surface of `b` unchanged, in some state: it has no index of its
    /// own, (nearly) that of vacuum, that of another, or another outranks it.
    pub(crate) fn may_be_null(&self, b: u32) -> bool {
        let Some(ior) = self.ranked[b as usize].ior else {
            return true;
        };
        let mut others = self.meeting[b as usize].iter();
        let matches = |other: Option<f32>| other.is_some_and(|other| nearly_equal(ior / other));
        let hidden = others.any(|&o| self.hides(o, b) || matches(self.ranked[o as usize].ior));
        nearly_equal(ior) || hidden
    }
}

fn outside_all(base: Filling) -> State {
    let members = Vec::new();
    State { base, members }
}

fn entered(state: &State, b: u32) -> State {
    let mut members = state.members.clone();
    members.push(b);
    members.sort_unstable();
    let base = state.base.clone();
    State { base, members }
}

fn overlap(a: &Boundary, b: &Boundary) -> bool {
    let (a, b) = (a.bounds, b.bounds);
    a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
}

/// For each boundary those whose boxes meet its own, found by a sweep along the longest axis; `None`
/// if there are too many.
fn meeting(boundaries: &[Boundary]) -> Option<Vec<Vec<u32>>> {
    let all = (boundaries.iter()).fold(Aabb::EMPTY, |all, b| all.union(b.bounds));
    let axis = all.size().max_position();
    let mut order: Vec<_> = (0..boundaries.len() as u32).collect();
    let start = |b: u32| boundaries[b as usize].bounds.min[axis];
    order.sort_by(|&a, &b| start(a).total_cmp(&start(b)));
    let mut meeting = vec![Vec::new(); boundaries.len()];
    let (mut open, mut pairs): (Vec<u32>, _) = (Vec::new(), 0);
    for b in order {
        let here = &boundaries[b as usize];
        open.retain(|&a| boundaries[a as usize].bounds.max[axis] >= start(b));
        for &a in open
            .iter()
            .filter(|&&a| overlap(&boundaries[a as usize], here))
        {
            meeting[a as usize].push(b);
            meeting[b as usize].push(a);
            pairs += 1;
        }
        open.push(b);
        if pairs > MAX_STEPS {
            return None;
        }
    }
    meeting.iter_mut().for_each(|list| list.sort_unstable());
    Some(meeting)
}
