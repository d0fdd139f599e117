//! Which boundaries hold, on tables made by hand.

use super::*;
use glam::Vec3;

fn boundary(shape: usize, half: f32, ior: Option<f32>, priority: i32) -> Boundary {
    Boundary {
        shape,
        bounds: Aabb {
            min: Vec3::splat(-half),
            max: Vec3::splat(half),
        },
        inside: vec![shape],
        adds: false,
        outside: None,
        ior,
        priority,
    }
}

/// Glass (shape 0, priority 2) full of water (shape 1, priority 1) that overlaps its wall.
fn glass_of_water() -> Boundaries {
    let glass = boundary(0, 1.0, Some(1.5), 2);
    let water = boundary(1, 0.9, Some(1.33), 1);
    Boundaries::new(vec![glass, water], vec![]).unwrap()
}

#[test]
fn the_higher_priority_holds_and_hides_the_other() {
    let table = glass_of_water();
    let [glass, water] = [0, 1].map(|s| table.of_shape(s).unwrap());
    let air = table.ambient();
    assert_eq!(air, MediumId::VACUUM);
    assert_eq!(table.relative_ior(glass, air), Some(1.5));
    let in_glass = table.across(glass, true, air);
    assert_eq!(table.filling(in_glass), [0]);
    // Inside the wall, the surface of the water is not there.
    assert_eq!(table.relative_ior(water, in_glass), None);
    let in_both = table.across(water, true, in_glass);
    assert_eq!(table.filling(in_both), [0]);
    // Leaving the wall into the water: glass against water.
    assert_eq!(table.relative_ior(glass, in_both), Some(1.5 / 1.33));
    let in_water = table.across(glass, false, in_both);
    assert_eq!(table.filling(in_water), [1]);
    assert_eq!(table.across(water, false, in_water), air);
}

#[test]
fn of_equal_priority_the_inner_holds() {
    let fog = boundary(0, 10.0, None, 0);
    let ball = boundary(1, 1.0, Some(1.5), 0);
    let table = Boundaries::new(vec![ball, fog], vec![]).unwrap();
    let [fog, ball] = [0, 1].map(|s| table.of_shape(s).unwrap());
    let in_fog = table.across(fog, true, table.ambient());
    let in_ball = table.across(ball, true, in_fog);
    assert_eq!(table.filling(in_ball), [1]);
    assert_eq!(table.relative_ior(ball, in_fog), Some(1.5));
    assert!(!table.may_be_null(ball) && table.may_be_null(fog));
}

/// A small box of smoke half in a big block of glass.
#[test]
fn smoke_fills_glass_and_does_not_hide_it() {
    let glass = boundary(0, 10.0, Some(1.5), 0);
    let mut smoke = boundary(1, 1.0, None, 0);
    smoke.bounds.min.x += 10.0;
    smoke.bounds.max.x += 10.0;
    let table = |smoke| Boundaries::new(vec![glass.clone(), smoke], vec![]).unwrap();
    let into_glass = |table: &Boundaries| {
        let [glass, smoke] = [0, 1].map(|s| table.of_shape(s).unwrap());
        let in_smoke = table.across(smoke, true, table.ambient());
        let in_both = table.across(glass, true, in_smoke);
        let filling = table.filling(in_both).to_vec();
        (table.relative_ior(glass, in_smoke), filling)
    };
    let tied = table(smoke.clone());
    assert_eq!(into_glass(&tied), (Some(1.5), vec![1]));
    assert!(!tied.may_be_null(tied.of_shape(0).unwrap()));
    let first = table(Boundary {
        priority: 1,
        ..smoke
    });
    assert_eq!(into_glass(&first), (None, vec![1]));
}

/// Two plumes that overlap, in fog, and a ball of glass in the middle.
#[test]
fn what_adds_shares_its_place_but_not_that_of_glass() {
    let adding = |shape, half, inside| Boundary {
        inside: vec![inside],
        adds: true,
        priority: 3,
        ..boundary(shape, half, None, 0)
    };
    let glass = Boundary {
        priority: 4,
        ..boundary(2, 0.5, Some(1.5), 0)
    };
    let plumes = [adding(0, 2.0, 8), adding(1, 1.0, 5)];
    let table = Boundaries::new([plumes.to_vec(), vec![glass]].concat(), vec![7]).unwrap();
    let [outer, inner, glass] = [0, 1, 2].map(|s| table.of_shape(s).unwrap());
    let in_one = table.across(outer, true, table.ambient());
    assert_eq!(table.filling(in_one), [7, 8]);
    let in_two = table.across(inner, true, in_one);
    assert_eq!(table.filling(in_two), [5, 7, 8]);
    let in_glass = table.across(glass, true, in_two);
    assert_eq!(table.filling(in_glass), [2]);
    assert_eq!(table.relative_ior(glass, in_two), Some(1.5));
    let in_inner = table.across(outer, false, in_two);
    assert_eq!(table.filling(in_inner), [5, 7]);
    // The outer plume may reach into the glass; of higher rank, it fills it as well.
    let thin = Boundary {
        priority: 0,
        ..boundary(2, 0.5, Some(1.5), 0)
    };
    let table = Boundaries::new([plumes.to_vec(), vec![thin]].concat(), vec![]).unwrap();
    let all = table.state(&[0, 1, 2]);
    assert_eq!(table.filling(all), [2, 5, 8]);
    assert_eq!(table.relative_ior(0, all), Some(1.5), "the glass is seen");
}

#[test]
fn outside_replaces_what_is_around() {
    let sea = Boundary {
        outside: Some(vec![]),
        ..boundary(0, 1.0, None, 0)
    };
    let table = Boundaries::new(vec![sea], vec![7]).unwrap();
    let sea = table.of_shape(0).unwrap();
    assert_eq!(table.filling(table.ambient()), [7]);
    assert_eq!(table.across(sea, false, table.ambient()), MediumId::VACUUM);
}

/// What a table of all steps would be, crossing by crossing, along random ways through boxes
/// that overlap here and there.
#[test]
fn states_hold_what_was_entered_and_not_left() {
    let boxes: Vec<_> = (0..12)
        .map(|i| {
            let mut b = boundary(i, 1.0, Some(1.0 + i as f32), (i % 3) as i32);
            b.bounds.min.x += 1.5 * i as f32;
            b.bounds.max.x += 1.5 * i as f32;
            b
        })
        .collect();
    let table = Boundaries::new(boxes, vec![99]).unwrap();
    let (mut here, mut inside, mut seed) = (table.ambient(), Vec::<u32>::new(), 1_u32);
    for _ in 0..10_000 {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (b, entering) = ((seed >> 16) % 12, seed >> 31 == 0);
        here = table.across(b, entering, here);
        if entering && !inside.contains(&b) {
            inside.retain(|&m| table.overlap(m, b));
            inside.push(b);
            inside.sort_unstable();
        } else if !entering {
            inside.retain(|&m| m != b);
        }
        assert_eq!(table.states[here.0 as usize].members, inside);
        assert_eq!(table.states[here.0 as usize].base, [99]);
    }
}

#[test]
fn ten_thousand_separate_boundaries_in_fog_load() {
    let balls = (0..10_000).map(|i| {
        let mut ball = boundary(i + 1, 0.4, Some(1.5), 0);
        let shift = Vec3::new((i % 100) as f32, 0.0, (i / 100) as f32);
        ball.bounds.min += shift;
        ball.bounds.max += shift;
        ball
    });
    let fog = boundary(0, 1e3, None, 0);
    let table = Boundaries::new(balls.chain([fog]).collect(), vec![]).unwrap();
    assert_eq!(table.states.len(), 2 * 10_001);
    let steps: usize = table.steps.iter().map(Vec::len).sum();
    assert_eq!(steps, 10_001 + 10_001 + 10_000 * 2 + 10_000 * 2);
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
    let table = Boundaries::new(balls.chain([fog]).collect(), vec![]).unwrap();
    assert_eq!(table.states.len(), 2 * 201);
    let crowd = (0..40).map(|i| boundary(i, 1.0, Some(1.5), 0));
    assert!(Boundaries::new(crowd.collect(), vec![]).is_none());
}
