//! Modes identified from recordings, together with the extractions that the reports show.

use std::ops::Deref;
use std::sync::Arc;

use iwan_ident::curves::ForceAxis;
use iwan_ident::identify::{Held, Identification, ModeRecord, Settings, identify_isolated};
use iwan_ident::signal::Method;
use iwan_ident::{Parameter, Parameters};
use iwan_machine::checkpoint::Checkpoint;
use iwan_machine::threads::in_parallel;
use iwan_study::identified::{IdentifiedMode, RecordOfMode};

use crate::failure::Failure;
use crate::records::{Axis, Extraction, ModalRecord, Recording, Wanted};

/// A mode with all results of its identification.
#[derive(Debug, Clone)]
pub(crate) struct Identified {
    /// The mode's extraction from each record, by all methods.
    pub(crate) extractions: Vec<Extraction>,
    identified: IdentifiedMode,
}

impl Deref for Identified {
    type Target = IdentifiedMode;

    fn deref(&self) -> &IdentifiedMode {
        &self.identified
    }
}

/// Extracts the mode from each of its records. What cannot be used is refused here, before the long computation begins.
pub(crate) fn extract(
    recordings: &[Recording],
    wanted: &Wanted,
    method: Method,
    threads: usize,
) -> Result<Vec<Extraction>, Failure> {
    let all: Vec<usize> = (0..wanted.records.len()).collect();
    let one = |record: &usize| Extraction::new(recordings, wanted, *record, method, Axis::Modal);
    in_parallel(&all, threads, &one).into_iter().collect()
}

impl Identified {
    /// Identifies one mode; the work is kept in a checkpoint where one is given.
    pub(crate) fn new(
        recordings: &[Recording],
        wanted: &Wanted,
        extractions: Vec<Extraction>,
        axis: Axis,
        held: &[(Parameter, f64)],
        kept: Option<&Arc<Checkpoint>>,
    ) -> Result<Self, Failure> {
        let place = format!("{}, {}", recordings[0].name, wanted.name);
        let sources = sources(recordings, wanted).into_iter();
        let records: Vec<_> = sources.zip(extractions.iter().map(|x| &x.isolated)).collect();
        let method = extractions.first().map(|x| x.method).unwrap_or_default();
        let held = held.iter().map(|&(parameter, value)| Held { parameter, value }).collect();
        let settings = Settings { options: wanted.options, method, held };
        let found = identify_isolated(&records, &settings, kept).map_err(|e| Failure::said(&place, &e))?;
        Self::of(recordings, wanted, extractions, axis, found)
    }

    /// Takes over a mode that is identified already.
    pub(crate) fn of(
        recordings: &[Recording],
        wanted: &Wanted,
        extractions: Vec<Extraction>,
        axis: Axis,
        found: Identification,
    ) -> Result<Self, Failure> {
        let place = format!("{}, {}", recordings[0].name, wanted.name);
        let sources = sources(recordings, wanted).into_iter().zip(&extractions);
        let records: Vec<RecordOfMode<'_>> = sources
            .map(|(source, x)| RecordOfMode { source, isolated: &x.isolated, start: x.start })
            .collect();
        let axis = force_axis(axis, &found.parameters);
        let identified = IdentifiedMode::new(&wanted.name, &records, axis, found).map_err(|e| match e {
            iwan_study::Error::Identification { source, .. } => Failure::said(&place, &source),
            iwan_study::Error::Simulation { source, .. } => {
                Failure::computation(format!("{place}: {source}"))
            }
            other => Failure::computation(other.to_string()),
        })?;
        Ok(Self { extractions, identified })
    }
}

/// The mode's records in the form that the identification takes.
fn sources<'a>(recordings: &[Recording], wanted: &'a Wanted) -> Vec<ModeRecord<'a>> {
    let source = |r: &'a ModalRecord| {
        let recording = &recordings[r.source];
        ModeRecord { samples: &r.samples, dt: recording.record.dt(), quantity: recording.quantity }
    };
    wanted.records.iter().map(source).collect()
}

/// The axis of force for the library; the joint force needs frequency and K_T.
fn force_axis(axis: Axis, p: &Parameters) -> ForceAxis {
    match axis {
        Axis::Modal => ForceAxis::Modal,
        Axis::Joint => ForceAxis::Joint { frequency: p.frequency, k_t: p.k_t },
    }
}
