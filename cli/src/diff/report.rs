//! The figures, for people and for programs.

use super::DiffArguments;
use super::errors::{EPSILON, Largest, Ratio, largest, mean_squares, ratios};
use super::pair::Pair;
use super::significance::{Channel, Verdict, ZTest, test};
use serde::Serialize;
use std::fmt;

/// What `tyndall diff` says.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    image: String,
    reference: String,
    width: u32,
    height: u32,
    channels: &'static [&'static str],
    /// Pixels that are not finite in both images: no figure counts them.
    left_out: usize,
    mse: f64,
    rel_mse: f64,
    rel_mse_epsilon: f64,
    mean_ratio: Vec<Ratio>,
    largest_difference: Largest,
    #[cfg(feature = "flip")]
    flip: super::flip::Flip,
    z_test: Option<ZTest>,
    /// Why there is no z-test.
    no_z_test: Option<String>,
}

impl Report {
    pub(crate) fn of(arguments: &DiffArguments, pair: &Pair<'_>) -> Self {
        let (mse, rel_mse) = mean_squares(pair);
        let (z_test, no_z_test) = match test(pair) {
            Ok(found) => (Some(found), None),
            Err(why) => (None, Some(why)),
        };
        Self {
            image: arguments.image.display().to_string(),
            reference: arguments.reference.display().to_string(),
            width: pair.image.width,
            height: pair.image.height,
            channels: pair.channels(),
            left_out: pair.left_out(),
            mse,
            rel_mse,
            rel_mse_epsilon: EPSILON,
            mean_ratio: ratios(pair),
            largest_difference: largest(pair),
            #[cfg(feature = "flip")]
            flip: super::flip::compare(pair),
            z_test,
            no_z_test,
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (width, height, channels) = (self.width, self.height, self.channels.join(" "));
        writeln!(f, "{} against {}", self.image, self.reference)?;
        writeln!(f, "pixels      {width} × {height}, {channels}")?;
        if self.left_out > 0 {
            writeln!(
                f,
                "not finite  {} pixels, left out of all figures",
                self.left_out
            )?;
        }
        writeln!(f, "MSE         {:.4e}", self.mse)?;
        writeln!(f, "relMSE      {:.4e} (ε = {EPSILON})", self.rel_mse)?;
        for ratio in &self.mean_ratio {
            writeln!(f, "mean ratio  {ratio}")?;
        }
        writeln!(f, "largest     {}", self.largest_difference)?;
        #[cfg(feature = "flip")]
        writeln!(f, "FLIP        {}", self.flip)?;
        match (&self.z_test, &self.no_z_test) {
            (Some(test), _) => write!(f, "{test}"),
            (None, Some(why)) => writeln!(f, "z-test      none: {why}"),
            (None, None) => Ok(()),
        }
    }
}

impl fmt::Display for Ratio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.ratio, self.standard_error) {
            (None, _) => write!(f, "{} none: the reference is black", self.channel),
            (Some(ratio), None) => write!(f, "{} {ratio:.6}", self.channel),
            (Some(ratio), Some(error)) => write!(f, "{} {ratio:.6} ± {error:.6}", self.channel),
        }
    }
}

impl fmt::Display for Largest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        write!(
            f,
            "{:.4e} in {} at ({x}, {y}): {:.4e}, reference {:.4e}",
            self.difference, self.channel, self.image, self.reference
        )
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Agree => "agree",
            Self::Differ => "differ",
        })
    }
}

impl fmt::Display for ZTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rate = 100.0 * self.false_alarm;
        writeln!(f, "z-test      {} (false alarms: {rate} %)", self.verdict)?;
        self.channels.iter().try_for_each(|c| writeln!(f, "{c}"))
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |z: Option<f64>| z.map_or("∞".into(), |z| format!("{z:.2}"));
        let (largest, mean) = (number(self.largest), number(self.mean_z));
        let [x, y] = self.largest_pixel;
        let freedom = self.degrees_of_freedom;
        writeln!(f, "  {} {}", self.channel, self.verdict)?;
        writeln!(
            f,
            "    |z| > 2   {:.3} % of the pixels that vary (4.550 % expected), |z| > 3 {:.3} % (0.270 %)",
            100.0 * self.beyond_2,
            100.0 * self.beyond_3
        )?;
        writeln!(
            f,
            "    largest z {largest} at ({x}, {y}), p {:.1e} in one pixel",
            self.largest_p
        )?;
        writeln!(
            f,
            "    χ²        {:.1} of {freedom} expected, p {:.1e}",
            self.chi2, self.chi2_p
        )?;
        write!(
            f,
            "    mean      {mean} standard errors, p {:.1e}",
            self.mean_p
        )
    }
}
