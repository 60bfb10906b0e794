//! Measured blows, and the time axis on which the structure is compared with them.

use iwan_fem::{Kinematic, NamedModes, Output};
use iwan_ident::coupled::{Sums, between_samples};

use crate::error::Error;

/// Time steps per period of the fastest compared mode. Prewarped average acceleration keeps the mode's frequency, and the joints' forces are then off
/// by (2π/40)²/12 = 0.2 % of their change in a step. As in fits of modes that share joints.
const STEPS_A_PERIOD: f64 = 40.0;
/// Fewest samples of a record; shorter records are refused, because they hold not even one cycle of the slowest mode.
const FEWEST: usize = 64;

/// Motions of several points of a structure under a blow from rest.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredBlow {
    /// Origin of the record, for messages and results.
    pub source: String,
    /// Sampling interval, s.
    pub dt: f64,
    /// Force at each sample, in the unit of the structure.
    pub force: Vec<f64>,
    /// The measured points as outputs of the structure, each with its samples.
    pub points: Vec<(Output, Vec<f64>)>,
    /// Whether displacement, velocity or acceleration was measured.
    pub kinematic: Kinematic,
}

/// The blows from which joints are found.
#[derive(Debug, Clone)]
pub struct BlowTask {
    /// Load vector: the forces on the structure's unknowns under a force of 1.
    pub load: Vec<f64>,
    /// Blows that are fitted.
    pub blows: Vec<MeasuredBlow>,
    /// Blows that are kept out of the fit and predicted.
    pub held_out: Vec<MeasuredBlow>,
    /// Names of the modes at whose frequencies the points are compared.
    pub modes: Vec<String>,
}

/// A blow on the time axis of the computation.
#[derive(Debug, Clone)]
pub(super) struct Timed {
    pub(super) source: String,
    pub(super) step: f64,
    pub(super) every: usize,
    pub(super) samples: usize,
    pub(super) force: Vec<f64>,
    pub(super) kinematic: Kinematic,
    pub(super) gates: Vec<Gate>,
}

/// One mode at one point: complex amplitudes in windows along the record.
#[derive(Debug, Clone)]
pub(super) struct Gate {
    pub(super) point: usize,
    pub(super) name: String,
    /// Index of the mode among the compared ones.
    pub(super) mode: usize,
    pub(super) sums: Sums,
    /// Amplitudes of the record: all real parts, then all imaginary parts.
    pub(super) measured: Vec<f64>,
    /// Root mean square of the change that finer steps make in the computed amplitudes; 0 until it is known.
    pub(super) stepping: f64,
}

impl Gate {
    /// Complex amplitudes of a motion, in the order of `measured`.
    pub(super) fn of(&self, motion: &[f64]) -> Vec<f64> {
        entries(&self.sums, motion)
    }
}

/// Real parts of all windows, then imaginary parts, so that neighbouring entries belong to neighbouring windows.
fn entries(sums: &Sums, samples: &[f64]) -> Vec<f64> {
    let mut pairs = vec![0.0; sums.count(samples.len())];
    sums.apply(samples, &mut pairs);
    (0..2).flat_map(|part| pairs.iter().skip(part).step_by(2).copied().collect::<Vec<_>>()).collect()
}

impl MeasuredBlow {
    fn checked(&self, unknowns: usize) -> Result<(), Error> {
        let refused = |finding: String, remedy| Error::Update { place: self.source.clone(), finding, remedy };
        let n = self.force.len();
        if !(self.dt.is_finite() && self.dt > 0.0) {
            return Err(refused(format!("the sampling interval is {}", self.dt), "give seconds > 0"));
        }
        if n < FEWEST {
            return Err(refused(format!("{n} samples"), "record longer: at least 64 samples"));
        }
        if self.points.is_empty() {
            return Err(refused(
                "no point was measured".into(),
                "give channels called as outputs of the structure",
            ));
        }
        for (output, samples) in &self.points {
            if samples.len() != n {
                let finding = format!("{} has {} samples, the force {n}", output.name, samples.len());
                return Err(refused(finding, "give force and motions on one clock"));
            }
            if output.coefficients.len() != unknowns {
                let finding = format!("{} is no output of this structure", output.name);
                return Err(refused(finding, "make outputs with the structure that is updated"));
            }
        }
        let motions = self.points.iter().map(|(_, samples)| samples).chain([&self.force]);
        if motions.flatten().any(|x| !x.is_finite()) {
            return Err(refused("a sample is not finite".into(), "mend or cut the record"));
        }
        if self.force.iter().all(|f| *f == 0.0) {
            return Err(refused("the force is zero throughout".into(), "name the channel of the hammer"));
        }
        Ok(())
    }

    /// Puts the blow on a time axis that resolves the fastest of these frequencies (Hz). Of a record that is sampled faster only every n-th sample is
    /// a time step, and the computed motion is compared with weighted means of the record over n samples to either side.
    pub(super) fn timed(&self, frequencies: &[f64], unknowns: usize) -> Result<Timed, Error> {
        self.checked(unknowns)?;
        let fastest = frequencies.iter().copied().fold(0.0, f64::max);
        let steps = self.dt * fastest * STEPS_A_PERIOD;
        let (every, stride) =
            if steps > 1.0 { (steps.ceil() as usize, 1) } else { (1, (1.0 / steps) as usize) };
        let dt = self.dt * stride as f64;
        let force: Vec<f64> = self.force.iter().step_by(stride).copied().collect();
        let samples = force.len();
        let force = if every > 1 { between_samples(&force, every) } else { force };
        let mut gates = Vec::new();
        for (point, (output, motion)) in self.points.iter().enumerate() {
            let means = means(motion, stride);
            for (mode, frequency) in frequencies.iter().enumerate() {
                let sums = Sums::of_free(dt, frequencies, mode);
                let lost = lost_by_means(frequency * self.dt, stride);
                let measured = entries(&sums, &means).into_iter().map(|x| x / lost).collect::<Vec<_>>();
                gates.push(Gate { point, name: output.name.clone(), mode, sums, measured, stepping: 0.0 });
            }
        }
        if gates.iter().all(|gate| gate.measured.is_empty()) {
            let finding = format!("{:.3} s are shorter than a window of any mode", dt * samples as f64);
            let remedy = "record longer: eight periods of a mode at least";
            return Err(Error::Update { place: self.source.clone(), finding, remedy });
        }
        Ok(Timed {
            source: self.source.clone(),
            step: dt / every as f64,
            every,
            samples,
            force,
            kinematic: self.kinematic,
            gates,
        })
    }
}

/// Every `stride`-th sample as a mean over its neighbours with falling (triangular) weights, so that the samples between are used, too, and their
/// noise averages out.
fn means(samples: &[f64], stride: usize) -> Vec<f64> {
    let weight = |d: usize| (stride - d) as f64 / (stride * stride) as f64;
    let at = |n: usize| {
        let side = |d: usize| {
            let before = n.checked_sub(d).map_or(0.0, |i| samples[i]);
            before + samples.get(n + d).copied().unwrap_or(0.0)
        };
        weight(0) * samples[n] + (1..stride).map(|d| weight(d) * side(d)).sum::<f64>()
    };
    (0..samples.len()).step_by(stride).map(at).collect()
}

/// Factor by which such means reduce a sinusoid of `periods` periods per sample.
fn lost_by_means(periods: f64, stride: usize) -> f64 {
    let half = std::f64::consts::PI * periods;
    if stride == 1 { 1.0 } else { ((half * stride as f64).sin() / (stride as f64 * half.sin())).powi(2) }
}

/// Indices of the stuck modes with these names, and their frequencies in Hz.
pub(super) fn modes_of(named: &NamedModes, names: &[String]) -> Result<(Vec<usize>, Vec<f64>), Error> {
    let one = |name: &String| {
        let mode = named.named(name).map_err(Error::structure(name))?;
        Ok((mode.pair.stuck, named.stuck.frequency(mode.pair.stuck)))
    };
    Ok(names.iter().map(one).collect::<Result<Vec<_>, Error>>()?.into_iter().unzip())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_leave_of_a_sinusoid_what_is_said() {
        let periods = 0.03;
        let wave: Vec<f64> =
            (0..400).map(|n| (std::f64::consts::TAU * periods * f64::from(n)).cos()).collect();
        for stride in [1, 3, 5] {
            let found = means(&wave, stride);
            for (n, mean) in found.iter().enumerate().skip(2).take(60) {
                let expected = lost_by_means(periods, stride) * wave[n * stride];
                assert!((mean - expected).abs() < 1e-12, "{stride} {n}");
            }
        }
    }
}
