//! What the records do not tell because of how hard their blows are.

use super::outcome::{CoupledEstimate, FittedSharing};
use super::unknowns::{CHI_RANGE, Unknown};

/// Largest slip over φ_max that the records must reach for a knee to be told. Where the records have no knee, the fit puts one just below the loudest blow: the
/// modal model's sliders, as every small defect at the loud start, are described by it. A judgement.
const PASSED: f64 = 1.5;
/// A record begins softly enough to tell micro-slip where its largest slip over φ_max is below this value. A judgement.
const HARD: f64 = 0.3;

/// Where the model leaves less than this share of the motion, the knee counts as told even if the remainder is not noise: by one joint of the paper's beam F_S comes within 5
/// %. A judgement.
const KNEE_TOLD: f64 = 0.01;

/// A remainder below this share of the motion may come from steps and sliders (200 sliders keep the dissipation per cycle within 0.14 %), and says nothing of the model.
const OF_STEPS: f64 = 0.002;

/// What the chosen model leaves of the records: size and kind.
pub(super) struct Left {
    /// Relative misfit of the records fitted.
    pub(super) misfit: f64,
    /// Whether the remainder is noise.
    pub(super) is_noise: bool,
}

impl Left {
    fn tells_knees(&self) -> bool {
        self.is_noise || self.misfit <= KNEE_TOLD
    }

    /// A sentence that says so where the law itself misses something.
    pub(super) fn words(&self) -> Vec<String> {
        if self.is_noise || self.misfit < OF_STEPS {
            return Vec::new();
        }
        let untold =
            if self.tells_knees() { "" } else { "; where a joint slips as a whole is not told by them" };
        vec![format!(
            "what is left, {:.2} % of the motion, is not noise: the model misses something, such as modes that were left out; intervals are widened by how differently \
             the stretches of the records pull, and the values are those with which these modes stand for the structure: a joint's own can lie elsewhere{untold}",
            100.0 * self.misfit
        )]
    }
}

/// Smallest and largest slip over φ_max of a joint in the records.
fn ratios(model: &FittedSharing, joint: usize) -> (f64, f64) {
    let all = model.slip_ratios.iter().map(|of_joint| of_joint[joint]);
    all.fold((f64::INFINITY, 0.0_f64), |r, x| (r.0.min(x), r.1.max(x)))
}

/// The estimates without those interval ends that rest on a knee which the records have not clearly passed, or which is described by a law that misses something: then the joint
/// may be as strong and as stiff as one likes.
pub(super) fn without_knees(
    model: &FittedSharing,
    left: &Left,
    mut estimates: Vec<CoupledEstimate>,
) -> Vec<CoupledEstimate> {
    for joint in (0..model.values.laws.len()).filter(|j| !left.tells_knees() || ratios(model, *j).1 < PASSED)
    {
        for e in &mut estimates {
            match e.unknown {
                Unknown::FS(j) | Unknown::KT(j) if j == joint => e.high = None,
                Unknown::Beta(j) if j == joint => (e.low, e.high) = (None, None),
                _ => {}
            }
        }
    }
    // A χ at the end of its range is only where the search ran to: one blow by itself gave -0.98, within 0.04, for a joint with -0.3.
    for e in &mut estimates {
        if matches!(e.unknown, Unknown::Chi(_)) && (e.value <= CHI_RANGE.0 || e.value >= CHI_RANGE.1) {
            (e.low, e.high) = (None, None);
        }
    }
    estimates
}

/// Sentences on joints that the records move too little, or in none of them little enough.
pub(super) fn one_sided(model: &FittedSharing) -> Vec<String> {
    let mut words = Vec::new();
    for joint in 0..model.values.laws.len() {
        let (least, most) = ratios(model, joint);
        let name =
            if model.values.laws.len() == 1 { "the joint".into() } else { format!("joint {}", joint + 1) };
        if most < PASSED {
            words.push(format!(
                "the records hold soft blows only: they do not tell where {name} slips as a whole; add a hard blow, or do not trust predictions of harder ones"
            ));
        } else if least > HARD {
            words.push(format!(
                "the records hold hard blows only: in the softest of them {name} slips {} times as far as where it slips as a whole; add a soft blow, or do not \
                 trust predictions of softer ones",
                about(least)
            ));
        }
    }
    words
}

/// Two digits of a ratio, whole where it is large.
fn about(ratio: f64) -> String {
    if ratio < 10.0 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}

#[cfg(test)]
mod tests {
    use iwan_core::FourParameter;

    use super::*;
    use crate::coupled::{Sharing, Values};

    /// A fit of two modes that share a joint, to two records with these slips over φ_max.
    fn fitted(chi: f64, slip_ratios: [f64; 2]) -> FittedSharing {
        let values = Values {
            frequency: vec![20.0, 52.0],
            damping_ratio: vec![1e-3; 2],
            laws: vec![FourParameter::new(1500.0, 20.0, chi, 0.1).unwrap()],
            participation: vec![vec![1.0, -2.5]],
            compliance: vec![0.0],
            slip_at_force: vec![0.0],
            shape_at_sensor: vec![1.0; 2],
            shape_at_force: vec![1.0; 2],
            initial: Vec::new(),
        };
        FittedSharing {
            sharing: Sharing::Shared(1),
            values,
            unknowns: 10,
            criterion: 0.0,
            misfits: Vec::new(),
            held_out: Vec::new(),
            misfit: 0.005,
            held_out_misfit: None,
            slip_ratios: slip_ratios.map(|ratio| vec![ratio]).to_vec(),
            converged: true,
            motions: Vec::new(),
        }
    }

    /// Whether K_T, F_S, χ and β keep their lower and upper ends.
    fn kept(chi: f64, slip_ratios: [f64; 2], left: &Left) -> [[bool; 2]; 4] {
        let of =
            |unknown, value: f64| CoupledEstimate { unknown, value, low: Some(value), high: Some(value) };
        let all = vec![
            of(Unknown::KT(0), 1500.0),
            of(Unknown::FS(0), 20.0),
            of(Unknown::Chi(0), chi),
            of(Unknown::Beta(0), 0.1),
        ];
        let estimates = without_knees(&fitted(chi, slip_ratios), left, all);
        let ends: Vec<[bool; 2]> = estimates.iter().map(|e| [e.low.is_some(), e.high.is_some()]).collect();
        ends.try_into().unwrap()
    }

    #[test]
    fn ends_that_the_records_do_not_hold_are_open() {
        let (noise, misses) =
            (Left { misfit: 0.005, is_noise: true }, Left { misfit: 0.05, is_noise: false });
        assert_eq!(kept(-0.3, [0.1, 5.0], &noise), [[true; 2]; 4]);
        let no_knee = [[true, false], [true, false], [true; 2], [false; 2]];
        assert_eq!(kept(-0.3, [0.1, 1.2], &noise), no_knee);
        assert_eq!(kept(-0.3, [0.1, 5.0], &misses), no_knee);
        assert_eq!(kept(CHI_RANGE.0, [4.0, 5.0], &noise), [[true; 2], [true; 2], [false; 2], [true; 2]]);
        assert!(misses.words()[0].contains("5.00 %") && noise.words().is_empty());
    }

    #[test]
    fn soft_and_hard_blows_are_named() {
        assert!(one_sided(&fitted(-0.3, [0.1, 5.0])).is_empty());
        assert!(one_sided(&fitted(-0.3, [0.1, 1.2]))[0].contains("soft blows only"));
        let hard = one_sided(&fitted(-0.3, [42.03, 107.0]));
        assert!(hard[0].contains("in the softest of them the joint slips 42 times as far"), "{hard:?}");
    }
}
