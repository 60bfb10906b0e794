//! Points of log amplitude and of phase against time, before smoothing.

/// Values of a quantity at times.
#[derive(Debug, Clone, Default)]
pub(super) struct Trace {
    /// Times, s.
    pub(super) t: Vec<f64>,
    pub(super) y: Vec<f64>,
}

impl Trace {
    pub(super) fn push(&mut self, t: f64, y: f64) {
        self.t.push(t);
        self.y.push(y);
    }
}

impl FromIterator<(f64, f64)> for Trace {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(points: I) -> Self {
        let (t, y) = points.into_iter().unzip();
        Self { t, y }
    }
}

/// Points of amplitude and phase that a method takes from a mode.
#[derive(Debug, Clone, Default)]
pub(super) struct Traces {
    /// Logarithm of the amplitude.
    pub(super) amplitude: Trace,
    /// Phase (rad), less that of the reference frequency.
    pub(super) phase: Trace,
}
