//! The results of the laboratory as numbers, as `reproduce.json` holds them.

use serde::Serialize;

use super::bench::{MEASURED, NOISE, RATE, SECONDS, SENSORS, SUSPENSION};
use super::evaluation::Laboratory;
use super::hit::Hit;
use super::table_4::Table4Row;
use crate::beam::letter;
use crate::printed::BAND;
use crate::span::Span;

/// The settings of the measurements, and the results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LaboratorySummary {
    /// The beam's configuration.
    pub configuration: &'static str,
    /// Number of sensors.
    pub sensors: usize,
    /// Sampling rate, Hz.
    pub sampling_rate: f64,
    /// Length of a record, s.
    pub seconds: f64,
    /// Root mean square of a sensor's noise, m/s².
    pub noise: f64,
    /// Band of mode 1, Hz.
    pub band: Span,
    /// Rank of the modal filter of bending modes 1 to 3 at the sensors.
    pub filter_rank: usize,
    /// Condition number of that filter.
    pub filter_condition: f64,
    /// One entry for each hit.
    pub hits: Vec<HitSummary>,
    /// Viscous damping ratio that the suspension was given.
    pub damping_ratio_given: f64,
    /// The same damping ratio as found by comparing hits at equal times.
    pub damping_ratio_found: f64,
    /// Exponent of the joints' dissipation over force, by the same comparison.
    pub slope_found: f64,
    /// Deviation of the joints' dissipation from that power law: root mean square of ln D.
    pub slope_misfit: f64,
    /// ζ_v of the fit of one joint with a damper in parallel to all curves.
    pub damping_ratio_fitted: f64,
    /// Frequency ω0/2π of that fit, Hz.
    pub frequency_fitted: f64,
    /// χ of that fit.
    pub chi_fitted: f64,
    /// How well that fit follows the curves, in words.
    pub misfit: String,
    /// Range, largest minus smallest, of the slopes from hit to hit at equal times.
    pub drift: f64,
    /// The same range without the viscous term.
    pub drift_without_viscous: f64,
}

/// One hit in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HitSummary {
    /// Peak force of the hammer, N.
    pub force: f64,
    /// Largest acceleration of any sensor, m/s².
    pub peak_acceleration: f64,
    /// Largest misfit of a sensor to the average, relative.
    pub largest_misfit: f64,
    /// Number of sensors with a misfit above a quarter.
    pub outliers: usize,
    /// Part of the record in which the envelope can be trusted, s.
    pub trusted: Span,
    /// Frequency at the beginning and the end of that part, Hz.
    pub frequency: Span,
    /// Damping ratio at the beginning and the end of that part.
    pub damping_ratio: Span,
    /// Modal force at the beginning and the end of that part, √kg·m/s².
    pub modal_force: Span,
}

impl HitSummary {
    fn new(hit: &Hit) -> Self {
        Self {
            force: hit.force,
            peak_acceleration: hit.peak,
            largest_misfit: hit.average.misfit.iter().copied().fold(0.0, f64::max),
            outliers: hit.average.outliers.len(),
            trusted: hit.envelope.trusted.into(),
            frequency: Span::ends(&hit.curves.frequency),
            damping_ratio: Span::ends(&hit.curves.damping_ratio),
            modal_force: Span::ends(&hit.curves.force),
        }
    }
}

impl Laboratory {
    /// The summary of the laboratory's results.
    #[must_use]
    pub fn summary(&self) -> LaboratorySummary {
        let drift = |slope: fn(&Table4Row) -> Option<f64>| {
            let slopes = self.table_4.iter().filter_map(slope);
            slopes.clone().fold(f64::NEG_INFINITY, f64::max) - slopes.fold(f64::INFINITY, f64::min)
        };
        let p = &self.fit.parameters;
        LaboratorySummary {
            configuration: letter(MEASURED),
            sensors: SENSORS,
            sampling_rate: RATE,
            seconds: SECONDS,
            noise: NOISE,
            band: BAND,
            filter_rank: self.filter.rank(),
            filter_condition: self.filter.condition(),
            hits: self.hits.iter().map(HitSummary::new).collect(),
            damping_ratio_given: SUSPENSION,
            damping_ratio_found: self.levels.damping_ratio,
            slope_found: self.levels.slope,
            slope_misfit: self.levels.misfit,
            damping_ratio_fitted: p.damping_ratio,
            frequency_fitted: p.frequency,
            chi_fitted: p.chi,
            misfit: self.fit.verdict.misfit.clone(),
            drift: drift(|row| row.step),
            drift_without_viscous: drift(|row| row.step_without_viscous),
        }
    }
}
