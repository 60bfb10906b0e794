//! A mode identified from one or several records, and its ring-downs beside the records.

use iwan_core::Pulse;
use iwan_ident::curves::{Curves, ForceAxis, Quantity};
use iwan_ident::density::{Evidence, FreeForm, density};
use iwan_ident::identify::{Held, Identification, ModeRecord, Settings, identify};
use iwan_ident::signal::Method;
use iwan_ident::{Parameter, Parameters};
use iwan_sim::{JointLaw, Mode, Response};

use crate::args::Axis;
use crate::extraction::Extraction;
use crate::failure::Failure;
use crate::records::{ModalRecord, Recording, Wanted};

/// Samples in a cycle of the ring-downs that are drawn beside records: straight lines between them do not show.
const PER_CYCLE: f64 = 100.0;

/// A mode with everything that was found about it.
#[derive(Debug, Clone)]
pub(crate) struct Identified {
    pub(crate) name: String,
    /// Each record by all methods.
    pub(crate) extractions: Vec<Extraction>,
    pub(crate) found: Identification,
    /// Curves of each record on the axis asked for.
    pub(crate) curves: Vec<Curves>,
    /// Densities of any form: for both curves, and for dissipation alone.
    pub(crate) densities: Vec<FreeForm>,
    /// Record and model, one for each record.
    pub(crate) comparisons: Vec<Comparison>,
}

/// A record and the model's ring-down at the same times.
#[derive(Debug, Clone)]
pub(crate) struct Comparison {
    /// Time of the first sample on the record's axis, s, and the sampling interval.
    pub(crate) start: f64,
    pub(crate) dt: f64,
    pub(crate) record: Vec<f64>,
    pub(crate) model: Vec<f64>,
    /// Whether the record was compared as it is, or in the band of the mode.
    pub(crate) unfiltered: bool,
}

/// The mode in each of its records: what cannot be used is refused here, before anything takes long.
pub(crate) fn extract(
    recordings: &[Recording],
    wanted: &Wanted,
    method: Method,
) -> Result<Vec<Extraction>, Failure> {
    let one = |record| Extraction::new(recordings, wanted, record, method, Axis::Modal);
    (0..wanted.records.len()).map(one).collect()
}

impl Identified {
    /// Identifies one mode.
    pub(crate) fn new(
        recordings: &[Recording],
        wanted: &Wanted,
        extractions: Vec<Extraction>,
        axis: Axis,
        held: &[(Parameter, f64)],
    ) -> Result<Self, Failure> {
        let place = format!("{}, {}", recordings[0].name, wanted.name);
        let said = |e: iwan_ident::Error| Failure::said(&place, &e);
        let sources = sources(recordings, wanted);
        let method = extractions.first().map(|x| x.method).unwrap_or_default();
        let held = held.iter().map(|&(parameter, value)| Held { parameter, value }).collect();
        let settings = Settings { options: wanted.options, method, held };
        let found = identify(&sources, &settings).map_err(said)?;
        Self::of(recordings, wanted, extractions, axis, found)
    }

    /// One mode that is identified already.
    pub(crate) fn of(
        recordings: &[Recording],
        wanted: &Wanted,
        extractions: Vec<Extraction>,
        axis: Axis,
        found: Identification,
    ) -> Result<Self, Failure> {
        let place = format!("{}, {}", recordings[0].name, wanted.name);
        let said = |e: iwan_ident::Error| Failure::said(&place, &e);
        let sources = sources(recordings, wanted);
        let on_axis = |c: &Curves| c.clone().on_axis(force_axis(axis, &found.parameters));
        let curves = found.curves.iter().map(on_axis).collect::<Result<Vec<_>, _>>().map_err(said)?;
        // A record that no density explains is told so by its misfit; one that gives no density at all has none.
        let densities = [Evidence::Both, Evidence::Dissipation]
            .into_iter()
            .filter_map(|e| density(&found.curves, e).ok());
        let densities = densities.collect();
        let comparisons = (0..sources.len())
            .map(|n| Comparison::new(&extractions[n], &sources[n], &found, n))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|e| Failure::Computation(format!("{place}: {e}")))?;
        Ok(Self { name: wanted.name.clone(), extractions, found, curves, densities, comparisons })
    }

    /// Index of the record in which the mode is loudest.
    pub(crate) fn loudest(&self) -> usize {
        let starts = &self.found.refined.starts;
        (0..starts.len())
            .max_by(|&i, &j| starts[i].displacement.abs().total_cmp(&starts[j].displacement.abs()))
            .unwrap_or(0)
    }

    /// The mode as it rings down from where a record begins.
    pub(crate) fn mode(&self, record: usize) -> Result<Mode, iwan_core::Error> {
        mode(&self.name, &self.found.parameters, self.found.refined.starts[record].displacement)
    }
}

/// The mode's records as the identification takes them.
fn sources<'a>(recordings: &[Recording], wanted: &'a Wanted) -> Vec<ModeRecord<'a>> {
    let source = |r: &'a ModalRecord| {
        let recording = &recordings[r.source];
        ModeRecord { samples: &r.samples, dt: recording.record.dt(), quantity: recording.quantity }
    };
    wanted.records.iter().map(source).collect()
}

/// The axis with what it needs.
fn force_axis(axis: Axis, p: &Parameters) -> ForceAxis {
    match axis {
        Axis::Modal => ForceAxis::Modal,
        Axis::Joint => ForceAxis::Joint { frequency: p.frequency, k_t: p.k_t },
    }
}

/// A mode of these parameters, released from rest at a displacement.
fn mode(name: &str, p: &Parameters, displacement: f64) -> Result<Mode, iwan_core::Error> {
    let joint = iwan_core::FourParameter::new(p.k_t, p.f_s, p.chi, p.beta)?;
    Ok(Mode {
        damping_ratio: p.damping_ratio,
        initial: (displacement, 0.0),
        ..Mode::new(name, p.frequency, Some(JointLaw::FourParameter(joint)))
    })
}

/// The time step of ring-downs beside a record: a whole part of its sampling interval.
pub(crate) fn step(dt: f64, frequency: f64) -> f64 {
    dt / (PER_CYCLE * frequency * dt).ceil().max(1.0)
}

impl Comparison {
    fn new(
        x: &Extraction,
        source: &ModeRecord<'_>,
        found: &Identification,
        n: usize,
    ) -> Result<Self, iwan_sim::SimulationError> {
        let (first, start) = (found.first_samples[n], found.refined.starts[n]);
        let (displacement, late) = (start.displacement, start.time);
        // Records with other modes in them are compared in the band, behind the filter's transient.
        let window = &x.isolated.window;
        let unfiltered = first < window.start;
        let samples = if unfiltered { source.samples } else { x.isolated.samples.as_slice() };
        let dt = source.dt;
        let step = step(dt, found.parameters.frequency);
        let mode = mode(&x.name, &found.parameters, displacement)?;
        let settings = iwan_sim::Settings {
            method: iwan_sim::Method::HalfCycle,
            ..iwan_sim::Settings::new(step, (window.end - first) as f64 * dt - late + 2.0 * dt)
        };
        let response = iwan_sim::simulate(&mode, &Pulse::None, &settings)?;
        // The turning point may lie a little behind the first sample.
        let skip = (late / dt).ceil().max(0.0) as usize;
        let compared = first + skip..window.end;
        let model = compared.clone().map(|i| at(&response, source.quantity, (i - first) as f64 * dt - late));
        Ok(Self {
            start: x.start + compared.start as f64 * dt,
            dt,
            model: model.collect(),
            record: samples[compared].to_vec(),
            unfiltered,
        })
    }

    /// Record less model.
    pub(crate) fn residual(&self) -> Vec<f64> {
        self.record.iter().zip(&self.model).map(|(x, m)| x - m).collect()
    }

    /// Root mean square of the residual over that of the record.
    pub(crate) fn relative(&self) -> f64 {
        let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
        (square(&self.residual()) / square(&self.record).max(f64::MIN_POSITIVE)).sqrt()
    }
}

/// A response at a time between its samples, by a cubic through four of them.
fn at(response: &Response, quantity: Quantity, t: f64) -> f64 {
    let y = match quantity {
        Quantity::Displacement => &response.displacement,
        Quantity::Velocity => &response.velocity,
        Quantity::Acceleration => &response.acceleration,
    };
    let place = t / response.dt;
    let i = (place as usize).clamp(1, y.len().saturating_sub(3).max(1));
    let s = place - i as f64;
    let [a, b, c, d] = [i - 1, i, i + 1, i + 2].map(|k| y.get(k).copied().unwrap_or_default());
    // Lagrange's polynomial at -1, 0, 1, 2.
    a * s * (s - 1.0) * (2.0 - s) / 6.0
        + b * (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0
        + c * s * (s + 1.0) * (2.0 - s) / 2.0
        + d * s * (s + 1.0) * (s - 1.0) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_samples_lies_the_cubic_through_them() {
        let cubic = |t: f64| 1.0 + t - 0.5 * t * t + 0.25 * t * t * t;
        let displacement: Vec<f64> = (0..10).map(|n| cubic(0.5 * f64::from(n))).collect();
        let response = Response { dt: 0.5, displacement, ..Response::default() };
        for t in [0.0, 0.2, 0.75, 2.0, 4.4] {
            assert!((at(&response, Quantity::Displacement, t) - cubic(t)).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn steps_divide_the_sampling_interval() {
        let step = step(1e-3, 80.0);
        assert!((1e-3 / step - (1e-3_f64 / step).round()).abs() < 1e-9 && step * 80.0 <= 0.01 + 1e-12);
    }
}
