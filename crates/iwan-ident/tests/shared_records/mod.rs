//! Two modes that share one joint, simulated in the continuum: a memory that the fit does not use.
#![allow(clippy::unwrap_used, reason = "shared by several programs; a failed test may panic and say why")]

use iwan_core::{
    Continuum, CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows, FourParameter, Newmark,
    OneJoint, Oscillator, Pulse, ResidualStiffness, Reversal, TabledFourParameter,
};

/// Modes with their joint stuck, and the law of the joint.
pub(crate) struct Pair {
    pub(crate) frequencies: [f64; 2],
    pub(crate) damping_ratio: f64,
    /// Mode shapes at the load.
    pub(crate) shapes: [f64; 2],
    /// K_T, F_S, χ and β.
    pub(crate) law: [f64; 4],
    /// Slip of the joint in the second mode; in the first it is 1.
    pub(crate) slip: f64,
    /// Compliance times K_T.
    pub(crate) compliance: f64,
    /// Slip of the joint under a unit load, through modes left out.
    pub(crate) slip_at_force: f64,
}

impl Pair {
    /// Accelerations of both modes under a blow from rest, and the force, at `count` instants `dt` apart.
    pub(crate) fn struck(&self, blow: &Pulse<'_>, dt: f64, count: usize) -> ([Vec<f64>; 2], Vec<f64>) {
        let force: Vec<f64> = (0..count).map(|n| blow.at(n as f64 * dt)).collect();
        let modes = [0, 1].map(|r| {
            let oscillator =
                Oscillator::new(self.frequencies[r], self.damping_ratio, 0.0, ResidualStiffness::Positive)
                    .unwrap();
            let scheme = Newmark::prewarped(dt, oscillator.omega0()).unwrap();
            CoupledMode { oscillator, scheme, shape_at_force: self.shapes[r] }
        });
        let [k_t, f_s, chi, beta] = self.law;
        let joint = CoupledJoint {
            stiffness: k_t,
            participation: &[1.0, self.slip],
            compliance: &[self.compliance / k_t],
            slip_at_force: self.slip_at_force,
        };
        let storage = |groups: usize| vec![[0.0; 4]; groups];
        let coupled = CoupledModes::new(&modes, &[joint], storage).unwrap();
        let law = Continuum::new(TabledFourParameter::new(FourParameter::new(k_t, f_s, chi, beta).unwrap()));
        let mut state = law.virgin(vec![Reversal::default(); 2000]).unwrap();
        let mut joint = OneJoint::new(&law, &mut state);
        let mut motion =
            CoupledMotion::new(&coupled, &mut joint, [&[0.0; 2], &[0.0; 2]], 0.0, storage).unwrap();
        let (mut q, mut v, mut a) = (storage(count), storage(count), storage(count));
        let (mut s, mut f) = (vec![0.0; count], vec![0.0; count]);
        let mut rows = CoupledRows {
            displacement: &mut q,
            velocity: &mut v,
            acceleration: &mut a,
            slip: &mut s,
            joint_force: &mut f,
        };
        coupled.integrate(&mut motion, &mut joint, &force, &mut rows).unwrap();
        ([0, 1].map(|r| a.iter().map(|lanes| lanes[r]).collect()), force)
    }
}
