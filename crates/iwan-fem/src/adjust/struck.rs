//! An adjusted structure under a blow: the transient of all modes of the reduced model with all joints.
//!
//! In the stuck modes of the adjusted structure the equations are those of [`iwan_core::CoupledModes`] with zero compliance, because no
//! mode is left out: q_r'' + 2ζω q' + ω² q + Σ b N = φ f, s = B q. Rigid motions are integrals of the force.

use iwan_core::{
    CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows, Grid, Lanes, Newmark, Oscillator,
    ResidualStiffness, Run, Runs, SeveralJoints, Slider, Sliders, groups,
};

use super::adjustable::Adjustable;
use super::adjusted::Adjusted;
use crate::error::Error;
use crate::structure::Law;
use crate::transient::Reduced;

/// Angle ω dt of a step, rad, above which a mode is not prewarped: the tangent of prewarping would lengthen the step without limit as two
/// steps a cycle are approached.
const PREWARPED: f64 = 1.0;
/// Largest slip in all modes, as a share of that of the most mobile joint, up to which a joint is left stuck: so small a slip is rounding
/// of a projection.
const UNMOVED: f64 = 1e-9;
/// Number of samples stepped at a time: the rows of fifty modes take 400 kB and stay in the cache.
const ROWS: usize = 256;

/// A linear functional of the unknowns (a load or an output) in the coordinates of a reduced model, with rigid motions kept separately.
#[derive(Debug, Clone, PartialEq)]
pub struct InCoordinates {
    rigid: Vec<f64>,
    elastic: Vec<f64>,
}

impl Adjustable {
    /// A functional of the unknowns in the coordinates of `reduced`, the reduced model of which this was made.
    ///
    /// # Errors
    /// [`Error::Analysis`] for coefficients of another structure.
    pub fn in_coordinates(
        &self,
        reduced: &Reduced<'_>,
        coefficients: &[f64],
    ) -> Result<InCoordinates, Error> {
        let fits = coefficients.len() == reduced.assembled().unknowns()
            && reduced.coordinates() == self.zero + self.eigenvalues.len();
        if !fits {
            return Err(Error::Analysis {
                analysis: "blow on an adjusted structure",
                finding: format!("a load or output has {} coefficients", coefficients.len()),
                remedy: "make it with the assembled structure of the reduced model",
            });
        }
        let mut rigid = reduced.project(coefficients);
        let elastic = rigid.split_off(self.zero);
        Ok(InCoordinates { rigid, elastic })
    }
}

/// A blow on a structure at rest, and the outputs.
#[derive(Debug, Clone, Copy)]
pub struct Blow<'a> {
    /// Force at each step, the first at t = 0; zero after the last.
    pub step: f64,
    /// Force at each step, the first at t = 0; zero behind the last.
    pub force: &'a [f64],
    /// The load: where the force acts.
    pub load: &'a InCoordinates,
    /// The outputs: where the motion is recorded.
    pub outputs: &'a [InCoordinates],
    /// The recorded quantity.
    pub kinematic: Kinematic,
    /// Number of steps from one sample to the next.
    pub every: usize,
    /// Number of samples, the first at t = 0.
    pub samples: usize,
    /// Number of bins (sliders) of each joint.
    pub bins: usize,
}

/// The quantity that is recorded at an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kinematic {
    /// The displacement.
    Displacement,
    /// The velocity.
    Velocity,
    /// The acceleration.
    Acceleration,
}

/// The response to a blow.
#[derive(Debug, Clone, PartialEq)]
pub struct Struck {
    /// The recorded quantity of each output at the samples.
    pub motion: Vec<Vec<f64>>,
    /// Largest slip of each joint, in the order of the structure's slips that have a law.
    pub slips: Vec<f64>,
}

/// The slips that move, and the functionals in terms of the modes.
struct Parts {
    slips: Vec<usize>,
    /// Modal value φ_r of the load in each mode.
    load: Vec<f64>,
    outputs: Vec<Vec<f64>>,
}

impl Adjusted<'_> {
    /// The response to a blow; `damping` gives the viscous damping ratio of a mode from its frequency in Hz.
    ///
    /// # Errors
    /// [`Error::Analysis`] for a structure that cannot be stepped: because of its laws, its compliance, or slips that do not settle.
    ///
    /// ```
    /// use iwan_core::Pulse;
    /// use iwan_fem::{Adjustable, Basis, Blow, Kinematic, mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// let reduced = assembled.reduce(20, Basis::default())?;
    /// let adjustable = Adjustable::new(&reduced, &[])?;
    /// let tip = adjustable.in_coordinates(&reduced, &assembled.load("tip", [0.0, 0.0, 1.0])?)?;
    /// let pulse = Pulse::Haversine { amplitude: 10.0, duration: 1.6e-3 };
    /// let force: Vec<f64> = (0..1001).map(|n| pulse.at(f64::from(n) * 1e-5)).collect();
    /// let struck = adjustable.at(&[], &[], &[])?.struck(
    ///     &Blow { step: 1e-5, force: &force, load: &tip, outputs: &[tip.clone()],
    ///         kinematic: Kinematic::Acceleration, every: 1, samples: 1001, bins: 100 },
    ///     |_| 0.0,
    /// )?;
    /// assert_eq!(struck.motion[0].len(), 1001);
    /// assert!(struck.slips.iter().any(|s| *s > 0.0));
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn struck(&self, blow: &Blow<'_>, damping: impl Fn(f64) -> f64) -> Result<Struck, Error> {
        let parts = self.parts(blow);
        let laws: Vec<Law> = parts.slips.iter().map(|s| self.law(*s)).collect();
        let coupled = self.coupled(blow, &parts, &laws, damping)?;
        let mut tables = vec![vec![Slider::default(); Sliders::table_len(blow.bins)]; laws.len()];
        let sliders = laws
            .iter()
            .zip(&mut tables)
            .map(|(law, table)| Sliders::discretise(law.as_ref(), Grid::graded(blow.bins), blow.bins, table));
        let sliders = sliders.collect::<Result<Vec<_>, _>>().map_err(|e| failed(&e))?;
        let virgin = |law: &Sliders<'_>| law.virgin(vec![Run::default(); law.len()]);
        let mut states: Vec<Runs<Vec<Run>>> =
            sliders.iter().map(virgin).collect::<Result<_, _>>().map_err(|e| failed(&e))?;
        let mut joints = SeveralJoints::new(&sliders, &mut states, storage).map_err(|e| failed(&e))?;
        let still = vec![0.0; self.values.len()];
        let first = blow.force.first().copied().unwrap_or(0.0);
        let mut motion = CoupledMotion::new(&coupled, &mut joints, [&still, &still], first, storage)
            .map_err(|e| failed(&e))?;
        let readings: Vec<Reading> = (0..blow.outputs.len()).map(|o| reading(blow, &parts, o)).collect();
        let mut found = Struck {
            motion: vec![Vec::with_capacity(blow.samples); readings.len()],
            slips: vec![0.0; self.adjustable.laws.len()],
        };
        let (width, j) = (groups(self.values.len()), laws.len());
        let rigid = rigid_motion(blow);
        let total = (blow.samples.max(1) - 1) * blow.every + 1;
        let most = ROWS.min(total).max(2);
        let mut rows: [Vec<Lanes>; 3] = std::array::from_fn(|_| storage(most * width));
        let mut of_joints: [Vec<f64>; 2] = std::array::from_fn(|_| vec![0.0; most * j]);
        let mut begin = 0;
        loop {
            let count = most.min(total - begin);
            let [q, v, a] = rows.each_mut().map(|rows| &mut rows[..count * width]);
            let [s, f] = of_joints.each_mut().map(|rows| &mut rows[..count * j]);
            let force = blow.force.get(begin..).unwrap_or(&[]);
            let mut out =
                CoupledRows { displacement: q, velocity: v, acceleration: a, slip: s, joint_force: f };
            coupled.integrate(&mut motion, &mut joints, force, &mut out).map_err(|e| failed(&e))?;
            let read = match blow.kinematic {
                Kinematic::Displacement => &rows[0],
                Kinematic::Velocity => &rows[1],
                Kinematic::Acceleration => &rows[2],
            };
            let sample = (if begin == 0 { 0 } else { begin + 1 }).next_multiple_of(blow.every);
            for n in (sample..begin + count).step_by(blow.every) {
                let at = (n - begin) * width;
                let modes = read[at..at + width].as_flattened();
                for (reading, out) in readings.iter().zip(&mut found.motion) {
                    let elastic: f64 = reading.shape.iter().zip(modes).map(|(c, q)| c * q).sum();
                    out.push(reading.rigid * rigid[n] + elastic);
                }
            }
            for (n, slip) in of_joints[0][..count * j].iter().enumerate() {
                let most = &mut found.slips[parts.slips[n % j]];
                *most = most.max(slip.abs());
            }
            begin += count - 1;
            if begin + 1 >= total {
                break;
            }
        }
        let known = found.motion.iter().flatten().all(|x| x.is_finite());
        if known { Ok(found) } else { Err(failed(&"the motion grows beyond all bounds")) }
    }

    /// The law of a slip: that of its group, or the structure's own.
    fn law(&self, slip: usize) -> Law {
        match self.group[slip] {
            Some(group) => std::sync::Arc::new(self.laws[group]),
            None => self.adjustable.laws[slip].clone(),
        }
    }

    fn parts(&self, blow: &Blow<'_>) -> Parts {
        let n = self.values.len();
        let modal = |f: &InCoordinates| -> Vec<f64> {
            (0..n).map(|i| (0..n).map(|k| f.elastic[k] * self.shapes[(k, i)]).sum()).collect()
        };
        let size = |slip: usize| (0..n).map(|i| self.slips[slip][i].abs()).fold(0.0, f64::max);
        let all: Vec<f64> = (0..self.slips.len()).map(size).collect();
        let largest = all.iter().copied().fold(0.0, f64::max);
        let slips = (0..self.slips.len()).filter(|s| all[*s] > UNMOVED * largest).collect();
        Parts { slips, load: modal(blow.load), outputs: blow.outputs.iter().map(modal).collect() }
    }

    fn coupled(
        &self,
        blow: &Blow<'_>,
        parts: &Parts,
        laws: &[Law],
        damping: impl Fn(f64) -> f64,
    ) -> Result<CoupledModes<Vec<Lanes>>, Error> {
        let mode = |i: usize| -> Result<CoupledMode, iwan_core::Error> {
            let omega = self.values[i].sqrt();
            let frequency = omega / std::f64::consts::TAU;
            let oscillator =
                Oscillator::new(frequency, damping(frequency), 0.0, ResidualStiffness::Positive)?;
            let scheme = if omega * blow.step < PREWARPED {
                Newmark::prewarped(blow.step, omega)?
            } else {
                Newmark::average_acceleration(blow.step)?
            };
            Ok(CoupledMode { oscillator, scheme, shape_at_force: parts.load[i] })
        };
        let modes =
            (0..self.values.len()).map(mode).collect::<Result<Vec<_>, _>>().map_err(|e| failed(&e))?;
        // No mode is left out, so the compliance is zero.
        let compliance = vec![0.0; laws.len()];
        let rows: Vec<Vec<f64>> = parts.slips.iter().map(|s| self.slips[*s].clone()).collect();
        let joints: Vec<CoupledJoint<'_>> = rows
            .iter()
            .zip(laws)
            .map(|(participation, law)| CoupledJoint {
                stiffness: law.initial_stiffness(),
                participation,
                compliance: &compliance,
                slip_at_force: 0.0,
            })
            .collect();
        CoupledModes::new(&modes, &joints, storage).map_err(|e| failed(&e))
    }
}

/// An output as a combination of the elastic modes and of the rigid motion of a unit mass.
struct Reading {
    rigid: f64,
    shape: Vec<f64>,
}

/// The coefficients of an output.
fn reading(blow: &Blow<'_>, parts: &Parts, output: usize) -> Reading {
    let shape = parts.outputs[output].clone();
    let rigid = blow.outputs[output].rigid.iter().zip(&blow.load.rigid).map(|(a, b)| a * b).sum();
    Reading { rigid, shape }
}

/// Motion of a unit mass under the force, at each step.
fn rigid_motion(blow: &Blow<'_>) -> Vec<f64> {
    let total = (blow.samples.max(1) - 1) * blow.every + 1;
    let mut motion: Vec<f64> = (0..total).map(|n| blow.force.get(n).copied().unwrap_or(0.0)).collect();
    let integrals = match blow.kinematic {
        Kinematic::Displacement => 2,
        Kinematic::Velocity => 1,
        Kinematic::Acceleration => 0,
    };
    for _ in 0..integrals {
        let (mut sum, mut before) = (0.0, motion[0]);
        for x in &mut motion {
            sum += 0.5 * blow.step * (before + *x);
            before = *x;
            *x = sum;
        }
        // The first sum added half a step before t = 0, where nothing has moved yet; its value is subtracted.
        let first = motion[0];
        for x in &mut motion {
            *x -= first;
        }
    }
    motion
}

fn storage(groups: usize) -> Vec<Lanes> {
    vec![[0.0; 4]; groups]
}

fn failed(error: &dyn std::fmt::Display) -> Error {
    Error::Analysis {
        analysis: "blow on an adjusted structure",
        finding: error.to_string(),
        remedy: "begin nearer to the joints of the structure, or give softer blows",
    }
}
