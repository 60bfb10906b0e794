//! The spectrogram of a record, as its report shows it.

use iwan_ident::signal::{Band, spectral_peaks, spectrogram};

use crate::page::figure::Axis;
use crate::page::heat::HeatMap;

/// Cells along the time axis: nearly one for every two units of the plane's width.
const TIMES: usize = 200;
/// Cells along the frequency axis: one for every two units of the plane's height.
const CELLS: usize = 120;
/// Without a band, the picture ends at this multiple of the frequency of the highest-frequency peak that reaches …
const BEYOND: f64 = 1.3;
/// … this part of the height of the highest peak: above it the picture would be empty.
const SEEN: f64 = 0.03;
/// With a band, the picture ends at this multiple of the band's upper edge (or at half the sampling rate), so that neighbours are visible.
const AROUND: f64 = 2.5;
/// Level at the light end of the shades, dB below the largest value: the floor of the spectrogram itself.
const FLOOR: f64 = -80.0;

/// The spectrogram of samples every `dt` seconds from `start` (s); none where the record is too short for one.
pub(super) fn picture(samples: &[f64], dt: f64, start: f64, band: Option<Band>) -> Option<HeatMap> {
    let nyquist = 0.5 / dt;
    let wanted = if let Some(band) = band {
        AROUND * band.high
    } else {
        let peaks = spectral_peaks(&[samples], dt).unwrap_or_default();
        BEYOND * peaks.iter().filter(|p| p.height > SEEN).map(|p| p.frequency).fold(0.0, f64::max)
    };
    let high = if wanted > 0.0 { wanted.min(nyquist) } else { nyquist };
    let shown = spectrogram(samples, dt, (0.0, high), (TIMES, CELLS)).ok()?;
    let values =
        shown.decibels.iter().map(|column| column.iter().map(|d| 1.0 - d / FLOOR).collect()).collect();
    let (first, last) = (shown.times.first()?, shown.times.last()?);
    let half = 0.5 * (last - first) / (shown.times.len() - 1).max(1) as f64;
    let words = if band.is_some() { " The lines are the edges of the band that was cut out." } else { "" };
    Some(HeatMap {
        title: "Spectrum over time".into(),
        caption: format!(
            "Hann windows of {:.3} s, each cell the highest line in it, in decibels below the highest. A ring-down is a stripe that fades; a \
             stripe that does not fade is a hum; an upright stripe is a hit.{words}",
            shown.window
        ),
        x: Axis::linear("time", "s"),
        y: Axis::linear("frequency", "Hz"),
        across: (start + first - half, start + last + half.max(1e-3 * dt)),
        up: (0.0, high),
        values,
        band: band.map(|band| (band.low, band.high)),
        ends: ("\u{2212}80 dB".into(), "0 dB".into()),
    })
}
