//! A mode's curves, stored with their points.

use iwan_core::{CurvePoint, Error, ModeCurves};

/// Frequency and damping ratio against amplitude in place of a law.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    table: [Vec<f64>; 3],
    points: ModeCurves<Vec<CurvePoint>>,
    extrapolate: bool,
}

impl Curves {
    /// Curves through two or more points: modal displacement `amplitude` > 0, ascending; `frequency` in Hz; `damping_ratio`. A simulation
    /// that exceeds the largest amplitude is refused.
    ///
    /// ```
    /// use iwan_core::{Motion, Pulse};
    /// use iwan_sim::{Curves, Method, Mode, Settings, simulate};
    /// let curves = Curves::new(vec![1e-4, 1e-2], vec![124.0, 122.0], vec![0.001, 0.005])?;
    /// let mode = Mode { initial: Motion::held_at(5e-3), ..Mode::by_curves("measured", curves) };
    /// let response = simulate(&mode, &Pulse::None, &Settings::new(1e-5, 0.2))?;
    /// assert!((mode.frequency_at(1e-3)? - 123.0).abs() < 1e-9);
    /// // The amplitude has not fallen below the smallest of the curves; there the values of the first point would hold.
    /// assert!(response.quality.outside_curves.below_from.is_none());
    /// // An amplitude above the largest is refused unless extrapolation is allowed.
    /// let beyond = Mode { initial: Motion::held_at(0.02), ..mode };
    /// assert!(simulate(&beyond, &Pulse::None, &Settings::new(1e-5, 0.2)).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`ModeCurves::new`].
    pub fn new(amplitude: Vec<f64>, frequency: Vec<f64>, damping_ratio: Vec<f64>) -> Result<Self, Error> {
        let buffer = vec![CurvePoint::default(); amplitude.len()];
        let points = ModeCurves::new(&amplitude, &frequency, &damping_ratio, buffer)?;
        Ok(Self { table: [amplitude, frequency, damping_ratio], points, extrapolate: false })
    }

    /// The same curves with extrapolation beyond the largest amplitude allowed or not; there the values of the last point hold.
    #[must_use]
    pub fn extrapolating(self, allowed: bool) -> Self {
        Self { extrapolate: allowed, ..self }
    }

    /// Whether amplitudes above the largest are allowed.
    #[must_use]
    pub const fn extrapolates(&self) -> bool {
        self.extrapolate
    }

    /// Amplitudes, frequencies (Hz) and damping ratios, as given.
    #[must_use]
    pub fn table(&self) -> [&[f64]; 3] {
        self.table.each_ref().map(Vec::as_slice)
    }

    /// The curves through the points.
    #[must_use]
    pub const fn points(&self) -> &ModeCurves<Vec<CurvePoint>> {
        &self.points
    }
}
