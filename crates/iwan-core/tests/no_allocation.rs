//! No time step and no evaluation of a force allocates memory; an allocator counts the calls.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use iwan_core::{
    Averaging, Continuum, CoupledEnergy, CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows,
    Decay, EventDriven, FourParameter, Grid, Harmonics, Hysteresis, Motion, Newmark, OneJoint, Oscillator,
    Plain, Pulse, ResidualStiffness, Reversal, Run, Samples, SeveralJoints, Slider, Sliders, SteadyWork,
    TabledFourParameter, one_harmonic, steady_force,
};

#[test]
fn nothing_allocates() {
    let mut buffers: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; 2001]);
    let [displacement, velocity, acceleration, joint_force] = &mut buffers;
    let mut out = Samples { displacement, velocity, acceleration, joint_force };
    let counted = allocation_counter::measure(|| run_everything(&mut out));
    assert_eq!(counted.count_total, 0, "allocations in iwan-core: {counted:?}");
}

fn run_everything(out: &mut Samples<'_>) {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let oscillator = Oscillator::new(124.0, 2.5e-4, 4.45e4, ResidualStiffness::Positive).unwrap();
    let mut table = [Slider::default(); Sliders::table_len(100)];
    let sliders = Sliders::discretise(&joint, Grid::graded(100), 100, &mut table).unwrap();
    let pulse = Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 };
    let mut force = [0.0; 200];
    let used = pulse.sample(1e-5, &mut force);
    let scheme = Newmark::prewarped(1e-5, oscillator.omega0()).unwrap();

    let mut runs = sliders.virgin([Run::default(); 101]).unwrap();
    scheme.integrate_sliders(&oscillator, &sliders, &mut runs, 0.0, &force[..used], out).unwrap();
    let mut runs = sliders.virgin([Run::default(); 101]).unwrap();
    scheme.integrate(&oscillator, &sliders, &mut runs, 0.0, &force[..used], out).unwrap();
    let plain = Plain::new(sliders);
    let mut extensions = plain.virgin([0.0; 101]).unwrap();
    scheme.integrate(&oscillator, &plain, &mut extensions, 0.0, &force[..used], out).unwrap();
    let continuum = Continuum::new(TabledFourParameter::new(joint));
    let mut reversals = continuum.virgin([Reversal::default(); 64]).unwrap();
    scheme.integrate(&oscillator, &continuum, &mut reversals, 0.0, &force[..used], out).unwrap();
    for u in [1e-3, -2e-2, 5e-4, 0.0] {
        sliders.advance(&mut runs, u);
        plain.advance(&mut extensions, u);
        continuum.advance(&mut reversals, u);
    }
    let start = Motion { displacement: 0.3 * joint.phi_max(), velocity: 0.1 };
    Decay::new(&oscillator, &joint, 0.0, start, [Reversal::default(); 64])
        .unwrap()
        .sample(1e-5, out)
        .unwrap();
    Averaging::new(&oscillator, &joint, start).unwrap().sample(1e-5, out).unwrap();
    let (motion, mut coefficients, mut jacobian) = ([1e-3, 0.0, 5e-4, 0.0], [0.0; 4], [0.0; 16]);
    let mut work = SteadyWork::new();
    let odd = Harmonics::odd(3).unwrap();
    steady_force(&joint, odd, &motion, &mut coefficients, Some(&mut jacobian), &mut work).unwrap();
    let (cosine, sine) = coefficients.split_at_mut(2);
    one_harmonic(&joint, 1e-2, cosine, sine).unwrap();
    let mut runs = sliders.virgin([Run::default(); 101]).unwrap();
    EventDriven::new(&oscillator, sliders, pulse, 1.0).unwrap().integrate(&mut runs, 0.0, 1e-5, out).unwrap();
    coupled(&continuum, &sliders, &force[..used]);
}

/// Two modes that share one joint, then two modes that share two joints.
fn coupled(continuum: &Continuum<TabledFourParameter>, sliders: &Sliders<'_>, force: &[f64]) {
    let mode = |frequency: f64| {
        let oscillator = Oscillator::new(frequency, 0.0, 0.0, ResidualStiffness::Positive).unwrap();
        CoupledMode { oscillator, scheme: Newmark::average_acceleration(1e-5).unwrap(), shape_at_force: 1.0 }
    };
    let (modes, storage) = ([mode(124.0), mode(700.0)], |_: usize| [[0.0; 4]; 6]);
    let joint = |compliance| CoupledJoint {
        stiffness: 4.45e4,
        participation: &[1.0, -2.0],
        compliance,
        slip_at_force: 0.0,
    };
    let (mut q, mut v, mut a) = ([[0.0; 4]; 300], [[0.0; 4]; 300], [[0.0; 4]; 300]);
    let (mut slip, mut joint_force) = ([0.0; 600], [0.0; 600]);
    let one = CoupledModes::new(&modes, &[joint(&[1e-7])], storage).unwrap();
    let mut rows = CoupledRows {
        displacement: &mut q,
        velocity: &mut v,
        acceleration: &mut a,
        slip: &mut slip[..300],
        joint_force: &mut joint_force[..300],
    };
    let mut state = continuum.virgin([Reversal::default(); 64]).unwrap();
    let mut law = OneJoint::new(continuum, &mut state);
    let mut motion = CoupledMotion::new(&one, &mut law, [&[0.0; 2]; 2], 0.0, storage).unwrap();
    one.integrate(&mut motion, &mut law, force, &mut rows).unwrap();
    let mut runs = sliders.virgin([Run::default(); 101]).unwrap();
    one.integrate_sliders(&mut motion, sliders, &mut runs, force, &mut rows).unwrap();
    CoupledEnergy::new(&one, storage).unwrap().add(&one, force, &rows).unwrap();
    let two = CoupledModes::new(&modes, &[joint(&[1e-7, 0.0]), joint(&[0.0, 1e-7])], storage).unwrap();
    let laws = [(); 2].map(|()| continuum.clone());
    let mut states = [(); 2].map(|()| continuum.virgin([Reversal::default(); 64]).unwrap());
    let mut several = SeveralJoints::new(&laws, &mut states, storage).unwrap();
    let mut motion = CoupledMotion::new(&two, &mut several, [&[0.0; 2]; 2], 0.0, storage).unwrap();
    let mut rows = CoupledRows {
        displacement: &mut q,
        velocity: &mut v,
        acceleration: &mut a,
        slip: &mut slip,
        joint_force: &mut joint_force,
    };
    two.integrate(&mut motion, &mut several, force, &mut rows).unwrap();
}
