//! The case of the benches, and the linear oscillator they are measured against.
//!
//! Mode 1 of Table 2 of Deaner et al. (J. Vib. Acoust. 137:021012, 2015): 124 Hz, ζ_v = 2.5e-4, a haversine of
//! 1.6 ms, dt = 1e-5 s, 20,000 steps. The pulse amplitudes 10, 1000 and 10,000 drive q_max/φ_max to 0.001, 0.107 and 1.09.
#![allow(dead_code, reason = "each bench takes what it needs")]

use iwan::core::{
    FourParameter, Grid, Newmark, Oscillator, Pulse, ResidualStiffness, Run, Samples, Slider, Sliders,
};

pub(crate) const DT: f64 = 1e-5;
pub(crate) const STEPS: usize = 20_000;
pub(crate) const FREQUENCY: f64 = 124.0;
pub(crate) const DAMPING_RATIO: f64 = 2.5e-4;
pub(crate) const PULSE: f64 = 1.6e-3;
/// Pulse amplitudes for micro-slip, the paper's level, and macro-slip.
pub(crate) const AMPLITUDES: [f64; 3] = [10.0, 1e3, 1e4];
/// Starts of a free decay, as shares of φ_max.
pub(crate) const SHARES: [(&str, f64); 2] = [("micro-slip", 0.107), ("macro-slip", 1.5)];

/// The joint of mode 1.
pub(crate) fn joint() -> FourParameter {
    FourParameter::new(4.45e4, 239.4, -0.183, 0.3).expect("Table 2")
}

/// Mode 1.
pub(crate) fn oscillator() -> Oscillator {
    Oscillator::new(FREQUENCY, DAMPING_RATIO, joint().k_t(), ResidualStiffness::Positive).expect("Table 2")
}

pub(crate) fn newmark() -> Newmark {
    Newmark::average_acceleration(DT).expect("dt > 0")
}

/// The pulse's samples, without the zeros behind it.
pub(crate) fn force(amplitude: f64) -> Vec<f64> {
    let mut samples = vec![0.0; 256];
    let used = Pulse::Haversine { amplitude, duration: PULSE }.sample(DT, &mut samples);
    samples.truncate(used);
    samples
}

/// A population with the memory it stands on.
pub(crate) struct Population {
    table: Vec<Slider>,
    strength: Vec<f64>,
    stiffness: Vec<f64>,
}

impl Population {
    pub(crate) fn new(grid: Grid, bins: usize) -> Self {
        let mut table = vec![Slider::default(); Sliders::table_len(bins)];
        let sliders = Sliders::discretise(&joint(), grid, bins, &mut table).expect("room for all bins");
        let (strength, stiffness): (Vec<f64>, Vec<f64>) = sliders.elements().unzip();
        table.truncate(strength.len() + 1);
        Self { table, strength, stiffness }
    }

    pub(crate) fn sliders(&mut self) -> Sliders<'_> {
        Sliders::from_elements(&self.strength, &self.stiffness, &mut self.table)
            .expect("taken from a population")
    }

    /// One slider a line, strength and stiffness: what the peers read.
    pub(crate) fn lines(&self) -> String {
        let lines: Vec<_> =
            self.strength.iter().zip(&self.stiffness).map(|(phi, k)| format!("{phi:e} {k:e}")).collect();
        lines.join("\n")
    }
}

/// Both grids with their names: the one of the published comparisons, and the default.
pub(crate) fn grids(bins: usize) -> [(&'static str, Grid); 2] {
    [("uniform", Grid::Uniform), ("graded", Grid::graded(bins))]
}

/// Buffers of a response, touched once so that no page is fresh when the clock runs.
pub(crate) struct Buffers([Vec<f64>; 4]);

impl Buffers {
    pub(crate) fn new(samples: usize) -> Self {
        Self(std::array::from_fn(|_| vec![1.0; samples]))
    }

    pub(crate) fn samples(&mut self) -> Samples<'_> {
        let [displacement, velocity, acceleration, joint_force] = &mut self.0;
        Samples { displacement, velocity, acceleration, joint_force }
    }

    pub(crate) fn last_displacement(&self) -> f64 {
        self.0[0].last().copied().unwrap_or(f64::NAN)
    }
}

/// A whole run on sliders from rest; returns the final velocity.
pub(crate) fn run_sliders(sliders: &Sliders<'_>, runs: &mut [Run], force: &[f64], out: &mut Buffers) -> f64 {
    let mut state = sliders.virgin(runs).expect("one run per slider");
    newmark()
        .integrate_sliders(&oscillator(), sliders, &mut state, 0.0, force, &mut out.samples())
        .expect("buffers agree")
}

/// The linear oscillator q'' + c q' + k q = f by average acceleration in the recurrence of the slider stepper
/// (one product and one sum between steps), with the same four outputs and nothing else: no test, no table.
pub(crate) struct Linear {
    /// Spring behind the output "joint force" (1/s²), and the rest of the stiffness.
    joint: f64,
    k_inf: f64,
    viscous: f64,
}

impl Linear {
    /// Mode 1 with its joint stuck.
    pub(crate) fn new() -> Self {
        let oscillator = oscillator();
        Self { joint: joint().k_t(), k_inf: oscillator.k_inf(), viscous: oscillator.viscous() }
    }

    /// From rest under a force that is zero behind its samples.
    pub(crate) fn run(&self, force: &[f64], out: &mut Buffers) {
        let forced = force.len().min(STEPS);
        let at = |n: usize| force.get(n).copied().unwrap_or(0.0);
        let mean = |n: usize| 0.5 * (at(n) + at(n + 1));
        let mut motion = [0.0, 0.0, mean(0)];
        let Samples { displacement, velocity, acceleration, joint_force } = out.samples();
        (displacement[0], velocity[0], acceleration[0], joint_force[0]) = (0.0, 0.0, at(0), 0.0);
        let cut = forced + 1;
        let (d, v) = (displacement.split_at_mut(cut), velocity.split_at_mut(cut));
        let (a, f) = (acceleration.split_at_mut(cut), joint_force.split_at_mut(cut));
        let load = |i: usize| (at(i + 1), mean(i + 1), mean(i + 2));
        motion = self.steps(motion, [&mut d.0[1..], &mut v.0[1..], &mut a.0[1..], &mut f.0[1..]], load);
        self.steps(motion, [d.1, v.1, a.1, f.1], |_| (-0.0, -0.0, -0.0));
    }

    /// Steps through the buffers from (q, w = 2 q'/h, r), r half the load of the step's equation; `load(i)` is the force at
    /// the end of step i and the mean forces of the two steps behind it (-0.0 leaves a sum as it is).
    #[inline]
    fn steps(
        &self,
        start: [f64; 3],
        out: [&mut [f64]; 4],
        load: impl Fn(usize) -> (f64, f64, f64),
    ) -> [f64; 3] {
        let (k, damping) = (self.k_inf + self.joint, -self.viscous);
        let inertia = 4.0 / (DT * DT);
        let inverse = 2.0 / (inertia + 2.0 * self.viscous / DT + k);
        let (gain, loss) = ((inertia - k) * inverse, (inertia + k) * inverse);
        let [mut q, mut w, mut r] = start;
        let mut s = k * q;
        let mut e = (load(0).1 - w) - s;
        let [displacement, velocity, acceleration, joint_force] = out;
        let outputs = displacement.iter_mut().zip(velocity).zip(acceleration).zip(joint_force);
        for (i, (((q_out, v_out), a_out), f_out)) in outputs.enumerate() {
            let (p, _, next) = load(i);
            let (dq, r_next) = (r * inverse, e + gain * r);
            e = (next + (w - s)) - loss * r;
            (q, w, r) = (q + dq, inertia * dq - w, r_next);
            s = k * q;
            let v = 0.5 * DT * w;
            (*q_out, *v_out) = (q, v);
            (*a_out, *f_out) = ((p + damping * v) - s, self.joint * q);
        }
        [q, w, r]
    }
}
