//! Zero-phase Butterworth filter in second-order sections, equal to SciPy's `butter` and `sosfiltfilt`.
//!
//! Written here because the ready-made one (sci-rs 0.4.1) panics on short records and brings a second linear algebra
//! with it. Sections of a band-pass carry one zero at 0 Hz and one at the Nyquist frequency each, where SciPy pairs
//! zeros by distance: the product is the same, and here every section by itself stops an offset.

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use crate::error::{Error, check, check_dt, check_samples};

/// What passes, in Hz; the edges are the half-power frequencies of one pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Passband {
    /// Everything below.
    Low(f64),
    /// Everything above.
    High(f64),
    /// Between two frequencies.
    Band {
        /// Lower edge, Hz.
        low: f64,
        /// Upper edge, Hz.
        high: f64,
    },
}

/// One second-order section (b0 + b1/z + b2/z²) / (1 + a1/z + a2/z²).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
    /// State of the section's two delays when the input of the whole filter is constantly 1.
    steady: [f64; 2],
}

/// A Butterworth filter for records of one sampling interval.
///
/// ```
/// use iwan_ident::signal::{Butterworth, Passband};
/// let dt = 1e-3;
/// let filter = Butterworth::new(3, Passband::Band { low: 60.0, high: 105.0 }, dt)?;
/// // Half power at the edges, by definition; nothing of an offset.
/// assert!((filter.gain(60.0).powi(2) - 0.5).abs() < 1e-10);
/// let offset = filter.forward_backward(&[1.0; 64])?;
/// assert!(offset.iter().all(|y| y.abs() < 1e-12));
/// # Ok::<(), iwan_ident::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Butterworth {
    sections: Vec<Section>,
    poles: usize,
    dt: f64,
}

impl Butterworth {
    /// Filter of `order` (1 to 10; a band-pass has twice as many poles) for samples every `dt` seconds.
    ///
    /// Analogue prototype, frequency transformation, bilinear transformation with prewarped edges: as
    /// `scipy.signal.butter(order, edges, fs=1/dt, output="sos")`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when an edge is not between 0 and the Nyquist frequency, the edges are not in ascending
    /// order, or `order` or `dt` is out of range.
    pub fn new(order: usize, pass: Passband, dt: f64) -> Result<Self, Error> {
        let nyquist = 0.5 / check_dt(dt)?;
        check("order", order as f64, (1..=10).contains(&order), "1 to 10", "3 is a good choice")?;
        let warp = |name, edge| warped(name, edge, nyquist);
        // Prototype poles on the left unit half circle, the upper half of them and the real one.
        let prototype = |k: usize| Complex64::from_polar(1.0, PI * (0.5 + (k as f64 + 0.5) / order as f64));
        let upper = (0..order.div_ceil(2)).map(prototype);
        let sections: Vec<Section> = match pass {
            Passband::Low(edge) => {
                let w = warp("upper edge", edge)?;
                upper.map(|p| one_sided(p * w, -1.0, Complex64::new(1.0, 0.0))).collect()
            }
            Passband::High(edge) => {
                let w = warp("lower edge", edge)?;
                upper.map(|p| one_sided(w / p, 1.0, Complex64::new(-1.0, 0.0))).collect()
            }
            Passband::Band { low, high } => {
                let (w1, w2) = (warp("lower edge", low)?, warp("upper edge", high)?);
                let allowed = format!("below the upper edge {high} Hz");
                check("lower edge", low, low < high, &allowed, "give the band as low:high")?;
                let centre = Complex64::from_polar(1.0, 2.0 * (w1 * w2).sqrt().atan());
                upper.flat_map(|p| band_sections(p, w2 - w1, w1 * w2, centre)).collect()
            }
        };
        let poles = if matches!(pass, Passband::Band { .. }) { 2 * order } else { order };
        let mut filter = Self { sections, poles, dt };
        filter.settle();
        Ok(filter)
    }

    /// Steady state of each section under a constant 1 at the filter's input (`scipy.signal.sosfilt_zi`).
    fn settle(&mut self) {
        let mut input = 1.0;
        for Section { b, a, steady } in &mut self.sections {
            let output = input * (b[0] + b[1] + b[2]) / (1.0 + a[0] + a[1]);
            let last = b[2] * input - a[1] * output;
            *steady = [b[1] * input - a[0] * output + last, last];
            input = output;
        }
    }

    /// Sampling interval in seconds.
    #[must_use]
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Samples added at each end before filtering: 3 (poles + 1), SciPy's default.
    #[must_use]
    pub fn padding(&self) -> usize {
        3 * (self.poles + 1)
    }

    /// Gain of one pass at `frequency` (Hz); forward-backward filtering has the square of it and no phase.
    #[must_use]
    pub fn gain(&self, frequency: f64) -> f64 {
        let z = Complex64::from_polar(1.0, -2.0 * PI * frequency * self.dt);
        let each =
            |s: &Section| ((s.b[0] + z * (s.b[1] + z * s.b[2])) / (1.0 + z * (s.a[0] + z * s.a[1]))).norm();
        self.sections.iter().map(each).product()
    }

    /// Memory of the filter in seconds: the time in which its response to an impact falls to 1/e, by its slowest pole.
    #[must_use]
    pub fn memory(&self) -> f64 {
        let radius = |s: &Section| {
            let root = Complex64::new(0.25 * s.a[0] * s.a[0] - s.a[1], 0.0).sqrt();
            (root - 0.5 * s.a[0]).norm().max((root + 0.5 * s.a[0]).norm())
        };
        let slowest = self.sections.iter().map(radius).fold(0.0, f64::max);
        -self.dt / slowest.ln()
    }

    /// Filters forward and backward: no phase, squared gain. Equal to `scipy.signal.sosfiltfilt` with its default
    /// odd padding and initial states, to 1e-10 of the largest sample.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; [`Error::TooShort`] unless `x` has more than [`padding`](Self::padding) samples.
    pub fn forward_backward(&self, x: &[f64]) -> Result<Vec<f64>, Error> {
        let edge = self.padding();
        let remedy = "record longer, or choose a lower filter order";
        check_samples("record", x, edge + 1, remedy)?;
        let n = x.len();
        let mut y = Vec::with_capacity(n + 2 * edge);
        y.extend((1..=edge).rev().map(|i| 2.0 * x[0] - x[i]));
        y.extend_from_slice(x);
        y.extend((2..=edge + 1).map(|i| 2.0 * x[n - 1] - x[n - i]));
        let first = y[0];
        self.pass(first, y.iter_mut());
        let last = y[y.len() - 1];
        self.pass(last, y.iter_mut().rev());
        y.truncate(edge + n);
        y.drain(..edge);
        Ok(y)
    }

    /// One pass in place (direct form II transposed), from the steady state of the constant `level`.
    fn pass<'a>(&self, level: f64, samples: impl Iterator<Item = &'a mut f64>) {
        let mut state: Vec<[f64; 2]> = self.sections.iter().map(|s| s.steady.map(|z| z * level)).collect();
        for sample in samples {
            let mut value = *sample;
            for (Section { b, a, .. }, z) in self.sections.iter().zip(&mut state) {
                let input = value;
                value = b[0] * input + z[0];
                z[0] = b[1] * input - a[0] * value + z[1];
                z[1] = b[2] * input - a[1] * value;
            }
            *sample = value;
        }
    }
}

/// Analogue frequency tan(π f/fs) of an edge: the bilinear transformation s = (z-1)/(z+1) brings it back to f.
fn warped(name: &'static str, edge: f64, nyquist: f64) -> Result<f64, Error> {
    let allowed = format!("between 0 and the Nyquist frequency {nyquist} Hz, both excluded");
    check(name, edge, edge > 0.0 && edge < nyquist, &allowed, "move the band, or sample faster")?;
    Ok((0.5 * PI * edge / nyquist).tan())
}

/// The pole s mapped to the z plane by the bilinear transformation.
fn bilinear(s: Complex64) -> Complex64 {
    (1.0 + s) / (1.0 - s)
}

/// Section with the pole pair (s, s*), or the single real pole s, and its zeros at z = `zero`; gain 1 at `at`.
fn one_sided(s: Complex64, zero: f64, at: Complex64) -> Section {
    let p = bilinear(s);
    // The imaginary part of a real pole is rounding; complex poles keep away from the real axis by sin(π/20) of their modulus.
    let (b, a) = if s.im.abs() < 1e-9 * s.norm() {
        ([1.0, -zero, 0.0], [-p.re, 0.0])
    } else {
        ([1.0, -2.0 * zero, 1.0], [-2.0 * p.re, p.norm_sqr()])
    };
    scaled(b, a, at)
}

/// The sections of a band-pass from one prototype pole: roots of s² - p B s + W² = 0.
fn band_sections(p: Complex64, width: f64, centre_squared: f64, at: Complex64) -> Vec<Section> {
    let half = 0.5 * width * p;
    let root = (half * half - centre_squared).sqrt();
    let pair = [bilinear(half + root), bilinear(half - root)];
    let b = [1.0, 0.0, -1.0];
    if p.im.abs() < 1e-9 {
        // Two conjugate or two real poles share a section.
        return vec![scaled(b, [-(pair[0] + pair[1]).re, (pair[0] * pair[1]).re], at)];
    }
    pair.map(|z| scaled(b, [-2.0 * z.re, z.norm_sqr()], at)).to_vec()
}

/// Scales a section to gain 1 at the point `at` of the unit circle.
fn scaled(b: [f64; 3], a: [f64; 2], at: Complex64) -> Section {
    let z = at.inv();
    let gain = ((b[0] + z * (b[1] + z * b[2])) / (1.0 + z * (a[0] + z * a[1]))).norm();
    Section { b: b.map(|c| c / gain), a, steady: [0.0; 2] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An input that is exact in any language: x[n] = ((37 n + 11) mod 101 - 50)/32 + (n² mod 23)/16.
    fn input() -> Vec<f64> {
        (0..400_i32)
            .map(|n| f64::from((37 * n + 11) % 101 - 50) / 32.0 + f64::from(n * n % 23) / 16.0)
            .collect()
    }

    /// SciPy 1.17.1: `y = sosfiltfilt(butter(order, edges, kind, fs=fs, output="sos"), x)`; `y[[0, 1, 17, 100,
    /// 250, 398, 399]]` and `abs(y).sum()`.
    fn assert_scipy(order: usize, pass: Passband, fs: f64, golden: [f64; 7], sum: f64) {
        let y = Butterworth::new(order, pass, 1.0 / fs).unwrap().forward_backward(&input()).unwrap();
        for (i, expected) in [0, 1, 17, 100, 250, 398, 399].into_iter().zip(golden) {
            assert!((y[i] - expected).abs() < 1e-10, "{pass:?} {i}: {} {expected}", y[i]);
        }
        let found: f64 = y.iter().map(|v| v.abs()).sum();
        assert!((found / sum - 1.0).abs() < 1e-10, "{pass:?}: {found} {sum}");
    }

    #[test]
    fn equals_scipy_band_pass() {
        let golden = [
            -0.0027935782256655883,
            0.4565485436024928,
            0.29246433664323995,
            -0.20074933035549067,
            -0.08368090004810663,
            0.11970392788677967,
            0.060156684465844934,
        ];
        assert_scipy(3, Passband::Band { low: 60.0, high: 105.0 }, 1000.0, golden, 84.71180124128888);
        let golden = [
            -0.0029759339081266898,
            -0.002603923667275963,
            0.0031412142469571533,
            -0.0014426849468033116,
            0.00018757443005897265,
            -1.0731129813287986e-06,
            -9.10025296695687e-07,
        ];
        assert_scipy(4, Passband::Band { low: 120.0, high: 135.0 }, 12800.0, golden, 0.44130496645921813);
        let golden = [
            0.0024367689869824183,
            0.9526421350379858,
            -0.1927818646117807,
            1.2045913594368327,
            0.4361603454959689,
            1.3056989675825044,
            0.004099634387761231,
        ];
        assert_scipy(2, Passband::Band { low: 60.0, high: 400.0 }, 1000.0, golden, 267.69553219528893);
    }

    #[test]
    fn equals_scipy_low_and_high_pass() {
        let golden = [
            -1.2143321069570119,
            -0.4954684494431464,
            0.8210536663071331,
            0.4321552618344595,
            0.3977827647102831,
            0.4468172946628397,
            0.4383637377967896,
        ];
        assert_scipy(5, Passband::Low(90.0), 1000.0, golden, 202.07496374576039);
        let golden = [
            -0.008439566767386664,
            0.5073250529796443,
            -0.4570851581889077,
            1.5055223244756446,
            0.7969773105781175,
            1.0199866597743907,
            0.024606155310291644,
        ];
        assert_scipy(3, Passband::High(90.0), 1000.0, golden, 314.5674200616223);
        let golden = [
            -0.0023211808207921347,
            0.504643498705649,
            -0.3977863463822854,
            1.449386404915368,
            0.7646924667340833,
            0.8871447591038503,
            -0.03592675827174846,
        ];
        assert_scipy(1, Passband::High(90.0), 1000.0, golden, 306.07353325265024);
    }

    #[test]
    fn zero_phase_and_squared_gain_on_a_sine() {
        let filter = Butterworth::new(3, Passband::Band { low: 60.0, high: 105.0 }, 1e-3).unwrap();
        let wave = |n: usize| (2.0 * PI * 64.0 * n as f64 * 1e-3).sin();
        let x: Vec<f64> = (0..4000).map(wave).collect();
        let y = filter.forward_backward(&x).unwrap();
        let gain = filter.gain(64.0).powi(2);
        assert!((1500..2500).all(|n| (y[n] - gain * x[n]).abs() < 1e-9));
    }

    #[test]
    fn memory_of_a_first_order_low_pass_is_its_time_constant() {
        let filter = Butterworth::new(1, Passband::Low(1.0), 1e-5).unwrap();
        assert!((filter.memory() * 2.0 * PI - 1.0).abs() < 1e-6);
    }

    #[test]
    fn refusals_name_the_value_and_the_range() {
        let new = |order, pass, dt| Butterworth::new(order, pass, dt).unwrap_err().to_string();
        let message = new(3, Passband::Band { low: 60.0, high: 600.0 }, 1e-3);
        assert!(message.contains("upper edge = 600") && message.contains("500 Hz"), "{message}");
        let message = new(3, Passband::Band { low: 105.0, high: 60.0 }, 1e-3);
        assert!(message.contains("lower edge = 105"), "{message}");
        for pass in [Passband::Low(f64::NAN), Passband::Low(0.0), Passband::High(-1.0), Passband::Low(500.0)]
        {
            assert!(Butterworth::new(3, pass, 1e-3).is_err());
        }
        assert!(new(0, Passband::Low(1.0), 1e-3).contains("order"));
        assert!(new(3, Passband::Low(1.0), f64::NAN).contains("dt"));
        let filter = Butterworth::new(3, Passband::Band { low: 60.0, high: 105.0 }, 1e-3).unwrap();
        assert_eq!(filter.padding(), 21);
        assert!(matches!(filter.forward_backward(&[0.0; 21]), Err(Error::TooShort { needed: 22, .. })));
        assert!(filter.forward_backward(&[0.0; 22]).is_ok());
        let mut x = [0.0; 64];
        x[7] = f64::NAN;
        assert!(matches!(filter.forward_backward(&x), Err(Error::NotFinite { index: 7, .. })));
    }
}
