//! What the fitted mode predicts where it was measured.

use iwan_core::FourParameter;
use iwan_ident::sweeps::{SteadyData, SteadyFit};
use iwan_sim::{JointLaw, Mode, Sweep, forced_response};

use super::measurement::Measurement;
use crate::failure::Failure;

/// How far a predicted curve runs beyond the measured frequencies, as a part of their range.
const BEYOND: f64 = 0.05;

/// The fitted mode by itself.
pub(super) fn mode(name: &str, fit: &SteadyFit) -> Result<Mode, Failure> {
    let p = fit.parameters;
    let joint = FourParameter::new(p.k_t, p.f_s, p.chi, p.beta);
    let joint = joint.map_err(|error| Failure::computation(error.to_string()))?;
    Ok(Mode {
        damping_ratio: p.damping_ratio,
        ..Mode::new(name, p.frequency, Some(JointLaw::FourParameter(joint)))
    })
}

/// Frequency, amplitude and phase along the curve of a level.
#[derive(Debug, Clone, Default)]
pub(super) struct Curve {
    /// Which level of its measurement.
    pub(super) level: usize,
    pub(super) points: Vec<[f64; 3]>,
}

/// The mode's curves at the levels of a measurement, with the other modes' part, on the day of the measurement.
pub(super) fn curves(
    mode: &Mode,
    fit: &SteadyFit,
    measurement: &Measurement,
    drift: f64,
) -> Result<Vec<Curve>, Failure> {
    let SteadyData::Response(points) = &measurement.data else { return Ok(Vec::new()) };
    // To first order the day moves the frequency of every amplitude alike.
    let day = drift.exp();
    let mut curves = Vec::new();
    for (n, level) in measurement.levels.iter().enumerate() {
        let Some((control, value)) = level.held else { continue };
        let frequencies = || level.points.iter().map(|&i| points[i].frequency / day);
        let (low, high) = (frequencies().fold(f64::INFINITY, f64::min), frequencies().fold(0.0, f64::max));
        let margin = BEYOND * (high - low);
        if margin <= 0.0 {
            continue;
        }
        let sweep = Sweep {
            from: (low - margin).max(0.5 * low),
            to: high + margin,
            control,
            levels: vec![value],
            harmonics: 1,
            points: Sweep::DEFAULT_POINTS,
        };
        let found =
            forced_response(mode, &sweep, 1.0).map_err(|error| Failure::computation(error.to_string()))?;
        let with_others = |p: &iwan_sim::SteadyPoint| {
            let (re, im) = (p.amplitude * p.phase.cos(), p.amplitude * p.phase.sin());
            let re = re + fit.others * p.excitation;
            [p.frequency * day, re.hypot(im), im.atan2(re)]
        };
        let points = found.iter().flat_map(|curve| &curve.points).map(with_others).collect();
        curves.push(Curve { level: n, points });
    }
    Ok(curves)
}
