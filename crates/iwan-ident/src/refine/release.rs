//! Where a ring-down begins, and its samples from there.

use iwan_core::{Decay, Motion, Reversal, Samples};
use serde::{Deserialize, Serialize};

use crate::curves::Quantity;
use crate::error::Error;
use crate::parameters::Parameters;

/// The unknowns of one record: the turning point from which the model's ring-down starts at rest, and the frequency on the record's day.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TurningPoint {
    /// Displacement q at the turning point, mass-normalised.
    pub displacement: f64,
    /// Time of the turning point from the first sample, s: negative when it lies before that sample.
    pub time: f64,
    /// ln of the frequency at small amplitude on the day of the record over that of the mode: temperature and mounting differ from hit to hit. Zero
    /// for one record alone.
    pub day: f64,
}

/// The times at which a ring-down is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sampling {
    /// Sampling interval, s.
    pub(crate) dt: f64,
    /// How many samples, the first at time 0.
    pub(crate) count: usize,
}

impl TurningPoint {
    /// The parameters of the mode on the day of the record.
    #[must_use]
    pub fn of_day(&self, parameters: &Parameters) -> Parameters {
        Parameters { frequency: parameters.frequency * self.day.exp(), ..*parameters }
    }

    /// The same turning point on the mean of all days.
    pub(super) fn on_mean_day(self) -> Self {
        Self { day: 0.0, ..self }
    }

    /// Samples of the model's ring-down from this turning point, at the times of the sampling. Before the release the motion is mirrored in time,
    /// because the release is a turning point.
    ///
    /// # Errors
    /// [`Error::Model`] when the parameters are no model.
    pub(crate) fn samples(
        &self,
        parameters: &Parameters,
        Sampling { dt, count }: Sampling,
        quantity: Quantity,
    ) -> Result<Vec<f64>, Error> {
        let before = ((self.time / dt).ceil().max(0.0) as usize).min(count);
        let from = |first: f64, count: usize| self.from(parameters, first, Sampling { dt, count }, quantity);
        let mut samples = from(before as f64 * dt - self.time, count - before)?;
        if before > 0 {
            let sign = if quantity == Quantity::Velocity { -1.0 } else { 1.0 };
            let mirrored = from(self.time - (before - 1) as f64 * dt, before)?;
            samples.splice(0..0, mirrored.iter().rev().map(|x| sign * x));
        }
        Ok(samples)
    }

    /// Samples from `first` seconds after the release on.
    fn from(
        &self,
        parameters: &Parameters,
        first: f64,
        Sampling { dt, count }: Sampling,
        quantity: Quantity,
    ) -> Result<Vec<f64>, Error> {
        let own = self.of_day(parameters);
        let (oscillator, joint) = own.model()?;
        let seconds = first + count as f64 * dt;
        let stack = vec![Reversal::default(); (2.5 * seconds * own.frequency) as usize + 16];
        let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; count]);
        let [displacement, velocity, acceleration, joint_force] = &mut out;
        let mut samples = Samples { displacement, velocity, acceleration, joint_force };
        Decay::new(&oscillator, &joint, 0.0, Motion::held_at(self.displacement), stack)?.sample_from(
            first.max(0.0),
            dt,
            &mut samples,
        )?;
        let [displacement, velocity, acceleration, _] = out;
        Ok(match quantity {
            Quantity::Displacement => displacement,
            Quantity::Velocity => velocity,
            Quantity::Acceleration => acceleration,
        })
    }
}
