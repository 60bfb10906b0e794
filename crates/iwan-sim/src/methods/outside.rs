//! Times at which a mode given by curves leaves its curves.

use crate::curves::Curves;
use crate::error::SimulationError;
use crate::response::{OutsideCurves, Response};

/// Relative rounding of an amplitude: a release exactly at the largest amplitude of the curves counts as within.
const ROUNDING: f64 = 1e-12;

/// Follows a motion sample by sample and records where its amplitude leaves the curves.
#[derive(Debug)]
pub(crate) struct Follower<'a> {
    curves: &'a Curves,
    dt: f64,
    samples: usize,
    last_within: Option<usize>,
    outside: OutsideCurves,
}

impl<'a> Follower<'a> {
    pub(crate) fn new(curves: &'a Curves, dt: f64) -> Self {
        Self { curves, dt, samples: 0, last_within: None, outside: OutsideCurves::default() }
    }

    /// Takes the next samples of the motion.
    pub(crate) fn follow(&mut self, displacement: &[f64], velocity: &[f64]) {
        let (smallest, largest) = self.curves.points().range();
        for (n, (q, v)) in (self.samples..).zip(displacement.iter().zip(velocity)) {
            let amplitude = self.curves.points().amplitude(*q, *v);
            if amplitude >= smallest {
                self.last_within = Some(n);
            }
            if amplitude > largest * (1.0 + ROUNDING) {
                self.outside.above_from.get_or_insert(n as f64 * self.dt);
                self.outside.largest_amplitude = self.outside.largest_amplitude.max(amplitude);
            }
        }
        self.samples += displacement.len();
    }

    /// Where the motion left the curves; an error if it exceeded the largest amplitude and extrapolation is not allowed.
    pub(crate) fn found(&self) -> Result<OutsideCurves, SimulationError> {
        let (amplitude, largest) = (self.outside.largest_amplitude, self.curves.points().range().1);
        if let Some(time) = self.outside.above_from.filter(|_| !self.curves.extrapolates()) {
            return Err(SimulationError::BeyondCurves { amplitude, largest, time });
        }
        let below = self.last_within.map_or(0, |n| n + 1);
        let below_from = (below < self.samples).then_some(below as f64 * self.dt);
        Ok(OutsideCurves { below_from, ..self.outside })
    }
}

/// Records in a response where it left the mode's curves, and refuses one that exceeded them without leave to extrapolate.
pub(crate) fn within(curves: &Curves, mut response: Response) -> Result<Response, SimulationError> {
    let mut follower = Follower::new(curves, response.dt);
    follower.follow(&response.displacement, &response.velocity);
    response.quality.outside_curves = follower.found()?;
    Ok(response)
}
