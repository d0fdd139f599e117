//! Sparse grids against a map of voxels.

use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3, Vec3};
use std::collections::HashMap;
use tyndall_core::{Aabb, Coefficients, Rgb, Sampler};
use tyndall_media::{
    DenseGrid, Field, Filter, GridMedium, Hint, MediumError, Phase, Precision, Region,
    SparseBuilder, SparseGrid, TileSize, plume,
};
use tyndall_testkit::rng;

/// Shears, turns, mirrors and moves.
fn skewed() -> DAffine3 {
    let turn = DMat3::from_quat(DQuat::from_rotation_x(0.7) * DQuat::from_rotation_z(-1.1));
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.3, 1.0, 0.0), DVec3::Z);
    let scale = DMat3::from_diagonal(DVec3::new(0.1, -0.2, 0.15));
    DAffine3::from_mat3_translation(turn * shear * scale, DVec3::new(3.0, -2.0, 5.0))
}

/// What a grid is to hold: voxels, and tiles by their first voxel and edge.
struct Reference {
    background: f32,
    voxels: HashMap<IVec3, f32>,
    tiles: Vec<(IVec3, i32, f32)>,
}

impl Reference {
    fn at(&self, ijk: IVec3) -> f32 {
        if let Some(value) = self.voxels.get(&ijk) {
            return *value;
        }
        let holds = |(origin, edge, _): &&(IVec3, i32, f32)| {
            ijk.cmpge(*origin).all() && ijk.cmplt(*origin + *edge).all()
        };
        self.tiles
            .iter()
            .find(holds)
            .map_or(self.background, |t| t.2)
    }

    /// In the order of `random`.
    fn build(&self, random: &mut impl Sampler, precision: Precision) -> SparseBuilder {
        let mut grid = SparseBuilder::new(self.background).with_precision(precision);
        for &(origin, edge, value) in &self.tiles {
            let size = match edge {
                8 => TileSize::Leaf,
                128 => TileSize::Lower,
                _ => TileSize::Upper,
            };
            grid.tile(origin, size, value, true).unwrap();
        }
        let mut voxels: Vec<_> = self.voxels.iter().collect();
        voxels.sort_by_key(|(ijk, _)| ijk.to_array());
        for i in (1..voxels.len()).rev() {
            voxels.swap(i, (random.next_1d() * (i + 1) as f32) as usize);
        }
        for (ijk, value) in voxels {
            grid.voxel(*ijk, *value).unwrap();
        }
        grid
    }
}

/// Clusters of voxels around corners of nodes of every size, and tiles of every size.
fn reference(random: &mut impl Sampler) -> Reference {
    let mut voxels = HashMap::new();
    let places = [0, -1, 8, 127, 128, -4096, 4095, 5000].map(IVec3::splat);
    for place in places.into_iter().chain([IVec3::new(-70_000, 3, 99_999)]) {
        for _ in 0..60 {
            let offset = Vec3::from(random.next::<3>()) * 12.0 - 6.0;
            let ijk = place + offset.round().as_ivec3();
            voxels.insert(ijk, 2.0 * random.next_1d());
        }
    }
    let tiles = vec![
        (IVec3::new(16, 0, 0), 8, 0.75),
        (IVec3::new(256, 0, -128), 128, 0.5),
        (IVec3::new(8192, 0, 0), 4096, 0.25),
    ];
    Reference {
        background: 0.125,
        voxels,
        tiles,
    }
}

/// Points among the voxels: near clusters and tiles, mostly.
fn places(reference: &Reference, random: &mut impl Sampler) -> Vec<DVec3> {
    let centers: Vec<IVec3> = {
        let mut all: Vec<_> = reference.voxels.keys().copied().collect();
        all.sort_by_key(|ijk| ijk.to_array());
        all.extend(
            reference
                .tiles
                .iter()
                .flat_map(|(o, e, _)| [*o, *o + (*e - 1), *o + *e / 2]),
        );
        all
    };
    let offset = |random: &mut dyn FnMut() -> f32| {
        DVec3::from_array([(); 3].map(|()| f64::from(random()) * 4.0 - 2.0))
    };
    centers
        .iter()
        .flat_map(|c| [c.as_dvec3(); 4])
        .map(|c| c + offset(&mut || random.next_1d()))
        .collect()
}

#[test]
fn voxels_are_where_they_were_put() {
    let mut random = rng(1);
    let reference = reference(&mut random);
    let grid = reference.build(&mut random, Precision::Single);
    let grid = grid.build(DAffine3::IDENTITY).unwrap();
    for place in places(&reference, &mut random) {
        let ijk = place.floor().as_ivec3();
        assert_eq!(grid.voxel(ijk), reference.at(ijk), "{ijk}");
    }
    let tiles: u64 = reference.tiles.iter().map(|t| (t.1 as u64).pow(3)).sum();
    let statistics = grid.statistics();
    assert_eq!(statistics.voxels, tiles + reference.voxels.len() as u64);
    let sum: f64 = reference.voxels.values().map(|v| f64::from(*v)).sum();
    let of_tiles = |t: &(IVec3, i32, f32)| f64::from(t.1).powi(3) * f64::from(t.2);
    let sum = sum + reference.tiles.iter().map(of_tiles).sum::<f64>();
    let mean = sum / statistics.voxels as f64;
    assert!((f64::from(statistics.mean) / mean - 1.0).abs() < 1e-6);
    let least = reference.voxels.values().copied().fold(f32::MAX, f32::min);
    assert_eq!(statistics.min, least.min(0.25));
    let [first, last] = grid.content().unwrap();
    assert_eq!(first.x, reference.voxels.keys().map(|v| v.x).min().unwrap());
    assert_eq!(last.x, 8192 + 4095);
}

/// Interpolation of the reference, in `f64`.
fn interpolated(reference: &Reference, x: DVec3) -> f64 {
    let base = x.floor();
    let mut sum = 0.0;
    for corner in 0..8 {
        let corner = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
        let weight = (1.0 - (x - base - corner.as_dvec3()).abs()).element_product();
        sum += weight * f64::from(reference.at(base.as_ivec3() + corner));
    }
    sum
}

/// By either filter and under any map. The test finds the place by the same inverse as the grid, so
/// that only the interpolation rounds: products of values up to 2 in `f32`, and voxels of
/// [`Precision::Half`] to 2⁻¹¹ of theirs.
#[test]
fn lookups_interpolate_between_voxels() {
    let mut random = rng(2);
    let reference = reference(&mut random);
    for (map, precision, tolerance) in [
        (DAffine3::IDENTITY, Precision::Single, 2e-6),
        (skewed(), Precision::Single, 2e-6),
        (skewed(), Precision::Half, 2e-6 + 1e-3),
    ] {
        let builder = reference.build(&mut random, precision);
        let grid = builder.build(map).unwrap();
        let nearest = grid.clone().with_filter(Filter::Nearest);
        let mut hint = Hint::default();
        for x in places(&reference, &mut random) {
            let p = map.transform_point3(x).as_vec3();
            let x = map.inverse().transform_point3(p.as_dvec3());
            let expected = interpolated(&reference, x);
            let value = Field::lookup(&grid, p, &mut hint);
            assert!(
                (f64::from(value) - expected).abs() < tolerance,
                "{x}: {value} {expected}"
            );
            assert_eq!(value, Field::lookup(&grid, p, &mut Hint::default()));
            let off = (x + 0.5 - (x + 0.5).floor() - 0.5).abs().max_element();
            if off < 0.49 {
                let value = Field::lookup(&nearest, p, &mut hint);
                let expected = reference.at((x + 0.5).floor().as_ivec3());
                assert!(
                    (value - expected).abs()
                        < 1e-3 * f32::from(precision == Precision::Half) + 1e-9
                );
            }
        }
    }
}

#[test]
fn ranges_bound_what_lookups_read() {
    let mut random = rng(3);
    let reference = reference(&mut random);
    for filter in [Filter::Trilinear, Filter::Nearest] {
        let grid = reference
            .build(&mut random, Precision::Single)
            .build(skewed())
            .unwrap();
        let grid = grid.with_filter(filter);
        for place in places(&reference, &mut random) {
            let size = DVec3::splat(40.0) * f64::from(random.next_1d()).powi(2);
            let to_world =
                skewed() * DAffine3::from_translation(place) * DAffine3::from_scale(size);
            let range = grid.range(&Region { to_world });
            assert!(range.min <= range.mean && range.mean <= range.max);
            for _ in 0..20 {
                let inside = Vec3::from(random.next::<3>()).as_dvec3();
                let p = to_world.transform_point3(inside).as_vec3();
                let value = Field::lookup(&grid, p, &mut Hint::default());
                let slack = 1e-6 * range.max;
                assert!(range.min - slack <= value && value <= range.max + slack);
            }
        }
    }
}

#[test]
fn dense_grids_become_sparse_and_dense_again() {
    let bounds = Aabb {
        min: Vec3::new(-1.0, 2.0, 0.5),
        max: Vec3::new(2.0, 4.0, 3.5),
    };
    let dense = plume([30, 20, 33], bounds, 1).unwrap();
    let sparse = SparseGrid::from_dense(&dense, Precision::Single).unwrap();
    let again = sparse.to_dense().unwrap();
    let mut random = rng(4);
    for _ in 0..10_000 {
        let inner = 0.03 + 0.94 * Vec3::from(random.next::<3>());
        let p = bounds.min + inner * bounds.size();
        let expected = dense.lookup(p);
        for value in [
            Field::lookup(&sparse, p, &mut Hint::default()),
            again.lookup(p),
        ] {
            assert!((value - expected).abs() < 1e-5, "{p}: {value} {expected}");
        }
    }
    let half = SparseGrid::from_dense(&dense, Precision::Half).unwrap();
    let (a, b) = (sparse.statistics(), half.statistics());
    // Rounding to 11 bits is even-handed.
    assert!((a.mean - b.mean).abs() < 1e-5 && (a.max - b.max).abs() < 5e-4);
    assert!(half.bytes() < sparse.bytes() * 6 / 10);
    let skew = SparseBuilder::<f32>::new(0.0).build(skewed()).unwrap();
    assert_eq!(skew.to_dense().unwrap_err(), MediumError::NotAligned);
}

/// A cloud that fills 5 % of 256³.
#[test]
fn memory_goes_with_the_leaves() {
    let mut cloud = SparseBuilder::new(0.0_f32);
    let center = DVec3::splat(128.0);
    for i in 0..32_i32.pow(3) {
        let origin = 8 * IVec3::new(i / 1024, i / 32 % 32, i % 32);
        if (origin.as_dvec3() + 4.0).distance(center) < 58.0 {
            cloud.leaf(origin, &[1.0; 512], [u64::MAX; 8]).unwrap();
        }
    }
    let cloud = cloud.build(DAffine3::IDENTITY).unwrap();
    assert!((1_500..1_800).contains(&cloud.leaf_count()));
    let ratio = cloud.bytes() as f64 / (cloud.leaf_count() * 2048) as f64;
    assert!(ratio < 1.06, "{ratio}");
}

#[test]
fn what_is_wrong_is_named() {
    let mut bad = SparseBuilder::new(0.0_f32);
    bad.voxel(IVec3::new(4, 5, 6), -1.0).unwrap();
    bad.voxel(IVec3::new(-9, 5, 6), f32::NAN).unwrap();
    let error = bad.build(DAffine3::IDENTITY).unwrap().check().unwrap_err();
    assert!(
        matches!(
            error,
            MediumError::Voxel {
                voxel: [-9, 5, 6],
                ..
            }
        ),
        "{error}"
    );

    let mut bad = SparseBuilder::new(Rgb::default());
    let tile = Rgb::new(0.0, f32::INFINITY, 0.0);
    bad.tile(IVec3::new(128, 0, 0), TileSize::Lower, tile, false)
        .unwrap();
    let error = bad.build(DAffine3::IDENTITY).unwrap().check().unwrap_err();
    let expected = MediumError::Voxel {
        voxel: [128, 0, 0],
        channel: 1,
        value: f32::INFINITY,
    };
    assert_eq!(error, expected);

    let mut grid = SparseBuilder::new(0.0_f32);
    grid.tile(IVec3::ZERO, TileSize::Lower, 1.0, true).unwrap();
    for error in [
        grid.voxel(IVec3::ONE, 1.0),
        grid.leaf(IVec3::ZERO, &[0.0; 512], [0; 8]),
        grid.leaf(IVec3::ONE, &[0.0; 512], [0; 8]),
        grid.tile(IVec3::ZERO, TileSize::Upper, 1.0, true),
        grid.tile(IVec3::splat(64), TileSize::Lower, 1.0, true),
    ] {
        assert!(matches!(error, Err(MediumError::Block { .. })), "{error:?}");
    }
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    for map in [flat, DAffine3::from_scale(DVec3::splat(f64::NAN))] {
        assert_eq!(grid.clone().build(map).unwrap_err(), MediumError::Transform);
    }
}

#[test]
fn the_ends_of_the_index_space_are_there() {
    let mut grid = SparseBuilder::new(0.0_f32);
    let ends = [IVec3::MIN, IVec3::MAX, IVec3::new(i32::MIN, 0, i32::MAX)];
    for end in ends {
        grid.voxel(end, 1.0).unwrap();
    }
    let grid = grid
        .build(DAffine3::from_scale(DVec3::splat(1e-6)))
        .unwrap();
    for end in ends {
        assert_eq!(grid.voxel(end), 1.0);
        let p = (end.as_dvec3() * 1e-6).as_vec3();
        assert!(Field::lookup(&grid, p, &mut Hint::default()).is_finite());
    }
    assert_eq!(grid.range(&Region::of(grid.bounds())).max, 1.0);
}

#[test]
fn an_empty_grid_is_its_background() {
    let grid = SparseBuilder::new(0.5_f32).build(skewed()).unwrap();
    assert!(grid.bounds().min == Vec3::NEG_INFINITY && grid.content().is_none());
    assert_eq!(grid.statistics().voxels, 0);
    assert_eq!(Field::lookup(&grid, Vec3::ONE, &mut Hint::default()), 0.5);
    let dense: Result<DenseGrid, _> = SparseBuilder::new(0.0_f32)
        .build(DAffine3::IDENTITY)
        .unwrap()
        .to_dense();
    assert!(matches!(dense, Err(MediumError::NotDense { .. })));
}

/// A hint of one grid says nothing of another.
#[test]
fn hints_of_other_grids_change_nothing() {
    let full = |values: &[f32]| {
        let mut grid = SparseBuilder::new(0.0);
        for (i, &value) in (0..).zip(values) {
            grid.leaf(IVec3::new(8 * i, 0, 0), &[value; 512], [!0; 8])
                .unwrap();
        }
        grid.build(DAffine3::IDENTITY).unwrap()
    };
    let (many, few) = (full(&[1.0, 2.0, 3.0]), full(&[0.0, 0.0, 4.0]));
    let mut hint = Hint::default();
    for x in [20.0, 3.0, 20.0, 12.0] {
        let p = Vec3::new(x, 3.0, 3.0);
        for grid in [&many, &few] {
            let value = Field::lookup(grid, p, &mut hint);
            assert_eq!(value, Field::lookup(grid, p, &mut Hint::default()));
        }
    }
}

/// A density that is not 0 somewhere outside of every box, or is no density there.
#[test]
fn backgrounds_of_a_density_are_zero() {
    let medium = |background: f32| {
        let mut grid = SparseBuilder::new(background);
        grid.voxel(IVec3::ZERO, 1.0).unwrap();
        let grid = grid.build(DAffine3::IDENTITY).unwrap();
        GridMedium::<f32, _>::new(grid, Coefficients::default(), Phase::Isotropic).map(|_| ())
    };
    assert_eq!(medium(0.0), Ok(()));
    assert_eq!(medium(0.5), Err(MediumError::Endless));
}

/// What was added before is converted, both ways.
#[test]
fn precision_may_be_chosen_late() {
    let voxels = [
        (IVec3::ZERO, 0.1),
        (IVec3::new(9, 0, 0), -3.0),
        (IVec3::new(-1, 300, 0), 7.5),
    ];
    let add = |grid: &mut SparseBuilder, voxels: &[(IVec3, f32)]| {
        for (at, value) in voxels {
            grid.voxel(*at, *value).unwrap();
        }
    };
    let half = |x: f32| if x == 0.1 { 0.099_975_586 } else { x };
    for first in [Precision::Single, Precision::Half] {
        for then in [Precision::Single, Precision::Half] {
            let mut grid = SparseBuilder::new(0.0).with_precision(first);
            add(&mut grid, &voxels[..2]);
            let mut grid = grid.with_precision(then);
            add(&mut grid, &voxels[2..]);
            let grid = grid.build(DAffine3::IDENTITY).unwrap();
            assert_eq!(grid.precision(), then);
            for (at, value) in voxels {
                let rounded = [first, then].contains(&Precision::Half);
                let expected = if rounded { half(value) } else { value };
                assert_eq!(grid.voxel(at), expected, "{first:?}, {then:?}");
            }
        }
    }
}

/// What halves cannot hold is kept in 32 bits, wherever it comes; infinities stay what they are.
#[test]
fn halves_never_overflow() {
    let late = |value: f32, precision| {
        let mut grid = SparseBuilder::new(0.0).with_precision(precision);
        grid.voxel(IVec3::ZERO, 0.5).unwrap();
        grid.voxel(IVec3::X, value).unwrap();
        grid
    };
    let early = |value: f32| late(value, Precision::Single).with_precision(Precision::Half);
    let leaf = |value: f32| {
        let mut grid = late(1.0, Precision::Half);
        grid.leaf(IVec3::splat(8), &[value; 512], [1; 8]).unwrap();
        grid
    };
    let makers: [(&dyn Fn(f32) -> SparseBuilder, IVec3); 3] = [
        (&|value| late(value, Precision::Half), IVec3::X),
        (&early, IVec3::X),
        (&leaf, IVec3::splat(9)),
    ];
    for (make, at) in makers {
        for (value, precision) in [
            (65_504.0, Precision::Half),
            (-65_504.0, Precision::Half),
            (f32::INFINITY, Precision::Half),
            (70_000.0, Precision::Single),
            (f32::MIN, Precision::Single),
        ] {
            let grid = make(value).build(DAffine3::IDENTITY).unwrap();
            assert_eq!((grid.precision(), grid.voxel(at)), (precision, value));
            assert_eq!(grid.voxel(IVec3::ZERO), 0.5);
        }
    }
    let far = SparseBuilder::new(1e6_f32).with_precision(Precision::Half);
    let far = far.build(DAffine3::IDENTITY).unwrap();
    assert_eq!(
        (far.precision(), far.background()),
        (Precision::Single, 1e6)
    );
}

/// The background is rounded as the voxels of its value are, so that none of them is content.
#[test]
fn background_among_halves_is_no_content() {
    let mut grid = SparseBuilder::new(0.1_f32).with_precision(Precision::Half);
    grid.voxel(IVec3::new(3, 4, 5), 2.0).unwrap();
    (grid.tile(IVec3::splat(128), TileSize::Lower, 0.1, true)).unwrap();
    let grid = grid.build(DAffine3::IDENTITY).unwrap();
    assert_eq!(grid.content(), Some([IVec3::new(3, 4, 5); 2]));
    assert_eq!(grid.background(), 0.099_975_586);
    assert_eq!(grid.statistics().voxels, 1 + 128_u64.pow(3));
}

/// To the bit, where a product with an inverse would round.
#[test]
fn grids_are_placed_anew() {
    let mut grid = SparseBuilder::new(0.0_f32);
    grid.voxel(IVec3::ONE, 1.0).unwrap();
    let grid = grid.build(skewed()).unwrap();
    let other = DAffine3::from_translation(DVec3::new(0.1, 0.2, 0.3)) * skewed().inverse();
    let placed = grid.clone().placed(other).unwrap();
    assert_eq!((placed.to_world(), placed.voxel(IVec3::ONE)), (other, 1.0));
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    assert_eq!(grid.placed(flat).err(), Some(MediumError::Transform));
}
