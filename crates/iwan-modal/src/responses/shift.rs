//! Whether a peak has the same frequency in all hits: a structure that warms up, loosens or is taken apart between hits moves it.

use iwan_ident::signal::{half_power_width, is_peak, vertex};

use crate::number::median;

/// Number of peaks that are compared: the highest of the first hit.
const PEAKS: usize = 10;
/// A peak stands at least this many times above the median of the lines around it.
const STANDS: f64 = 10.0;
/// A peak stands alone within this fraction of its frequency: no other one there has half of its height, so that different ones cannot be taken in two hits. It is also the
/// largest distance by which a peak moves.
const ALONE: f64 = 0.03;
/// Peaks of two hits belong to one mode where their heights, relative to the highest of each hit, agree within this factor.
const ALIKE: f64 = 4.0;
/// A peak has moved where its frequencies differ by more than this fraction of its width at half power: by less, averages smear the peak and do not split it.
const MOVED: f64 = 0.5;
/// The frequencies must also differ by more than this many lines: less is what noise and the length of a record do.
const LINES: f64 = 2.0;

/// A peak that stands at different frequencies in two hits.
pub(super) struct Shift {
    /// The hits in which the peak stands lowest and highest, and its lines there.
    pub(super) hits: [usize; 2],
    pub(super) lines: [f64; 2],
    /// Width between its half-power points, in lines.
    pub(super) width: f64,
}

/// A local maximum of a spectrum.
struct Peak {
    line: f64,
    /// Height over the highest line of the spectrum.
    height: f64,
    width: f64,
}

/// The peak that moves most between hits relative to its width, if any moves; `spectra` are magnitudes at the same lines for each hit.
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

/// The highest peak about a line; none where it does not stand alone, or hardly stands out.
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

    /// Magnitudes of two modes at these lines, with this half width each; the height of the second is relative to the first.
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
        // Two modes next to each other; in one hit the first is higher, in the other the second. Either of them alone would have seemed to move.
        let beside = |second| spectrum([300.0, 308.0], 1.0, second);
        assert!(shift(&[beside(0.8), beside(1.25)]).is_none());
        assert!(shift(&[beside(0.1), beside(10.0)]).is_some());
        assert!(shift(&[vec![1.0; 100], vec![1.0; 100]]).is_none());
        assert!(shift(&[vec![], vec![]]).is_none());
    }
}
