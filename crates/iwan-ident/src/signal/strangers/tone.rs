//! A line in a mode's band, or next to it, that remains when the mode has died away and does not decay.

use crate::signal::isolated::Isolated;
use crate::signal::spectrum::{amplitude_spectrum, is_peak, median, vertex};

use super::mains::{BESIDE, is_multiple};

/// Number of parts of the record; the last two are compared with each other and with the loudest of those before.
const PARTS: usize = 6;
/// The mode has died away where the line is lower by at least this factor than the highest line of the band in the loudest part. A judgement: with less the mode itself might
/// be the line.
const DIED: f64 = 3.0;
/// The line stands out of those around it by at least this factor: noise then lets it differ by a tenth from one part to the other.
const STANDS: f64 = 20.0;
/// Allowed difference of the line from one part to the other, as a natural logarithm, because a rest of the mode may beat with it.
const EVEN: f64 = 0.1;
/// Further allowance, in ratios of the lines around to the line: a normal variable's standard deviation is 0.85 medians of its magnitude in a plane.
const SCATTER: f64 = 2.0;
/// Lines up to OWN on either side may be made by the Hann window of the one line; the median of those from OWN to AROUND is what stands around it.
const OWN: usize = 3;
const AROUND: usize = 12;

/// Frequency (Hz) and amplitude of the highest steady line in the band of `mode`, or next to it, where `x` is the record that the mode was taken out of. None of the mains,
/// which are named as such.
pub(super) fn tone(mode: &Isolated, x: &[f64]) -> Option<(f64, f64)> {
    let length = x.len() / PARTS;
    let step = 1.0 / (length as f64 * mode.dt);
    let part = |n: usize| -> Option<Vec<f64>> {
        let lines = amplitude_spectrum(&x[n * length..(n + 1) * length], mode.dt).ok()?;
        Some(lines.iter().map(|line| line.amplitude).collect())
    };
    let (before, last) = (part(PARTS - 2)?, part(PARTS - 1)?);
    let beside = BESIDE * mode.band.peak;
    let inside = |k: usize| (mode.band.low - beside..=mode.band.high + beside).contains(&(k as f64 * step));
    let highest = (AROUND..last.len().saturating_sub(AROUND))
        .filter(|&k| inside(k) && is_peak(&last, k))
        .max_by(|&i, &j| last[i].total_cmp(&last[j]))?;
    let below = median(last[highest - AROUND..=highest - OWN].to_vec());
    let around = median(last[highest + OWN..=highest + AROUND].to_vec()).max(below);
    // The sizes are compared by the energy of three lines, which hardly depends on where the tone lies between them.
    let size = |lines: &[f64]| lines[highest - 1..=highest + 1].iter().map(|l| l * l).sum::<f64>().sqrt();
    let (ends, now) = (size(&before), size(&last));
    let is_steady = (ends / now).ln().abs() < EVEN + SCATTER * around / now;
    let in_band =
        |lines: Vec<f64>| (0..lines.len()).filter(|&k| inside(k)).map(|k| lines[k]).fold(0.0, f64::max);
    let loudest = (0..PARTS - 2).filter_map(part).map(in_band).fold(0.0, f64::max);
    let (frequency, amplitude) = (vertex(&last, highest) * step, last[highest]);
    let stands = amplitude > STANDS * around && loudest > DIED * amplitude;
    (is_steady && stands && !is_multiple(frequency, step)).then_some((frequency, amplitude))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use crate::error::Error;
    use crate::signal::{Intruder, Isolated, Options, isolate};

    /// A mode of 140 Hz, a tone beside it and noise.
    fn found(
        offset: f64,
        tone: f64,
        noise: f64,
        rate_of_tone: f64,
    ) -> Result<(Isolated, Vec<Intruder>), Error> {
        let mut random = iwan_core::SplitMix64::new(3);
        let mut sample = |t: f64| {
            let mode = (-1.1 * t).exp() * (TAU * 139.74 * t).sin();
            let other = tone * (-rate_of_tone * t).exp() * (TAU * (139.74 + offset) * t).sin();
            mode + other + noise * random.next_symmetric()
        };
        let x: Vec<f64> = (0..40_000).map(|n| sample(f64::from(n) / 4000.0)).collect();
        let options = Options { band: Some((110.0, 170.0)), ..Options::default() };
        let mode = isolate(&x, 1.0 / 4000.0, &options)?;
        let found = mode.intruders(&x)?;
        Ok((mode, found))
    }

    #[test]
    fn a_steady_tone_beside_a_decay_is_told() {
        for offset in [-3.0, 9.0] {
            for noise in [0.0, 1e-3] {
                let (mode, found) = found(offset, 2e-3, noise, 0.0).unwrap();
                let [Intruder::Tone { frequency, amplitude }] = found[..] else {
                    panic!("{offset} {noise}: {found:?}")
                };
                assert!((frequency - 139.74 - offset).abs() < 0.03, "{offset}: {frequency}");
                assert!((amplitude / 2e-3 - 1.0).abs() < 0.15, "{offset}: {amplitude}");
                assert!(mode.notes.contains(&found[0].to_string()), "{:?}", mode.notes);
            }
        }
        // So near that the mode cannot be followed to where it sinks to the tone: then the tone is the reason.
        let refused = found(0.3, 2e-3, 0.0, 0.0).unwrap_err().to_string();
        assert!(refused.contains("a line at 140.0") && refused.contains("--to"), "{refused}");
    }

    #[test]
    fn decays_and_noise_are_no_tones() {
        for (tone, noise, rate) in
            [(0.0, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.1, 0.0), (2e-3, 0.0, 0.1), (2e-3, 1e-4, 0.1)]
        {
            assert_eq!(found(9.0, tone, noise, rate).unwrap().1, [], "{tone} {noise} {rate}");
        }
    }
}
