//! A population of N Jenkins elements in a slice that the caller provides.
//!
//! The table is sorted by strength and carries running sums, so that the force of the whole population takes one look-up (see
//! [`Runs`](crate::Runs)).

use crate::error::{Error, check, check_length};
use crate::law::{Backbone, Breakaway, Grid, jenkins_harmonic};

/// One Jenkins element and the running sums up to it: 32 bytes, half a cache line.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slider {
    /// Strength φ: the extension at which it slips (length).
    pub(crate) strength: f64,
    /// Stiffness k of the element.
    pub(crate) stiffness: f64,
    /// Σ k φ of all weaker sliders.
    pub(crate) slip_force_below: f64,
    /// Σ k of this and all stronger sliders.
    pub(crate) stiffness_from: f64,
}

/// A population of sliders on a borrowed table.
///
/// ```
/// use iwan_core::{Backbone, FourParameter, Grid, Slider, Sliders};
/// let joint = FourParameter::new(2.75e5, 300.0, -0.3, 0.02)?;
/// let mut table = [Slider::default(); Sliders::table_len(100)];
/// let sliders = Sliders::discretise(&joint, Grid::graded(100), 100, &mut table)?;
/// assert_eq!(sliders.len(), 101); // 100 bins and the Dirac at φ_max
/// assert!((sliders.initial_stiffness() / 2.75e5 - 1.0).abs() < 1e-15);
/// assert!((sliders.slip_force() / 300.0 - 1.0).abs() < 1e-15);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Sliders<'a> {
    /// Sorted by strength; the last entry is a sentinel of infinite reach without stiffness.
    table: &'a [Slider],
    /// Ratio of dynamic to static friction.
    friction_ratio: f64,
}

/// Reach of the sentinel behind the last slider, farther than any motion. It is finite so that 0 · reach is 0 and not NaN.
const BEYOND: f64 = f64::MAX;

/// Smallest share of K_T, left over by the bins, that counts as a Dirac at the strongest slider. A smaller rest is rounding of K_T and of
/// the bins' sum (2e-16 for laws in closed form, somewhat more for a table of many points) and gets no slider; a real Dirac as weak as that
/// is dropped too.
const LEAST_DIRAC: f64 = 1e-14;

impl<'a> Sliders<'a> {
    /// Largest number of entries that [`discretise`](Self::discretise) needs for `bins` bins: the bins, the Dirac at the strongest slider
    /// and a sentinel. Entries that are not needed stay unchanged.
    #[must_use]
    pub const fn table_len(bins: usize) -> usize {
        bins + 2
    }

    /// Cuts a law's density into `bins` bins on a grid.
    ///
    /// Each bin becomes one slider with the bin's exact stiffness ∫ρ and slip force ∫ρφ, so that
    /// Σk = K_T and Σkφ = F_S hold to rounding; a Dirac at the strongest slider stays a slider of its own.
    ///
    /// # Errors
    /// [`Error::Length`] when `table` is shorter than [`table_len`](Self::table_len) or `bins` is 0;
    /// [`Error::OutOfRange`] for a grid whose `smallest` or `ratio` is out of range.
    pub fn discretise<B: Backbone + ?Sized>(
        law: &B,
        grid: Grid,
        bins: usize,
        table: &'a mut [Slider],
    ) -> Result<Self, Error> {
        if bins == 0 || table.len() < Self::table_len(bins) {
            return Err(Error::Length {
                name: "table",
                needed: Self::table_len(bins.max(1)),
                found: table.len(),
            });
        }
        let (low, high) = law.strengths();
        let edges = grid.edges(bins, [low, high])?;
        let (mut count, mut stiffness, mut slip) = (0, 0.0, 0.0);
        let mut push = |k: f64, phi: f64| {
            if k > 0.0 {
                table[count] = Slider { strength: phi, stiffness: k, ..Slider::default() };
                count += 1;
            }
        };
        for i in 1..=bins {
            if high <= low {
                break;
            }
            let (from, to) = (edges.upper(i - 1), edges.upper(i));
            let (k, f) = (law.stiffness_below(to), law.force_below(to));
            let (dk, df) = (k - stiffness, f - slip);
            // The centroid lies in its bin, except for rounding, which is clipped here.
            let lower = if i == 1 { low } else { from };
            push(dk, if dk > 0.0 { (df / dk).max(lower).min(to) } else { to });
            (stiffness, slip) = (k, f);
        }
        let dirac = law.initial_stiffness() - stiffness;
        if dirac > LEAST_DIRAC * law.initial_stiffness() {
            push(dirac, high);
        }
        Ok(Self { friction_ratio: law.friction_ratio(), ..Self::close(count, table) })
    }

    /// The same sliders with a ratio 0 < `theta` <= 1 of dynamic to static friction. A population with `theta` < 1 can be used by
    /// [`StickSlip`](crate::StickSlip) only.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for `theta`.
    pub fn dropping(self, theta: f64) -> Result<Self, Error> {
        check("theta", theta, theta > 0.0 && theta <= 1.0, "must satisfy 0 < theta <= 1")?;
        Ok(Self { friction_ratio: theta, ..self })
    }

    /// From `strength` φ_i >= 0 (ascending, ties allowed) and `stiffness` k_i > 0 of each slider;
    /// `table` has one entry more than there are sliders.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::Entry`] with the first entry out of order or range.
    pub fn from_elements(
        strength: &[f64],
        stiffness: &[f64],
        table: &'a mut [Slider],
    ) -> Result<Self, Error> {
        let n = strength.len();
        if n == 0 {
            return Err(Error::Length { name: "strength", needed: 1, found: 0 });
        }
        check_length("stiffness", stiffness.len(), n)?;
        check_length("table", table.len(), n + 1)?;
        for (index, (&phi, &k)) in strength.iter().zip(stiffness).enumerate() {
            let ordered = index == 0 || phi >= strength[index - 1];
            if !(phi >= 0.0 && phi.is_finite() && ordered) {
                let allowed = "must be finite, >= 0 and not descending";
                return Err(Error::Entry { name: "strength", index, value: phi, allowed });
            }
            if !(k > 0.0 && k.is_finite()) {
                let allowed = "must be a finite number > 0";
                return Err(Error::Entry { name: "stiffness", index, value: k, allowed });
            }
            table[index] = Slider { strength: phi, stiffness: k, ..Slider::default() };
        }
        Ok(Self::close(n, table))
    }

    /// Fills in the running sums (compensated, exact to the last bit or two) and the sentinel.
    fn close(count: usize, table: &'a mut [Slider]) -> Self {
        let mut below = Compensated::default();
        for slider in &mut table[..count] {
            slider.slip_force_below = below.value();
            below.add(slider.stiffness * slider.strength);
        }
        let end =
            Slider { strength: BEYOND, stiffness: 0.0, slip_force_below: below.value(), stiffness_from: 0.0 };
        table[count] = end;
        let mut from = Compensated::default();
        for slider in table[..count].iter_mut().rev() {
            from.add(slider.stiffness);
            slider.stiffness_from = from.value();
        }
        Self { table: &table[..=count], friction_ratio: 1.0 }
    }

    /// Number of sliders.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.table.len() - 1
    }

    /// Never true: a population has at least one slider.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Strength φ and stiffness k of each slider, weakest first.
    #[must_use]
    pub fn elements(&self) -> impl ExactSizeIterator<Item = (f64, f64)> + '_ {
        self.table[..self.len()].iter().map(|s| (s.strength, s.stiffness))
    }

    /// The table with its sentinel.
    #[inline]
    pub(crate) const fn table(&self) -> &'a [Slider] {
        self.table
    }

    fn breakaway(&self) -> Breakaway {
        Breakaway { ratio: self.friction_ratio }
    }

    fn total(&self) -> &Slider {
        &self.table[self.len()]
    }

    /// Index of the first slider that has not slipped at displacement |u| on the virgin curve.
    fn frontier(&self, u: f64) -> usize {
        self.table[..self.len()].partition_point(|s| s.strength <= u.abs())
    }
}

/// The population's own virgin curve, which is piecewise linear, and its cycles as reached from rest.
impl Backbone for Sliders<'_> {
    fn initial_stiffness(&self) -> f64 {
        self.table[0].stiffness_from
    }

    fn slip_force(&self) -> f64 {
        self.total().slip_force_below
    }

    fn friction_ratio(&self) -> f64 {
        self.friction_ratio
    }

    fn strengths(&self) -> (f64, f64) {
        (self.table[0].strength, self.table[self.len() - 1].strength)
    }

    fn force(&self, u: f64) -> f64 {
        let next = &self.table[self.frontier(u)];
        (self.friction_ratio * next.slip_force_below + next.stiffness_from * u.abs()).copysign(u)
    }

    fn tangent(&self, u: f64) -> f64 {
        self.table[self.frontier(u)].stiffness_from
    }

    fn energy(&self, u: f64) -> f64 {
        let u = u.abs();
        if self.friction_ratio != 1.0 {
            return self.elements().map(|(phi, k)| k * self.breakaway().energy(phi, u)).sum();
        }
        self.elements().map(|(phi, k)| k * phi.min(u) * (u - 0.5 * phi.min(u))).sum()
    }

    fn dissipation(&self, u: f64) -> f64 {
        let u = u.abs();
        if self.friction_ratio != 1.0 {
            let sliding = self.elements().take_while(|e| e.0 <= u);
            return sliding.map(|(phi, k)| k * self.breakaway().dissipation(phi, u)).sum();
        }
        4.0 * self.elements().take_while(|e| e.0 < u).map(|(phi, k)| k * phi * (u - phi)).sum::<f64>()
    }

    fn energy_at_turn(&self, u: f64) -> f64 {
        let u = u.abs();
        let spring = |phi: f64| if phi <= u { self.friction_ratio * phi } else { u };
        self.elements().map(|(phi, k)| 0.5 * k * spring(phi) * spring(phi)).sum()
    }

    fn harmonic_stiffness(&self, u: f64) -> f64 {
        let u = u.abs();
        if self.friction_ratio != 1.0 {
            let one = |phi| if phi <= u { self.breakaway().harmonic(phi, u) } else { 1.0 };
            return self.elements().map(|(phi, k)| k * if u > 0.0 { one(phi) } else { 1.0 }).sum();
        }
        self.elements().map(|(phi, k)| k * jenkins_harmonic(phi / u)).sum()
    }

    fn is_smooth(&self) -> bool {
        false
    }

    fn stiffness_below(&self, phi: f64) -> f64 {
        self.elements().take_while(|e| e.0 < phi).map(|e| e.1).sum()
    }

    fn force_below(&self, phi: f64) -> f64 {
        self.elements().take_while(|e| e.0 < phi).map(|(strength, k)| k * strength).sum()
    }
}

/// A sum that also accumulates its rounding error (Neumaier, ZAMM 54:39, 1974, doi:10.1002/zamm.19740540106).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Compensated {
    sum: f64,
    lost: f64,
}

impl Compensated {
    #[inline]
    pub(crate) fn add(&mut self, x: f64) {
        let total = self.sum + x;
        self.lost += if self.sum.abs() >= x.abs() { (self.sum - total) + x } else { (x - total) + self.sum };
        self.sum = total;
    }

    #[inline]
    pub(crate) fn value(&self) -> f64 {
        self.sum + self.lost
    }
}
