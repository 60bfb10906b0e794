//! Predictions of the fitted mode at the measured levels.

use iwan_core::FourParameter;
use iwan_ident::sweeps::{SteadyData, SteadyFit};
use iwan_sim::{JointLaw, Mode, Sweep, forced_response};

use super::measurement::Measurement;
use crate::failure::Failure;

/// Predicted curves extend beyond the measured frequencies by this part of the measured range, on either side.
const BEYOND: f64 = 0.05;

/// The fitted mode as a mode of the library.
pub(super) fn mode(name: &str, fit: &SteadyFit) -> Result<Mode, Failure> {
    let p = fit.parameters;
    let joint = FourParameter::new(p.k_t, p.f_s, p.chi, p.beta);
    let joint = joint.map_err(|error| Failure::computation(error.to_string()))?;
    Ok(Mode {
        damping_ratio: p.damping_ratio,
        ..Mode::new(name, p.frequency, Some(JointLaw::FourParameter(joint)))
    })
}

/// A predicted curve of one level; a point is [frequency in Hz, amplitude, phase in rad].
#[derive(Debug, Clone, Default)]
pub(super) struct Curve {
    /// Index of the level in its measurement.
    pub(super) level: usize,
    pub(super) points: Vec<[f64; 3]>,
}

/// Predicted curves at the levels of a measurement, with the static part of the other modes. `drift` is ln of the measurement's linear frequency over
/// that of the reference (structures drift from day to day).
pub(super) fn curves(
    mode: &Mode,
    fit: &SteadyFit,
    measurement: &Measurement,
    drift: f64,
) -> Result<Vec<Curve>, Failure> {
    let SteadyData::Response(points) = &measurement.data else { return Ok(Vec::new()) };
    // To first order a drift of the linear frequency moves the frequency at every amplitude by the same ratio.
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
