//! What goes into a refinement and what comes out.

use serde::{Deserialize, Serialize};

use super::release::TurningPoint;
use crate::curves::Quantity;
use crate::parameters::Parameters;

/// Correlation of neighbouring residuals, in units of 1/√n, up to which they count as noise. White noise has the standard deviation 1/√n, so that 98
/// of 100 records of it stay below twice that. Above, residuals count as correlated: intervals are widened, and a misfit counts as a misfit.
const STILL_NOISE: f64 = 2.0;
/// Relative residual below which records count as made by the law itself: exact steps of the law leave 1e-11 and less, twenty sliders in 24 cycles
/// 2e-6, and Newmark's steps of a thousandth of a cycle 6e-8.
const OF_THE_LAW: f64 = 1e-8;

/// A measured ring-down in free decay: one mode, mass-normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingDown<'a> {
    /// Samples, free of aliases.
    pub samples: &'a [f64],
    /// Sampling interval, s.
    pub dt: f64,
    /// What was measured.
    pub quantity: Quantity,
    /// Width in Hz of the band that the samples were filtered to; none: unfiltered.
    pub band: Option<f64>,
    /// The contribution of other modes that was subtracted from the samples, sample by sample; none: nothing was subtracted.
    pub beside: Option<&'a [f64]>,
}

/// Standard deviations of what a model misses of ln D and ln ω (D: dissipation per cycle, ω: frequency), which both vary slowly with ln amplitude;
/// zero where only noise is left.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Discrepancy {
    /// Of ln D: the part that all records share.
    pub dissipation: f64,
    /// Of ln ω: the part that all records share.
    pub frequency: f64,
    /// Of ln D: the part that each level of force has of its own. What moves beside the mode, such as other modes that keep a joint slipping, differs
    /// from level to level.
    pub dissipation_of_level: f64,
    /// Of ln ω: the part that each level of force has of its own.
    pub frequency_of_level: f64,
    /// Of ln D: the part that each record has of its own, including its offset that is the same at all amplitudes.
    pub dissipation_of_record: f64,
    /// Of ln ω: the part that each record has of its own, without the offset of its day.
    pub frequency_of_record: f64,
    /// Of ln D: the part, shared by all records, that intervals allow for in records without noise, which say too little about what the law misses.
    /// Zero for other records, and where the law itself made the records.
    pub allowed: f64,
}

/// Parameters that reproduce records, and what is left of the residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// The parameters.
    pub parameters: Parameters,
    /// The turning point next to the first sample, one per record.
    pub starts: Vec<TurningPoint>,
    /// Standard deviation of white noise in the samples that would leave the same residuals, one per record, in the unit of the record.
    pub noise: Vec<f64>,
    /// Root mean square of all residuals over the root mean square of the records' amplitudes.
    pub relative_residual: f64,
    /// Correlation of neighbouring residuals: near 0 when only noise is left, near 1 when the model misses something.
    pub correlation: f64,
    /// How large a part of dissipation and of frequency the model misses, estimated from the form of the residuals.
    pub discrepancy: Discrepancy,
    /// Whether the search ended by itself, and not by its limit of iterations.
    pub converged: bool,
}

impl Discrepancy {
    /// Standard deviation of ln D, all discrepancies together.
    pub(crate) fn of_dissipation(&self) -> f64 {
        self.dissipation.hypot(self.dissipation_of_level).hypot(self.dissipation_of_record)
    }

    /// Whether the law misses anything beside noise and beside what repeats differ by.
    pub(crate) fn is_found(&self) -> bool {
        self.dissipation > 0.0 || self.dissipation_of_level > 0.0
    }
}

impl Refined {
    /// Whether the law itself made the records: so little is left that it is their rounding.
    pub(crate) fn is_of_the_law(&self) -> bool {
        self.relative_residual < OF_THE_LAW
    }

    /// The same without a discrepancy where the law itself made the records: its form is then that of their rounding.
    pub(super) fn without_rounding(self) -> Self {
        if self.is_of_the_law() { Self { discrepancy: Discrepancy::default(), ..self } } else { self }
    }

    /// Whether the `count` residuals look like white noise: neighbours are not correlated, and no discrepancy of the law was discounted before.
    pub(crate) fn leaves_noise(&self, count: usize) -> bool {
        !self.discrepancy.is_found() && self.correlation < STILL_NOISE / (count as f64).sqrt()
    }
}
