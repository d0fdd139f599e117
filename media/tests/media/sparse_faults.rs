//! Sparse grids that no medium can take: one error that names what is wrong first.

use glam::{DAffine3, DVec3, IVec3};
use tyndall_core::{Coefficients, Rgb};
use tyndall_media::{
    DenseGrid, GridMedium, MediumError, Phase, Precision, SparseBuilder, SparseGrid, TileSize,
};

const BAD: [f32; 4] = [-1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
const PRECISIONS: [Precision; 2] = [Precision::Single, Precision::Half];

fn coefficients(sigma: f32) -> Coefficients<f32> {
    Coefficients {
        sigma_a: sigma,
        sigma_s: sigma,
        emission: 0.0,
    }
}

fn fault(grid: SparseGrid) -> MediumError {
    GridMedium::new(grid, coefficients(1.0), Phase::Isotropic).unwrap_err()
}

/// NaN is not equal to itself.
fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

#[track_caller]
fn names(error: &MediumError, at: [i32; 3], bad: f32) {
    let MediumError::Voxel {
        voxel,
        channel,
        value,
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((*voxel, *channel), (at, 0));
    assert!(same(*value, bad), "{value} for {bad}");
    let [x, y, z] = at;
    let message = error.to_string();
    assert!(
        message.contains(&format!("[{x}, {y}, {z}]")) && !message.contains('\n'),
        "{message}"
    );
}

/// In the order of the tree (x slowest within a leaf), whatever the order in which they were set,
/// active or not.
#[test]
fn the_first_bad_voxel_is_named() {
    for (bad, precision) in BAD.into_iter().flat_map(|bad| PRECISIONS.map(|p| (bad, p))) {
        let mut grid = SparseBuilder::new(0.0).with_precision(precision);
        for at in [[900, 1, 1], [9, 3, 2], [9, 2, 7], [3, 5, 1], [-5, 0, 0]] {
            let value = if at[0] < 0 { 1.0 } else { bad };
            grid.voxel(IVec3::from(at), value).unwrap();
        }
        names(
            &fault(grid.build(DAffine3::IDENTITY).unwrap()),
            [3, 5, 1],
            bad,
        );

        let mut values = [0.5; 512];
        values[8 * 64 - 1] = bad;
        values[77] = bad;
        let mut grid = SparseBuilder::new(0.0).with_precision(precision);
        grid.leaf(IVec3::splat(-8), &values, [0; 8]).unwrap();
        let first = [-8 + 1, -8 + 1, -8 + 5];
        names(&fault(grid.build(DAffine3::IDENTITY).unwrap()), first, bad);
    }
}

#[test]
fn a_bad_tile_is_named_by_its_first_voxel() {
    let sizes = [TileSize::Leaf, TileSize::Lower, TileSize::Upper];
    for (bad, size) in BAD
        .into_iter()
        .flat_map(|bad| sizes.map(|size| (bad, size)))
    {
        for active in [false, true] {
            let mut grid = SparseBuilder::new(0.0);
            grid.voxel(IVec3::new(9000, 0, 0), bad).unwrap();
            grid.tile(IVec3::new(-4096, 4096, 0), size, bad, active)
                .unwrap();
            let fault = fault(grid.build(DAffine3::IDENTITY).unwrap());
            names(&fault, [-4096, 4096, 0], bad);
        }
    }
}

/// Everywhere around the voxels, and so at none of them.
#[test]
fn a_bad_background_is_named_as_such() {
    for (bad, precision) in BAD.into_iter().flat_map(|bad| PRECISIONS.map(|p| (bad, p))) {
        let mut grid = SparseBuilder::new(bad).with_precision(precision);
        grid.tile(IVec3::ZERO, TileSize::Leaf, 1.0, true).unwrap();
        let fault = fault(grid.build(DAffine3::IDENTITY).unwrap());
        let MediumError::Background { channel: 0, value } = fault else {
            panic!("{fault}");
        };
        assert!(same(value, bad), "{value} for {bad}");
        assert!(fault.to_string().contains("background"), "{fault}");
    }
}

/// Halves end at 65504: a grid that holds more keeps 32 bits.
#[test]
fn what_no_half_can_say_stays_single() {
    let mut grid = SparseBuilder::new(0.0_f32).with_precision(Precision::Half);
    grid.voxel(IVec3::ONE, 1e6).unwrap();
    let grid = grid.build(DAffine3::IDENTITY).unwrap();
    assert_eq!(grid.precision(), Precision::Single);
    assert_eq!(grid.voxel(IVec3::ONE), 1e6);
}

/// The second channel of an albedo, and an albedo that is no share.
#[test]
fn a_bad_albedo_names_its_channel() {
    let bounds = tyndall_core::Aabb {
        min: glam::Vec3::ZERO,
        max: glam::Vec3::ONE,
    };
    let with_albedo = |green| {
        let mut albedo = SparseBuilder::new(Rgb::new(0.5, 0.5, 0.5));
        (albedo.voxel(IVec3::new(4, -2, 1), Rgb::new(0.5, green, 0.5))).unwrap();
        let density = DenseGrid::new([1; 3], bounds, vec![1.0]).unwrap();
        let coefficients = Coefficients {
            sigma_a: Rgb::new(1.0, 1.0, 1.0),
            sigma_s: Rgb::default(),
            emission: Rgb::default(),
        };
        GridMedium::new(density, coefficients, Phase::Isotropic)
            .unwrap()
            .with_albedo(albedo.build(DAffine3::IDENTITY).unwrap())
    };
    assert!(with_albedo(1.0).is_ok());
    let fault = with_albedo(f32::NAN).unwrap_err();
    let (voxel, channel) = ([4, -2, 1], 1);
    assert!(
        matches!(fault, MediumError::Voxel { voxel: v, channel: c, .. } if (v, c) == (voxel, channel)),
        "{fault}"
    );
    let fault = with_albedo(1.5).unwrap_err();
    assert!(
        matches!(fault, MediumError::Albedo { channel: 1, .. }),
        "{fault}"
    );
}

/// Sizes that the `f32` of rays cannot say, and extinctions that would take for ever.
#[test]
fn a_medium_of_no_size_or_no_end_is_an_error() {
    let medium = |scale: f64, sigma| {
        let mut grid = SparseBuilder::new(0.0);
        grid.voxel(IVec3::ZERO, 1.0).unwrap();
        let grid = grid.build(DAffine3::from_scale(DVec3::splat(scale)));
        GridMedium::new(grid.unwrap(), coefficients(sigma), Phase::Isotropic).map(drop)
    };
    assert_eq!(medium(1.0, 1.0), Ok(()));
    for scale in [1e-50, 1e-20, 1e20] {
        assert_eq!(medium(scale, 0.0), Err(MediumError::GridBounds), "{scale}");
    }
    assert_eq!(medium(1e50, 0.0), Err(MediumError::Endless));
    let dense = medium(1.0, 1e30);
    assert!(
        matches!(dense, Err(MediumError::TooDense { .. })),
        "{dense:?}"
    );
}
