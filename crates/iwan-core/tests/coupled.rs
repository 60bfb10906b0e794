//! Coupled modes against the single mode, against a plain reference, and their energy balance.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use crate::common::{Buffers, worst};
use iwan_core::{
    Continuum, CoupledEnergy, CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows,
    EnergyBalance, Error, FourParameter, Grid, Hysteresis, JointEnergy, JointsInMotion, Lanes, Newmark,
    OneJoint, Oscillator, Plain, Pulse, ResidualStiffness, Reversal, Run, SeveralJoints, Slider, Sliders,
    TabledFourParameter, groups,
};

/// The joint of the paper's beam (configuration A) for three bending modes, scaled to b_1 = 1.
const K: f64 = 31_600.0;
const F_S: f64 = 143.8;
const B: [f64; 3] = [1.0, -0.0111, -4.905];
const RHO: f64 = 0.2875 / K;
const FREQUENCIES: [f64; 3] = [132.35, 372.0, 719.6];

fn law() -> FourParameter {
    FourParameter::new(K, F_S, -0.3, 0.02).unwrap()
}

fn modes(dt: f64, prewarped: bool) -> Vec<CoupledMode> {
    let mode = |frequency: f64| {
        let oscillator = Oscillator::new(frequency, 2.5e-4, 0.0, ResidualStiffness::Positive).unwrap();
        let omega = oscillator.omega0();
        let scheme =
            if prewarped { Newmark::prewarped(dt, omega) } else { Newmark::average_acceleration(dt) }
                .unwrap();
        CoupledMode { oscillator, scheme, shape_at_force: 23.0 }
    };
    FREQUENCIES.map(mode).to_vec()
}

fn storage(groups: usize) -> Vec<Lanes> {
    vec![[0.0; 4]; groups]
}

/// Buffers for the results of a run.
struct Rows {
    joints: usize,
    width: usize,
    modal: [Vec<Lanes>; 3],
    of_joints: [Vec<f64>; 2],
}

impl Rows {
    fn new(samples: usize, modes: usize, joints: usize) -> Self {
        let width = groups(modes);
        let modal = std::array::from_fn(|_| vec![[0.0; 4]; samples * width]);
        Self { joints, width, modal, of_joints: std::array::from_fn(|_| vec![0.0; samples * joints]) }
    }

    fn rows(&mut self) -> CoupledRows<'_> {
        let [displacement, velocity, acceleration] = &mut self.modal;
        let [slip, joint_force] = &mut self.of_joints;
        CoupledRows { displacement, velocity, acceleration, slip, joint_force }
    }

    /// One mode's displacement, velocity or acceleration.
    fn mode(&self, quantity: usize, r: usize) -> Vec<f64> {
        self.modal[quantity].chunks(self.width).map(|row| row.as_flattened()[r]).collect()
    }

    /// One joint's slip or force.
    fn joint(&self, quantity: usize, i: usize) -> Vec<f64> {
        self.of_joints[quantity].chunks(self.joints).map(|row| row[i]).collect()
    }
}

fn pulse(amplitude: f64, dt: f64, samples: usize) -> Vec<f64> {
    let mut force = vec![0.0; samples];
    let used = Pulse::Haversine { amplitude, duration: 1.6e-3 }.sample(dt, &mut force);
    force.truncate(used);
    force
}

fn run(
    coupled: &CoupledModes<Vec<Lanes>>,
    joints: &mut impl JointsInMotion,
    force: &[f64],
    samples: usize,
) -> (Rows, EnergyBalance) {
    let (n, j) = (coupled.modes(), coupled.joints());
    let mut rows = Rows::new(samples, n, j);
    let zero = vec![0.0; n];
    let mut motion = CoupledMotion::new(coupled, joints, [&zero, &zero], 0.0, storage).unwrap();
    coupled.integrate(&mut motion, joints, force, &mut rows.rows()).unwrap();
    let mut energy = CoupledEnergy::new(coupled, storage).unwrap();
    energy.add(coupled, force, &rows.rows()).unwrap();
    let end = (0..j).map(|i| joints.stored_energy(i)).sum();
    for r in 0..n {
        assert!(energy.of_mode(r).error() < 1e-13, "mode {r}: {:e}", energy.of_mode(r).error());
    }
    (rows, energy.balance(JointEnergy { start: 0.0, end }))
}

fn one_joint(rho: f64, a: f64) -> CoupledJoint<'static> {
    let compliance: &'static [f64] = Box::leak(Box::new([rho]));
    CoupledJoint { stiffness: K, participation: &B, compliance, slip_at_force: a }
}

fn in_the_continuum(amplitude: f64, dt: f64, samples: usize) -> (Rows, EnergyBalance) {
    let coupled = CoupledModes::new(&modes(dt, true), &[one_joint(RHO, 2e-8)], storage).unwrap();
    let joint = Continuum::new(TabledFourParameter::new(law()));
    let mut state = joint.virgin(vec![Reversal::default(); 600]).unwrap();
    run(&coupled, &mut OneJoint::new(&joint, &mut state), &pulse(amplitude, dt, samples), samples)
}

fn on_sliders(amplitude: f64, dt: f64, samples: usize, bins: usize) -> (Rows, EnergyBalance) {
    let coupled = CoupledModes::new(&modes(dt, true), &[one_joint(RHO, 2e-8)], storage).unwrap();
    let mut table = vec![Slider::default(); Sliders::table_len(bins)];
    let sliders = Sliders::discretise(&law(), Grid::graded(bins), bins, &mut table).unwrap();
    let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
    run(&coupled, &mut OneJoint::new(&sliders, &mut state), &pulse(amplitude, dt, samples), samples)
}

/// The energy balance closes to rounding over 20,000 steps, from micro-slip to far beyond macro-slip.
#[test]
fn the_energy_balance_closes() {
    for amplitude in [10.0, 1000.0, 1e5] {
        for (_, energy) in
            [in_the_continuum(amplitude, 1e-5, 20_001), on_sliders(amplitude, 1e-5, 20_001, 100)]
        {
            assert!(energy.error() < 1e-13, "{amplitude}: {:e} of {energy:?}", energy.error());
            assert!(energy.friction > 1e-3 * energy.input);
        }
    }
}

/// One mode that alone moves its joint, without compliance, is the single mode of Deaner et al., Eq. 5.
#[test]
fn one_mode_with_its_own_joint_is_the_single_mode() {
    let (dt, samples) = (1e-5, 4001);
    let stiff = Oscillator::new(132.35, 2.5e-4, K, ResidualStiffness::Positive).unwrap();
    for amplitude in [10.0, 1000.0, 3e4] {
        let mut table = vec![Slider::default(); Sliders::table_len(100)];
        let sliders = Sliders::discretise(&law(), Grid::graded(100), 100, &mut table).unwrap();
        let coupled = CoupledModes::new(
            &modes(dt, true)[..1],
            &[CoupledJoint { participation: &B[..1], ..one_joint(0.0, 0.0) }],
            storage,
        );
        let coupled = coupled.unwrap();
        let force = pulse(amplitude, dt, samples);
        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        let (rows, _) = run(&coupled, &mut OneJoint::new(&sliders, &mut state), &force, samples);

        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        let mut single = Buffers::new(samples);
        let scheme = Newmark::prewarped(dt, stiff.omega0()).unwrap();
        let modal: Vec<f64> = force.iter().map(|p| 23.0 * p).collect();
        scheme.integrate(&stiff, &sliders, &mut state, 0.0, &modal, &mut single.samples()).unwrap();
        for quantity in 0..3 {
            let difference = worst(&rows.mode(quantity, 0), &single.0[quantity]);
            assert!(difference < 1e-11, "{amplitude}, {quantity}: {difference:e}");
        }
        assert!(worst(&rows.joint(1, 0), &single.0[3]) < 1e-11);
    }
}

/// A reference that visits each slider and solves each step by halving; the result must be the same with any memory.
fn plainly(amplitude: f64, dt: f64, samples: usize, bins: usize) -> [Vec<f64>; 2] {
    let mut table = vec![Slider::default(); Sliders::table_len(bins)];
    let sliders = Sliders::discretise(&law(), Grid::graded(bins), bins, &mut table).unwrap();
    let plain = Plain::new(sliders);
    let mut state = plain.virgin(vec![0.0; sliders.len()]).unwrap();
    let force = pulse(amplitude, dt, samples + 1);
    let (mut q, mut v, mut n_before) = ([0.0; 3], [0.0; 3], 0.0);
    let mut out = [vec![0.0], vec![0.0]];
    let at = |n: usize| force.get(n).copied().unwrap_or(0.0);
    for n in 1..samples {
        let mean = 0.5 * (at(n - 1) + at(n));
        // q at the end of the step for the joint force N there, by average acceleration written out.
        let end = |missing: f64| -> ([f64; 3], [f64; 3]) {
            let mut next = ([0.0; 3], [0.0; 3]);
            for r in 0..3 {
                let (w, c) = (std::f64::consts::TAU * FREQUENCIES[r], 2.0 * 2.5e-4);
                let load = 23.0 * mean - B[r] * 0.5 * (n_before + missing) - w * w * q[r];
                let rate = (v[r] + 0.5 * dt * load) / (1.0 + 0.5 * dt * c * w + 0.25 * dt * dt * w * w);
                next.0[r] = q[r] + dt * rate;
                next.1[r] = 2.0 * rate - v[r];
            }
            next
        };
        let missing_at = |slip: f64| plain.advance(&mut state.clone(), slip) - K * slip;
        let residual = |slip: f64| {
            let missing = missing_at(slip);
            let way: f64 = end(missing).0.iter().zip(B).map(|(q, b)| q * b).sum();
            slip + RHO * missing - 2e-8 * at(n) - way
        };
        let s = plain.displacement(&state);
        let (mut low, mut high) = (s - 1e-2, s + 1e-2);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if residual(middle) > 0.0 { high = middle } else { low = middle }
        }
        let next = end(missing_at(high));
        n_before = plain.advance(&mut state, high) - K * high;
        (q, v) = next;
        out[1].push(high);
        out[0].push(q[2]);
    }
    out
}

#[test]
fn steps_are_those_of_a_plain_reference() {
    for amplitude in [30.0, 3000.0] {
        let (dt, samples, bins) = (2e-5, 400, 12);
        let coupled = CoupledModes::new(&modes(dt, false), &[one_joint(RHO, 2e-8)], storage).unwrap();
        let mut table = vec![Slider::default(); Sliders::table_len(bins)];
        let sliders = Sliders::discretise(&law(), Grid::graded(bins), bins, &mut table).unwrap();
        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        let mut joints = OneJoint::new(&sliders, &mut state);
        let (rows, _) = run(&coupled, &mut joints, &pulse(amplitude, dt, samples), samples);
        let [q, s] = plainly(amplitude, dt, samples, bins);
        assert!(worst(&rows.mode(0, 2), &q) < 1e-10, "{amplitude}: {:e}", worst(&rows.mode(0, 2), &q));
        assert!(worst(&rows.joint(0, 0), &s) < 1e-10);
    }
}

/// Half the step takes away three quarters of the error.
#[test]
fn the_scheme_is_of_second_order() {
    let at = |dt: f64, samples: usize| in_the_continuum(300.0, dt, samples).0.mode(0, 2);
    let [coarse, fine, finest] = [at(2e-5, 1001), at(1e-5, 2001), at(5e-6, 4001)];
    let thin = |values: &[f64], stride: usize| values.iter().copied().step_by(stride).collect::<Vec<_>>();
    let first = worst(&coarse, &thin(&fine, 2));
    let second = worst(&fine, &thin(&finest, 2));
    assert!((3.4..4.6).contains(&(first / second)), "{first:e} {second:e}");
}

/// The fast path for sliders gives the results of the general one, over reversals, breaks and stretches of a run.
#[test]
fn sliders_glide_as_they_step() {
    let (dt, samples) = (1e-5, 4001);
    for (amplitude, bins) in [(10.0, 100), (1000.0, 100), (1e4, 7), (1e5, 1000)] {
        let (stepped, _) = on_sliders(amplitude, dt, samples, bins);
        let coupled = CoupledModes::new(&modes(dt, true), &[one_joint(RHO, 2e-8)], storage).unwrap();
        let mut table = vec![Slider::default(); Sliders::table_len(bins)];
        let sliders = Sliders::discretise(&law(), Grid::graded(bins), bins, &mut table).unwrap();
        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        let force = pulse(amplitude, dt, samples);
        let mut rows = Rows::new(samples, 3, 1);
        let mut joint = OneJoint::new(&sliders, &mut state);
        let mut motion = CoupledMotion::new(&coupled, &mut joint, [&[0.0; 3]; 2], 0.0, storage).unwrap();
        let whole = rows.rows();
        // The run in two stretches, of which the second begins with the last sample of the first.
        for (from, to) in [(0, 1500), (1500, samples - 1)] {
            let rest = force.get(from..).unwrap_or(&[]);
            let mut part = CoupledRows {
                displacement: &mut whole.displacement[from..=to],
                velocity: &mut whole.velocity[from..=to],
                acceleration: &mut whole.acceleration[from..=to],
                slip: &mut whole.slip[from..=to],
                joint_force: &mut whole.joint_force[from..=to],
            };
            coupled.integrate_sliders(&mut motion, &sliders, &mut state, rest, &mut part).unwrap();
        }
        for quantity in 0..3 {
            for r in 0..3 {
                let difference = worst(&rows.mode(quantity, r), &stepped.mode(quantity, r));
                assert!(difference < 1e-10, "{amplitude}, {bins}, {quantity}, mode {r}: {difference:e}");
            }
        }
        assert!(worst(&rows.joint(1, 0), &stepped.joint(1, 0)) < 1e-10);
    }
}

/// Two joints that move alike are one joint of twice the stiffness and strength and half the compliance; the equations of the two joints
/// are singular.
#[test]
fn joints_that_move_alike_are_one_joint() {
    let (dt, samples) = (1e-5, 4001);
    let half = FourParameter::new(0.5 * K, 0.5 * F_S, -0.3, 0.02).unwrap();
    for amplitude in [10.0, 1000.0, 3e4] {
        let force = pulse(amplitude, dt, samples);
        let row = [RHO, RHO];
        let joint = CoupledJoint { stiffness: 0.5 * K, compliance: &row, ..one_joint(0.0, 2e-8) };
        let coupled = CoupledModes::new(&modes(dt, true), &[joint, joint], storage).unwrap();
        let laws = [Continuum::new(half); 2];
        let mut states = laws.map(|law| law.virgin(vec![Reversal::default(); 200]).unwrap());
        let mut joints = SeveralJoints::new(&laws, &mut states, storage).unwrap();
        let (two, energy) = run(&coupled, &mut joints, &force, samples);
        assert!(energy.error() < 1e-13, "{:e}", energy.error());
        let (one, _) = in_the_continuum(amplitude, dt, samples);
        for r in 0..3 {
            let difference = worst(&two.mode(0, r), &one.mode(0, r));
            assert!(difference < 1e-9, "{amplitude}, mode {r}: {difference:e}");
        }
    }
}

/// Joints of different modes move as if each were alone.
#[test]
fn joints_of_different_modes_do_not_meet() {
    let (dt, samples) = (1e-5, 3001);
    let force = pulse(1000.0, dt, samples);
    let both = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let rows = [[RHO, 0.0], [0.0, 0.5 * RHO]];
    let joint = |i: usize| CoupledJoint {
        stiffness: K,
        participation: &both[i],
        compliance: &rows[i],
        slip_at_force: 0.0,
    };
    let coupled = CoupledModes::new(&modes(dt, true), &[joint(0), joint(1)], storage).unwrap();
    let mut tables = [(); 2].map(|()| vec![Slider::default(); Sliders::table_len(50)]);
    let sliders: Vec<_> = tables
        .iter_mut()
        .map(|table| Sliders::discretise(&law(), Grid::graded(50), 50, table).unwrap())
        .collect();
    let mut states: Vec<_> =
        sliders.iter().map(|s| s.virgin(vec![Run::default(); s.len()]).unwrap()).collect();
    let mut joints = SeveralJoints::new(&sliders, &mut states, storage).unwrap();
    let (together, energy) = run(&coupled, &mut joints, &force, samples);
    assert!(energy.error() < 1e-13);
    for (i, mode) in [0, 2].into_iter().enumerate() {
        let alone = CoupledJoint { compliance: &rows[i][i..=i], ..joint(i) };
        let coupled = CoupledModes::new(&modes(dt, true), &[alone], storage).unwrap();
        let mut state = sliders[i].virgin(vec![Run::default(); sliders[i].len()]).unwrap();
        let (alone, _) = run(&coupled, &mut OneJoint::new(&sliders[i], &mut state), &force, samples);
        assert!(worst(&together.mode(0, mode), &alone.mode(0, mode)) < 1e-10);
    }
}

/// A mode that is held away from rest loads its virgin joint statically.
#[test]
fn the_initial_state_is_in_balance() {
    let coupled = CoupledModes::new(&modes(1e-5, true), &[one_joint(RHO, 2e-8)], storage).unwrap();
    let joint = Continuum::new(law());
    let q = [2e-3, 0.0, 1e-3];
    let mut state = joint.virgin(vec![Reversal::default(); 20]).unwrap();
    let mut joints = OneJoint::new(&joint, &mut state);
    CoupledMotion::new(&coupled, &mut joints, [&q, &[0.0; 3]], 50.0, storage).unwrap();
    let (s, f) = (joints.slip(0), joints.force(0));
    let way: f64 = q.iter().zip(B).map(|(q, b)| q * b).sum();
    assert!((s - (way - RHO * (f - K * s) + 2e-8 * 50.0)).abs() < 1e-15, "{s}");
    let laws = [joint];
    let mut states = [joint.virgin(vec![Reversal::default(); 20]).unwrap()];
    let mut several = SeveralJoints::new(&laws, &mut states, storage).unwrap();
    CoupledMotion::new(&coupled, &mut several, [&q, &[0.0; 3]], 50.0, storage).unwrap();
    assert!((several.slip(0) - s).abs() < 1e-16);
}

#[test]
fn what_has_no_unique_step_is_refused() {
    let refused = |joints: &[CoupledJoint<'_>]| CoupledModes::new(&modes(1e-5, true), joints, storage).err();
    let error = refused(&[one_joint(1.1 / K, 0.0)]).unwrap();
    let Error::OutOfRange { value, allowed, .. } = error else { panic!("{error}") };
    assert!((value - 1.1).abs() < 0.01 && allowed.contains("more modes"), "{error}");
    assert!(refused(&[one_joint(0.9 / K, 0.0)]).is_none());
    for (rho, a) in [(f64::NAN, 0.0), (-1e-9, 0.0), (0.0, f64::NAN)] {
        assert!(refused(&[one_joint(rho, a)]).is_some());
    }
    for participation in [[0.0; 3], [f64::NAN, 1.0, 1.0]] {
        assert!(refused(&[CoupledJoint { participation: &participation, ..one_joint(0.0, 0.0) }]).is_some());
    }
    // The compliance matrix is not symmetric, or not positive semi-definite: forces would then do work without a motion.
    for rows in [[[RHO, RHO], [0.0, RHO]], [[RHO, 1.2 * RHO], [1.2 * RHO, RHO]]] {
        let joint =
            |i: usize| CoupledJoint { stiffness: 0.3 * K, compliance: &rows[i], ..one_joint(0.0, 0.0) };
        assert!(refused(&[joint(0), joint(1)]).is_some(), "{rows:?}");
    }
}

/// A memory that is too small forgets reversals, and states how large an error of the force this may cause.
#[test]
fn a_memory_that_overflows_says_so() {
    let coupled = CoupledModes::new(&modes(1e-5, true), &[one_joint(RHO, 0.0)], storage).unwrap();
    let joint = Continuum::new(law());
    let forgotten = |room: usize| {
        let mut state = joint.virgin(vec![Reversal::default(); room]).unwrap();
        run(&coupled, &mut OneJoint::new(&joint, &mut state), &pulse(300.0, 1e-5, 5001), 5001);
        state.forgotten()
    };
    assert_eq!(forgotten(600), 0.0);
    assert!(forgotten(8) > 0.0);
}
