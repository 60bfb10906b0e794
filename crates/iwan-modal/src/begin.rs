//! The scale of shapes from the start of the decay.
//!
//! The decay of a mode whose damping falls with amplitude is no exponential: one that is fitted to the whole decay starts too low, and so does the mass-normalised shape, the
//! square of which is the exponential's factor. Right after the blow a mode has the amplitude that the force's impulse gives it, whether it is linear or not; under a fast
//! exponential window little else counts.

use std::borrow::Borrow;

use crate::analysis::ModalFit;
use crate::error::Error;
use crate::fit::{Band, Fitted};
use crate::measure::{Hit, Motion};
use crate::modes::{Scale, modes};
use crate::responses::{Estimator, Windows, early_responses};

/// Decay of the exponential window for the start of a record, in units of one over its length: of a ring-down in 200 cycles the first ten count. Half and twice
/// this value move the scale of the paper's beam by 0.1 %.
const EARLY: f64 = 30.0;
/// The shape of a mode is rescaled where the scale from the start differs by more than this many standard deviations.
const SIGNIFICANT: f64 = 4.0;
/// It must also differ by more than this fraction. Less is not worth the larger noise of the start alone.
const NOT_LINEAR: f64 = 3e-3;

/// Fraction of a record, after the last pulse of its force, that is transformed under the window: what comes later is below e^-7.5 = 6e-4 of its size there, or 3e-7 of its
/// energy. The end of the shorter record is in the model as any other.
const KEPT: f64 = 0.25;
/// Least number of lines of the whole record in the band for the shorter record to be enough; with fewer the whole record is transformed.
const ENOUGH: usize = 128;

impl ModalFit {
    /// The fit with shapes scaled by the start of the decays. `hits` are those of the fit's responses, which were averaged by `estimator` and without an exponential window. A
    /// shape is rescaled only where the scale from the start differs by more than 0.3 % and four standard deviations; such modes have a `stretch`. Frequencies and damping stay
    /// those of the whole decay. Without a drive point, and where the start cannot tell the modes apart, nothing changes; nor does it where too little of a record follows the blow.
    ///
    /// # Errors
    /// As [`frequency_responses`](crate::responses::frequency_responses) for times and channels.
    pub fn scaled_at_begin<H: Borrow<Hit>>(
        mut self,
        hits: &[H],
        motion: Motion,
        estimator: Estimator,
        whole_force: bool,
    ) -> Result<Self, Error> {
        let Some(drive) = self.drive.filter(|_| self.scale == Scale::DrivePoint) else { return Ok(self) };
        let hits: Vec<&Hit> = hits.iter().map(Borrow::borrow).collect();
        let length = hits.iter().map(|h| h.samples() as f64 * h.dt).fold(f64::INFINITY, f64::min);
        let part = if (self.band.1 - self.band.0) * length < ENOUGH as f64 { 1.0 } else { KEPT };
        let windows = Windows { whole_force, decay: EARLY / length };
        let early = &early_responses(&hits, motion, estimator, windows, part * length)?;
        // The highest line of a record of another length may lie a line lower.
        let edges = (self.band.0, self.band.1.min(early.frequency(early.lines().saturating_sub(1))));
        let fitted = Band::new(early, edges).and_then(|band| Fitted::near(&band, &self.fitted.poles));
        let Ok(fitted) = fitted else { return Ok(self) };
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
