//! What a band-pass filter makes of the ends of a decay, and how it is taken off again.
//!
//! A filter answers to the sudden begin of a decay, and to the end of the record, by transients of its own as long as its memory: they are
//! those of the mode that begins and ends, and that mode is known from the middle of the record. So the mode is continued to both ends,
//! the filter is given what the record holds beside it, from the begin of the decay on and without the blow before it, and the mode is put back.

use std::f64::consts::TAU;
use std::ops::Range;

use super::filter::Butterworth;
use super::raw::Raw;
use crate::error::Error;
use crate::smooth::{Points, Polynomial, Smooth};

/// Lengths of the transient over which an end of the mode is fitted by itself, to be continued by one such length.
const FITTED: f64 = 2.0;
/// Points of the analytic signal that a fit of an end needs: five cycles of four. With fewer the mode is not continued.
const LEAST_POINTS: usize = 20;
/// Degree of the continuation: a straight line would miss how a joint bends ln A and the phase, and a cubic runs off. Not
/// varied.
const DEGREE: usize = 2;
/// Part of the amplitude in the band outside the window that a continuation may leave: one that leaves more than half does not know the mode. A
/// judgement, not varied.
const LEFT: f64 = 0.5;
/// An end of the decay within so many transients of the window is what the window begins or ends for; farther off something else is, and the
/// mode is faded out in place of continued.
const NEAR: f64 = 1.5;

/// A record whose mode begins and ends suddenly.
#[derive(Debug, Clone)]
pub(super) struct Ends<'a> {
    /// The record.
    pub(super) x: &'a [f64],
    pub(super) filter: &'a Butterworth,
    /// From the begin of the mode to the last sample.
    pub(super) decay: Range<usize>,
    /// Length of the filter's transients, in samples.
    pub(super) reach: usize,
}

/// The filter of a band and where the mode's decay begins.
#[derive(Debug, Clone)]
pub(super) struct Gate {
    pub(super) filter: Butterworth,
    /// First sample of the decay.
    pub(super) begin: usize,
    /// Length of the filter's transients, in samples.
    pub(super) reach: usize,
}

/// The record behind the filter, without transients of the mode.
pub(super) struct Filtered {
    /// From the begin of the decay on.
    pub(super) samples: Vec<f64>,
    /// Sum of squares that the filter leaves outside the window once the mode is taken out of the record: of an exactly known mode none.
    pub(super) left: f64,
}

impl Ends<'_> {
    /// The filtered record with the mode's transients taken off, as far as the mode is known; none where that is too little, or where its
    /// continuation does not fit the record.
    pub(super) fn filtered(&self, known: &Known<'_>, order: usize) -> Result<Option<Filtered>, Error> {
        let Some(mode) = known.continued(self.x.len(), &self.decay, self.reach, order) else {
            return Ok(None);
        };
        let begin = self.decay.start;
        let mode = &mode[begin..];
        let rest: Vec<f64> = self.x[begin..].iter().zip(mode).map(|(x, mode)| x - mode).collect();
        let mut samples = self.filter.forward_backward(&rest)?;
        let (first, last) = (known.window.start.saturating_sub(begin), known.window.end - begin);
        let outside = [first.saturating_sub(self.reach)..first, last..rest.len().min(last + self.reach)];
        let sum = |y: &[f64]| outside.iter().flat_map(|part| &y[part.clone()]).map(|y| y * y).sum::<f64>();
        let left = sum(&samples);
        if left > LEFT * LEFT * sum(mode) {
            return Ok(None);
        }
        samples.iter_mut().zip(mode).for_each(|(y, mode)| *y += mode);
        Ok(Some(Filtered { samples, left }))
    }
}

/// A mode that is known in a window of a record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known<'a> {
    /// ln A and the phase without that of the reference frequency, inside the window.
    pub(super) raw: &'a Raw,
    /// Independent values among them.
    pub(super) effective: f64,
    pub(super) window: &'a Range<usize>,
    /// Sampling interval, s.
    pub(super) dt: f64,
    /// The reference frequency, Hz.
    pub(super) centre: f64,
}

/// ln A and phase as curves.
struct Curves([Polynomial; 2]);

impl Curves {
    fn at(&self, t: f64) -> [f64; 2] {
        [self.0[0].at(t).value, self.0[1].at(t).value]
    }
}

impl Known<'_> {
    /// The mode at all samples of the record, of which `decay` is free decay and transients are `reach` samples long: continued to the ends of
    /// the decay where these are near the window, else faded out. None where the window holds too little of it.
    pub(super) fn continued(
        &self,
        samples: usize,
        decay: &Range<usize>,
        reach: usize,
        order: usize,
    ) -> Option<Vec<f64>> {
        let stretch = FITTED * reach as f64 * self.dt;
        let (first, last) = (*self.raw.t.first()?, *self.raw.t.last()?);
        let middle = self.curves(|_| true, None, order)?;
        let begin = self.curves(|t| t <= first + stretch, Some(DEGREE), DEGREE)?;
        let end = self.curves(|t| t >= last - stretch, Some(DEGREE), DEGREE)?;
        // From the begin's own curve over that of the middle to the end's.
        let curve = |t: f64| {
            let mut curve = middle.at(t.clamp(first, last));
            if t < first + stretch {
                curve = mixed(begin.at(t), curve, rise((t - first) / stretch));
            }
            if t > last - stretch {
                curve = mixed(curve, end.at(t), rise((t - last + stretch) / stretch));
            }
            curve
        };
        let near = (NEAR * reach as f64) as usize;
        let Range { start, end: stop } = *self.window;
        let low = (decay.start + near >= start).then_some(decay.start);
        let high = (stop + near >= decay.end).then_some(decay.end);
        let faded = |away: usize| 1.0 - rise(away as f64 / reach as f64);
        let at = |n: usize| {
            let before =
                low.map_or_else(|| faded(start.saturating_sub(n)), |low| f64::from(u8::from(n >= low)));
            let behind = high
                .map_or_else(|| faded((n + 1).saturating_sub(stop)), |high| f64::from(u8::from(n < high)));
            if before * behind == 0.0 {
                return 0.0;
            }
            let t = n as f64 * self.dt;
            let [log, phase] = curve(t);
            before * behind * log.exp() * (phase + TAU * (t * self.centre).fract()).cos()
        };
        let mode: Vec<f64> = (0..samples).map(at).collect();
        mode.iter().all(|x| x.is_finite()).then_some(mode)
    }

    /// Curves through the points at some of the times.
    fn curves(&self, wanted: impl Fn(f64) -> bool, given: Option<usize>, order: usize) -> Option<Curves> {
        let of = |y: &[f64]| {
            let (t, y): (Vec<f64>, Vec<f64>) =
                self.raw.t.iter().zip(y).filter(|(t, _)| wanted(**t)).map(|(t, y)| (*t, *y)).unzip();
            let share = t.len() as f64 / self.raw.t.len() as f64;
            let points =
                Points { t: &t, y: &y, weight: &vec![1.0; t.len()], effective: share * self.effective };
            (t.len() >= LEAST_POINTS).then(|| Polynomial::fit(&points, given, order))
        };
        Some(Curves([of(&self.raw.log_amplitude)?, of(&self.raw.phase)?]))
    }
}

/// From `a` to `b` as `share` goes from 0 to 1.
fn mixed(a: [f64; 2], b: [f64; 2], share: f64) -> [f64; 2] {
    [0, 1].map(|i| a[i] + share * (b[i] - a[i]))
}

/// From 0 to 1 over 0 to 1, with slopes of nothing at both.
fn rise(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}
