//! The input of an update, brought into the form of the model.

use iwan_fem::{Adjustable, Correction, NamedModes};

use super::group::{JointGroup, slips_of_group};
use super::measured::{MeasuredCurve, Point};
use super::model::{Beside, Curve, DAMPING_UNIT, bounds, coordinates};
use crate::error::Error;

/// Standard deviations that the first search assumes, of ln ζ and of the frequency relative to its shift; the residuals then give better ones.
const FIRST: f64 = 0.02;
/// What is given and what is sought in an update.
#[derive(Debug, Clone)]
pub struct UpdateTask<'a> {
    /// The structure with its modes.
    pub named: &'a NamedModes,
    /// Groups of joints whose laws are sought; other joints keep their laws.
    pub groups: Vec<JointGroup>,
    /// Parts of the stiffness that may be wrong by a factor: name, part, and the standard deviation of the factor's logarithm where it is known
    /// beforehand.
    pub corrections: Vec<(String, Correction, Option<f64>)>,
    /// Whether each measured mode has an unknown viscous damping beside the joints.
    pub viscous: bool,
    /// The measured curves that are fitted.
    pub curves: Vec<MeasuredCurve>,
    /// Curves that are kept out of the fit and predicted.
    pub held_out: Vec<MeasuredCurve>,
    /// Number of threads.
    pub threads: usize,
}

/// A measured curve with the index of its mode.
pub(super) struct Placed<'a> {
    pub(super) curve: &'a MeasuredCurve,
    pub(super) mode: usize,
    pub(super) points: Vec<Point>,
}

/// Refuses groups and prior knowledge that do not fit the structure.
pub(super) fn checked(task: &UpdateTask<'_>) -> Result<(), Error> {
    let refused =
        |finding: &str, remedy| Error::Update { place: "update".into(), finding: finding.into(), remedy };
    let empty = task.groups.iter().find(|g| slips_of_group(&task.named.assembled, g).is_empty());
    if task.groups.is_empty() || empty.is_some() {
        let name = empty.map_or("", |g| g.name.as_str());
        return Err(refused(
            &format!("there is no joint with a law to be found {name}"),
            "give joints with four-parameter laws as start values",
        ));
    }
    let bad = task.corrections.iter().find(|c| c.2.is_some_and(|sd| !(sd.is_finite() && sd > 0.0)));
    match bad {
        Some((name, ..)) => Err(refused(
            &format!("the prior of {name} is not > 0"),
            "give the standard deviation of its logarithm",
        )),
        None => Ok(()),
    }
}

pub(super) fn placed<'a>(
    task: &UpdateTask<'_>,
    curves: &'a [MeasuredCurve],
) -> Result<Vec<Placed<'a>>, Error> {
    let one = |curve: &'a MeasuredCurve| {
        let mode = task.named.named(&curve.mode).map_err(Error::structure(&curve.source))?;
        Ok(Placed { curve, mode: mode.pair.stuck, points: curve.points()? })
    };
    curves.iter().map(one).collect()
}

/// Names of the measured modes, each once.
pub(super) fn modes_of(measured: &[Placed<'_>]) -> Vec<String> {
    let mut modes: Vec<String> = Vec::new();
    for placed in measured {
        let name = placed.curve.mode.replace('-', " ");
        if !modes.contains(&name) {
            modes.push(name);
        }
    }
    modes
}

pub(super) fn model<'a>(
    task: &UpdateTask<'_>,
    adjustable: &'a Adjustable,
    measured: &[Placed<'_>],
    modes: &[String],
) -> Beside<'a> {
    let curve = |placed: &Placed<'_>| {
        let range = placed
            .points
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |r, p| (r.0.min(p.frequency), r.1.max(p.frequency)));
        let name = placed.curve.mode.replace('-', " ");
        Curve {
            mode: placed.mode,
            viscous: modes.iter().position(|mode| *mode == name).filter(|_| task.viscous),
            stiffness: placed.curve.stiffness,
            points: placed.points.clone(),
            frequency_sd: (FIRST * (range.1 - range.0)).max(1e-5 * range.1),
            damping_sd: FIRST,
        }
    };
    let viscous = if task.viscous { modes.len() } else { 0 };
    Beside {
        adjustable,
        groups: task.groups.iter().map(|g| slips_of_group(&task.named.assembled, g)).collect(),
        priors: task.corrections.iter().map(|c| c.2).collect(),
        curves: measured.iter().map(curve).collect(),
        bounds: bounds(task.groups.len(), task.corrections.len(), viscous),
    }
}

/// Start values: those of the file, and others within a factor of two to three, because a knee (the onset of macro-slip) can be mistaken for the
/// slope of micro-slip.
pub(super) fn starts(task: &UpdateTask<'_>, measured: &[Placed<'_>], modes: usize) -> Vec<Vec<f64>> {
    // Each row: factors on K_T and F_S, then χ and β/(1+β); NaN keeps the value of the file.
    const NAN: f64 = f64::NAN;
    const OTHERS: [[f64; 4]; 7] = [
        [1.0, 1.0, NAN, NAN],
        [1.0, 0.4, NAN, NAN],
        [1.0, 2.5, NAN, NAN],
        [2.0, 1.0, NAN, NAN],
        [0.5, 1.0, NAN, NAN],
        [1.0, 1.0, -0.6, 0.2],
        [1.0, 2.5, -0.2, 0.5],
    ];
    let least = measured.iter().flat_map(|p| &p.points).map(|p| p.log_damping).fold(f64::INFINITY, f64::min);
    // Without curves, the damping of the joints is taken as 0.1 %.
    let least = if least.is_finite() { least } else { DAMPING_UNIT.ln() };
    let viscous = if task.viscous { modes } else { 0 };
    let one = |&[k, f, chi, dirac]: &[f64; 4]| {
        let mut x: Vec<f64> = Vec::new();
        for group in &task.groups {
            let own = coordinates(&group.law);
            let or_own = |given: f64, own: f64| if given.is_nan() { own } else { given };
            x.extend([own[0] + k.ln(), own[1] + f.ln(), or_own(chi, own[2]), or_own(dirac, own[3])]);
        }
        x.extend(vec![0.0; task.corrections.len()]);
        x.extend(vec![0.3 * least.exp() / DAMPING_UNIT; viscous]);
        x
    };
    OTHERS.iter().map(one).collect()
}
