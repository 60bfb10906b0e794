//! Steady vibration beside tmdsimpy (github.com/tmd-lab/tmdsimpy, commit 17d5fc3): ours is the limit of its curves.
//!
//! tmdsimpy samples a period, runs sliders through it and transforms back. Its numbers below were computed with its own solver
//! (xtol 1e-13) on its own examples, harmonics 1 and 3 (and 5), refined as said; its sliders converge with a ratio of about 0.3 from
//! one doubling to the next, so that the last three are extrapolated (Aitken), and its samples by what the last quadrupling
//! changed.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::TAU;

use iwan_core::{FourParameter, Jenkins};
use iwan_sim::{
    Control, JointLaw, JointedModes, Mode, Residual, SlipJoint, SteadyPoint, StuckMode, Sweep, backbone,
    forced_response_of,
};
use nalgebra::{Matrix3, Vector3};

/// `examples/vprnm_rom_iwan.py`: three freedoms with a superharmonic resonance, one four-parameter joint, C = 0.01 M.
fn vprnm() -> JointedModes {
    let phi: Matrix3<f64> = Matrix3::from_columns(&[
        Vector3::new(1.0, 2.0, 3.0),
        Vector3::new(2.0, 1.0, -1.0),
        Vector3::new(-2.0, 1.0, 1.0),
    ]);
    let inverse: Matrix3<f64> = phi.try_inverse().unwrap();
    let squares = Matrix3::from_diagonal(&Vector3::new(1.0, 9.0, 56.25));
    let slip: Vector3<f64> = Vector3::new(0.0, 1.0, -1.0);
    let k_t = 0.6;
    // K = K_ir - k_t/2 q qᵀ, and with the joint stuck k_t more.
    let stuck: Matrix3<f64> = inverse.transpose() * squares * inverse + 0.5 * k_t * slip * slip.transpose();
    // M⁻¹ = Φ Φᵀ: in the coordinates of Φ the problem is an ordinary one.
    let eigen = (phi.transpose() * stuck * phi).symmetric_eigen();
    let (mut modes, mut participation) = (Vec::new(), Vec::new());
    for k in 0..3 {
        let omega: f64 = eigen.eigenvalues[k].sqrt();
        let shape: Vector3<f64> = phi * eigen.eigenvectors.column(k);
        modes.push(StuckMode {
            omega,
            damping_ratio: 0.005 / omega,
            at_force: shape[0],
            at_output: shape[0],
        });
        participation.push(slip.dot(&shape));
    }
    let law = JointLaw::FourParameter(FourParameter::new(k_t, 10.0, -0.5, 0.0).unwrap()).into();
    let joint = SlipJoint { name: "joint".into(), law, participation };
    JointedModes::new(modes, vec![joint], Residual::default()).unwrap()
}

/// The response of the first freedom held at `level` from 0.95 to 0.99 rad/s: both ends.
fn ends(level: f64) -> [SteadyPoint; 2] {
    let sweep = Sweep {
        from: 0.95 / TAU,
        to: 0.99 / TAU,
        control: Control::Displacement,
        levels: vec![level],
        harmonics: 3,
        points: 16,
    };
    let curve = forced_response_of(&vprnm(), &sweep).unwrap().remove(0);
    assert!(curve.remarks.is_empty(), "{:?}", curve.remarks);
    [curve.points.first().unwrap().clone(), curve.points.last().unwrap().clone()]
}

fn near(found: f64, limit: f64, tolerance: f64) {
    assert!((found / limit - 1.0).abs() < tolerance, "{found} {limit} {:e}", found / limit - 1.0);
}

#[test]
fn the_limit_of_sliders_and_samples_with_a_four_parameter_joint() {
    // Sliders 400, 800, 1600 at 1024 samples; then 1600 sliders at 4096 samples: force, third harmonic.
    let theirs = [
        (
            [3.0375991462, 3.0375519137, 3.0375385379, 3.0375354251],
            [0.5762867493, 0.5763940042, 0.5764241641, 0.5764147387],
        ),
        (
            [1.7938651312, 1.7937940233, 1.7937692087, 1.7937693653],
            [1.5180561291, 1.5182973382, 1.5183761475, 1.5183736239],
        ),
    ];
    let limit = |[a, b, c, fine]: [f64; 4]| {
        let (first, second) = (b - a, c - b);
        c + second * second / (first - second) + (fine - c) * 16.0 / 15.0
    };
    for (point, (force, third)) in ends(20.0).iter().zip(theirs) {
        near(point.amplitude, 20.0, 1e-12);
        near(point.excitation, limit(force), 2e-6);
        near(point.harmonics[0][0], limit(third), 2e-5);
        // At its own settings, 100 sliders and 128 samples, it is off by 2e-4 to 5e-4.
    }
    assert!((ends(20.0)[1].excitation / 1.7946226746 - 1.0).abs() > 3e-4);
}

#[test]
fn no_start_value_is_needed_where_the_peer_fails() {
    // From its own prediction at the amplitude 70 and 0.99 rad/s its solver stops at a residual of 6.6.
    let [_, point] = ends(70.0);
    near(point.amplitude, 70.0, 1e-12);
    assert!(point.excitation > 0.0 && point.excitation.is_finite());
}

#[test]
fn the_limit_of_samples_with_a_jenkins_element() {
    // `tests/test_epmc.py`, one freedom: m = k = 1, c = 0.01, k_t = 0.25, F_s = 0.2; 65,536 samples: amplitude, frequency
    // (rad/s), damping ξ, amplitudes of the harmonics 3 and 5.
    let theirs = [
        (1.0, 1.102139885006, 0.055824982307, 0.001736580518, 0.000227096848),
        (3.0, 1.026363952189, 0.070798336828, 0.007383911577, 0.000828067933),
        (20.0, 1.001665443920, 0.022208571727, 0.010148932634, 0.001887066784),
    ];
    let omega0 = 1.25_f64.sqrt();
    let joint = JointLaw::Jenkins(Jenkins::new(0.25, 0.2).unwrap());
    let mode = Mode { damping_ratio: 0.005 / omega0, ..Mode::new("jenkins", omega0 / TAU, Some(joint)) };
    let amplitudes = theirs.map(|row| row.0);
    let curve = backbone(&mode, 5, &amplitudes).unwrap();
    for (point, (_, omega, xi, third, fifth)) in curve.points.iter().zip(theirs) {
        near(point.frequency * TAU, omega, 2e-9);
        near(2.0 * point.damping_ratio * point.frequency * TAU, xi, 1e-7);
        near(point.response[1], third, 1e-6);
        near(point.response[2], fifth, 1e-6);
    }
}
