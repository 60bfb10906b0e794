//! Nonlinear modes by the extended periodic motion concept: frequency, damping and harmonics of a mode against its amplitude.
//!
//! A free vibration that loses energy is not periodic. Krack (Computers & Structures 154:59, 2015, doi:10.1016/j.compstruc.2015.03.008)
//! makes it periodic by a negative damping -ξ M q' of all modes that returns the lost energy; the damping of the mode is then ξ = 2 ζ ω.

use std::f64::consts::TAU;

use super::balance::Balance;
use super::continuation::Follower;
use super::jointed::JointedModes;
use super::problems::{Problem, Task};
use crate::error::SimulationError;
use crate::mode::Mode;

/// Frequency, damping and motion of a nonlinear mode at one amplitude.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BackbonePoint {
    /// Amplitude of the first harmonic of the modal displacement.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// First harmonic of each joint's slip: amplitude and phase (rad) against the modal displacement.
    pub slips: Vec<[f64; 2]>,
    /// Amplitudes of the response's harmonics 1, 3, 5, …
    pub response: Vec<f64>,
}

/// A nonlinear mode.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NonlinearMode {
    /// The points, with ascending amplitudes.
    pub points: Vec<BackbonePoint>,
    /// Where and why the computation ended before the largest requested amplitude.
    pub remarks: Vec<String>,
}

/// Frequency and damping of one mode against its modal amplitude, with odd harmonics up to `harmonics`. With 1 the result is the closed
/// form of [`Mode::frequency_at`] and [`Mode::damping_ratio_at`].
///
/// # Errors
/// [`SimulationError::Parameter`] for the mode, the harmonics, or amplitudes that are not finite, > 0 and ascending.
///
/// ```
/// use iwan_core::FourParameter;
/// use iwan_sim::{JointLaw, Mode, backbone};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let mode = Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint)));
/// let [one, seven] = [1, 7].map(|harmonics| backbone(&mode, harmonics, &[0.5 * joint.phi_max()]));
/// let (one, seven) = (&one?.points[0], &seven?.points[0]);
/// // For one mode harmonics hardly matter: the joint is a small part of its stiffness.
/// assert!((one.frequency / seven.frequency - 1.0).abs() < 1e-5);
/// # Ok::<(), iwan_sim::SimulationError>(())
/// ```
pub fn backbone(mode: &Mode, harmonics: usize, amplitudes: &[f64]) -> Result<NonlinearMode, SimulationError> {
    iwan_core::Harmonics::odd(harmonics)?;
    if harmonics > 1 && mode.joint.is_some() {
        return nonlinear_mode(&JointedModes::of_mode(mode, 1.0)?, 0, harmonics, amplitudes);
    }
    checked(amplitudes)?;
    let point = |&amplitude: &f64| -> Result<BackbonePoint, SimulationError> {
        Ok(BackbonePoint {
            amplitude,
            frequency: mode.frequency_at(amplitude)?,
            damping_ratio: mode.damping_ratio_at(amplitude)?,
            slips: mode.joint.iter().map(|_| [amplitude, 0.0]).collect(),
            response: vec![amplitude],
        })
    };
    let points = amplitudes.iter().map(point).collect::<Result<_, _>>()?;
    Ok(NonlinearMode { points, remarks: Vec::new() })
}

fn checked(amplitudes: &[f64]) -> Result<(), SimulationError> {
    let allowed = "must be finite, > 0 and ascending";
    for (index, &value) in amplitudes.iter().enumerate() {
        let after = index == 0 || value > amplitudes[index - 1];
        if !(value > 0.0 && value.is_finite() && after) {
            return Err(iwan_core::Error::Entry { name: "amplitudes", index, value, allowed }.into());
        }
    }
    Ok(())
}

/// Longest step of the logarithm of the amplitude. If requested amplitudes lie farther apart, amplitudes in between are computed first.
const LONGEST: f64 = 1.0;
/// Shortest step of the logarithm of the amplitude; if even that fails, the computation ends with a remark.
const SHORTEST: f64 = 1e-4;

/// The nonlinear mode that begins as the stuck mode number `mode`, at the given amplitudes of that mode's displacement.
///
/// # Errors
/// The errors of [`backbone`]; also [`SimulationError::Parameter`] if `mode` is not the index of an elastic mode.
pub fn nonlinear_mode(
    system: &JointedModes,
    mode: usize,
    harmonics: usize,
    amplitudes: &[f64],
) -> Result<NonlinearMode, SimulationError> {
    checked(amplitudes)?;
    let Some(own) = system.modes.get(mode).filter(|own| own.omega > 0.0) else {
        let allowed = "must be the number of an elastic mode";
        return Err(iwan_core::Error::OutOfRange { name: "mode", value: mode as f64, allowed }.into());
    };
    let unit = own.omega;
    let mut problem = Problem::new(Balance::new(system, harmonics)?, Task::Free { mode }, unit);
    let (count, modal) = (problem.unknowns(), problem.balance.modal());
    let mut branch = NonlinearMode::default();
    let Some(&first) = amplitudes.first() else { return Ok(branch) };
    // The start: the stuck mode at an amplitude so small that it is a solution to good accuracy.
    let mut here = first.min(START * system.macro_slip(mode).unwrap_or(first));
    let mut y = vec![0.0; count];
    let each = problem.balance.each();
    for (j, joint) in system.joints.iter().enumerate() {
        y[j * each] = joint.participation[mode] * here;
    }
    (y[modal], y[modal + 1], y[count - 1]) = (1.0, 2.0 * own.damping_ratio, here.ln());
    let mut follower = Follower::new(&mut problem, count);
    let Some(start) = follower.at_held(&y, count - 1)? else {
        branch.remarks.push(format!("the stuck mode was not found at the amplitude {here:.4e}"));
        return Ok(branch);
    };
    let mut node = follower.first(start, count - 1, 1.0)?;
    for &amplitude in amplitudes {
        while let Some(from) = node.clone().filter(|_| here < amplitude) {
            let mut step = (amplitude / here).ln().min(LONGEST);
            node = None;
            while node.is_none() && step > SHORTEST {
                let to = if (amplitude / here).ln() <= step { amplitude } else { here * step.exp() };
                let way = (to.ln() - from.y[count - 1]) / from.tangent[count - 1];
                let mut guess: Vec<f64> =
                    from.y.iter().zip(&from.tangent).map(|(y, t)| y + way * t).collect();
                guess[count - 1] = to.ln();
                if let Some(y) = follower.at_held(&guess, count - 1)? {
                    node = follower.first(y, count - 1, 1.0)?;
                    here = if node.is_some() { to } else { here };
                }
                step *= 0.4;
            }
        }
        let Some(node) = &node else {
            branch.remarks.push(format!(
                "the mode cannot be followed beyond the amplitude {here:.6e}: it meets another one, or nothing but friction held it"
            ));
            return Ok(branch);
        };
        branch.points.push(point(follower.curve, &node.y)?);
    }
    Ok(branch)
}

/// Amplitude at which a nonlinear mode begins, over that of first macro-slip. There the joints have lost less than a millionth of their
/// stiffness for the values of χ in the literature, and for any χ the stuck mode is close enough to start from.
const START: f64 = 1e-6;

fn point(problem: &mut Problem<'_>, y: &[f64]) -> Result<BackbonePoint, SimulationError> {
    let response = problem.response(y)?.iter().map(|[a, b]| a.hypot(*b)).collect();
    let state = problem.state(y);
    let amplitude = y[y.len() - 1].exp();
    Ok(BackbonePoint {
        amplitude,
        frequency: state.omega / TAU,
        damping_ratio: 0.5 * state.xi / state.omega,
        slips: (0..problem.balance.system.joints.len()).map(|j| problem.slip(y, j)).collect(),
        response,
    })
}
