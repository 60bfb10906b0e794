//! How a law enters a computation: cut into sliders on a grid, or as the continuous law.

use crate::error::{Error, check};

/// How a joint's law is represented in time stepping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Representation {
    /// A population of Jenkins elements; K_T and F_S stay exact.
    Sliders {
        /// Number of bins into which the density is cut.
        bins: usize,
        /// Where the bins lie.
        grid: Grid,
    },
    /// The continuous law by Masing's rule, with return-point memory and no sliders.
    Continuum,
}

impl Representation {
    /// Number of bins unless the user chooses another.
    ///
    /// On the default grid of a mode 100 bins keep the dissipation per cycle within 0.5 % from 0.001 to 0.3 φ_max (-0.5 <= χ < 0). More
    /// bins cost time and gain accuracy: 50 bins keep it within 1.7 %, 200 within 0.14 %, 400 within 0.04 %.
    pub const DEFAULT_BINS: usize = 100;

    /// The default of a mode: `bins` sliders on [`Grid::graded`].
    #[must_use]
    pub fn in_a_mode(bins: usize) -> Self {
        Self::Sliders { bins, grid: Grid::graded(bins) }
    }

    /// The default of a mode with [`DEFAULT_BINS`](Self::DEFAULT_BINS).
    #[must_use]
    pub fn default_sliders() -> Self {
        Self::in_a_mode(Self::DEFAULT_BINS)
    }

    /// The default of a joint in a structure: `bins` sliders on [`Grid::IN_STRUCTURES`].
    #[must_use]
    pub const fn in_a_structure(bins: usize) -> Self {
        Self::Sliders { bins, grid: Grid::IN_STRUCTURES }
    }

    /// The default of a joint in a structure with [`DEFAULT_BINS`](Self::DEFAULT_BINS).
    pub const DEFAULT_IN_A_STRUCTURE: Self = Self::in_a_structure(Self::DEFAULT_BINS);
}

/// How the strengths of a continuous density are cut into bins.
///
/// ```
/// use iwan_core::Grid;
/// // 100 bins from 1e-4 of the largest strength: 99 ratios of 1.0975 between their upper edges.
/// let Grid::Graded { smallest } = Grid::graded(100) else { unreachable!() };
/// assert!((smallest - 1e-4).abs() < 1e-19);
/// assert!((1.0975_f64.powi(99) * smallest - 1.0).abs() < 1e-2);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Grid {
    /// Bins of equal width between the weakest and the strongest slider.
    ///
    /// The textbook choice, but unsuitable for ring-downs: nothing dissipates at amplitudes below the first strength.
    Uniform,
    /// Bins in geometric progression. The upper edge of the first bin lies at the part `smallest` of the way from the weakest to the
    /// strongest slider (for most laws at `smallest` φ_max); the upper edge of the last bin lies at the strongest slider.
    ///
    /// All strengths below the first edge are one slider. The first edge is therefore the smallest amplitude at which the sliders still
    /// represent a density.
    Graded {
        /// Upper edge of the first bin over φ_max, between 0 and 1.
        smallest: f64,
    },
    /// The same progression, given by the ratio of neighbouring edges: the upper edge of the first bin lies at ratio^-(bins - 1).
    Geometric {
        /// Ratio > 1 of neighbouring edges.
        ratio: f64,
    },
}

impl Grid {
    /// Upper edge of the first bin on the default grid of a mode, over φ_max, times the number of bins.
    ///
    /// At 100 bins the first edge lies at 1e-4 φ_max and the ratio of edges is 1.0975. All strengths below the first edge are one slider,
    /// which calls for a small edge; but the farther a given number of bins reaches, the wider each bin, which calls for a large edge. The
    /// largest error of 100 bins in the dissipation per cycle, from 0.001 to 0.3 φ_max and for -0.5 <= χ < 0, is 60 % with the first edge
    /// at 1e-3 φ_max, 3 % at 3e-4, 0.5 % at 1e-4, 0.7 % at 1e-5 and 1.1 % at 1e-6. Because the edge is inversely proportional to the number
    /// of bins, both errors vanish together as bins are added, nearly as the inverse square of their number.
    pub const SMALLEST_TIMES_BINS: f64 = 0.01;

    /// The default grid in a structure: graded from 1e-6 φ_max.
    ///
    /// The joints of a structure slip by very different amounts, and one grid serves them all. From 1e-6 φ_max, 100 bins keep the
    /// dissipation per cycle within 1.1 % from 1e-5 to 0.3 φ_max (-0.5 <= χ < 0; the ratio of edges is 1.15). The default grid of a mode
    /// keeps it within 0.5 % from 0.001 φ_max on, but has no dissipation left at 1e-4 φ_max.
    pub const IN_STRUCTURES: Self = Self::Graded { smallest: 1e-6 };

    /// The default grid of a mode with `bins` bins: graded from [`SMALLEST_TIMES_BINS`](Self::SMALLEST_TIMES_BINS)/`bins` φ_max.
    #[must_use]
    pub fn graded(bins: usize) -> Self {
        Self::Graded { smallest: Self::SMALLEST_TIMES_BINS / bins.max(1) as f64 }
    }

    /// The edges of `bins` bins between the strengths `low` and `high`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for the grid's `smallest` or `ratio`.
    pub(crate) fn edges(self, bins: usize, [low, high]: [f64; 2]) -> Result<Edges, Error> {
        let ratio = match self {
            Self::Uniform => None,
            Self::Graded { smallest } => {
                let inside = smallest > 0.0 && smallest < 1.0;
                check("smallest", smallest, inside, "must satisfy 0 < smallest < 1")?;
                let steps = bins.saturating_sub(1).max(1) as f64;
                Some(libm::pow(smallest, -1.0 / steps))
            }
            Self::Geometric { ratio } => {
                Some(check("ratio", ratio, ratio > 1.0, "must be a finite number > 1")?)
            }
        };
        Ok(Edges { ratio, bins, low, high })
    }
}

/// The edges of a grid's bins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edges {
    /// Ratio of neighbouring edges; none for equal widths.
    ratio: Option<f64>,
    bins: usize,
    low: f64,
    high: f64,
}

impl Edges {
    /// Upper edge of bin `i`, counted from 1.
    pub(crate) fn upper(&self, i: usize) -> f64 {
        let Self { ratio, bins: n, low, high } = *self;
        if i >= n {
            return high;
        }
        match ratio {
            None => low + (high - low) * i as f64 / n as f64,
            Some(ratio) => low + (high - low) * libm::pow(ratio, i as f64 - n as f64),
        }
    }
}
