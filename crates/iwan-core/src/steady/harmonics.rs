//! The set of harmonics of a steady motion, and the motion's value and slopes at an angle.

use crate::error::{Error, check_length};

/// The highest harmonic of a steady motion that is allowed; it determines the fixed memory of [`SteadyWork`](super::SteadyWork) (130 kB). A
/// higher one is refused. Forced responses need 3 to 15 harmonics; the detail of a motion beyond the 31st has no effect on a joint.
pub const MOST_HARMONICS: usize = 31;

/// Largest number of coefficients of a motion: the mean, and a cosine and a sine of each harmonic.
pub(super) const MOST_COEFFICIENTS: usize = 2 * MOST_HARMONICS + 1;

/// The harmonics of a steady motion u(θ) = a_0 + Σ a_n cos nθ + b_n sin nθ, θ = Ω t.
///
/// The order of the coefficients is a_1, b_1, a_3, b_3, … for [`odd`](Self::odd) and a_0, a_1, b_1, a_2, b_2, … for
/// [`all`](Self::all).
///
/// ```
/// use iwan_core::Harmonics;
/// assert_eq!(Harmonics::odd(7)?.len(), 8);
/// assert_eq!(Harmonics::all(7)?.len(), 15);
/// assert_eq!(Harmonics::odd(5)?.orders().collect::<Vec<_>>(), [1, 3, 5]);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Harmonics {
    highest: usize,
    odd: bool,
}

impl Harmonics {
    /// The odd harmonics up to `highest` (odd, 1 to 31), for motions whose second half period repeats the first with the opposite sign, as
    /// with joints under forces without even harmonics. They need half the unknowns and half the work.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn odd(highest: usize) -> Result<Self, Error> {
        let allowed = "must be an odd number from 1 to 31";
        let ok = highest % 2 == 1 && highest <= MOST_HARMONICS;
        crate::error::check("harmonics", highest as f64, ok, allowed)?;
        Ok(Self { highest, odd: true })
    }

    /// The mean and all harmonics up to `highest` (1 to 31).
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn all(highest: usize) -> Result<Self, Error> {
        let ok = (1..=MOST_HARMONICS).contains(&highest);
        crate::error::check("harmonics", highest as f64, ok, "must be a number from 1 to 31")?;
        Ok(Self { highest, odd: false })
    }

    /// The highest harmonic.
    #[must_use]
    pub const fn highest(self) -> usize {
        self.highest
    }

    /// Whether there are odd harmonics only.
    #[must_use]
    pub const fn is_odd(self) -> bool {
        self.odd
    }

    /// Number of coefficients.
    #[expect(clippy::len_without_is_empty, reason = "there is always a first harmonic")]
    #[must_use]
    pub const fn len(self) -> usize {
        if self.odd { self.highest + 1 } else { 2 * self.highest + 1 }
    }

    /// The harmonics, ascending; 0 stands for the mean.
    pub fn orders(self) -> impl Iterator<Item = usize> + Clone {
        let (first, step) = if self.odd { (1, 2) } else { (0, 1) };
        (first..=self.highest).step_by(step)
    }

    /// Index of the cosine coefficient of the harmonic `n`; the sine coefficient is the next one.
    #[must_use]
    pub const fn index(self, n: usize) -> usize {
        if self.odd {
            n - 1
        } else if n == 0 {
            0
        } else {
            2 * n - 1
        }
    }

    /// The angle after which the motion repeats; with odd harmonics it repeats with the opposite sign.
    pub(super) const fn period(self) -> f64 {
        if self.odd { core::f64::consts::PI } else { 2.0 * core::f64::consts::PI }
    }

    /// Difference between successive harmonics.
    pub(super) const fn step(self) -> usize {
        if self.odd { 2 } else { 1 }
    }

    /// Values at an angle of the functions 1, cos nθ, sin nθ that belong to all coefficients.
    pub(super) fn shapes(self, theta: f64, out: &mut [f64]) {
        let (sine, cosine) = libm::sincos(theta);
        let step = if self.odd { turned([cosine, sine], [cosine, sine]) } else { [cosine, sine] };
        let mut z = if self.odd { [cosine, sine] } else { [1.0, 0.0] };
        for n in self.orders() {
            let at = self.index(n);
            out[at] = z[0];
            if n > 0 {
                out[at + 1] = z[1];
            }
            z = turned(z, step);
        }
    }
}

/// The product of two complex numbers.
pub(super) fn turned(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// A motion: its coefficients, and a bound of its third derivative.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course<'a> {
    pub(super) harmonics: Harmonics,
    pub(super) coefficients: &'a [f64],
    /// Σ n³ √(a_n² + b_n²), a bound of the third derivative at all angles.
    pub(super) third: f64,
}

/// Value, slope and curvature of a motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Local {
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl<'a> Course<'a> {
    /// # Errors
    /// [`Error::Length`], [`Error::Entry`] where a coefficient is not finite.
    pub(super) fn new(harmonics: Harmonics, coefficients: &'a [f64]) -> Result<Self, Error> {
        check_length("displacement", coefficients.len(), harmonics.len())?;
        if let Some(index) = coefficients.iter().position(|c| !c.is_finite()) {
            let (value, allowed) = (coefficients[index], "must be a finite number");
            return Err(Error::Entry { name: "displacement", index, value, allowed });
        }
        let size = |n: usize| {
            let at = harmonics.index(n);
            (n * n * n) as f64 * libm::hypot(coefficients[at], coefficients[at + 1])
        };
        let third = harmonics.orders().filter(|&n| n > 0).map(size).sum();
        Ok(Self { harmonics, coefficients, third })
    }

    /// Value, slope and curvature at an angle.
    pub(super) fn at(&self, theta: f64) -> Local {
        let (sine, cosine) = libm::sincos(theta);
        self.at_point([cosine, sine])
    }

    /// Value, slope and curvature at the angle whose cosine and sine are `first`.
    pub(super) fn at_point(&self, first: [f64; 2]) -> Local {
        let odd = self.harmonics.odd;
        let step = if odd { turned(first, first) } else { first };
        let (mut value, mut slope, mut curvature) = (if odd { 0.0 } else { self.coefficients[0] }, 0.0, 0.0);
        let mut z = first;
        let mut n = 1.0;
        let pairs = &self.coefficients[usize::from(!odd)..];
        for pair in pairs.chunks_exact(2) {
            let along = pair[0] * z[0] + pair[1] * z[1];
            value += along;
            slope += n * (pair[1] * z[0] - pair[0] * z[1]);
            curvature -= n * n * along;
            n += self.harmonics.step() as f64;
            z = turned(z, step);
        }
        Local { value, slope, curvature }
    }

    /// The angle at which the motion has the value `target`, between the angles `low` and `high`; between them the motion must be monotone
    /// and pass `target`.
    pub(super) fn reaches(&self, target: f64, low: f64, high: f64) -> f64 {
        let rising = self.at(high).value > self.at(low).value;
        bracketed(low, high, |theta| {
            let here = self.at(theta);
            let gap = if rising { here.value - target } else { target - here.value };
            (gap, if rising { here.slope } else { -here.slope })
        })
    }
}

/// Largest number of rounds for a root: Newton's method takes four to eight, and halving alone reaches rounding after 52. When it is
/// reached, the last angle is used.
const MOST_ROUNDS: u32 = 60;

/// The root of a function (value and slope) that rises from negative at `low` to positive at `high`.
pub(super) fn bracketed(mut low: f64, mut high: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut at = 0.5 * (low + high);
    for _ in 0..MOST_ROUNDS {
        let (value, slope) = f(at);
        if value > 0.0 {
            high = at;
        } else {
            low = at;
        }
        let newton = at - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - at).abs() <= f64::EPSILON * (1.0 + at.abs()) {
            return next;
        }
        at = next;
    }
    at
}
