//! Lines in a mode's band that do not belong to the mode: harmonics of a stronger mode, the mains, and other tones.

use super::mains::{Line, lines};
use super::tone::tone;
use crate::error::Error;
use crate::signal::isolated::Isolated;
use crate::signal::survey::{SpectralPeak, spectral_peaks};

/// Orders of harmonics that friction and clearance make strong enough to matter.
const HARMONICS: [u32; 2] = [2, 3];
/// A lower mode of at least this fraction of the height of the band's own peak makes harmonics that are seen in the band: they are some per cent of that mode at most.
const STRONG: f64 = 0.3;
/// A line in the band of a mode that does not belong to the mode.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Intruder {
    /// A multiple of a stronger mode's frequency.
    Harmonic {
        /// 2 or 3.
        order: u32,
        /// Frequency of that mode, Hz.
        of: f64,
        /// Frequency of the line, Hz.
        frequency: f64,
    },
    /// A multiple of the mains frequency that does not decay.
    Mains {
        /// 50 or 60 Hz.
        base: f64,
        /// Multiple of the base frequency.
        order: u32,
        /// Amplitude, in the unit of the record. Under a mode that is loud to the end it is what remains of the line after modes beside the band were subtracted, a third at
        /// least.
        amplitude: f64,
    },
    /// A line that does not decay, in what remains of the record when the mode has died away.
    Tone {
        /// Hz.
        frequency: f64,
        /// In the unit of the record.
        amplitude: f64,
    },
}

impl Intruder {
    /// Whether it is a line that does not decay.
    pub(in crate::signal) fn is_steady(&self) -> bool {
        !matches!(self, Self::Harmonic { .. })
    }
}

impl std::fmt::Display for Intruder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Harmonic { order, of, frequency } => {
                let word = if *order == 2 { "second" } else { "third" };
                write!(
                    f,
                    "the {word} harmonic ({frequency:.2} Hz) of the mode at {of:.2} Hz falls into the band: while that mode is loud, \
                           it is a part of what is seen here"
                )
            }
            Self::Tone { frequency, amplitude } => write!(
                f,
                "in the last third of the record a line at {frequency:.3} Hz, amplitude {amplitude:.2e}, does not decay and stands in the band or next to it: a tone that somebody drives, or a mode of much \
                 less damping. Damping beats with it, and where the mode sinks to it, it is not the mode that is seen"
            ),
            Self::Mains { base, order, amplitude } => {
                let frequency = base * f64::from(*order);
                write!(
                    f,
                    "a line of the mains at {frequency} Hz ({order} x {base} Hz), amplitude {amplitude:.2e} or more, does not decay and stands \
                           in the band or next to it: damping beats with it, and where the mode sinks to it, it is not the mode that is seen"
                )
            }
        }
    }
}

impl Isolated {
    /// The lines that fall into the band of the mode and do not belong to it: second and third harmonics of modes below it that are not much weaker; multiples of the mains
    /// frequency that do not decay, also next to the band; and any other steady line that remains when the mode has died away. `x` is the record that the mode was taken out
    /// of.
    ///
    /// # Errors
    /// Those of [`spectral_peaks`].
    ///
    /// ```
    /// use iwan_ident::signal::{Intruder, Options, isolate};
    /// use std::f64::consts::TAU;
    /// let wave = |t: f64, f: f64| (-2.0 * t).exp() * (TAU * f * t).sin();
    /// let x: Vec<f64> = (0..8000).map(|n| n as f64 / 2000.0).map(|t| wave(t, 122.4) + 0.5 * wave(t, 243.4)).collect();
    /// let options = Options { band: Some((190.0, 300.0)), ..Options::default() };
    /// let found = isolate(&x, 1.0 / 2000.0, &options)?.intruders(&x)?;
    /// assert!(matches!(found[..], [Intruder::Harmonic { order: 2, of, .. }] if (of - 122.4).abs() < 0.05));
    /// # Ok::<(), iwan_ident::Error>(())
    /// ```
    pub fn intruders(&self, x: &[f64]) -> Result<Vec<Intruder>, Error> {
        Ok(self.intruders_among(&spectral_peaks(&[x], self.dt)?, x))
    }

    /// The same for peaks of the record that are known.
    pub(in crate::signal) fn intruders_among(&self, peaks: &[SpectralPeak], x: &[f64]) -> Vec<Intruder> {
        let inside = |f: f64| (self.band.low..=self.band.high).contains(&f);
        let own = peaks.iter().filter(|p| inside(p.frequency)).map(|p| p.height).fold(0.0, f64::max);
        let strong = peaks.iter().filter(|p| p.frequency < self.band.low && p.height >= STRONG * own);
        let harmonics = strong.flat_map(|p| {
            let line = |order: u32| Intruder::Harmonic {
                order,
                of: p.frequency,
                frequency: f64::from(order) * p.frequency,
            };
            HARMONICS.into_iter().filter(|order| inside(f64::from(*order) * p.frequency)).map(line)
        });
        let mains = lines(self, x).into_iter();
        let mains = mains.map(|Line { base, order, amplitude }| Intruder::Mains { base, order, amplitude });
        let tone = tone(self, x).map(|(frequency, amplitude)| Intruder::Tone { frequency, amplitude });
        harmonics.chain(mains).chain(tone).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Options, isolate};

    /// A mode of 160 Hz or of another frequency, with hum at 149.95 Hz.
    fn found(frequency: f64, rate: f64, hum: f64) -> Vec<Intruder> {
        let wave = |t: f64| {
            let mode = (-rate * t).exp() * (std::f64::consts::TAU * frequency * t).sin();
            mode + hum * (std::f64::consts::TAU * 149.95 * t).sin()
        };
        let x: Vec<f64> = (0..20_000).map(|n| wave(f64::from(n) / 5000.0)).collect();
        let options = Options { band: Some((120.0, 190.0)), ..Options::default() };
        isolate(&x, 2e-4, &options).unwrap().intruders(&x).unwrap()
    }

    #[test]
    fn the_mains_are_told_from_a_mode_beside_them() {
        // A mode that is gone before the end, and one that is loud throughout.
        for rate in [3.0, 0.3] {
            assert_eq!(found(160.0, rate, 0.0), []);
            // One of 5 % beside a loud mode is refused: the envelope beats.
            for hum in if rate > 1.0 { [0.01, 0.05] } else { [0.005, 0.01] } {
                let lines = found(160.0, rate, hum);
                let [Intruder::Mains { base: 50.0, order: 3, amplitude }] = lines[..] else {
                    panic!("{rate} {hum}: {lines:?}")
                };
                assert!((amplitude / hum - 1.0).abs() < 0.3, "{rate} {hum}: {amplitude}");
                assert!(lines[0].to_string().contains("150 Hz"));
            }
        }
        // Six beats with a mode that outlives the record: no spectrum of its end tells the two apart.
        assert!(
            matches!(found(151.5, 0.3, 0.01)[..], [Intruder::Mains { order: 3, amplitude, .. }] if amplitude > 0.003)
        );
        assert_eq!(found(151.5, 0.3, 0.0), []);
    }

    #[test]
    fn a_mode_at_a_multiple_of_the_mains_is_none() {
        for rate in [1.5, 0.1] {
            assert_eq!(found(150.0, rate, 0.0), []);
            assert_eq!(found(150.15, rate, 0.0), []);
        }
    }
}
