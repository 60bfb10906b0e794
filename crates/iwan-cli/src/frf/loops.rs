//! Hysteresis loops of the joints in steady vibration, at the peaks of the curves.

use iwan_sim::{SharedLaw, SlipJoint, SteadyCurve};

use crate::page::numbers::short;

/// Points of a loop: from 100 points on the straight pieces cannot be told from a curve.
const POINTS: usize = 241;

/// Joints that slip by less than this part of the largest slip get no loop: it would be drawn as a dot.
const LEAST: f64 = 0.05;

/// The loop of one joint in one steady vibration.
#[derive(Clone)]
pub(crate) struct Loop {
    /// Name of the level, or of the joint.
    pub(crate) name: String,
    law: SharedLaw,
    /// Amplitude of the slip's first harmonic.
    slip: f64,
}

impl std::fmt::Debug for Loop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Loop").field("name", &self.name).field("slip", &self.slip).finish_non_exhaustive()
    }
}

/// Name of a curve's level: the held quantity with its value.
pub(super) fn level(curve: &SteadyCurve) -> String {
    format!("{} {}", curve.control.name().replace('_', " "), short(curve.level))
}

/// Loops of one mode's own joint, at the peak of each level; the response is `shape` times the modal displacement.
pub(super) fn of_mode(law: &SharedLaw, shape: f64, curves: &[SteadyCurve]) -> Vec<Loop> {
    let peaks = curves.iter().filter_map(|curve| Some((level(curve), curve.peak()?)));
    peaks.map(|(name, peak)| Loop { name, law: law.clone(), slip: peak.amplitude / shape.abs() }).collect()
}

/// Loops of shared joints: with one joint, at the peak of each level; with several, at the peak of the last level.
pub(super) fn of_joints(joints: &[SlipJoint], curves: &[SteadyCurve]) -> Vec<Loop> {
    let at = |curve: &SteadyCurve, joint: usize, name: String| {
        let slip = curve.peak()?.slips.get(joint).copied()?;
        Some(Loop { name, law: joints[joint].law.clone(), slip })
    };
    if joints.len() == 1 {
        return curves.iter().filter_map(|curve| at(curve, 0, level(curve))).collect();
    }
    let Some(last) = curves.last() else { return Vec::new() };
    let loops: Vec<Loop> =
        (0..joints.len()).filter_map(|joint| at(last, joint, joints[joint].name.clone())).collect();
    let most = loops.iter().fold(0.0, |most: f64, one| most.max(one.slip));
    loops.into_iter().filter(|one| one.slip > LEAST * most).collect()
}

impl Loop {
    /// Slip and force along one period of the slip's first harmonic, by Masing's rule. The line of the stuck joint is subtracted: the force is F -
    /// K_T s.
    pub(super) fn points(&self) -> Vec<(f64, f64)> {
        let (law, a) = (&self.law, self.slip);
        let top = law.force(a);
        let at = |i: usize| {
            let theta = std::f64::consts::TAU * i as f64 / (POINTS - 1) as f64;
            let s = a * theta.cos();
            let back = theta <= std::f64::consts::PI;
            let force = if back {
                top - 2.0 * law.force(0.5 * (a - s))
            } else {
                2.0 * law.force(0.5 * (a + s)) - top
            };
            (s, force - law.initial_stiffness() * s)
        };
        (0..POINTS).map(at).collect()
    }
}
