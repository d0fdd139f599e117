//! Pearson's χ² test.

use statrs::function::gamma::gamma_ur;

/// Smallest expected count of a cell for which χ² is trusted (Cochran 1954).
const POOL_BELOW: f64 = 5.0;

/// Whether counts follow their expectations, at the given false-alarm rate (Pearson 1900).
///
/// Cells that expect less than 5 are pooled, smallest first. Both slices sum to the number of
/// samples, so that one degree of freedom is lost; the rate is asymptotic, within a factor two for
/// rates down to 1e-6 where most cells expect 20 or more.
///
/// ```
/// use tyndall_testkit::stats::chi2_test;
/// assert!(chi2_test(&[48.0, 52.0], &[50.0, 50.0], 1e-3).is_ok());
/// assert!(chi2_test(&[20.0, 80.0], &[50.0, 50.0], 1e-3).is_err());
/// ```
///
/// # Errors
/// A sentence with the worst cell if the counts disagree, if a cell that expects nothing was hit,
/// or if the sums differ.
///
/// # Panics
/// If the slices differ in length.
pub fn chi2_test(observed: &[f64], expected: &[f64], false_alarm: f64) -> Result<(), String> {
    assert_eq!(observed.len(), expected.len(), "counts and expectations");
    check_totals(observed, expected)?;
    let cells = pool(observed, expected);
    if cells.len() < 2 {
        return Err("fewer than two cells expect five samples: draw more".to_owned());
    }
    let statistic: f64 = cells.iter().map(|&(o, e, _)| (o - e).powi(2) / e).sum();
    let freedom = (cells.len() - 1) as f64;
    let p = if statistic > 0.0 {
        gamma_ur(0.5 * freedom, 0.5 * statistic)
    } else {
        1.0
    };
    if p >= false_alarm {
        return Ok(());
    }
    let badness = |&(o, e, _): &(f64, f64, usize)| (o - e).powi(2) / e;
    let worst = cells
        .iter()
        .max_by(|a, b| badness(a).total_cmp(&badness(b)));
    let &(o, e, i) = worst.unwrap_or(&(0.0, 0.0, 0));
    Err(format!(
        "χ² = {statistic:.1} with {freedom} degrees of freedom (probability {p:.1e}, threshold \
         {false_alarm:.1e}); worst is cell {i}: {o} samples, {e:.1} expected"
    ))
}

fn check_totals(observed: &[f64], expected: &[f64]) -> Result<(), String> {
    for (i, (&o, &e)) in observed.iter().zip(expected).enumerate() {
        if !(o >= 0.0 && e >= 0.0 && o.is_finite() && e.is_finite()) {
            return Err(format!("cell {i}: {o} samples, {e} expected"));
        }
        if e == 0.0 && o > 0.0 {
            return Err(format!("cell {i}: {o} samples where none can be"));
        }
    }
    let (drawn, total) = (observed.iter().sum::<f64>(), expected.iter().sum::<f64>());
    // A difference of 0.1·√n adds at most 0.01 to the statistic.
    if (drawn - total).abs() > 0.1 * drawn.sqrt() {
        return Err(format!(
            "{drawn} samples, {total:.2} expected: the expectations leave out some outcome"
        ));
    }
    Ok(())
}

/// (observed, expected, index) of cells that expect enough; small ones merged.
fn pool(observed: &[f64], expected: &[f64]) -> Vec<(f64, f64, usize)> {
    let mut order: Vec<usize> = (0..expected.len()).filter(|&i| expected[i] > 0.0).collect();
    order.sort_by(|&a, &b| expected[a].total_cmp(&expected[b]));
    let mut cells: Vec<(f64, f64, usize)> = Vec::new();
    for i in order {
        match cells.last_mut() {
            Some(last) if last.1 < POOL_BELOW => {
                *last = (last.0 + observed[i], last.1 + expected[i], i)
            }
            _ => cells.push((observed[i], expected[i], i)),
        }
    }
    cells
}
