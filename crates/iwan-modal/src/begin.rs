//! The scale of shapes from the start of the decay.
//!
//! The decay of a mode whose damping falls with amplitude is no exponential: one that is fitted to the whole decay starts too low, and so does the mass-normalised shape, the
//! square of which is the exponential's factor. Right after the blow a mode has the amplitude that the force's impulse gives it, whether it is linear or not; under a fast
//! exponential window little else counts.

use crate::analysis::ModalFit;
use crate::error::Error;
use crate::fit::{Band, Fitted};
use crate::modes::{Scale, modes};
use crate::responses::FrequencyResponses;

/// Decay of the exponential window for the start of a record, in units of one over its length: of a ring-down in 200 cycles the first ten count. Half and twice
/// this value move the scale of the paper's beam by 0.1 %.
const EARLY: f64 = 30.0;
/// The shape of a mode is rescaled where the scale from the start differs by more than this many standard deviations.
const SIGNIFICANT: f64 = 4.0;
/// It must also differ by more than this fraction. Less is not worth the larger noise of the start alone.
const NOT_LINEAR: f64 = 3e-3;

/// Decay (1/s) of the exponential window under which mainly the start of the records of `responses` counts.
///
/// ```
/// use iwan_modal::measure::{Channel, Freedom, Motion};
/// let tip = Channel { name: "tip".into(), freedom: Freedom::point("tip"), samples: (0..100).map(f64::from).collect() };
/// // Of a second.
/// let responses = iwan_modal::responses::free_responses(&[vec![tip]], 0.01, Motion::Acceleration)?;
/// assert_eq!(iwan_modal::early_decay(&responses), 30.0);
/// # Ok::<(), iwan_modal::Error>(())
/// ```
#[must_use]
pub fn early_decay(responses: &FrequencyResponses) -> f64 {
    EARLY * responses.step
}

impl ModalFit {
    /// The fit with shapes scaled by `early`, the responses of the same hits under an exponential window of [`early_decay`]. A shape is rescaled only where that scale differs
    /// by more than 0.3 % and four standard deviations; such modes have a `stretch`. Frequencies and damping stay those of the whole decay. Without a drive point, and where
    /// the windowed responses cannot tell the modes apart, nothing changes.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] where `early` does not reach over the band of the fit.
    pub fn scaled_at_begin(mut self, early: &FrequencyResponses) -> Result<Self, Error> {
        let Some(drive) = self.drive.filter(|_| self.scale == Scale::DrivePoint) else { return Ok(self) };
        let band = Band::new(early, self.band)?;
        let Ok(fitted) = Fitted::without_curves(&band, &self.fitted.poles) else { return Ok(self) };
        let found = modes(early, &fitted, &|_| true).modes;
        for mode in &mut self.modes {
            let distance = |other: &&crate::modes::Mode| (other.pole - mode.pole).norm();
            let near = found.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let Some(other) = near.filter(|other| distance(other) < (mode.pole.re + other.pole.re).abs())
            else {
                continue;
            };
            let [own, begin] =
                [&*mode, other].map(|m| (m.real_shape[drive.freedom].abs(), m.shape_sd[drive.freedom]));
            let (difference, sd) = ((begin.0 - own.0).abs(), own.1.hypot(begin.1));
            if !(difference > SIGNIFICANT * sd && difference > NOT_LINEAR * own.0) {
                continue;
            }
            let stretch = begin.0 / own.0;
            let uncertain = begin.1 / begin.0;
            for x in &mut mode.shape {
                *x *= stretch;
            }
            for (x, sd) in mode.real_shape.iter_mut().zip(&mut mode.shape_sd) {
                *x *= stretch;
                *sd = (*sd * stretch).hypot(uncertain * *x);
            }
            mode.stretch = Some(stretch);
        }
        Ok(self)
    }
}
