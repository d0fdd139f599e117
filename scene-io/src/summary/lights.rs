//! Lights.

use crate::Scene;
use crate::light::Source;
use serde::Serialize;
use tyndall_core::Spectrum;

/// All lights of one kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LightSummary {
    /// `area`, `beam`, `directional`, `environment`, `point` or `spot`.
    pub kind: &'static str,
    /// How many there are; for `area`, emissive shapes.
    pub count: usize,
    /// Power of all of them, W, mean of the channels; of light from infinity what falls on the
    /// sphere around the scene.
    pub power: f64,
}

pub(super) fn summarise<S: Spectrum>(scene: &Scene<S>) -> Vec<LightSummary> {
    let mut summaries: Vec<LightSummary> = Vec::new();
    let mut last_shape = None;
    for (source, power) in scene.lights.powers() {
        let shape = match source {
            Source::Area(area) => Some(area.shape),
            _ => None,
        };
        let counted = shape.is_some() && shape == last_shape;
        last_shape = shape;
        let kind = kind(source);
        let i = match summaries.iter().position(|s| s.kind == kind) {
            Some(i) => i,
            None => {
                summaries.push(LightSummary {
                    kind,
                    count: 0,
                    power: 0.0,
                });
                summaries.len() - 1
            }
        };
        summaries[i].count += usize::from(!counted);
        summaries[i].power += f64::from(power.mean());
    }
    summaries.sort_by_key(|s| s.kind);
    summaries
}

fn kind(source: &Source) -> &'static str {
    match source {
        Source::Area(_) => "area",
        Source::Beam(_) => "beam",
        Source::Directional(_) => "directional",
        Source::Environment(_) => "environment",
        Source::Point(_) => "point",
        Source::Spot(_) => "spot",
    }
}
