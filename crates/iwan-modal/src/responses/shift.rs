//! Whether a peak stands at one frequency in all hits: what warms up, loosens or was taken apart between hits moves it.

use iwan_ident::signal::{half_power_width, is_peak, vertex};

use crate::number::median;

/// Peaks that are compared: the highest of the first hit.
const PEAKS: usize = 10;
/// A peak stands so many times above the median of the lines around it, …
const STANDS: f64 = 10.0;
/// … and alone within this part of its frequency: no other one there has half of its height, so that two hits cannot take different ones. It is also how far a peak
/// moves at most.
const ALONE: f64 = 0.03;
/// Peaks of two hits are one mode where they are alike in height within this factor, relative to the highest of each hit.
const ALIKE: f64 = 4.0;
/// A peak has moved where its frequencies differ by more than this part of its width at half power: by less, averages smear it and do not split it.
const MOVED: f64 = 0.5;
/// … and by more than so many lines, which is what noise and the length of a record do.
const LINES: f64 = 2.0;

/// A peak that stands at different frequencies in two hits.
pub(super) struct Shift {
    /// The hits between which it moves most, and its lines there.
    pub(super) hits: [usize; 2],
    pub(super) lines: [f64; 2],
    /// Lines between its half-power points.
    pub(super) width: f64,
}

/// A local maximum of a spectrum.
struct Peak {
    line: f64,
    /// Over the highest of the spectrum.
    height: f64,
    width: f64,
}

/// The peak that moves most between hits, in its own width, if any moves; `spectra` are magnitudes at the same lines for each hit.
pub(super) fn shift(spectra: &[Vec<f64>]) -> Option<Shift> {
    let highest: Vec<f64> = spectra.iter().map(|s| s.iter().copied().fold(0.0, f64::max)).collect();
    let lines = spectra.iter().map(Vec::len).min()?;
    let first = &spectra[0];
    let mut candidates: Vec<usize> = (1..lines.saturating_sub(1)).filter(|k| is_peak(first, *k)).collect();
    candidates.sort_by(|a, b| first[*b].total_cmp(&first[*a]));
    let peak = |h: usize, k: usize| highest_near(&spectra[h][..lines], k, highest[h]);
    let moved = |k: usize| {
        let found: Vec<Peak> = (0..spectra.len()).map(|h| peak(h, k)).collect::<Option<_>>()?;
        let alike = |p: &Peak| (p.height / found[0].height).ln().abs() < ALIKE.ln();
        found.iter().all(alike).then_some(())?;
        let by_line = |a: &usize, b: &usize| found[*a].line.total_cmp(&found[*b].line);
        let (low, high) = ((0..found.len()).min_by(by_line)?, (0..found.len()).max_by(by_line)?);
        let width = median(&found.iter().map(|p| p.width).collect::<Vec<_>>());
        let shift = Shift { hits: [low, high], lines: [found[low].line, found[high].line], width };
        let apart = shift.lines[1] - shift.lines[0];
        (apart > LINES && apart > MOVED * width).then_some(shift)
    };
    let parts = |s: &Shift| (s.lines[1] - s.lines[0]) / s.width;
    candidates.into_iter().take(PEAKS).filter_map(moved).max_by(|a, b| parts(a).total_cmp(&parts(b)))
}

/// The highest peak about a line; none where it is not alone, or hardly stands out.
fn highest_near(x: &[f64], line: usize, highest: f64) -> Option<Peak> {
    let reach = ((ALONE * line as f64).ceil() as usize).max(8);
    let near = line.saturating_sub(reach).max(1)..(line + reach + 1).min(x.len() - 1);
    let mut peaks: Vec<usize> = near.clone().filter(|k| is_peak(x, *k)).collect();
    peaks.sort_by(|a, b| x[*b].total_cmp(&x[*a]));
    let &top = peaks.first()?;
    let is_alone = peaks.get(1).is_none_or(|k| x[*k] < 0.5 * x[top]);
    let around = line.saturating_sub(4 * reach).max(1)..(line + 4 * reach).min(x.len());
    let stands = x[top] > STANDS * median(&x[around]);
    if !is_alone || !stands || top == near.start || top + 1 == near.end {
        return None;
    }
    let power: Vec<f64> = x.iter().map(|x| x * x).collect();
    Some(Peak { line: vertex(x, top), height: x[top] / highest, width: half_power_width(&power, top)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Magnitudes of two modes at these lines, with this half width each, the second so many times as high.
    fn spectrum(modes: [f64; 2], half: f64, second: f64) -> Vec<f64> {
        let mode = |k: f64, at: f64| 1.0 / ((k - at).powi(2) + half * half).sqrt();
        (0..2000).map(|k| mode(f64::from(k), modes[0]) + second * mode(f64::from(k), modes[1])).collect()
    }

    #[test]
    fn a_mode_that_moves_between_hits_is_found() {
        let spectra = [[300.0, 900.0], [301.0, 912.0], [302.0, 908.0]].map(|m| spectrum(m, 4.0, 0.3));
        let found = shift(&spectra).unwrap();
        assert_eq!(found.hits, [0, 1]);
        assert!((found.lines[1] - found.lines[0] - 12.0).abs() < 0.1 && (found.width - 8.0).abs() < 0.2);
    }

    #[test]
    fn modes_that_stay_or_stand_beside_others_are_none() {
        assert!(shift(&[[300.0, 900.0], [301.0, 902.0]].map(|m| spectrum(m, 4.0, 0.3))).is_none());
        // Two modes next to each other, of which one is higher in one hit and the other in the other; one of them alone would have moved.
        let beside = |second| spectrum([300.0, 308.0], 1.0, second);
        assert!(shift(&[beside(0.8), beside(1.25)]).is_none());
        assert!(shift(&[beside(0.1), beside(10.0)]).is_some());
        assert!(shift(&[vec![1.0; 100], vec![1.0; 100]]).is_none());
        assert!(shift(&[vec![], vec![]]).is_none());
    }
}
