//! One blow of the hammer: force and responses, sampled together.

use super::freedom::Freedom;
use crate::error::{Error, check};
use crate::number::{median, sum};

/// What the sensors measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// Displacement: responses are receptances.
    Displacement,
    /// Velocity: mobilities.
    Velocity,
    /// Acceleration: accelerances.
    Acceleration,
}

impl Motion {
    /// Number of time derivatives of displacement: 0, 1, 2.
    #[must_use]
    pub const fn derivatives(self) -> i32 {
        match self {
            Self::Displacement => 0,
            Self::Velocity => 1,
            Self::Acceleration => 2,
        }
    }
}

/// Samples of one sensor, or of the hammer.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name as the file has it.
    pub name: String,
    /// Where and in which direction.
    pub freedom: Freedom,
    /// In the user's consistent unit.
    pub samples: Vec<f64>,
}

/// One blow: the force and the response of each sensor, over the same times.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    /// Name, such as the file with the number of the hit in it; messages begin with it.
    pub name: String,
    /// Sampling interval in s.
    pub dt: f64,
    /// The hammer's channel.
    pub force: Channel,
    /// The sensors' channels.
    pub responses: Vec<Channel>,
}

/// Least number of samples of a hit: with fewer a spectrum has too few lines for any mode, and the hit is refused.
const FEWEST: usize = 64;

impl Hit {
    /// Number of samples.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.force.samples.len()
    }

    /// Largest magnitude of the force's deviation from its median.
    #[must_use]
    pub fn peak_force(&self) -> f64 {
        let zero = median(&self.force.samples);
        self.force.samples.iter().map(|f| (f - zero).abs()).fold(0.0, f64::max)
    }

    /// Checks interval, lengths and samples.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for the interval; [`Error::Refused`] for a hit without responses, channels of other lengths, too few
    /// samples or a channel that stands still; [`Error::NotFinite`]. Each names hit and channel.
    pub fn check(&self) -> Result<(), Error> {
        self.check_times()?;
        self.channels().try_for_each(|channel| self.check_samples(channel))
    }

    /// Checks interval and lengths.
    pub(crate) fn check_times(&self) -> Result<(), Error> {
        check(
            "dt",
            self.dt,
            self.dt > 0.0,
            "a sampling interval > 0 s",
            "give the sampling interval in seconds",
        )?;
        if self.responses.is_empty() {
            let remedy = "name at least one channel of motion";
            return Err(Error::refused(&self.name, "there is a force and no response", remedy));
        }
        let n = self.samples();
        if n < FEWEST {
            let finding = format!("{n} samples are too few for a spectrum, at least {FEWEST} are needed");
            return Err(Error::refused(&self.name, finding, "record longer"));
        }
        let Some(channel) = self.channels().find(|channel| channel.samples.len() != n) else { return Ok(()) };
        let finding = format!("{} samples, the force has {n}", channel.samples.len());
        Err(Error::refused(self.place(channel), finding, "record all channels together"))
    }

    /// The force, then the responses.
    fn channels(&self) -> impl Iterator<Item = &Channel> {
        std::iter::once(&self.force).chain(&self.responses)
    }

    /// Hit and channel, as messages name them.
    fn place(&self, channel: &Channel) -> String {
        format!("{}, channel {}", self.name, channel.name)
    }

    fn check_samples(&self, channel: &Channel) -> Result<(), Error> {
        let x = &channel.samples;
        // Nearly always all samples are finite, and so is their sum, which takes one fast pass.
        if !sum(x).is_finite()
            && let Some(index) = x.iter().position(|v| !v.is_finite())
        {
            return Err(Error::NotFinite { place: self.place(channel), index, value: x[index] });
        }
        if x.iter().all(|v| *v == x[0]) {
            let finding = format!("all samples are {}", x[0]);
            let remedy = "check the cable, or leave the channel out";
            return Err(Error::refused(self.place(channel), finding, remedy));
        }
        Ok(())
    }
}
