//! How joint laws are evaluated in time: as sliders on a grid, or as the continuum that they are.

use iwan_core::Grid;

/// How the joints' laws are evaluated in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Population {
    /// Cut into Jenkins elements on a grid; K_T and F_S stay exact.
    Sliders {
        /// Number of bins.
        bins: usize,
        /// The grid.
        grid: Grid,
    },
    /// The law itself by Masing's rule.
    Continuum,
}

impl Population {
    /// Sliders in `bins` geometric bins from 1e-6 φ_max: resolves joints that slip little beside others that slip much.
    #[must_use]
    pub fn graded(bins: usize) -> Self {
        let steps = bins.saturating_sub(1).max(1) as f64;
        Self::Sliders { bins, grid: Grid::Geometric { ratio: 1e6_f64.powf(1.0 / steps) } }
    }
}

impl Default for Population {
    /// 100 graded sliders.
    fn default() -> Self {
        Self::graded(100)
    }
}
