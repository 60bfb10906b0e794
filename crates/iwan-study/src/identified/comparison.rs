//! A record and the model's ring-down at the same times.

use iwan_core::Pulse;
use iwan_ident::identify::{Identification, ModeRecord};
use iwan_ident::signal::Isolated;
use iwan_sim::{Method, Settings, SimulationError, simulate};

use super::ring_down::{between, released, time_step};

/// The record of a mode that was identified, and the mode in its band.
#[derive(Debug, Clone, Copy)]
pub struct RecordOfMode<'a> {
    /// The record as the identification took it.
    pub source: ModeRecord<'a>,
    /// The mode taken out of it.
    pub isolated: &'a Isolated,
    /// Time of the first sample on the record's own clock, s.
    pub start: f64,
}

/// A record and the model's ring-down at the same times.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Time of the first sample that is compared, on the record's own clock, s.
    pub start: f64,
    /// Sampling interval, s.
    pub dt: f64,
    /// Samples of the record.
    pub record: Vec<f64>,
    /// The model at the same times.
    pub model: Vec<f64>,
    /// Whether the record was compared as it is, or in the band of the mode.
    pub unfiltered: bool,
}

impl Comparison {
    /// Record `n` of an identification.
    pub(super) fn new(
        name: &str,
        record: &RecordOfMode<'_>,
        found: &Identification,
        n: usize,
    ) -> Result<Self, SimulationError> {
        let (first, release) = (found.first_samples[n], found.refined.starts[n]);
        let (displacement, late) = (release.displacement, release.time);
        // Records with other modes in them are compared in the band, behind the filter's transient.
        let (isolated, source) = (record.isolated, &record.source);
        let window = &isolated.window;
        let unfiltered = first < window.start;
        let samples = if unfiltered { source.samples } else { isolated.samples.as_slice() };
        let dt = source.dt;
        let step = time_step(dt, found.parameters.frequency);
        let mode = released(name, &release.of_day(&found.parameters), displacement)?;
        // Two samples more than are compared: the cubic between samples looks ahead.
        let duration = (window.end - first) as f64 * dt - late + 2.0 * dt;
        let settings = Settings { method: Method::HalfCycle, ..Settings::new(step, duration) };
        let response = simulate(&mode, &Pulse::None, &settings)?;
        // The turning point may lie a little behind the first sample.
        let skip = (late / dt).ceil().max(0.0) as usize;
        let compared = first + skip..window.end;
        let at = |i: usize| between(&response, source.quantity, (i - first) as f64 * dt - late);
        Ok(Self {
            start: record.start + compared.start as f64 * dt,
            dt,
            model: compared.clone().map(at).collect(),
            record: samples[compared].to_vec(),
            unfiltered,
        })
    }

    /// Record less model.
    #[must_use]
    pub fn residual(&self) -> Vec<f64> {
        self.record.iter().zip(&self.model).map(|(x, m)| x - m).collect()
    }

    /// Root mean square of the residual over that of the record.
    #[must_use]
    pub fn relative(&self) -> f64 {
        let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
        (square(&self.residual()) / square(&self.record).max(f64::MIN_POSITIVE)).sqrt()
    }
}
