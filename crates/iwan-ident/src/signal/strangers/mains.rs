//! Lines of the mains in a mode's band: behind a decay where the mode has died away, and under a mode that is loud to the end.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use crate::signal::isolated::{Isolated, MAX_ORDER};
use crate::smooth::{Points, Polynomial, Smooth};

/// Frequencies of the mains in use, Hz.
const FREQUENCIES: [f64; 2] = [50.0, 60.0];
/// Highest multiple that is looked for: that up to which grids are judged (IEC 61000-4-7). Bands of kilohertz would hold thousands of further ones, which take time and are
/// not there.
const HIGHEST: u32 = 40;
/// Lines up to this distance outside the band, relative to the mode's frequency, are looked for as well: an automatic band ends between mode and line, and its filter lets a
/// part of the line pass.
pub(super) const BESIDE: f64 = 0.05;
/// The mains wander by this much, Hz: 0.2 Hz is the range in which grids of Europe and North America are kept.
const WANDER: f64 = 0.2;
/// A line of the mains stands out of its neighbours by at least this factor.
const STANDS: f64 = 5.0;
/// Behind the decay a line of the mains is as high in the middle third of the record as in the last, within this factor: it does not decay. Noise lets a line that just stands
/// out differ by a third.
const STEADY: f64 = 1.4;
/// The same factor for a line at the band's own peak, which may be the mode: the two thirds of a mode differ by more than this, else its record would tell nothing of damping.
const EVEN: f64 = 1.03;
/// Least share of the residual of a smooth mode that one line explains, where the mode is loud. Noise and a joint's bend leave no line. A judgement.
const SHARE: f64 = 0.5;
/// Least number of beats of the line with the mode: with fewer a smooth curve is as good an explanation.
const BEATS: f64 = 3.0;
/// Largest number of frequencies on either side of a multiple at which a line is looked for within the mains' wander. Decays longer than 40 s would need more; for them only the
/// time behind the decay is looked at, where lines are told apart.
const MOST_PLACES: i32 = 32;

/// A line of the mains: its base frequency (Hz), the multiple of it, and its amplitude in the unit of the record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) base: f64,
    pub(super) order: u32,
    pub(super) amplitude: f64,
}

/// The lines of the mains in the band of `mode`, or next to it; `x` is the record that the mode was taken out of.
pub(super) fn lines(mode: &Isolated, x: &[f64]) -> Vec<Line> {
    let beside = BESIDE * mode.band.peak;
    let (low, high) = (mode.band.low - beside, mode.band.high + beside);
    let multiples = |base: f64| {
        let (first, last) = ((low / base).ceil() as u32, (high / base).floor() as u32);
        (first.max(1)..=last.min(HIGHEST)).map(move |order| (base, order))
    };
    // 300 Hz is a multiple of both 50 and 60 Hz: it is named once.
    let twice = |(base, order): &(f64, u32)| {
        *base == FREQUENCIES[1] && (base * f64::from(*order) / FREQUENCIES[0]).fract() == 0.0
    };
    let loud = Loud::new(mode);
    let all = FREQUENCIES.into_iter().flat_map(multiples).filter(|line| !twice(line));
    let line = |(base, order)| {
        let frequency = base * f64::from(order);
        let amplitude = behind(mode, x, frequency).or_else(|| loud.as_ref()?.line_near(frequency))?;
        Some(Line { base, order, amplitude })
    };
    all.filter_map(line).collect()
}

/// Whether a frequency (Hz) known to within `line` (Hz) may be a multiple of the mains.
pub(super) fn is_multiple(frequency: f64, line: f64) -> bool {
    FREQUENCIES.iter().any(|base| {
        let order = (frequency / base).round();
        (1.0..=f64::from(HIGHEST)).contains(&order) && (frequency - order * base).abs() < WANDER + 0.5 * line
    })
}

/// Amplitude of a line about `frequency` (Hz) that stands out of the last third of a record and is as high in the middle third; none where there is none, or where it is the
/// mode.
fn behind(mode: &Isolated, x: &[f64], frequency: f64) -> Option<f64> {
    let (dt, third) = (mode.dt, x.len() / 3);
    let (middle, late) = (&x[third..2 * third], &x[2 * third..]);
    let line = 1.0 / (late.len() as f64 * dt);
    // Number of lines, as far apart as a third of the record resolves, over which the mains may wander.
    let reach = (WANDER / line).ceil() as i32;
    let is_mode = (mode.band.peak - frequency).abs() < WANDER + 2.0 * line;
    let within = if is_mode { EVEN } else { STEADY };
    if f64::from(reach + 12) * line > 0.5 * frequency {
        return None;
    }
    let at = |part: &[f64], k: i32| line_of(part, dt, frequency + f64::from(k) * line);
    let top = (-reach..=reach).max_by(|&i, &j| at(late, i).total_cmp(&at(late, j)))?;
    let amplitude = at(late, top);
    // The median, because the mode may stand there too.
    let beside = |side: i32| {
        let mut beside: Vec<f64> = (3..12).map(|k| at(late, top + side * k)).collect();
        *beside.select_nth_unstable_by(4, f64::total_cmp).1
    };
    let around = (-reach..=reach).map(|k| at(middle, k)).fold(0.0, f64::max);
    let steady = around < within * amplitude && amplitude < within * around;
    // Lines on the skirt of the mode's own line rise towards the mode.
    let is_top = [-1, 1].iter().all(|side| at(late, top + side) < amplitude);
    let stands = is_top && amplitude > STANDS * beside(1).max(beside(-1));
    (steady && stands).then_some(amplitude)
}

/// Amplitude at `frequency` (Hz) under a Hann window.
fn line_of(x: &[f64], dt: f64, frequency: f64) -> f64 {
    let n = x.len() as f64;
    let turn = Complex64::cis(-TAU * frequency * dt);
    let (mut phase, mut sum) = (Complex64::new(1.0, 0.0), Complex64::default());
    for (i, x) in x.iter().enumerate() {
        // The phase is turned step by step, and set anew now and then against rounding.
        if i % 1024 == 0 {
            phase = Complex64::cis(-TAU * (frequency * dt * i as f64).fract());
        }
        sum += phase * (x * (PI * (i as f64 + 0.5) / n).sin().powi(2));
        phase *= turn;
    }
    4.0 * sum.norm() / n
}

/// The analytic signal z of a mode in its window. The logarithm of z is a polynomial in time except for what does not belong to the mode: a line h e^{iωt} adds h e^{iωt}/z
/// to it.
struct Loud<'a> {
    t: &'a [f64],
    /// Frequency (Hz) that the phase of z is relative to.
    centre: f64,
    /// The analytic signal, in the unit of the record.
    z: Vec<Complex64>,
    /// ln z less its polynomial, times |z|: the residual, in the unit of the record.
    left: Vec<Complex64>,
}

impl<'a> Loud<'a> {
    fn new(mode: &'a Isolated) -> Option<Self> {
        let raw = &mode.raw;
        (raw.t.len() > 4 * MAX_ORDER).then_some(())?;
        let log: Vec<Complex64> =
            raw.log_amplitude.iter().zip(&raw.phase).map(|(a, p)| Complex64::new(*a, *p)).collect();
        let z = log.iter().map(|log| log.exp()).collect();
        let mut loud = Self { t: &raw.t, centre: mode.band.peak, z, left: vec![] };
        loud.left = loud.without_polynomial(&log);
        Some(loud)
    }

    /// What a polynomial leaves of `ratios`, which are values over z, times |z|.
    fn without_polynomial(&self, ratios: &[Complex64]) -> Vec<Complex64> {
        let weight: Vec<f64> = self.z.iter().map(Complex64::norm_sqr).collect();
        let rest = |part: fn(&Complex64) -> f64| -> Vec<f64> {
            let y: Vec<f64> = ratios.iter().map(part).collect();
            let points = Points { t: self.t, y: &y, weight: &weight, effective: y.len() as f64 };
            let fit = Polynomial::fit(&points, Some(MAX_ORDER), MAX_ORDER);
            self.t.iter().zip(&y).map(|(t, y)| y - fit.at(*t).value).collect()
        };
        let (real, imaginary) = (rest(|r| r.re), rest(|r| r.im));
        real.iter()
            .zip(&imaginary)
            .zip(&self.z)
            .map(|((re, im), z)| Complex64::new(*re, *im) * z.norm())
            .collect()
    }

    /// A line of amplitude one divided by z, at an offset (Hz) from the centre.
    fn ratios(&self, offset: f64) -> Vec<Complex64> {
        self.t.iter().zip(&self.z).map(|(t, z)| Complex64::cis(TAU * (offset * t).fract()) / z).collect()
    }

    /// Share of the residual's power that a line at an offset (Hz) explains, if the polynomial took up nothing of the line.
    fn part(&self, offset: f64) -> f64 {
        let turned = |((t, z), left): ((&f64, &Complex64), &Complex64)| {
            let line = Complex64::cis(TAU * (offset * t).fract()) / z * z.norm();
            line.conj() * left
        };
        let sum: Complex64 = self.t.iter().zip(&self.z).zip(&self.left).map(turned).sum();
        sum.norm_sqr() / (self.t.len() as f64 * power(&self.left))
    }

    /// Amplitude of a line about `frequency` (Hz) that explains most of the residual of a smooth mode; none without such a line.
    fn line_near(&self, frequency: f64) -> Option<f64> {
        let seconds = self.t[self.t.len() - 1] - self.t[0];
        let (offset, apart) = (frequency - self.centre, 0.25 / seconds);
        let reach = (WANDER / apart).ceil() as i32;
        if (offset.abs() - WANDER) * seconds < BEATS || reach > MOST_PLACES {
            return None;
        }
        let place = |k: i32| offset + f64::from(k) * apart;
        let top = (-reach..=reach).max_by(|&i, &j| self.part(place(i)).total_cmp(&self.part(place(j))))?;
        // Compared with lines on either side, a width and more away, and with the image about the mode's own frequency, where a bend of amplitude or frequency leaves as much.
        let beside = (2..8).flat_map(|k| [4 * k, -4 * k]).map(|k| self.part(place(top + k)));
        let highest = beside.chain([self.part(-place(top))]).fold(0.0, f64::max);
        if self.part(place(top)) < STANDS * highest {
            return None;
        }
        self.amplitude(place(top))
    }

    /// Amplitude of the line at an offset (Hz) by least squares beside the polynomial; none where the line explains too little of the residual.
    fn amplitude(&self, offset: f64) -> Option<f64> {
        let without = self.without_polynomial(&self.ratios(offset));
        let sum: Complex64 = without.iter().zip(&self.left).map(|(line, left)| line.conj() * left).sum();
        let (lines, all) = (power(&without), power(&self.left));
        (sum.norm_sqr() > SHARE * lines * all).then(|| sum.norm() / lines)
    }
}

fn power(values: &[Complex64]) -> f64 {
    values.iter().map(Complex64::norm_sqr).sum()
}
