//! Exponentials of many numbers at once.

use tyndall_density::exp_negative;

#[test]
fn transmittances_are_right_to_three_ten_millionths() {
    let depths: Vec<f32> = (0..400_000)
        .map(|i| i as f32 * (87.0 / 400_000.0))
        .collect();
    let mut found = depths.clone();
    exp_negative(&mut found);
    for (depth, found) in depths.into_iter().zip(found) {
        let expected = (-f64::from(depth)).exp();
        let error = (f64::from(found) / expected - 1.0).abs();
        assert!(error < 3e-7, "{depth}: {found}, {error:.1e} off");
        assert!(found <= 1.0);
    }
}

#[test]
fn beyond_the_range_nothing_is_left() {
    for count in 0..20 {
        let mut depths = vec![0.0, 1e-40, 87.0, 1e4, f32::MAX, f32::INFINITY];
        depths.resize(count, f32::INFINITY);
        exp_negative(&mut depths);
        let expected = [1.0, 1.0].into_iter().chain(std::iter::repeat(0.0));
        assert!(depths.into_iter().eq(expected.take(count)));
    }
}
