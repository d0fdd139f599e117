//! Short tests and long ones of the same things.

/// How long a test may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// With every change: it sees what is lost or counted twice.
    Short,
    /// By hand: standard errors of 1 % at the most.
    Long,
}

impl Tier {
    /// Of a short test and a long one.
    pub fn passes(self, [short, long]: [u64; 2]) -> u64 {
        match self {
            Self::Short => short,
            Self::Long => long,
        }
    }

    /// The relative standard error that is asked for.
    pub fn precision(self, short: f64) -> f64 {
        match self {
            Self::Short => short,
            Self::Long => short.min(0.01),
        }
    }
}

/// A short test, in a module `in_short`, and a long one that is ignored, in `in_detail`, of each of
/// these functions of a [`Tier`].
///
/// ```
/// # use tyndall_testkit::{Tier, in_both_tiers};
/// in_both_tiers! { light_is_right }
///
/// fn light_is_right(tier: Tier) {
///     assert!(tier.passes([10, 1000]) >= 10);
/// }
/// ```
#[macro_export]
macro_rules! in_both_tiers {
    ($($name:ident),+ $(,)?) => {
        mod in_short {
            $(
                #[test]
                fn $name() {
                    super::$name($crate::Tier::Short);
                }
            )+
        }

        mod in_detail {
            $(
                #[test]
                #[ignore = "long: cargo test in_detail -- --ignored"]
                fn $name() {
                    super::$name($crate::Tier::Long);
                }
            )+
        }
    };
}
