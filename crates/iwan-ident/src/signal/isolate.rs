//! One mode out of a record that may hold others.

use super::beside::others;
use super::in_band::{InBand, Options, behind_filter, in_band};
use super::isolated::Isolated;
use crate::error::Error;

/// Takes one mode out of a uniformly sampled record `x` (any unit, every `dt` seconds).
///
/// What the band of the mode holds is taken out of the record; modes beside the band that reach into it are taken off before, and the band is
/// looked at once more. Each step that finds something leaves a note, and so do lines that stand in the band and are not of the mode.
///
/// # Errors
/// [`Error::Refused`] for a record with two modes in the band, without decay, or clipped to its end;
/// [`Error::TooShort`], [`Error::NotFinite`], [`Error::OutOfRange`].
pub fn isolate(x: &[f64], dt: f64, options: &Options) -> Result<Isolated, Error> {
    let InBand { mut mode, gate } = in_band(x, dt, options)?;
    let x = &x[..mode.samples.len()];
    let beside = gate.filter(|_| !mode.is_alone(x)).and_then(|gate| others(x, &mode, &gate, options));
    if let Some(beside) = beside {
        let rest: Vec<f64> = x.iter().zip(&beside.samples).map(|(x, other)| x - other).collect();
        let again = behind_filter(&rest, dt, mode.band, options, Some(mode.notes.clone()));
        if let Ok(InBand { mode: mut found, .. }) = again {
            found.beside =
                Some(mode.samples.iter().zip(&found.samples).map(|(with, own)| with - own).collect());
            mode = found;
            mode.notes.push(beside.in_words());
        }
    }
    mode.refuse_second_line()?;
    // A record too short for its spectrum has been refused by now.
    let strangers = mode.intruders(x).unwrap_or_default();
    mode.notes.extend(strangers.iter().map(ToString::to_string));
    Ok(mode)
}
