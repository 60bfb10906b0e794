//! One record by the model.

use iwan_core::{
    CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows, FourParameter, Grid, Lanes, Newmark,
    OneJoint, Oscillator, ResidualStiffness, Run, Runs, SeveralJoints, Slider, Sliders, groups,
};
use nalgebra::DMatrix;

use super::unknowns::{Sharing, Values};
use crate::curves::Quantity;

/// Sliders of a joint. 200 hold the dissipation per cycle within 0.14 % from 0.001 to 0.3 φ_max, a fifth of the least misfit of a
/// modal model; a step costs the same for any number.
const BINS: usize = 200;
/// Steps in a period of the fastest mode, at least: prewarped average acceleration keeps its frequency, and the joint's force is then off
/// by (2π/40)²/12 = 0.2 % of what it loses in a step.
pub(super) const STEPS_A_PERIOD: f64 = 40.0;
/// Samples stepped at a time: rows of four modes take 100 kB, which stay in the cache.
const ROWS: usize = 1024;

/// When and how a record is stepped.
#[derive(Debug, Clone)]
pub(super) struct Clock {
    /// Step, s, and steps for each sample.
    pub(super) step: f64,
    pub(super) steps: usize,
    /// Load at each step; empty: none.
    pub(super) force: Vec<f64>,
    /// Sliders of a joint.
    bins: usize,
}

impl Clock {
    /// Steps for samples `dt` apart that resolve the frequency `fastest`.
    pub(super) fn new(dt: f64, force: Option<&[f64]>, fastest: f64) -> Self {
        Self::finer(dt, force, fastest, 1)
    }

    /// The same with so many times the steps and the sliders.
    pub(super) fn finer(dt: f64, force: Option<&[f64]>, fastest: f64, times: usize) -> Self {
        let steps = (dt * fastest * STEPS_A_PERIOD).ceil().max(1.0) as usize * times;
        Self {
            step: dt / steps as f64,
            steps,
            force: force.map_or_else(Vec::new, |force| between_samples(force, steps)),
            bins: times * BINS,
        }
    }
}

/// A load at so many steps from each of its samples to the next: a cubic through four of them. Straight lines take the factor sinc²(π f dt) off its
/// spectrum, 0.9 % at 52 Hz sampled at 1 kHz.
#[must_use]
pub fn between_samples(force: &[f64], steps: usize) -> Vec<f64> {
    let at = |n: isize| usize::try_from(n).ok().and_then(|n| force.get(n)).copied().unwrap_or(0.0);
    let value = |i: usize| {
        let (n, s) = ((i / steps).cast_signed(), (i % steps) as f64 / steps as f64);
        let (a, b, c, d) = (s + 1.0, s, s - 1.0, s - 2.0);
        // Lagrange's weights of the samples before, at, and twice behind.
        -b * c * d / 6.0 * at(n - 1) + a * c * d / 2.0 * at(n) - a * b * d / 2.0 * at(n + 1)
            + a * b * c / 6.0 * at(n + 2)
    };
    (0..force.len() * steps).map(value).collect()
}

/// Motions of the modes at the samples, and the largest slip of each joint over its φ_max.
pub(super) struct Motions {
    pub(super) modes: Vec<Vec<f64>>,
    pub(super) slip_ratios: Vec<f64>,
}

/// Modes and joints that move together.
struct Part<'a> {
    modes: Vec<usize>,
    joints: Vec<usize>,
    values: &'a Values,
}

/// Runs the record `k` for so many samples; none where the modes and joints make no structure.
pub(super) fn run(
    (sharing, values): (Sharing, &Values),
    k: usize,
    clock: &Clock,
    samples: usize,
    quantity: Quantity,
) -> Option<Motions> {
    let n = values.frequency.len();
    let mut out = Motions { modes: vec![Vec::new(); n], slip_ratios: vec![0.0; values.laws.len()] };
    let parts: Vec<Part<'_>> = match sharing {
        Sharing::Linear => (0..n).map(|r| Part { modes: vec![r], joints: Vec::new(), values }).collect(),
        Sharing::Uncoupled => (0..n).map(|r| Part { modes: vec![r], joints: vec![r], values }).collect(),
        Sharing::Shared(j) => vec![Part { modes: (0..n).collect(), joints: (0..j).collect(), values }],
    };
    for part in parts {
        part.run(k, clock, (samples, quantity), &mut out)?;
    }
    Some(out)
}

fn storage(groups: usize) -> Vec<Lanes> {
    vec![[0.0; 4]; groups]
}

impl Part<'_> {
    /// Whether the structure keeps a positive stiffness when all joints slip: K^½ (ρ + Σ b bᵀ/ω²) K^½ < 1.
    fn holds(&self) -> bool {
        let v = self.values;
        let entry = |i: usize, l: usize| {
            let (i, l) = (self.joints[i], self.joints[l]);
            let modes = self.modes.iter().map(|r| {
                let omega = std::f64::consts::TAU * v.frequency[*r];
                v.participation[i][*r] * v.participation[l][*r] / (omega * omega)
            });
            let own = if i == l { v.compliance[i] } else { 0.0 };
            (v.laws[i].k_t() * v.laws[l].k_t()).sqrt() * (own + modes.sum::<f64>())
        };
        match self.joints.len() {
            0 => true,
            1 => entry(0, 0) < 1.0,
            j => DMatrix::from_fn(j, j, entry).symmetric_eigenvalues().max() < 1.0,
        }
    }

    fn coupled(&self, step: f64, joints: &[CoupledJoint<'_>]) -> Option<CoupledModes<Vec<Lanes>>> {
        let v = self.values;
        let mode = |r: &usize| -> Option<CoupledMode> {
            let oscillator =
                Oscillator::new(v.frequency[*r], v.damping_ratio[*r], 0.0, ResidualStiffness::Positive)
                    .ok()?;
            let scheme = Newmark::prewarped(step, oscillator.omega0()).ok()?;
            Some(CoupledMode { oscillator, scheme, shape_at_force: v.shape_at_force[*r] })
        };
        let modes = self.modes.iter().map(mode).collect::<Option<Vec<_>>>()?;
        CoupledModes::new(&modes, joints, storage).ok()
    }

    /// Laws of the joints; of a linear mode one that is never felt.
    fn laws(&self) -> Option<Vec<FourParameter>> {
        let mut laws: Vec<FourParameter> = self.joints.iter().map(|j| self.values.laws[*j]).collect();
        if laws.is_empty() {
            // It slips at displacements of 1e40 of any unit, and takes a billionth of the stiffness.
            let omega = std::f64::consts::TAU * self.values.frequency[self.modes[0]];
            laws.push(FourParameter::new(1e-9 * omega * omega, 1e40, 0.0, 0.0).ok()?);
        }
        Some(laws)
    }

    fn run(
        &self,
        k: usize,
        clock: &Clock,
        (samples, quantity): (usize, Quantity),
        out: &mut Motions,
    ) -> Option<()> {
        if !self.holds() {
            return None;
        }
        let (v, laws) = (self.values, self.laws()?);
        let j = laws.len();
        let rows: Vec<(Vec<f64>, Vec<f64>)> = (0..j)
            .map(|i| match self.joints.get(i) {
                None => (vec![1.0], vec![0.0]),
                Some(joint) => (
                    self.modes.iter().map(|r| v.participation[*joint][*r]).collect(),
                    (0..j).map(|l| if l == i { v.compliance[*joint] } else { 0.0 }).collect(),
                ),
            })
            .collect();
        let joints: Vec<CoupledJoint<'_>> = laws
            .iter()
            .zip(&rows)
            .map(|(law, (participation, compliance))| CoupledJoint {
                stiffness: law.k_t(),
                participation,
                compliance,
                slip_at_force: 0.0,
            })
            .collect();
        let coupled = self.coupled(clock.step, &joints)?;
        let bins = if self.joints.is_empty() { 1 } else { clock.bins };
        let mut tables = vec![vec![Slider::default(); Sliders::table_len(bins)]; j];
        let sliders = laws
            .iter()
            .zip(&mut tables)
            .map(|(law, table)| Sliders::discretise(law, Grid::graded(bins), bins, table).ok())
            .collect::<Option<Vec<_>>>()?;
        let virgin = |law: &Sliders<'_>| law.virgin(vec![Run::default(); law.len()]).ok();
        let mut states = sliders.iter().map(virgin).collect::<Option<Vec<_>>>()?;
        let begin: [Vec<f64>; 2] =
            std::array::from_fn(|i| self.modes.iter().map(|r| v.initial[k][*r][i]).collect());
        let stepping = Stepping { coupled: &coupled, clock, samples, quantity, part: self };
        let slips = match (sliders.as_slice(), states.as_mut_slice()) {
            ([law], [state]) => stepping.one(law, state, &begin, out)?,
            (laws, states) => stepping.several(laws, states, &begin, out)?,
        };
        for ((joint, slip), law) in self.joints.iter().zip(slips).zip(&laws) {
            out.slip_ratios[*joint] = slip / law.phi_max();
        }
        Some(())
    }
}

struct Stepping<'a> {
    coupled: &'a CoupledModes<Vec<Lanes>>,
    clock: &'a Clock,
    samples: usize,
    quantity: Quantity,
    part: &'a Part<'a>,
}

type Motion = CoupledMotion<Vec<Lanes>>;

impl Stepping<'_> {
    /// One joint, by the path without iterations where that can be.
    fn one(
        &self,
        law: &Sliders<'_>,
        state: &mut Runs<Vec<Run>>,
        [q, v]: &[Vec<f64>; 2],
        out: &mut Motions,
    ) -> Option<Vec<f64>> {
        let mut motion = CoupledMotion::new(
            self.coupled,
            &mut OneJoint::new(law, state),
            [q, v],
            self.clock.force.first().copied().unwrap_or(0.0),
            storage,
        )
        .ok()?;
        self.stretches(1, out, |force, rows| {
            self.coupled.integrate_sliders(&mut motion, law, state, force, rows).ok()
        })
    }

    fn several(
        &self,
        laws: &[Sliders<'_>],
        states: &mut [Runs<Vec<Run>>],
        [q, v]: &[Vec<f64>; 2],
        out: &mut Motions,
    ) -> Option<Vec<f64>> {
        let mut joints = SeveralJoints::new(laws, states, storage).ok()?;
        let p = self.clock.force.first().copied().unwrap_or(0.0);
        let mut motion: Motion = CoupledMotion::new(self.coupled, &mut joints, [q, v], p, storage).ok()?;
        self.stretches(laws.len(), out, |force, rows| {
            self.coupled.integrate(&mut motion, &mut joints, force, rows).ok()
        })
    }

    /// All samples, stretch by stretch; returns the largest slips.
    fn stretches(
        &self,
        joints: usize,
        out: &mut Motions,
        mut step: impl FnMut(&[f64], &mut CoupledRows<'_>) -> Option<()>,
    ) -> Option<Vec<f64>> {
        let (width, steps) = (groups(self.part.modes.len()), self.clock.steps);
        let total = (self.samples - 1) * steps + 1;
        let count = ROWS.min(total);
        let mut modal: [Vec<Lanes>; 3] = std::array::from_fn(|_| storage(count * width));
        let mut of_joints: [Vec<f64>; 2] = std::array::from_fn(|_| vec![0.0; count * joints]);
        let mut slips = vec![0.0_f64; joints];
        for r in &self.part.modes {
            out.modes[*r].reserve(self.samples);
        }
        let mut first = 0;
        loop {
            let count = ROWS.min(total - first);
            let [q, v, a] = modal.each_mut().map(|rows| &mut rows[..count * width]);
            let [s, f] = of_joints.each_mut().map(|rows| &mut rows[..count * joints]);
            let force = self.clock.force.get(first..).unwrap_or(&[]);
            step(
                force,
                &mut CoupledRows { displacement: q, velocity: v, acceleration: a, slip: s, joint_force: f },
            )?;
            self.hand_out((&modal, first, count), out);
            for (n, s) in of_joints[0][..count * joints].iter().enumerate() {
                slips[n % joints] = s.abs().max(slips[n % joints]);
            }
            first += count - 1;
            if first + 1 >= total {
                return slips.iter().all(|s| s.is_finite()).then_some(slips);
            }
        }
    }

    /// Samples among the rows; the first row of all but the first stretch is the last of the one before.
    fn hand_out(&self, (modal, first, count): (&[Vec<Lanes>; 3], usize, usize), out: &mut Motions) {
        let width = groups(self.part.modes.len());
        let rows = match self.quantity {
            Quantity::Displacement => &modal[0],
            Quantity::Velocity => &modal[1],
            Quantity::Acceleration => &modal[2],
        };
        let steps = self.clock.steps;
        let begin = if first == 0 { 0 } else { first + 1 };
        let sample = begin.next_multiple_of(steps);
        for (lane, r) in self.part.modes.iter().enumerate() {
            let flat = rows.as_flattened();
            let at = (sample..first + count).step_by(steps);
            out.modes[*r].extend(at.map(|n| flat[(n - first) * width * 4 + lane]));
        }
    }
}
