//! How a law stands in a computation: cut into sliders on a grid, or as it is.

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
    /// The law itself by Masing's rule with return-point memory.
    Continuum,
}

impl Representation {
    /// Bins unless the user says otherwise.
    ///
    /// On the default grid of a mode they hold the dissipation per cycle within 0.5 % from 0.001 to 0.3 φ_max. The
    /// number is a choice between digits and time: 50 bins hold 1.7 %, 200 hold 0.14 %, 400 hold 0.04 % (-0.5 <= χ
    /// < 0).
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
    /// The textbook choice, and a trap for ring-downs: nothing dissipates below the
    /// first strength.
    Uniform,
    /// Bins in geometric progression: the upper edge of the first lies at `smallest` of the way from the weakest to
    /// the strongest slider, for most laws `smallest` φ_max, that of the last at the strongest.
    ///
    /// All below the first edge is one slider, so this is the amplitude down to which a motion still finds a density.
    Graded {
        /// Upper edge of the first bin over φ_max, between 0 and 1.
        smallest: f64,
    },
    /// The same progression by the ratio of neighbouring edges: `bins` of them begin at ratio^-(bins - 1).
    Geometric {
        /// Ratio > 1 of neighbouring edges.
        ratio: f64,
    },
}

impl Grid {
    /// Smallest strength of the default grid of a mode, over φ_max, times the number of bins.
    ///
    /// At 100 bins that is 1e-4 φ_max and a ratio of 1.0975. All below the first edge is one slider, which asks for
    /// a small edge, and bins are the wider the farther the same number reaches, which asks for a large one. What
    /// 100 bins are wrong by at most, in the dissipation per cycle from 0.001 to 0.3 φ_max and for -0.5 <= χ < 0:
    /// 60 % from an edge at 1e-3 φ_max, 3 % from 3e-4, 0.5 % from 1e-4, 0.7 % from 1e-5, 1.1 % from 1e-6. With the
    /// number of bins in it the first edge falls as bins grow finer, so both errors vanish together, nearly as the
    /// inverse square of that number.
    pub const SMALLEST_TIMES_BINS: f64 = 0.01;

    /// The default grid in a structure: graded from 1e-6 φ_max.
    ///
    /// The joints of a structure slip unequally, and one grid serves them all. From 1e-6 φ_max, 100 bins hold the
    /// dissipation per cycle within 1.1 % from 1e-5 to 0.3 φ_max (-0.5 <= χ < 0; the ratio is 1.15), where that of
    /// a mode has lost all of it at 1e-4 φ_max and is within 0.5 % from 0.001 on.
    pub const IN_STRUCTURES: Self = Self::Graded { smallest: 1e-6 };

    /// The default grid of a mode with so many bins: graded from
    /// [`SMALLEST_TIMES_BINS`](Self::SMALLEST_TIMES_BINS)/`bins` φ_max.
    #[must_use]
    pub fn graded(bins: usize) -> Self {
        Self::Graded { smallest: Self::SMALLEST_TIMES_BINS / bins.max(1) as f64 }
    }

    /// The edges of `bins` bins between the strengths `low` and `high`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the grid's number.
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
