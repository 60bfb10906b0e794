//! Steady vibration beside tmdsimpy (github.com/tmd-lab/tmdsimpy, commit 17d5fc3) and juliajim: ours is the limit of their curves.
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
    forced_response_of, nonlinear_mode,
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

#[test]
fn the_limit_of_samples_in_a_forced_response() {
    // juliajim (github.com/Nidish96/juliajim, commit 55465ef), `examples/b2_jenkhb.jl`: ω0 = 2, ζ0 = 0.005, k_t = 5, F_s = 1, F = 0.1,
    // harmonics 1, 3 and 5. Its marching of the slider, twice round the period from f = k_t u, was written anew in NumPy and solved with
    // SciPy's fsolve (xtol 1e-13) at 32,768 samples: Ω, amplitudes of the harmonics, phase of the first.
    let theirs = [
        (2.93, [0.210206472907, 0.000293842896, 0.000053606917], -0.810096714323),
        (2.96, [0.214819531791, 0.000407580461, 0.000071607422], -1.371864868849),
        (3.00, [0.214295098761, 0.000382726102, 0.000067691872], -1.874259359816),
        (3.04, [0.210113347472, 0.000268654647, 0.000049349773], -2.330519344527),
    ];
    let joint = JointLaw::Jenkins(Jenkins::new(5.0, 1.0).unwrap());
    let mode = Mode { damping_ratio: 0.02 / 6.0, ..Mode::new("jenkins", 3.0 / TAU, Some(joint)) };
    let system = JointedModes::of_mode(&mode, 1.0).unwrap();
    for pair in theirs.chunks(2) {
        let sweep = Sweep {
            from: pair[0].0 / TAU,
            to: pair[1].0 / TAU,
            control: Control::Force,
            levels: vec![0.1],
            harmonics: 5,
            points: 16,
        };
        let curve = forced_response_of(&system, &sweep).unwrap().remove(0);
        let ends = [curve.points.first().unwrap(), curve.points.last().unwrap()];
        for (point, (_, [first, third, fifth], phase)) in ends.iter().zip(pair) {
            near(point.amplitude, *first, 5e-7);
            near(point.phase, *phase, 5e-7);
            near(point.harmonics[0][0], *third, 2e-6);
            near(point.harmonics[1][0], *fifth, 5e-6);
        }
        // At its own setting, 512 samples, it is off by up to 1.5e-5.
    }
}

/// M = I, K = [[2, -1], [-1, 2]], a Jenkins element at the second freedom; C = αM + βK, of which the modes with the joint stuck see their own
/// part. Observed at a freedom.
fn two_freedoms([alpha, beta]: [f64; 2], [k_t, f_s]: [f64; 2], observed: usize) -> JointedModes {
    let stiffness = nalgebra::Matrix2::new(2.0, -1.0, -1.0, 2.0);
    let stuck = stiffness + nalgebra::Matrix2::new(0.0, 0.0, 0.0, k_t);
    let eigen = stuck.symmetric_eigen();
    let lowest = if eigen.eigenvalues[0] < eigen.eigenvalues[1] { [0, 1] } else { [1, 0] };
    let shapes = lowest.map(|k| {
        let shape = eigen.eigenvectors.column(k).into_owned();
        shape * shape.sum().signum()
    });
    let mode = |n: usize| {
        let (shape, omega) = (shapes[n], eigen.eigenvalues[lowest[n]].sqrt());
        let viscous = alpha + beta * shape.dot(&(stiffness * shape));
        StuckMode { omega, damping_ratio: 0.5 * viscous / omega, at_force: 0.0, at_output: shape[observed] }
    };
    let law = JointLaw::Jenkins(Jenkins::new(k_t, f_s).unwrap()).into();
    let joint = SlipJoint { name: "slider".into(), law, participation: shapes.map(|shape| shape[1]).into() };
    JointedModes::new(vec![mode(0), mode(1)], vec![joint], Residual::default()).unwrap()
}

/// Amplitude of mode 1; frequency (rad/s), ξ, and the amplitudes of both freedoms in the harmonics 1, 3 and 5.
type Reference = (f64, f64, f64, [f64; 6]);

#[test]
fn the_limit_of_samples_in_nonlinear_modes_of_two_freedoms() {
    // scripts/peers/epmc.py: parameters of tmdsimpy's `tests/test_epmc.py` (mdof_jenkins), whose own residual at these solutions is 4e-7 at the
    // most with its 1,024 samples; and of juliajim's `examples/c4_mdofgen_epmc.jl`, whose 256 samples are off by 4e-6 in frequency. Its C = 0.01 M +
    // 0.001 K couples the modes with the joint stuck, which we leave out: that moves the frequency by up to 2.4e-5 and ξ by up to 0.5 %.
    let tmdsimpy: [Reference; 3] = [
        (
            1.5,
            1.049630080035,
            0.031618476430,
            [1.115868944630, 1.002678829472, 0.000284054221, 0.002248517098, 0.000010274833, 0.000262453493],
        ),
        (
            4.0,
            1.014724100680,
            0.041223802460,
            [2.873550212083, 2.789792343979, 0.001177922327, 0.008560676079, 0.000034489099, 0.000818845475],
        ),
        (
            20.0,
            1.001406712511,
            0.018461834410,
            [
                14.188133847948,
                14.148699334093,
                0.001656598416,
                0.011638241050,
                0.000081486233,
                0.001879921949,
            ],
        ),
    ];
    let juliajim: [Reference; 3] = [
        (
            2.0,
            1.173255499012,
            0.026342329267,
            [1.697133226879, 1.058520892114, 0.000233660980, 0.002427467604, 0.000012042260, 0.000390325402],
        ),
        (
            5.0,
            1.060740965573,
            0.122138113764,
            [3.811004271117, 3.363786386850, 0.004718209432, 0.038378507809, 0.000144917071, 0.003787498324],
        ),
        (
            30.0,
            1.004201265995,
            0.038923925027,
            [
                21.865513952460,
                21.689694730803,
                0.008255733267,
                0.058419549057,
                0.000415733401,
                0.009649472729,
            ],
        ),
    ];
    for (damping, joint, theirs) in
        [([0.01, 0.0], [0.25, 0.2], tmdsimpy), ([0.01, 0.001], [1.0, 1.0], juliajim)]
    {
        let amplitudes = theirs.map(|row| row.0);
        for freedom in 0..2 {
            let system = two_freedoms(damping, joint, freedom);
            let curve = nonlinear_mode(&system, 0, 5, &amplitudes).unwrap();
            for (point, (_, omega, xi, sizes)) in curve.points.iter().zip(theirs) {
                near(point.frequency * TAU, omega, 1e-9);
                near(2.0 * point.damping_ratio * point.frequency * TAU, xi, 1e-7);
                for (harmonic, found) in point.response.iter().enumerate() {
                    near(*found, sizes[2 * harmonic + freedom], 1e-6);
                }
            }
        }
    }
}
