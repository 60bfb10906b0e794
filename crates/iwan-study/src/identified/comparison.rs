//! A record and the model's ring-down at the same times.

use iwan_core::Pulse;
use iwan_ident::identify::{Identification, ModeRecord};
use iwan_ident::signal::Isolated;
use iwan_sim::{Method, Settings, SimulationError, simulate};

use super::ring_down::{between, released, time_step};

/// The record of a mode that was identified, and the band-passed mode.
#[derive(Debug, Clone, Copy)]
pub struct RecordOfMode<'a> {
    /// The record as the identification took it.
    pub source: ModeRecord<'a>,
    /// The mode isolated from the record.
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
    /// Samples of the record, in its unit.
    pub record: Vec<f64>,
    /// Samples of the model at the same times.
    pub model: Vec<f64>,
    /// Whether the raw record was compared, rather than the record in the band of the mode.
    pub unfiltered: bool,
}

impl Comparison {
    /// Compares record `n` of an identification with the model.
    pub(super) fn new(
        name: &str,
        record: &RecordOfMode<'_>,
        found: &Identification,
        n: usize,
    ) -> Result<Self, SimulationError> {
        let (first, release) = (found.first_samples[n], found.refined.starts[n]);
        let (displacement, late) = (release.displacement, release.time);
        // A record that contains other modes is compared in the band, after the filter's transient.
        let (isolated, source) = (record.isolated, &record.source);
        let window = &isolated.window;
        let unfiltered = first < window.start;
        let samples = if unfiltered { source.samples } else { isolated.samples.as_slice() };
        let dt = source.dt;
        let step = time_step(dt, found.parameters.frequency);
        let mode = released(name, &release.of_day(&found.parameters), displacement)?;
        // The response is computed for two samples more than are compared, because the cubic between samples needs later ones.
        let duration = (window.end - first) as f64 * dt - late + 2.0 * dt;
        // Nobody asks for the error of this response, which would take a few times as long as the response itself.
        let settings =
            Settings { method: Method::HalfCycle, quality: false, ..Settings::new(step, duration) };
        let response = simulate(&mode, &Pulse::None, &settings)?;
        // The turning point, at which the model is released, may lie a little after the first sample.
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

    /// The record minus the model, sample by sample.
    #[must_use]
    pub fn residual(&self) -> Vec<f64> {
        self.record.iter().zip(&self.model).map(|(x, m)| x - m).collect()
    }

    /// Root mean square of the residual over the root mean square of the record.
    #[must_use]
    pub fn relative(&self) -> f64 {
        let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
        (square(&self.residual()) / square(&self.record).max(f64::MIN_POSITIVE)).sqrt()
    }
}
