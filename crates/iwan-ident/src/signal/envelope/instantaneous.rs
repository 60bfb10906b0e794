//! Amplitude, frequency and damping ratio against time: one result for all methods.

/// How amplitude and phase are taken from the mode, and how they are smoothed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Method {
    /// Analytic signal; polynomials in time through log amplitude and phase. The paper's choice, and the default.
    #[default]
    Hilbert,
    /// Interpolated peaks and zero crossings; cubic splines through log |peaks| and phase (Eq. 6-8).
    Peaks,
    /// Peak finding and fitting: a sinusoid fitted around each peak, moving least squares (after M. Jin, W. Chen,
    /// M. R. W. Brake, H. Song, J. Vib. Acoust. 142, 051111, 2020, doi:10.1115/1.4047416).
    PeakFitting,
    /// Hann-windowed demodulation at the spectral peak, moving least squares: a cross-check, coarser at the ends.
    Demodulation,
    /// FREEVIB: analytic signal, moving least squares, and Feldman's equations for the natural frequency and the damping coefficient of an
    /// oscillator whose stiffness and damping move (M. Feldman, Mechanical Systems and Signal Processing 8:119, 1994,
    /// doi:10.1006/mssp.1994.1011). It differs from the others where amplitude and frequency change fast.
    FreeVibration,
}

impl Method {
    /// All methods, the default first.
    pub const ALL: [Self; 5] =
        [Self::Hilbert, Self::Peaks, Self::PeakFitting, Self::Demodulation, Self::FreeVibration];
    /// Methods that find amplitude and phase each in a way of its own, so that their results check one another.
    pub const INDEPENDENT: [Self; 4] = [Self::Hilbert, Self::Peaks, Self::PeakFitting, Self::Demodulation];

    /// The method's name in reports and options.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hilbert => "hilbert",
            Self::Peaks => "peaks",
            Self::PeakFitting => "pff",
            Self::Demodulation => "demodulation",
            Self::FreeVibration => "freevib",
        }
    }
}

/// Amplitude, frequency and damping ratio of one mode against time.
///
/// All vectors have one entry per cycle of the trusted window. Standard deviations follow from the scatter about the smooth
/// curve. They are widened where the scatter is larger than elsewhere (near a start that other modes share) and where residuals are correlated (where the curve
/// bends too little). What several methods get wrong in different ways is in [`Spread`](crate::signal::Spread).
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Time from the first sample of the record, s.
    pub t: Vec<f64>,
    /// Amplitude A of the mode, in the unit of the record.
    pub amplitude: Vec<f64>,
    /// Frequency θ'/2π of oscillation, Hz.
    pub frequency: Vec<f64>,
    /// Damping ratio ζ = λ/√(ω² + λ²) with the decay rate λ = -A'/A and ω = θ': exact for a linear mode.
    pub damping_ratio: Vec<f64>,
    /// Standard deviation of ln A.
    pub log_amplitude_sd: Vec<f64>,
    /// Standard deviation of the frequency, Hz.
    pub frequency_sd: Vec<f64>,
    /// Standard deviation of the damping ratio.
    pub damping_ratio_sd: Vec<f64>,
    /// Start and end of the window in which the values can be trusted, s.
    pub trusted: (f64, f64),
    /// The method that found the envelope.
    pub method: Method,
    /// Degree of the polynomial (Hilbert), number of spline intervals (peaks), cycles in a neighbourhood (the others).
    pub order: usize,
    /// Standard deviation of the noise in the band, in the unit of the record.
    pub noise: f64,
    /// What was found and done on the way, in words.
    pub notes: Vec<String>,
}

/// A mode at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Amplitude, in the unit of the record.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
}

impl Envelope {
    /// The mode at a time (s) of the trusted window, by linear interpolation between entries; none outside.
    #[must_use]
    pub fn at(&self, t: f64) -> Option<Instant> {
        let (first, last) = self.trusted;
        if !(first..=last).contains(&t) {
            return None;
        }
        let i = self.t.partition_point(|s| *s <= t).clamp(1, self.t.len() - 1);
        let s = (t - self.t[i - 1]) / (self.t[i] - self.t[i - 1]);
        let between = |v: &[f64]| v[i - 1] + s * (v[i] - v[i - 1]);
        Some(Instant {
            amplitude: between(&self.amplitude),
            frequency: between(&self.frequency),
            damping_ratio: between(&self.damping_ratio),
        })
    }
}
