//! Orders of convergence.

/// The power of a fitted power law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// d ln y / d ln x.
    pub slope: f64,
    /// Its standard deviation, from the scatter of the points around the line; `points − 2` are
    /// its degrees of freedom, and it is infinite for two points.
    pub standard_error: f64,
}

/// The power s of y ∝ xˢ: least squares of ln y over ln x, every point of the same weight.
///
/// An error that falls with the number of passes is such a law. The standard error presumes points
/// of independent and equal *relative* error: errors of several runs at different lengths, not one
/// run watched as it goes on, whose points share their samples.
///
/// ```
/// use tyndall_testkit::stats::log_log_slope;
/// let fit = log_log_slope(&[(1.0, 8.0), (4.0, 4.0), (16.0, 2.0)]);
/// assert!((fit.slope + 0.5).abs() < 1e-15 && fit.standard_error < 1e-15);
/// ```
///
/// # Panics
/// If a coordinate is not positive and finite, or fewer than two x differ.
pub fn log_log_slope(points: &[(f64, f64)]) -> Slope {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .map(|&(x, y)| {
            let lawful = |v: f64| v > 0.0 && v.is_finite();
            assert!(lawful(x) && lawful(y), "no power law through ({x}, {y})");
            (x.ln(), y.ln())
        })
        .collect();
    let n = logs.len() as f64;
    let (sum_x, sum_y) = logs
        .iter()
        .fold((0.0, 0.0), |(a, b), (x, y)| (a + x, b + y));
    let (mean_x, mean_y) = (sum_x / n, sum_y / n);
    let (mut xx, mut xy) = (0.0, 0.0);
    for (x, y) in &logs {
        xx += (x - mean_x).powi(2);
        xy += (x - mean_x) * (y - mean_y);
    }
    assert!(xx > 0.0, "a slope needs two different x");
    let slope = xy / xx;
    let residuals: f64 = logs
        .iter()
        .map(|(x, y)| (y - mean_y - slope * (x - mean_x)).powi(2))
        .sum();
    let standard_error = if logs.len() > 2 {
        (residuals / ((n - 2.0) * xx)).sqrt()
    } else {
        f64::INFINITY
    };
    Slope {
        slope,
        standard_error,
    }
}

/// The root of the mean squared error of pairs (estimate, reference): of one quantity over runs, or
/// of the pixels of an image. Of n independent runs its own relative standard error is 1/√(2n).
///
/// ```
/// use tyndall_testkit::stats::rmse;
/// assert_eq!(rmse([5.0, 5.0, 1.0, 1.0].map(|estimate| (estimate, 3.0))), 2.0);
/// ```
///
/// # Panics
/// If there are no pairs.
pub fn rmse(pairs: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u64);
    for (estimate, reference) in pairs {
        sum += (estimate - reference).powi(2);
        count += 1;
    }
    assert!(count > 0, "no estimates, no error");
    (sum / count as f64).sqrt()
}
