//! What goes into a refinement and what comes out.

use super::release::TurningPoint;
use crate::curves::Quantity;
use crate::parameters::Parameters;

/// Neighbouring residuals of white noise correlate by 1/√n (standard deviation): twice that is noise still, in 98 of 100
/// records. Where it is passed the residuals count as correlated: intervals are widened, and a misfit is a misfit.
const STILL_NOISE: f64 = 2.0;

/// A ring-down in free decay: one mode, mass-normalised.
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
    /// What other modes had in the samples before it was taken off them; none: nothing was.
    pub beside: Option<&'a [f64]>,
}

/// Standard deviations of what a model misses, each varying slowly with ln amplitude: zero where nothing is left but noise.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Discrepancy {
    /// Of ln D, in all records alike.
    pub dissipation: f64,
    /// Of ln ω, in all records alike.
    pub frequency: f64,
    /// Of ln D from level to level: what moves beside the mode, such as other modes that keep a joint slipping, is another at every level.
    pub dissipation_of_level: f64,
    /// Of ln ω from level to level.
    pub frequency_of_level: f64,
    /// Of ln D from record to record, with what they differ by at all amplitudes alike.
    pub dissipation_of_record: f64,
    /// Of ln ω from record to record, the day's included.
    pub frequency_of_record: f64,
    /// Of ln D, in all records alike: what intervals allow for in records without noise, which say too little of what the law misses; zero in others and where the law itself made them.
    pub allowed: f64,
}

/// Parameters that reproduce records, and what is left over.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// The parameters.
    pub parameters: Parameters,
    /// Of each record: the turning point next to its first sample.
    pub starts: Vec<TurningPoint>,
    /// Standard deviation of white noise in a record's samples that would leave the same residuals, unit of the record.
    pub noise: Vec<f64>,
    /// Root mean square of all residuals over that of the records' amplitudes.
    pub relative_residual: f64,
    /// Correlation of neighbouring residuals: near 0 when only noise is left, near 1 when the model misses something.
    pub correlation: f64,
    /// How large a part of dissipation and of frequency the model misses, by the form of the residuals.
    pub discrepancy: Discrepancy,
    /// Whether the search ended by itself.
    pub converged: bool,
}

impl Discrepancy {
    /// Of ln D, all together.
    pub(crate) fn of_dissipation(&self) -> f64 {
        self.dissipation.hypot(self.dissipation_of_level).hypot(self.dissipation_of_record)
    }

    /// Whether the law misses anything beside noise and what repeats differ by.
    pub(crate) fn is_found(&self) -> bool {
        self.dissipation > 0.0 || self.dissipation_of_level > 0.0
    }
}

impl Refined {
    /// Whether what is left of `count` values looks like white noise: neighbours are not correlated, and nothing that the law misses was set aside
    /// before.
    pub(crate) fn leaves_noise(&self, count: usize) -> bool {
        !self.discrepancy.is_found() && self.correlation < STILL_NOISE / (count as f64).sqrt()
    }
}
