//! Takes one mode out of a record that may hold others.

use super::beside::others;
use super::in_band::{InBand, Options, behind_filter, chosen, in_band, rises};
use super::isolated::Isolated;
use super::spectrum::{Band, is_steady};
use super::survey::{SpectralPeak, Treatment, spectral_peaks, treatment};
use crate::error::Error;

/// A note names another peak where it is more than this many times as high as the mode chosen, in the spectrum of what follows the loudest sample. That spectrum weights the
/// record differently from the one by which the mode was chosen, and modes of about the same height change places. A judgement.
const LOUDER: f64 = 1.5;

/// An amplitude that rises slowly so many times is driven all the time: once it does so where a resonance builds up before its decay.
const AGAIN: usize = 2;

/// Takes one mode out of a uniformly sampled record `x` (any unit, every `dt` seconds).
///
/// The band of the mode is taken out of the record; then modes beside the band that reach into it are subtracted, and the band is
/// looked at once more. Each step that finds something leaves a note, and so do each line in the band that does not belong to the mode, and a filter or a window that the record went
/// through before.
///
/// # Errors
/// [`Error::Refused`] for a record with two modes in the band, without decay, or clipped to its end;
/// [`Error::TooShort`], [`Error::NotFinite`], [`Error::OutOfRange`].
pub fn isolate(x: &[f64], dt: f64, options: &Options) -> Result<Isolated, Error> {
    let (whole, found) = (x, in_band(x, dt, options));
    let InBand { mut mode, gate, of_record } = found.map_err(|e| {
        driven_throughout(&e, x, dt, options).unwrap_or_else(|| beside_a_louder(e, x, dt, options))
    })?;
    let x = &x[..mode.samples.len()];
    let beside = gate.filter(|_| !mode.is_alone(x)).and_then(|gate| others(x, &mode, &gate, options));
    if let Some(beside) = beside {
        let rest: Vec<f64> = x.iter().zip(&beside.samples).map(|(x, other)| x - other).collect();
        let again = behind_filter(&rest, dt, mode.band, options, Some(of_record));
        if let Ok(InBand { mode: mut found, .. }) = again {
            found.beside =
                Some(mode.samples.iter().zip(&found.samples).map(|(with, own)| with - own).collect());
            mode = found;
            mode.notes.push(beside.in_words());
        }
    }
    // Records too short for a spectrum are refused above.
    let peaks = spectral_peaks(&[x], dt).unwrap_or_default();
    let strangers = mode.intruders_among(&peaks, x);
    mode.steady = strangers.iter().filter(|line| line.is_steady()).map(ToString::to_string).collect();
    mode.refuse_second_line().map_err(|e| mode.refused(e))?;
    mode.notes.extend(strangers.iter().map(ToString::to_string));
    let declared = options.windowed.then_some(Treatment::Declared);
    mode.treatment = treatment(whole, dt, mode.band.peak).or(declared);
    mode.notes.extend(mode.treatment.map(|seen| seen.in_words(mode.band.peak)));
    let louder = louder(&peaks, &mode.band).filter(|peak| chooses(options) && !is_steady(x, dt, *peak));
    mode.notes.extend(louder.map(|peak| {
        let note = "the mode of this band was chosen because it is highest in the spectrum of the whole record; behind the loudest sample the highest is that at";
        format!("{note} {peak:.2} Hz (--mode {peak:.2})")
    }));
    Ok(mode)
}

/// Whether the mode is chosen by its height alone, because neither a band nor a frequency is given.
fn chooses(options: &Options) -> bool {
    options.band.is_none() && options.near.is_none()
}

/// The frequency (Hz) of the highest of some peaks where it is much higher than all peaks in the band.
fn louder(peaks: &[SpectralPeak], band: &Band) -> Option<f64> {
    let inside = |p: &&SpectralPeak| (band.low..=band.high).contains(&p.frequency);
    let own = peaks.iter().filter(inside).map(|p| p.height).fold(0.0, f64::max);
    let highest = peaks.iter().max_by(|a, b| a.height.total_cmp(&b.height))?;
    (highest.height > LOUDER * own).then_some(highest.frequency)
}

/// Why a mode that comes and goes cannot be followed; none where it does not.
fn driven_throughout(error: &Error, x: &[f64], dt: f64, options: &Options) -> Option<Error> {
    let of_record = matches!(error, Error::TooShort { .. } | Error::Refused { .. });
    let (rises, peak) = rises(x, dt, options).filter(|(rises, _)| of_record && *rises >= AGAIN)?;
    Some(Error::Refused {
        finding: format!(
            "the amplitude at {peak:.4} Hz rises slowly, {rises} times in {:.1} s, where that of a ring-down falls: it is driven all the time, as by traffic, wind or a machine, or modes \
             beat",
            x.len() as f64 * dt
        ),
        remedy: "record a free decay, as behind a hit, a pluck or a shaker that is switched off, or cut one out of the record (--from, --to)",
    })
}

/// The error for a mode that is too short to be followed. If the mode was chosen by its height in the spectrum of the whole record, and another one is higher behind the
/// loudest sample, the error names that one, which may be the mode that is meant.
fn beside_a_louder(error: Error, x: &[f64], dt: f64, options: &Options) -> Error {
    let Error::TooShort { what, found, needed, .. } = error else { return error };
    let peaks = spectral_peaks(&[x], dt).unwrap_or_default();
    let band = chosen(x, dt, options).ok().filter(|_| chooses(options)).map(|chosen| chosen.band);
    let louder = band.and_then(|band| Some((band, louder(&peaks, &band)?)));
    let Some((band, peak)) = louder.filter(|(_, peak)| !is_steady(x, dt, *peak)) else { return error };
    Error::Refused {
        finding: format!(
            "{what}: {found} found, at least {needed} needed, of the mode at {:.2} Hz, which is highest in the spectrum of the whole record. Behind the loudest sample the highest is \
             that at {peak:.2} Hz",
            band.peak
        ),
        remedy: "name the mode that is meant (--mode HZ)",
    }
}
