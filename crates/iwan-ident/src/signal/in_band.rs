//! One band of a record: defects, band, filter, and the window in which the result can be trusted.

use std::ops::Range;

use super::defects::{clipped_until, gone_by, stops_at};
use super::filter::{Butterworth, Passband};
use super::first_peak::first_of_the_largest;
use super::isolated::{CYCLES, Isolated};
use super::raw::raw;
use super::spectrum::{Band, automatic_band, given_band, goes_on, is_steady};
use super::survey::{band_near, slow_rises, spectral_peaks};
use super::transients::{Ends, Gate};
use crate::error::{Error, check, check_dt, check_samples};

/// Length that is cut off at each end before the mode is known, in memories of the filter: e^-4 = 2 % of a transient is left. With half as much,
/// damping by peaks of a clean linear record was off by 27 % inside the window instead of 0.04 %; with twice as much a record of 27 cycles
/// (0.34 s at 80 Hz) is refused because fewer than eight cycles remain.
const MEMORIES: f64 = 4.0;
/// Least number of samples of a record: eight cycles of eight samples. Records with fewer are refused.
const SAMPLES: usize = 64;
/// Least number of samples between start and end of a window: with fewer nothing could be fitted, and the remedy is another window and not
/// a longer record.
const LEAST_WINDOW: usize = 16;

/// Highest order that may be asked for; a higher one is refused. Curves of higher order swing between the values that they go through, and degree 100 gave frequencies of
/// megahertz. No record tried needed more than 13.
const MOST_ORDER: usize = 30;

/// A mode of at least this fraction of the height of a steady tone is taken instead of the tone. Any record of a shaker holds lower ones beside the tone that is meant, and
/// they are left aside. A judgement.
const BESIDE_A_TONE: f64 = 0.1;

/// Half width, over its peak, of the band in which an amplitude that comes and goes is followed: what passes can change within some three cycles. A judgement.
const WIDE: f64 = 0.15;

/// Length in cycles of the blocks in which the energy of the filtered record is followed. A judgement: one cycle is less than the filter remembers.
const BLOCK: f64 = 2.0;

/// How a mode is taken out of a record. `Options::default()` finds all values automatically.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Band in Hz as (low, high); none: that of [`automatic_band`].
    pub band: Option<(f64, f64)>,
    /// Rough frequency of the mode in Hz, for the automatic band; none: the highest spectral peak.
    pub near: Option<f64>,
    /// Order of the Butterworth filter; 0: no filter, for records of one mode that start in free decay.
    pub filter_order: usize,
    /// Window in seconds from the first sample. None: it starts three cycles behind the start of the decay where the mode is alone, else 4 filter memories behind
    /// the largest amplitude; it ends 4 filter memories before the end of the record, or where the mode sinks into noise.
    pub window: Option<(f64, f64)>,
    /// Degree of the polynomials (Hilbert) or number of spline intervals (peaks); none: chosen by Schwarz's criterion.
    pub order: Option<usize>,
    /// Whether the record is known to lie under a window, as by the header of its file.
    pub windowed: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { band: None, near: None, filter_order: 3, window: None, order: None, windowed: false }
    }
}

/// A mode behind the filter of its band, with that filter and the start of the decay.
pub(super) struct InBand {
    pub(super) mode: Isolated,
    /// None where no filter is used.
    pub(super) gate: Option<Gate>,
    /// Notes on the record from before its band was looked at.
    pub(super) of_record: Vec<String>,
}

/// Takes one band out of a record, whether it holds one mode or more.
///
/// The steps, in this order: the samples are checked; the band is chosen; a tail of equal samples and a long tail of noise are cut off; the record is filtered; the window is
/// trimmed by the filter's memory and starts behind the last clipped sample; it ends where the mode sinks into noise; the transients that the filter makes of the mode's start
/// and end are subtracted. Each step that finds something leaves a note.
pub(super) fn in_band(x: &[f64], dt: f64, options: &Options) -> Result<InBand, Error> {
    check_dt(dt)?;
    check_samples("record", x, SAMPLES, "record longer")?;
    if let Some(order) = options.order {
        let allowed = format!("1 to {MOST_ORDER}");
        let remedy = "leave it out: Schwarz's criterion finds it";
        check("order", order as f64, (1..=MOST_ORDER).contains(&order), &allowed, remedy)?;
    }
    let mut notes = Vec::new();
    let Chosen { mut band, mut tone } = chosen(x, dt, options)?;
    let end = stops_at(x, (0.5 / (band.peak * dt)).ceil() as usize).unwrap_or(x.len());
    if end < x.len() {
        notes.push(format!("the samples are constant from {:.6} s on: cut there", end as f64 * dt));
        check_samples("record before its constant tail", &x[..end], SAMPLES, "record longer")?;
        Chosen { band, tone } = chosen(&x[..end], dt, options)?;
    }
    let mut x = &x[..end];
    // The spectrum of a whole record sees little of a decay at its very start, and all of the noise behind it.
    if let Some(gone) = gone_by(x, 1).filter(|gone| !goes_on(&x[*gone..], dt, band.peak)) {
        let shorter = chosen(&x[..gone], dt, options);
        if let Some(found) = shorter.ok().filter(|_| gone >= SAMPLES) {
            notes.push(format!("behind {:.6} s there is nothing but noise: cut there", gone as f64 * dt));
            Chosen { band, tone } = found;
            x = &x[..gone];
        }
    }
    notes.extend(tone.map(|tone| {
        format!(
            "a line at {tone:.6} Hz is highest and does not decay: the highest mode that does is taken (--mode {tone:.4} takes the line)"
        )
    }));
    let automatic = if options.band.is_none() { " (automatic)" } else { "" };
    notes
        .push(format!("band {:.6} to {:.6} Hz{automatic}, peak at {:.6} Hz", band.low, band.high, band.peak));
    behind_filter(x, dt, band, options, Some(notes))
}

/// The same in a known band, for samples that are checked. `notes` are those on the record; without them the mode is one beside the mode that is looked for, and a line that
/// does not decay is taken as well.
pub(super) fn behind_filter(
    x: &[f64],
    dt: f64,
    band: Band,
    options: &Options,
    notes: Option<Vec<String>>,
) -> Result<InBand, Error> {
    let must_decay = notes.is_some();
    let of_record = notes.unwrap_or_default();
    let mut notes = of_record.clone();
    let (mut x, mut behind) = (x, filtered(x, dt, band, options)?);
    let cycles = (BLOCK / (band.peak * dt)).ceil() as usize;
    if let Some(gone) = gone_by(&behind.samples, cycles).filter(|gone| must_decay && *gone >= SAMPLES) {
        notes.push(format!(
            "behind {:.6} s there is nothing but noise in the band: cut there",
            gone as f64 * dt
        ));
        x = &x[..gone];
        behind = filtered(x, dt, band, options)?;
    }
    let Filtered { samples, trim, bandwidth, filter } = behind;
    let window = window(x, &samples, (dt, band.peak), trim, options, &mut notes)?;
    let mut mode = Isolated {
        raw: raw(&samples, &window, dt, band.peak),
        samples,
        dt,
        band,
        window,
        noise: 0.0,
        notes,
        bandwidth,
        scatter: 0.0,
        treatment: None,
        begin: 0,
        beside: None,
        steady: Vec::new(),
    };
    mode.end_at_noise(must_decay)?;
    let Some(filter) = filter else { return Ok(InBand { mode, gate: None, of_record }) };
    let (begin, shown) = mode.begin(x, trim);
    mode.begin = begin;
    let ends = Ends { x, filter: &filter, decay: begin..x.len(), reach: trim };
    let may_widen = shown && options.window.is_none() && clipped_until(x).is_none();
    mode.without_transients(x, &ends, may_widen)?;
    Ok(InBand { mode, gate: Some(Gate { filter, begin, reach: trim }), of_record })
}

/// The mode in samples `x`, taken as `mode` was taken out of another record: behind the same filter, in the same window, with the transients of the
/// same start subtracted, and with the same weights. Smooth curves through both then have the same errors.
///
/// # Errors
/// As [`isolate`](super::isolate).
pub(crate) fn taken_as(mode: &Isolated, x: &[f64], options: &Options) -> Result<Isolated, Error> {
    let x = &x[..x.len().min(mode.samples.len())];
    let Filtered { samples, trim, filter, .. } = filtered(x, mode.dt, mode.band, options)?;
    let raw = raw(&samples, &mode.window, mode.dt, mode.band.peak);
    let mut taken = Isolated { raw, samples, beside: None, ..mode.clone() };
    if let Some(filter) = &filter {
        let ends = Ends { x, filter, decay: mode.begin..x.len(), reach: trim };
        taken.without_transients(x, &ends, false)?;
    }
    Ok(Isolated { noise: mode.noise, scatter: mode.scatter, ..taken })
}

/// How often the amplitude about the peak of a record's band rises again, slowly, and the frequency of the peak, Hz; none where there is no such band.
///
/// The band may be as narrow as one line of the spectrum of a long random vibration, and what is behind such a filter hardly varies. So the amplitude is followed in a band that is
/// wide enough for changes within a few cycles.
pub(super) fn rises(x: &[f64], dt: f64, options: &Options) -> Option<(usize, f64)> {
    let Band { low, high, peak } = chosen(x, dt, options).ok()?.band;
    let band = Band {
        low: low.min(peak * (1.0 - WIDE)),
        high: high.max((peak * (1.0 + WIDE)).min(0.5 * (high + 0.5 / dt))),
        peak,
    };
    let samples = filtered(x, dt, band, options).ok()?.samples;
    Some((slow_rises(&samples, (1.0 / (band.peak * dt)).round() as usize), band.peak))
}

/// A band, and the frequency (Hz) of a driven tone that is higher than the mode of that band; none where there is no such tone.
pub(super) struct Chosen {
    pub(super) band: Band,
    tone: Option<f64>,
}

/// The band that is asked for. Where none is, and the highest line of the spectrum is a tone that somebody drives, it is the band of the highest mode that decays.
pub(super) fn chosen(x: &[f64], dt: f64, options: &Options) -> Result<Chosen, Error> {
    let band = band(x, dt, options)?;
    let is_automatic = options.band.is_none() && options.near.is_none();
    let beside = if is_automatic { beside_a_tone(x, dt, &band) } else { None };
    let tone = beside.map(|_| band.peak);
    Ok(Chosen { band: beside.unwrap_or(band), tone })
}

/// The band of the highest mode that decays. None where the highest line decays itself, or where no mode decays that is at least a tenth as high.
fn beside_a_tone(x: &[f64], dt: f64, band: &Band) -> Option<Band> {
    is_steady(x, dt, band.peak).then_some(())?;
    let peaks = spectral_peaks(&[x], dt).ok()?;
    let decays = peaks.iter().filter(|p| p.height > BESIDE_A_TONE && goes_on(x, dt, p.frequency));
    let mode = decays.max_by(|a, b| a.height.total_cmp(&b.height))?;
    band_near(&[x], dt, mode.frequency).ok()
}

fn band(x: &[f64], dt: f64, options: &Options) -> Result<Band, Error> {
    let Some((low, high)) = options.band else { return automatic_band(x, dt, options.near) };
    let nyquist = 0.5 / dt;
    let allowed = format!("0 < low < high < {nyquist} Hz (Nyquist)");
    let remedy = "move the band, or sample faster";
    check("band low", low, low > 0.0 && low < high, &allowed, remedy)?;
    check("band high", high, high < nyquist, &allowed, remedy)?;
    given_band(x, dt, low, high)
}

/// A record behind the filter of a band.
struct Filtered {
    samples: Vec<f64>,
    /// Samples to trim at each end.
    trim: usize,
    /// Independent values a second behind the filter.
    bandwidth: f64,
    filter: Option<Butterworth>,
}

fn filtered(x: &[f64], dt: f64, band: Band, options: &Options) -> Result<Filtered, Error> {
    if options.filter_order == 0 {
        return Ok(Filtered { samples: x.to_vec(), trim: 0, bandwidth: 0.5 / dt, filter: None });
    }
    let pass = Passband::Band { low: band.low, high: band.high };
    let filter = Butterworth::new(options.filter_order, pass, dt)?;
    let trim = (MEMORIES * filter.memory() / dt).ceil() as usize;
    let samples = filter.forward_backward(x)?;
    Ok(Filtered { samples, trim, bandwidth: band.high - band.low, filter: Some(filter) })
}

/// The trusted window, as a range of samples, before its end is cut at the noise.
fn window(
    x: &[f64],
    samples: &[f64],
    (dt, peak): (f64, f64),
    trim: usize,
    options: &Options,
    notes: &mut Vec<String>,
) -> Result<Range<usize>, Error> {
    let n = samples.len();
    // The last samples hold the transient of the filter's own end, so the largest amplitude is not looked for there.
    let top = first_of_the_largest(samples[..n.saturating_sub(trim).max(1)].iter().map(|x| x.abs()));
    let mut start = if options.filter_order == 0 && options.window.is_some() { 0 } else { top + trim };
    let cycles = |samples: usize| (samples as f64 * dt * peak) as usize;
    if options.window.is_none() && start + LEAST_WINDOW > n.saturating_sub(trim) && 2 * top < n {
        return Err(Error::TooShort {
            what: "cycles of the mode behind its largest amplitude, of which the filter of its band takes most",
            found: cycles(n - top),
            needed: cycles(2 * trim) + CYCLES,
            remedy: "record longer, or choose a wider band (--band) where other modes leave room for it",
        });
    }
    if let Some(clipped) = clipped_until(x) {
        let seconds = clipped as f64 * dt;
        notes.push(format!("clipped up to {seconds:.6} s: the window starts behind it"));
        start = start.max(clipped + trim);
    }
    let mut end = n.saturating_sub(trim);
    if let Some((from, to)) = options.window {
        let allowed = format!("0 <= start < end <= {} s", n as f64 * dt);
        check("window start", from, from >= 0.0 && from < to, &allowed, "give the window as start:end")?;
        let wanted = (from / dt).ceil() as usize;
        if wanted < start {
            notes.push(format!(
                "the window was to start at {from} s: filter, impact or clipping reach to {:.6} s",
                start as f64 * dt
            ));
        }
        (start, end) = (start.max(wanted), end.min((to / dt) as usize));
    }
    if start + LEAST_WINDOW > end {
        return Err(Error::Refused {
            finding: format!(
                "nothing of the record is left: largest amplitude, clipping and the filter's beginning reach to {:.6} s, and its end begins at {:.6} s",
                start as f64 * dt,
                end as f64 * dt
            ),
            remedy: "record longer, widen the band (--band), or set a lower input range; a motion that grows, or a record that was turned round, is no ring-down",
        });
    }
    Ok(start..end)
}
