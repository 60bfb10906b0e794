//! A record prepared for the comparison with a model, and the model's curves, made as the record's were.

use std::borrow::Cow;

use super::settings::{ModeRecord, Settings};
use crate::curves::{Curves, ForceAxis, amplitude_drop};
use crate::error::Error;
use crate::parameters::Parameters;
use crate::refine::{RingDown, Sampling, TurningPoint, check_rate};
use crate::signal::{Band, Envelope, HARDLY, Isolated, hits, isolate, taken_as};

/// A record with its mode taken out, its curves, and the samples that are compared with the model.
pub(super) struct Prepared<'a> {
    record: ModeRecord<'a>,
    isolated: Cow<'a, Isolated>,
    pub(super) envelope: Envelope,
    pub(super) curves: Curves,
    /// Samples that are compared with the model.
    stretch: Vec<f64>,
    /// Samples of other modes that were subtracted from the stretch; none where nothing was.
    beside: Option<Vec<f64>>,
    /// Index, in the record, of the first sample that is compared.
    pub(super) first: usize,
    /// Width of the band that these samples were filtered to, Hz; none: the record as it is.
    band: Option<f64>,
}

impl<'a> Prepared<'a> {
    /// The mode is isolated where `isolated` does not hold it already.
    pub(super) fn new(
        record: ModeRecord<'a>,
        isolated: Option<&'a Isolated>,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let isolated = match isolated {
            Some(isolated) if isolated.is_of(record.samples, record.dt) => Cow::Borrowed(isolated),
            Some(_) => {
                return Err(Error::Refused {
                    finding: "the mode was isolated from another record: its samples are more, or at another interval".into(),
                    remedy: "isolate it from the record that is given with it",
                });
            }
            None => Cow::Owned(isolate(record.samples, record.dt, &settings.options)?),
        };
        check_rate(1.0 / (isolated.band.peak * record.dt))?;
        let envelope = isolated.envelope(settings.method, settings.options.order)?;
        let curves = Curves::new(&envelope, record.quantity, ForceAxis::Modal)?;
        let lost = amplitude_drop([&curves]);
        if lost < HARDLY {
            return Err(Error::Refused {
                finding: format!(
                    "the amplitude changes by {:.2} % in all: a tone that is driven, or a record too short to tell its damping",
                    100.0 * lost
                ),
                remedy: "record longer, or what is behind the end of the drive",
            });
        }
        let automatic = settings.options.band.is_none() && settings.options.window.is_none();
        let raw = settings.options.filter_order == 0 || (automatic && isolated.is_alone(record.samples));
        let (stretch, beside, first, band) = if raw {
            let range = isolated.free_decay(record.samples, settings.options.window);
            (record.samples[range.clone()].to_vec(), None, range.start, None)
        } else {
            let range = isolated.window.clone();
            let band = isolated.band.high - isolated.band.low;
            let beside = isolated.beside.as_ref().map(|b| b[range.clone()].to_vec());
            (isolated.samples[range.clone()].to_vec(), beside, range.start, Some(band))
        };
        Ok(Self { record, isolated, envelope, curves, stretch, beside, first, band })
    }

    /// Whether another record holds the same samples.
    pub(super) fn is_same_record(&self, other: &Self) -> bool {
        self.record.samples == other.record.samples && self.record.dt == other.record.dt
    }

    pub(super) fn ring_down(&self) -> RingDown<'_> {
        RingDown {
            samples: &self.stretch,
            dt: self.record.dt,
            quantity: self.record.quantity,
            band: self.band,
            beside: self.beside.as_deref(),
        }
    }

    /// Band and spectral peak of the mode.
    pub(super) fn band(&self) -> Band {
        self.isolated.band
    }

    /// The reason why the mode of this record could not be followed, with a word on what else stands in its band.
    pub(super) fn refused(&self, error: Error) -> Error {
        self.isolated.refused(error)
    }

    /// Whether the record was filtered next to the mode, or windowed, before it was given here.
    pub(super) fn is_treated(&self) -> bool {
        self.isolated.treatment.is_some_and(|seen| seen.spoils(self.isolated.band.peak))
    }

    /// Whether the record is driven again within the samples that are compared, at least a cycle after the first of them.
    pub(super) fn is_driven_again(&self) -> bool {
        let dt = self.record.dt;
        let from = self.first as f64 * dt + 1.0 / self.isolated.band.peak;
        let to = (self.first + self.stretch.len()) as f64 * dt;
        let inside = |time: &f64| (from..to).contains(time);
        let hits = hits(self.record.samples, dt).unwrap_or_default();
        hits.iter().any(|hit| inside(&hit.time) || hit.again.iter().any(inside))
    }

    pub(super) fn notes(&self) -> impl Iterator<Item = String> + '_ {
        let seconds = self.first as f64 * self.record.dt;
        let what = match self.band {
            None => {
                "no other line stands out of the spectrum: the model is compared with the record as it is"
            }
            Some(_) => "the model is compared with the record in the band",
        };
        let own = format!("{what}, from {seconds:.6} s on");
        self.envelope.notes.iter().cloned().chain([own])
    }

    /// Curves of the model's ring-down, made as the record's were. From the first compared sample on, the model's samples take the place of the
    /// record's own, so that filter and smooth curves see the same before that sample, and err alike.
    pub(super) fn model_curves(
        &self,
        parameters: &Parameters,
        start: TurningPoint,
        settings: &Settings,
    ) -> Result<Curves, Error> {
        let mut samples = self.before();
        let (dt, count) = (self.record.dt, self.isolated.samples.len() - self.first);
        let model = start.samples(parameters, Sampling { dt, count }, self.record.quantity)?;
        let off = |(own, model): (&f64, &f64)| own - model;
        let offset = self.stretch.iter().zip(&model).map(off).sum::<f64>() / self.stretch.len() as f64;
        samples.extend(model.iter().map(|x| x + offset));
        let isolated = taken_as(&self.isolated, &samples, &settings.options)?;
        let envelope = isolated.envelope(settings.method, Some(self.envelope.order))?;
        let model = Curves::new(&envelope, self.record.quantity, ForceAxis::Modal)?;
        Ok(model.at(&self.curves.t))
    }

    /// The record before the first sample that is compared; for a record in a band, only the mode, from where it begins.
    fn before(&self) -> Vec<f64> {
        if self.band.is_none() {
            return self.record.samples[..self.first].to_vec();
        }
        let begin = self.isolated.begin.min(self.first);
        let mut samples = vec![0.0; begin];
        samples.extend_from_slice(&self.isolated.samples[begin..self.first]);
        samples
    }
}
