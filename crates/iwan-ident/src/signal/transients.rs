//! Transients that a band-pass filter makes of the ends of a decay, and how they are subtracted.
//!
//! A filter answers to the sudden start of a decay, and to the end of the record, by transients as long as its memory. They are
//! those of the mode that starts and ends, and that mode is known from the middle of the record. So the mode is continued to both ends and subtracted from the record;
//! what remains, from the start of the decay on and without the blow before it, goes through the filter; then the mode is added again.

use std::f64::consts::TAU;
use std::ops::Range;

use super::filter::Butterworth;
use super::raw::Raw;
use crate::error::Error;
use crate::smooth::{Points, Polynomial};

/// Length over which an end of the mode is fitted by itself, to be continued beyond the window, in lengths of the transient; it is continued by one such length.
const FITTED: f64 = 2.0;
/// Least number of points of the analytic signal for the fit of an end: five cycles of four points. With fewer the mode is not continued.
const LEAST_POINTS: usize = 20;
/// Degree of the polynomials that continue ln A and the phase: a straight line would miss how a joint bends both, and a cubic runs off. Not
/// varied.
const DEGREE: usize = 2;
/// Largest remainder of a continuation outside the window, over the continued mode's amplitude there. Where more than half remains, the continuation does not know the mode, and
/// is not used. A judgement, not varied.
const LEFT: f64 = 0.5;
/// An end of the decay within this many transients of the window is the reason why the window ends there, and the mode is continued to it. Where the end is farther off,
/// something else lies between, and the mode is faded out instead.
const NEAR: f64 = 1.5;

/// A record whose mode begins and ends suddenly.
#[derive(Debug, Clone)]
pub(super) struct Ends<'a> {
    /// The record.
    pub(super) x: &'a [f64],
    pub(super) filter: &'a Butterworth,
    /// Samples from the start of the mode to the last one.
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
    /// Samples from the start of the decay on.
    pub(super) samples: Vec<f64>,
    /// Sum of squares that the filter leaves outside the window once the mode is subtracted from the record; 0 where the mode is known exactly.
    pub(super) left: f64,
}

impl Ends<'_> {
    /// The filtered record with the mode's transients subtracted, as far as the mode is known. None where too little of it is known, or where its
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
    /// ln A and the phase (less that of the reference frequency) inside the window.
    pub(super) raw: &'a Raw,
    /// Number of independent values among them.
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
        [self.0[0].value(t), self.0[1].value(t)]
    }
}

impl Known<'_> {
    /// The mode at all `samples` of the record: continued to the ends of its free `decay` where these are near the window, else faded out over `reach` samples, the length
    /// of a transient. None where the window holds too little of it.
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
        // From the curve fitted at the start over that of the middle to that of the end.
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

    /// Curves through the points at the `wanted` times; the degree is `given`, or chosen up to `order`.
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

/// Rises from 0 to 1 as s goes from 0 to 1, with zero slope at both ends.
fn rise(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}
