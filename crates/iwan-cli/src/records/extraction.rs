//! One mode of one record, followed by all methods, with its curves.

use iwan_ident::curve_fit::{fit, start};
use iwan_ident::curves::{Curves, ForceAxis};
use iwan_ident::signal::{Envelope, Isolated, Method, Opinions, isolate};

use super::args::Axis;
use super::reading::{Recording, Wanted};
use crate::failure::Failure;

/// A mode extracted from a record.
#[derive(Debug, Clone)]
pub(crate) struct Extraction {
    /// Name of the mode.
    pub(crate) name: String,
    /// Samples of the mode's record, before the band-pass filter.
    pub(crate) samples: Vec<f64>,
    /// Time of the first sample on the record's axis, s.
    pub(crate) start: f64,
    pub(crate) isolated: Isolated,
    pub(crate) opinions: Opinions,
    /// The method from whose envelope `curves` are computed.
    pub(crate) method: Method,
    pub(crate) curves: Curves,
    pub(crate) notes: Vec<String>,
}

impl Extraction {
    /// Isolates the mode in one of its records and follows it by all methods.
    pub(crate) fn new(
        recordings: &[Recording],
        wanted: &Wanted,
        record: usize,
        method: Method,
        axis: Axis,
    ) -> Result<Self, Failure> {
        let modal = &wanted.records[record];
        let recording = &recordings[modal.source];
        let place = format!("{}, {}", recording.name, wanted.name);
        let said = |e: iwan_ident::Error| {
            let failure = Failure::said(&place, &e);
            if recordings.len() == 1 {
                return failure;
            }
            failure.or("leave it out: name the other files, or one hit of a file with --hits N")
        };
        let dt = recording.record.dt();
        let isolated = isolate(&modal.samples, dt, &wanted.options).map_err(said)?;
        let mut opinions = isolated.opinions(None);
        if !Method::INDEPENDENT.contains(&method) {
            opinions.envelopes.push(isolated.envelope(method, None).map_err(said)?);
        }
        if let Some(refused) = opinions.refused.iter().find(|r| r.method == method) {
            return Err(said(refused.error.clone()));
        }
        let mut notes = [wanted.notes.clone(), isolated.notes.clone()].concat();
        let chosen = opinions.envelopes.iter().find(|e| e.method == method);
        let chosen = chosen
            .ok_or_else(|| Failure::computation(format!("{place}: no envelope by {}", method.name())))?;
        let mut curves = Curves::new(chosen, recording.quantity, ForceAxis::Modal).map_err(said)?;
        if axis == Axis::Joint {
            curves = on_joint_axis(curves, &mut notes).map_err(said)?;
        }
        let (name, samples) = (wanted.name.clone(), modal.samples.clone());
        let start = recording.record.start();
        Ok(Self { name, samples, start, isolated, opinions, method, curves, notes })
    }

    /// The envelope by the method that was asked for; none where that method could not be used.
    pub(crate) fn envelope(&self) -> Option<&Envelope> {
        self.opinions.envelopes.iter().find(|e| e.method == self.method)
    }
}

/// Puts the curves on the axis of joint force, which needs ω0 and K_T: both come from a least-squares fit to the curves here.
fn on_joint_axis(curves: Curves, notes: &mut Vec<String>) -> Result<Curves, iwan_ident::Error> {
    let first = start(&curves)?.parameters;
    let found = fit(std::slice::from_ref(&curves), &first, &[])?.parameters;
    notes.push(format!(
        "joint force with the frequency {:.6} Hz at small amplitude and K_T = {:.4e} 1/s^2, by least squares on the curves; \
         before macro-slip K_T is uncertain, and the joint force with it",
        found.frequency, found.k_t
    ));
    curves.on_axis(ForceAxis::Joint { frequency: found.frequency, k_t: found.k_t })
}
