//! Lines that fall into a mode's band and are not of it: harmonics of a stronger mode, and the mains.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use super::peak_list::spectral_peaks;
use crate::error::Error;
use crate::signal::spectrum::Band;

/// Harmonics that friction and clearance make strong enough to matter.
const HARMONICS: [u32; 2] = [2, 3];
/// A mode of this part of the height of the band's own peak makes harmonics that are seen in it: they are some per cent of it at most.
const STRONG: f64 = 0.3;
/// Frequencies of the mains in use, Hz.
const MAINS: [f64; 2] = [50.0, 60.0];
/// Highest multiple that grids are judged by (IEC 61000-4-7); bands of kilohertz would hold thousands of further ones, which take time and are not there.
const HIGHEST: u32 = 40;
/// The mains wander by this much, Hz: 0.2 Hz is the range in which grids of Europe and North America are kept.
const WANDER: f64 = 0.2;
/// A line of the mains stands out of its neighbours by this factor in the last third of the record, …
const STANDS: f64 = 5.0;
/// … and is as high in the first third, within this factor: it does not decay.
const STEADY: f64 = 2.0;

/// A line in the band that is not of the mode.
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
        /// Multiple of it.
        order: u32,
        /// Amplitude, in the unit of the record.
        amplitude: f64,
    },
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
            Self::Mains { base, order, amplitude } => {
                let frequency = base * f64::from(*order);
                write!(
                    f,
                    "a line of the mains at {frequency} Hz ({order} x {base} Hz), amplitude {amplitude:.4e}, does not decay and stands \
                           in the band: where the mode sinks to it, it is not the mode that is seen"
                )
            }
        }
    }
}

/// The lines that fall into the `band` of a mode of the record `x` (every `dt` seconds) and are not of it: second and third harmonics of
/// modes below it that are not much weaker, and multiples of the mains frequency that do not decay.
///
/// # Errors
/// Those of [`spectral_peaks`].
///
/// ```
/// use iwan_ident::signal::{Band, Intruder, intruders};
/// use std::f64::consts::TAU;
/// let wave = |t: f64, f: f64| (-2.0 * t).exp() * (TAU * f * t).sin();
/// let x: Vec<f64> = (0..8000).map(|n| n as f64 / 2000.0).map(|t| wave(t, 122.4) + 0.5 * wave(t, 243.4)).collect();
/// let found = intruders(&x, 1.0 / 2000.0, &Band { low: 190.0, high: 300.0, peak: 243.4 })?;
/// assert!(matches!(found[..], [Intruder::Harmonic { order: 2, of, .. }] if (of - 122.4).abs() < 0.05));
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn intruders(x: &[f64], dt: f64, band: &Band) -> Result<Vec<Intruder>, Error> {
    let peaks = spectral_peaks(&[x], dt)?;
    let inside = |f: f64| (band.low..=band.high).contains(&f);
    let own = peaks.iter().filter(|p| inside(p.frequency)).map(|p| p.height).fold(0.0, f64::max);
    let strong = peaks.iter().filter(|p| p.frequency < band.low && p.height >= STRONG * own);
    let harmonics = strong.flat_map(|p| {
        let line = |order: u32| Intruder::Harmonic {
            order,
            of: p.frequency,
            frequency: f64::from(order) * p.frequency,
        };
        HARMONICS.into_iter().filter(|order| inside(f64::from(*order) * p.frequency)).map(line)
    });
    let multiples = |base: f64| {
        let (first, last) = ((band.low / base).ceil() as u32, (band.high / base).floor() as u32);
        (first.max(1)..=last.min(HIGHEST)).map(move |order| (base, order))
    };
    // 300 Hz is a multiple of both: it is named once.
    let twice = |(base, order): &(f64, u32)| {
        *base == MAINS[1] && (base * f64::from(*order) / MAINS[0]).fract() == 0.0
    };
    let all = MAINS.into_iter().flat_map(multiples).filter(|line| !twice(line));
    let mains = all.filter_map(|(base, order)| mains(x, dt, base, order));
    Ok(harmonics.chain(mains).collect())
}

/// A line at a multiple of the mains, when it stands out and does not decay.
fn mains(x: &[f64], dt: f64, base: f64, order: u32) -> Option<Intruder> {
    let third = x.len() / 3;
    let (early, late) = (&x[..third], &x[2 * third..]);
    let centre = base * f64::from(order);
    let line = 1.0 / (late.len() as f64 * dt);
    // Lines of the window's own width around the middle, and what stands beside them.
    let reach = (WANDER / line).ceil() as i32;
    if f64::from(reach + 12) * line > 0.5 * centre {
        return None;
    }
    let at = |part: &[f64], k: i32| line_of(part, dt, centre + f64::from(k) * line);
    let top = (-reach..=reach).max_by(|&i, &j| at(late, i).total_cmp(&at(late, j)))?;
    let amplitude = at(late, top);
    let beside = |side: i32| (3..12).map(|k| at(late, top + side * k)).sum::<f64>() / 9.0;
    let around = (-reach..=reach).map(|k| at(early, k)).fold(0.0, f64::max);
    let steady = around < STEADY * amplitude && amplitude < STEADY * around;
    let stands = amplitude > STANDS * beside(1).max(beside(-1));
    (steady && stands).then_some(Intruder::Mains { base, order, amplitude })
}

/// Amplitude at a frequency under a Hann window.
fn line_of(x: &[f64], dt: f64, frequency: f64) -> f64 {
    let n = x.len() as f64;
    let turn = Complex64::cis(-TAU * frequency * dt);
    let (mut phase, mut sum) = (Complex64::new(1.0, 0.0), Complex64::default());
    for (i, x) in x.iter().enumerate() {
        // Turned step by step, and set right now and then.
        if i % 1024 == 0 {
            phase = Complex64::cis(-TAU * (frequency * dt * i as f64).fract());
        }
        sum += phase * (x * (PI * (i as f64 + 0.5) / n).sin().powi(2));
        phase *= turn;
    }
    4.0 * sum.norm() / n
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(hum: f64) -> Vec<f64> {
        let wave = |t: f64| (-1.5 * t).exp() * (TAU * 160.0 * t).sin() + hum * (TAU * 149.95 * t).sin();
        (0..40_000).map(|n| wave(f64::from(n) / 5000.0)).collect()
    }

    #[test]
    fn the_mains_are_told_from_a_mode_beside_them() {
        let band = Band { low: 120.0, high: 190.0, peak: 160.0 };
        assert_eq!(intruders(&record(0.0), 2e-4, &band).unwrap(), []);
        let found = intruders(&record(0.01), 2e-4, &band).unwrap();
        let [Intruder::Mains { base: 50.0, order: 3, amplitude }] = found[..] else { panic!("{found:?}") };
        assert!((amplitude / 0.01 - 1.0).abs() < 0.3, "{amplitude}");
        assert!(found[0].to_string().contains("150 Hz"));
    }

    #[test]
    fn a_mode_at_a_multiple_of_the_mains_decays_and_is_none() {
        let wave = |t: f64| (-1.5 * t).exp() * (TAU * 150.0 * t).sin();
        let x: Vec<f64> = (0..20_000).map(|n| wave(f64::from(n) / 5000.0)).collect();
        let band = Band { low: 120.0, high: 190.0, peak: 150.0 };
        assert_eq!(intruders(&x, 2e-4, &band).unwrap(), []);
    }
}
