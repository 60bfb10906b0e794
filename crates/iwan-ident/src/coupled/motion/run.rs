//! The motion of one record by the model, in time steps.

use iwan_core::{
    CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows, FourParameter, Grid, Lanes, Newmark,
    OneJoint, Oscillator, ResidualStiffness, Run, Runs, SeveralJoints, Slider, Sliders, groups,
};
use nalgebra::DMatrix;

use super::between::between_samples;
use crate::coupled::unknowns::{Sharing, Values};
use crate::curves::Quantity;

/// Number of sliders of a joint. 200 keep the dissipation per cycle within 0.14 % from 0.001 to 0.3 φ_max, a fifth of the least misfit of a
/// modal model; a step costs the same for any number.
const BINS: usize = 200;
/// Least number of steps in a period of the fastest mode: prewarped average acceleration keeps the mode's frequency, and the joint's force is then off
/// by (2π/40)²/12 = 0.2 % of what it loses in a step.
pub(in crate::coupled) const STEPS_A_PERIOD: f64 = 40.0;
/// Number of rows stepped at a time: those of four modes take 100 kB, which stay in the cache.
const ROWS: usize = 1024;

/// Times at which a record is stepped: several steps for each sample, or several samples for each step.
#[derive(Debug, Clone)]
pub(in crate::coupled) struct Clock {
    /// Step, s.
    pub(in crate::coupled) step: f64,
    /// Steps for each sample; 1 where a step spans several samples.
    steps: usize,
    /// Samples for each step; 1 where a sample takes several steps.
    every: usize,
    /// Load at each step; empty where there is none.
    pub(in crate::coupled) force: Vec<f64>,
    /// Number of sliders of a joint.
    pub(in crate::coupled) bins: usize,
}

impl Clock {
    /// Steps for samples `dt` apart that resolve the frequency `fastest` (Hz). Records of many more samples than that are stepped from every second or third sample
    /// to the next; what their sensors show in between follows by cubics, which are off by 1e-5 at forty steps a period.
    pub(in crate::coupled) fn new(dt: f64, force: Option<&[f64]>, fastest: f64) -> Self {
        Self::of((dt, force), dt * fastest * STEPS_A_PERIOD, BINS)
    }

    /// The same with `times` times the steps, or more, and with `times²` as many sliders: both errors are of second order, and sliders cost nothing.
    pub(in crate::coupled) fn finer(dt: f64, force: Option<&[f64]>, fastest: f64, times: usize) -> Self {
        let wanted = dt * fastest * STEPS_A_PERIOD;
        let own = if wanted > 1.0 { wanted.ceil() } else { 1.0 / samples_a_step(wanted) as f64 };
        Self::of((dt, force), times as f64 * own, times * times * BINS)
    }

    /// A clock with `wanted` steps for each sample, or a little more.
    fn of((dt, force): (f64, Option<&[f64]>), wanted: f64, bins: usize) -> Self {
        let (steps, every) = (wanted.ceil().max(1.0) as usize, samples_a_step(wanted));
        // A load between its samples is smooth where the record has more of them than the steps need.
        let force = force.map_or_else(Vec::new, |force| match every {
            1 => between_samples(force, steps),
            _ => force.iter().copied().step_by(every).collect(),
        });
        Self { step: dt * every as f64 / steps as f64, steps, every, force, bins }
    }

    /// The same with another load at its steps.
    pub(in crate::coupled) fn with_load(&self, force: Vec<f64>) -> Self {
        Self { force, ..self.clone() }
    }

    /// Time between samples of the record, s.
    pub(in crate::coupled) fn sample(&self) -> f64 {
        self.step * self.steps as f64 / self.every as f64
    }

    /// Number of steps for this many samples.
    pub(in crate::coupled) fn steps_for(&self, samples: usize) -> usize {
        samples * self.steps / self.every
    }

    /// Number of rows that hold this many samples; at least the four that cubics need.
    fn rows(&self, samples: usize) -> usize {
        if self.every == 1 {
            (samples - 1) * self.steps + 1
        } else {
            ((samples - 1).div_ceil(self.every) + 1).max(4)
        }
    }
}

/// Number of samples that one step spans where each sample needs `wanted` steps.
fn samples_a_step(wanted: f64) -> usize {
    (1.0 / wanted).floor().max(1.0) as usize
}

/// Motions of the modes, and the largest slip of each joint over its φ_max.
pub(in crate::coupled) struct Motions {
    /// Each mode's motion at every `every`th sample, and two rows beyond the last sample at most.
    pub(in crate::coupled) modes: Vec<Vec<f64>>,
    pub(in crate::coupled) every: usize,
    pub(in crate::coupled) slip_ratios: Vec<f64>,
}

/// A group of modes and joints that move together.
struct Part<'a> {
    modes: Vec<usize>,
    joints: Vec<usize>,
    values: &'a Values,
}

/// Memory for the sliders of `joints` joints.
pub(in crate::coupled) fn room(joints: usize, bins: usize) -> Vec<Vec<Slider>> {
    vec![vec![Slider::default(); Sliders::table_len(bins)]; joints]
}

/// The sliders of joints with these laws; none where a law cannot be discretised.
pub(in crate::coupled) fn populations<'a>(
    laws: &[FourParameter],
    bins: usize,
    room: &'a mut [Vec<Slider>],
) -> Option<Vec<Sliders<'a>>> {
    let of = |(law, table): (&FourParameter, &'a mut Vec<Slider>)| {
        Sliders::discretise(law, Grid::graded(bins), bins, table).ok()
    };
    laws.iter().zip(room).map(of).collect()
}

/// Motion of the modes in record `k` over `samples` samples; none where modes and joints make no structure that holds.
pub(in crate::coupled) fn run(
    of: (Sharing, &Values),
    k: usize,
    clock: &Clock,
    samples: usize,
    quantity: Quantity,
) -> Option<Motions> {
    let mut room = room(of.1.laws.len(), clock.bins);
    let sliders = populations(&of.1.laws, clock.bins, &mut room)?;
    run_with(of, &sliders, k, clock, (samples, quantity))
}

/// The same with sliders that are already made.
pub(in crate::coupled) fn run_with(
    (sharing, values): (Sharing, &Values),
    sliders: &[Sliders<'_>],
    k: usize,
    clock: &Clock,
    (samples, quantity): (usize, Quantity),
) -> Option<Motions> {
    let n = values.frequency.len();
    let mut out =
        Motions { modes: vec![Vec::new(); n], every: clock.every, slip_ratios: vec![0.0; values.laws.len()] };
    let parts: Vec<Part<'_>> = match sharing {
        Sharing::Linear => (0..n).map(|r| Part { modes: vec![r], joints: Vec::new(), values }).collect(),
        Sharing::Uncoupled => (0..n).map(|r| Part { modes: vec![r], joints: vec![r], values }).collect(),
        Sharing::Shared(j) => vec![Part { modes: (0..n).collect(), joints: (0..j).collect(), values }],
    };
    for part in parts {
        part.run(sliders, k, clock, (samples, quantity), &mut out)?;
    }
    Some(out)
}

fn storage(groups: usize) -> Vec<Lanes> {
    vec![[0.0; 4]; groups]
}

impl Part<'_> {
    /// Whether the structure keeps a positive stiffness when all joints slip: the largest eigenvalue of K^½ (ρ + Σ b bᵀ/ω²) K^½ is below 1.
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

    /// Laws of the joints; for a linear mode one joint that has no effect.
    fn laws(&self) -> Option<Vec<FourParameter>> {
        let mut laws: Vec<FourParameter> = self.joints.iter().map(|j| self.values.laws[*j]).collect();
        if laws.is_empty() {
            // This joint slips at displacements of 1e40 of any unit, and takes a billionth of the stiffness.
            let omega = std::f64::consts::TAU * self.values.frequency[self.modes[0]];
            laws.push(FourParameter::new(1e-9 * omega * omega, 1e40, 0.0, 0.0).ok()?);
        }
        Some(laws)
    }

    fn run(
        &self,
        sliders: &[Sliders<'_>],
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
            .enumerate()
            .map(|(i, (law, (participation, compliance)))| CoupledJoint {
                stiffness: law.k_t(),
                participation,
                compliance,
                slip_at_force: self.joints.get(i).map_or(0.0, |joint| v.slip_at_force[*joint]),
            })
            .collect();
        let coupled = self.coupled(clock.step, &joints)?;
        let mut room = room(1, 1);
        let sliders = if self.joints.is_empty() {
            populations(&laws, 1, &mut room)?
        } else {
            self.joints.iter().map(|joint| sliders[*joint]).collect()
        };
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
    /// Steps a group with one joint, by the path without iterations.
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

    /// Steps all samples, stretch by stretch, and returns the largest slip of each joint.
    fn stretches(
        &self,
        joints: usize,
        out: &mut Motions,
        mut step: impl FnMut(&[f64], &mut CoupledRows<'_>) -> Option<()>,
    ) -> Option<Vec<f64>> {
        let width = groups(self.part.modes.len());
        let total = self.clock.rows(self.samples);
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

    /// Picks the samples out of the rows; the first row of every stretch but the first is the last row of the one before, and is passed over.
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

#[cfg(test)]
mod tests {
    use super::super::between::at_samples;
    use super::*;

    /// A record of more samples than the steps need is stepped from every fifth sample to the next, and shows the same motion at all samples.
    #[test]
    fn steps_over_several_samples_show_what_steps_of_each_show() {
        let law = FourParameter::new(3e4, 140.0, -0.3, 0.1).unwrap();
        let values = Values {
            frequency: vec![130.0, 690.0],
            damping_ratio: vec![1e-3; 2],
            laws: vec![law],
            participation: vec![vec![1.0, -4.9]],
            compliance: vec![1e-6],
            slip_at_force: vec![0.0],
            shape_at_sensor: vec![1.0; 2],
            shape_at_force: vec![20.0; 2],
            initial: vec![vec![[0.0; 2]; 2]],
        };
        let dt = 1.0 / (690.0 * 5.5 * STEPS_A_PERIOD);
        let blow = |n: usize| {
            let phase = std::f64::consts::PI * n as f64 * dt / 1.6e-3;
            if phase < std::f64::consts::PI { 100.0 * phase.sin().powi(2) } else { 0.0 }
        };
        let force: Vec<f64> = (0..20_000).map(blow).collect();
        let coarse = Clock::new(dt, Some(&force), 690.0);
        assert_eq!((coarse.every, coarse.steps, coarse.force.len()), (5, 1, 4000));
        let each = Clock { step: dt, every: 1, force: force.clone(), ..coarse.clone() };
        let motions = |clock: &Clock| {
            let found = run((Sharing::Shared(1), &values), 0, clock, 19_998, Quantity::Acceleration).unwrap();
            found.modes.iter().map(|rows| at_samples(rows, found.every, 19_998)).collect::<Vec<_>>()
        };
        for (mode, (found, expected)) in motions(&coarse).iter().zip(&motions(&each)).enumerate() {
            assert_eq!((found.len(), expected.len()), (19_998, 19_998));
            let size = expected.iter().map(|x| x * x).sum::<f64>().sqrt();
            let off = found.iter().zip(expected).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            // The error is of second order in the step, and the fast mode's memory of the blow lasts 12 cycles.
            assert!(off < 5e-3 * size, "mode {mode}: {} of {size}", off / size);
        }
        let fine = Clock::finer(dt, Some(&force), 690.0, 4);
        assert_eq!((fine.every, fine.steps, fine.bins), (1, 1, 16 * BINS));
        assert_eq!(Clock::finer(4.0 * dt, None, 690.0, 4).steps, 4);
        assert_eq!(Clock::finer(12.0 * dt, None, 690.0, 4).steps, 4 * 3);
    }
}
