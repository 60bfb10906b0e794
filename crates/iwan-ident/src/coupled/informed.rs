//! What the levels of the records leave untold.

use super::outcome::{CoupledEstimate, FittedSharing};
use super::unknowns::Unknown;

/// Largest slip over φ_max that a knee must have been passed by to be told. Joints have their knee just below the loudest blow where there is none: the
/// modal model's sliders, as every small defect at the loud start, are told by it. A judgement.
const PASSED: f64 = 1.5;
/// A record begins softly enough to tell micro-slip where its largest slip is below this share. A judgement.
const HARD: f64 = 0.3;

/// What the chosen model leaves of the records.
pub(super) struct Left {
    /// Relative misfit.
    pub(super) misfit: f64,
    /// Whether it is noise, or less than any modal model leaves.
    pub(super) is_noise: bool,
}

impl Left {
    /// A sentence where the law itself misses something.
    pub(super) fn words(&self) -> Vec<String> {
        let misses = format!(
            "what is left, {:.1} % of the motion, is not noise: the law misses something, and intervals hold as far as it describes these records; where a \
             joint slips as a whole is not told by them",
            100.0 * self.misfit
        );
        if self.is_noise { Vec::new() } else { vec![misses] }
    }
}

/// Largest and smallest slip over φ_max of a joint in the records.
fn ratios(model: &FittedSharing, joint: usize) -> (f64, f64) {
    let all = model.slip_ratios.iter().map(|of_joint| of_joint[joint]);
    all.fold((f64::INFINITY, 0.0_f64), |r, x| (r.0.min(x), r.1.max(x)))
}

/// The estimates without the ends that need a knee which the records have not clearly passed, or which a law that misses something shows: the joint
/// may be as strong and as stiff as one likes.
pub(super) fn without_knees(
    model: &FittedSharing,
    left: &Left,
    mut estimates: Vec<CoupledEstimate>,
) -> Vec<CoupledEstimate> {
    for joint in (0..model.values.laws.len()).filter(|j| !left.is_noise || ratios(model, *j).1 < PASSED) {
        for e in &mut estimates {
            match e.unknown {
                Unknown::FS(j) | Unknown::KT(j) if j == joint => e.high = None,
                Unknown::Beta(j) if j == joint => (e.low, e.high) = (None, None),
                _ => {}
            }
        }
    }
    estimates
}

/// Sentences on joints that the records move too little, or never little enough.
pub(super) fn one_sided(model: &FittedSharing) -> Vec<String> {
    let mut words = Vec::new();
    for joint in 0..model.values.laws.len() {
        let (least, most) = ratios(model, joint);
        let name = if model.values.laws.len() == 1 { String::new() } else { format!(" {}", joint + 1) };
        if most < PASSED {
            words.push(format!(
                "the records hold soft blows only: they do not tell where joint{name} slips as a whole; add a hard blow, or do not trust predictions of harder ones"
            ));
        } else if least > HARD {
            words.push(format!(
                "the records hold hard blows only: joint{name} slips at least {least:.2} of where it slips as a whole; add a soft blow, or do not trust \
                 predictions of softer ones"
            ));
        }
    }
    words
}
