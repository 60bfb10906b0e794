//! Noisy points, and what a smooth curve through them says.

/// Value and slope of a smooth curve at one time, each with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Smoothed {
    pub(crate) value: f64,
    pub(crate) slope: f64,
    pub(crate) value_sd: f64,
    pub(crate) slope_sd: f64,
}

/// A curve that was fitted to points.
pub(crate) trait Smooth {
    /// The curve at `t`, within the range of the points.
    fn at(&self, t: f64) -> Smoothed;
}

/// Part of the weighted sum of squares of the data below which a sum of squared residuals is rounding: (450 ε)² with ε = 2.2e-16. Fits that reach it
/// count as equally good, so that the fit with the fewest coefficients is taken.
const ROUNDING: f64 = 1e-26;

/// Points (t, y) with weights; `effective` is the number of independent points among them.
///
/// Neighbouring samples after a filter of bandwidth B repeat each other: about B values a second are independent. Criteria and variances use the
/// number of independent points in place of the number of all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Points<'a> {
    pub(crate) t: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) weight: &'a [f64],
    pub(crate) effective: f64,
}

/// A range of times, by its middle and half its length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub(super) middle: f64,
    pub(super) half: f64,
}

impl Points<'_> {
    /// The range of times that the points cover.
    pub(super) fn stretch(&self) -> Stretch {
        let (first, last) = (self.t[0], self.t[self.t.len() - 1]);
        Stretch { middle: 0.5 * (first + last), half: 0.5 * (last - first) }
    }

    /// Schwarz's criterion (BIC) for a fit with `terms` coefficients and the weighted sum of squares `rss`.
    pub(super) fn criterion(&self, rss: f64, terms: usize) -> f64 {
        let total: f64 = self.t.iter().zip(self.weight).zip(self.y).map(|((_, w), y)| w * y * y).sum();
        let n = self.t.len() as f64;
        self.effective * ((rss / n).max(ROUNDING * total / n)).max(f64::MIN_POSITIVE).ln()
            + terms as f64 * self.effective.ln()
    }

    /// Variance of a value of weight 1, times the number of points over the number of independent ones.
    pub(super) fn variance(&self, rss: f64, terms: usize) -> f64 {
        rss / (self.effective - terms as f64).max(1.0)
    }
}
