//! Start values of the search, from what the points show without a law.

use std::f64::consts::{PI, TAU};

use super::data::{BackbonePoint, SteadyData};
use crate::error::Error;
use crate::parameters::Parameters;

/// Powers χ that are tried: the values in the literature lie between them.
const POWERS: [f64; 2] = [-0.6, -0.2];
/// Start value of the knee φ_max over the largest amplitude: the search goes inwards from there.
const KNEE: f64 = 10.0;
/// Fraction of the smallest loss that is put down to viscous damping at the start.
const VISCOUS: f64 = 0.3;
/// Start value of β, the Dirac's share.
const BETA: f64 = 0.1;
/// A point is in resonance, where it shows loss and stiffness, if its dynamic stiffness is at most this many times the imaginary part.
pub(super) const RESONANT: f64 = 10.0;

/// Squared circular frequency (`stiffness`) and imaginary stiffness (`loss`) at an amplitude.
struct Seen {
    amplitude: f64,
    stiffness: f64,
    loss: f64,
}

/// Start values, one set for each power in POWERS.
pub(super) fn guesses(sets: &[SteadyData]) -> Result<Vec<Parameters>, Error> {
    let mut seen = seen(sets);
    seen.sort_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
    let quarter = (seen.len() / 4).max(1);
    let (Some(low), Some(high)) = (seen.get(..quarter), seen.len().checked_sub(quarter)) else {
        return Err(Error::Refused {
            finding: "no point shows a resonance: the phase against the force is nowhere between 0 and -180 degrees".into(),
            remedy: "check the sign of the phase, the quantity of the response, and whether the band holds the resonance",
        });
    };
    let high = &seen[high..];
    let median = |of: &[Seen], value: fn(&Seen) -> f64| {
        let mut values: Vec<f64> = of.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let [at_low, at_high] = [low, high].map(|of| median(of, |s| s.stiffness));
    let top = seen.last().map_or(1.0, |s| s.amplitude);
    let (a, loss) = (median(high, |s| s.amplitude), median(high, |s| s.loss));
    let viscous = VISCOUS * median(low, |s| s.loss).min(loss);
    let guess = |chi: f64| {
        // In micro-slip the loss is D/(π a²) = 4 R a^(χ+1)/(π (χ+2)(χ+3)).
        let r = (loss - viscous) * PI * (chi + 2.0) * (chi + 3.0) / (4.0 * a.powf(chi + 1.0));
        let phi_max = KNEE * top;
        let of_power = r * phi_max.powf(chi + 1.0) / (chi + 1.0);
        let softened = (2.0 * r * a.powf(chi + 1.0) / ((chi + 1.0) * (chi + 2.0))).min(of_power);
        let stiffness = at_low.max(at_high) + 0.2 * softened;
        let k_t = (of_power * (1.0 + BETA)).min(0.9 * stiffness);
        let f_s = phi_max * k_t * (BETA + (chi + 1.0) / (chi + 2.0)) / (1.0 + BETA);
        let frequency = stiffness.sqrt() / TAU;
        let damping_ratio = (0.5 * viscous / stiffness).clamp(0.0, 0.4);
        Parameters { frequency, damping_ratio, k_t, f_s, chi, beta: BETA }
    };
    Ok(POWERS.map(guess).to_vec())
}

/// Stiffness and loss of the points in resonance; where none is, of all points that show a loss.
fn seen(sets: &[SteadyData]) -> Vec<Seen> {
    let all = |most: f64| -> Vec<Seen> { sets.iter().flat_map(|set| of_set(set, most)).collect() };
    let resonant = all(RESONANT);
    if resonant.is_empty() { all(f64::INFINITY) } else { resonant }
}

/// The same as backbones, one for each measurement that shows anything, its points in the order of amplitude.
pub(super) fn shown(sets: &[SteadyData]) -> Vec<SteadyData> {
    let as_backbone = |most: f64| -> Vec<SteadyData> {
        let each = sets.iter().map(|set| {
            let mut seen = of_set(set, most);
            seen.sort_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
            seen.iter().map(Seen::of_backbone).collect::<Vec<_>>()
        });
        each.filter(|points| !points.is_empty()).map(SteadyData::Backbone).collect()
    };
    let resonant = as_backbone(RESONANT);
    if resonant.is_empty() { as_backbone(f64::INFINITY) } else { resonant }
}

impl Seen {
    fn of_backbone(&self) -> BackbonePoint {
        let Self { amplitude, stiffness, loss } = *self;
        BackbonePoint { amplitude, frequency: stiffness.sqrt() / TAU, damping_ratio: 0.5 * loss / stiffness }
    }
}

fn of_set(set: &SteadyData, most: f64) -> Vec<Seen> {
    match set {
        SteadyData::Response(points) => points
            .iter()
            .filter_map(|p| {
                let (z, omega) = (p.force / p.amplitude, TAU * p.frequency);
                let (re, loss) = (z * p.phase.cos(), -z * p.phase.sin());
                let stiffness = re + omega * omega;
                let shows = loss > 0.0 && stiffness > 0.0 && z <= most * loss;
                shows.then_some(Seen { amplitude: p.amplitude, stiffness, loss })
            })
            .collect(),
        SteadyData::Backbone(points) => points
            .iter()
            .map(|p| {
                let stiffness = (TAU * p.frequency).powi(2);
                Seen { amplitude: p.amplitude, stiffness, loss: 2.0 * p.damping_ratio * stiffness }
            })
            .collect(),
    }
}
