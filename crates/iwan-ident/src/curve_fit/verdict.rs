//! Whether one four-parameter joint with a viscous damper matches dissipation and frequency together, and how far off
//! it is.

/// The model is adequate if dissipation is missed by at most this part (root mean square): about what repeated hits of one specimen
/// differ by. A judgement, not calibrated, …
const DISSIPATION: f64 = 0.03;
/// … as is the part of its measured shift by which frequency may be missed, unless noise explains more.
const FREQUENCY: f64 = 0.1;
/// Misfit, as a root mean square in standard deviations, that noise explains: two, as for an interval of 95 %.
const NOISE: f64 = 2.0;
/// A shift of the frequency below this part of it is none: ring-downs of real structures do not repeat better.
const SHIFT_FLOOR: f64 = 1e-5;

/// A measured value of a curve, its standard deviation, and the model's value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Compared {
    pub(crate) measured: f64,
    pub(crate) deviation: f64,
    pub(crate) model: f64,
}

/// The answer in numbers and in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Root-mean-square misfit of ln D.
    pub dissipation_misfit: f64,
    /// Root-mean-square misfit of the frequency, Hz.
    pub frequency_misfit: f64,
    /// Measured range of the frequency, Hz.
    pub frequency_shift: f64,
    /// Whether one four-parameter joint with a viscous damper matches dissipation and frequency together: dissipation
    /// within 3 %, frequency within a tenth of its shift, or both within twice their noise; or the model's ring-down leaves nothing of the
    /// record but noise.
    pub adequate: bool,
    /// What does not fit, in words and numbers.
    pub misfit: String,
}

impl Verdict {
    /// From ln D and frequency (Hz) at the same amplitudes.
    /// `noise_only`: a model's ring-down was subtracted from the record itself and left noise.
    pub(crate) fn new(dissipation: &[Compared], frequency: &[Compared], noise_only: bool) -> Self {
        let [d, f] = [dissipation, frequency].map(Distance::of);
        let range = frequency
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |r, c| (r.0.min(c.measured), r.1.max(c.measured)));
        let shift = range.1 - range.0;
        let smallest = SHIFT_FLOOR * range.1;
        let limits =
            [DISSIPATION.max(NOISE * d.noise), (FREQUENCY * shift).max(NOISE * f.noise).max(smallest)];
        let within = d.misfit <= limits[0] && f.misfit <= limits[1];
        let adequate = within || noise_only;
        let misfit = format!(
            "dissipation is missed by {:.2} % (limit {:.2} %), frequency by {:.4} Hz of a shift of {shift:.4} Hz (limit \
             {:.4} Hz){}: one four-parameter Iwan joint with a viscous damper {} dissipation and frequency together",
            100.0 * d.misfit,
            100.0 * limits[0],
            f.misfit,
            limits[1],
            if noise_only && !within { ", but what the model leaves of the record is noise" } else { "" },
            if adequate { "matches" } else { "does not match" }
        );
        Self {
            dissipation_misfit: d.misfit,
            frequency_misfit: f.misfit,
            frequency_shift: shift,
            adequate,
            misfit,
        }
    }
}

/// How far a model is from measured values, and how far noise is: root mean squares.
struct Distance {
    misfit: f64,
    noise: f64,
}

impl Distance {
    fn of(values: &[Compared]) -> Self {
        let n = values.len() as f64;
        let sum = |square: &dyn Fn(&Compared) -> f64| values.iter().fold(0.0, |s, c| s + square(c) / n);
        Self {
            misfit: sum(&|c| (c.measured - c.model).powi(2)).sqrt(),
            noise: sum(&|c| c.deviation.powi(2)).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_excuses_what_it_explains_and_no_more() {
        let values = |deviation: f64| -> Vec<Compared> {
            (0..10)
                .map(|i| Compared {
                    measured: 0.1 * f64::from(i),
                    deviation,
                    model: 0.1 * f64::from(i) + 0.05,
                })
                .collect()
        };
        let exact: Vec<Compared> = values(0.0).iter().map(|c| Compared { model: c.measured, ..*c }).collect();
        assert!(Verdict::new(&exact, &exact, false).adequate);
        let verdict = Verdict::new(&values(0.01), &exact, false);
        assert!(!verdict.adequate && verdict.misfit.contains("missed by 5.00 %"), "{}", verdict.misfit);
        assert!(Verdict::new(&values(0.04), &exact, false).adequate);
        let excused = Verdict::new(&values(0.01), &exact, true);
        assert!(excused.adequate && excused.misfit.contains("is noise"), "{}", excused.misfit);
        // A frequency missed by a twentieth of its shift passes.
        assert!(Verdict::new(&exact, &values(0.0), false).adequate);
    }
}
