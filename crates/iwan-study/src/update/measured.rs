//! Measured frequency and damping of a mode against amplitude.

use std::f64::consts::TAU;

use iwan_fem::Stiffness;

use crate::error::Error;

/// Number of means into which a long curve is condensed, in even steps of ln amplitude. Curves of ring-downs have one entry per cycle, and
/// neighbouring entries share most of their noise. This many means show all of a smooth curve, and the averages keep the information of the entries.
const MEANS: usize = 48;
/// Fewest entries per mean on average; a curve with fewer keeps all its entries. A mean of one or two entries says nothing about their noise and
/// distorts the curve where it bends: with 61 entries without noise, by 0.7 % of damping at the onset of macro-slip, which hid β altogether.
const FEWEST_IN_A_MEAN: usize = 4;
/// Fewest points of a curve: with fewer no level, slope and bend can be determined, and the curve is refused.
const FEWEST_POINTS: usize = 4;

/// A curve of one mode; all vectors have one entry per amplitude, in any order.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredCurve {
    /// Name of the mode, as `iwan modes` gives it.
    pub mode: String,
    /// Origin of the curve, for messages.
    pub source: String,
    /// Amplitude of the mass-normalised modal displacement, mass^½·length.
    pub displacement: Vec<f64>,
    /// Frequency, Hz.
    pub frequency: Vec<f64>,
    /// Damping ratio; entries that are not > 0 (noise at the end of a decay) are left out.
    pub damping_ratio: Vec<f64>,
    /// Which stiffness the frequency belongs to: the secant or the first harmonic.
    pub stiffness: Stiffness,
}

/// One point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    pub(super) displacement: f64,
    pub(super) frequency: f64,
    pub(super) log_damping: f64,
}

impl MeasuredCurve {
    /// Damping ratios from the dissipation per cycle, ζ = D / (2π ω² q²), with q the modal displacement (`displacement`) and ω/2π the frequency in
    /// Hz.
    ///
    /// ```
    /// use iwan_study::update::MeasuredCurve;
    /// let ratio = MeasuredCurve::damping_of(&[2.0], &[1.0 / std::f64::consts::TAU], &[std::f64::consts::TAU]);
    /// assert!((ratio[0] - 0.25).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn damping_of(displacement: &[f64], frequency: &[f64], dissipation: &[f64]) -> Vec<f64> {
        let one = |((q, f), d): ((&f64, &f64), &f64)| d / (TAU * (TAU * f * q).powi(2));
        displacement.iter().zip(frequency).zip(dissipation).map(one).collect()
    }

    /// The points in ascending amplitude, averaged where there are many.
    pub(super) fn points(&self) -> Result<Vec<Point>, Error> {
        let refused = |finding: String| Error::Update {
            place: format!("{}, {}", self.source, self.mode),
            finding,
            remedy: "give displacement > 0, frequency > 0 and damping ratio of at least four amplitudes",
        };
        let n = self.displacement.len();
        if self.frequency.len() != n || self.damping_ratio.len() != n {
            let lengths = (n, self.frequency.len(), self.damping_ratio.len());
            return Err(refused(format!("columns of different length: {lengths:?}")));
        }
        let mut points = Vec::new();
        for i in 0..n {
            let (q, f, z) = (self.displacement[i], self.frequency[i], self.damping_ratio[i]);
            if !(q.is_finite() && f.is_finite() && z.is_finite() && q > 0.0 && f > 0.0) {
                let columns =
                    [("displacement", q, q > 0.0), ("frequency", f, f > 0.0), ("damping ratio", z, true)];
                let bad = columns.iter().find(|(_, value, fits)| !(value.is_finite() && *fits));
                let (name, value) = bad.map_or(("", f64::NAN), |(name, value, _)| (*name, *value));
                return Err(refused(format!("the {name} is {value} in entry {} of {n}", i + 1)));
            }
            if z > 0.0 {
                points.push(Point { displacement: q, frequency: f, log_damping: z.ln() });
            }
        }
        if points.is_empty() && n > 0 {
            return Err(Error::Update {
                place: format!("{}, {}", self.source, self.mode),
                finding: "the damping ratio is 0 or less in all entries, so that nothing was lost at any amplitude: joints that slip lose energy".into(),
                remedy: "give the measured damping ratio or dissipation; an empty column may have been filled with zeros",
            });
        }
        if points.len() < FEWEST_POINTS {
            return Err(refused(format!("{} usable entries", points.len())));
        }
        points.sort_by(|a, b| a.displacement.total_cmp(&b.displacement));
        Ok(if points.len() > FEWEST_IN_A_MEAN * MEANS { averaged(&points) } else { points })
    }
}

/// Means of the points in even steps of the logarithm of the amplitude.
fn averaged(points: &[Point]) -> Vec<Point> {
    let log = |p: &Point| p.displacement.ln();
    let (first, last) = (log(&points[0]), log(&points[points.len() - 1]));
    let width = ((last - first) / MEANS as f64).max(f64::MIN_POSITIVE);
    let step = |p: &Point| (((log(p) - first) / width) as usize).min(MEANS - 1);
    let mean = |part: &[Point]| {
        let of = |get: &dyn Fn(&Point) -> f64| part.iter().map(get).sum::<f64>() / part.len() as f64;
        Point {
            displacement: of(&log).exp(),
            frequency: of(&|p| p.frequency),
            log_damping: of(&|p| p.log_damping),
        }
    };
    points.chunk_by(|a, b| step(a) == step(b)).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(n: usize) -> MeasuredCurve {
        let q: Vec<f64> = (0..n).map(|i| 1e-3 * (1.0 + i as f64)).rev().collect();
        MeasuredCurve {
            mode: "bending 1".into(),
            source: "table".into(),
            frequency: q.iter().map(|q| 100.0 - q).collect(),
            damping_ratio: q.clone(),
            displacement: q,
            stiffness: Stiffness::FirstHarmonic,
        }
    }

    #[test]
    fn many_entries_become_means_and_few_stay() {
        let few = curve(FEWEST_IN_A_MEAN * MEANS).points().unwrap();
        assert!(
            few.len() == FEWEST_IN_A_MEAN * MEANS
                && few.windows(2).all(|p| p[0].displacement < p[1].displacement)
        );
        let many = curve(1000).points().unwrap();
        assert!(many.len() <= MEANS && many.len() > MEANS / 2);
        // Damping equals amplitude in this curve, and the logarithm of damping is averaged as the mean of logarithms.
        assert!(many.iter().all(|p| (p.log_damping - p.displacement.ln()).abs() < 1e-12));
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let mut broken = curve(10);
        broken.frequency[3] = f64::NAN;
        assert!(broken.points().unwrap_err().to_string().contains("the frequency is NaN in entry 4 of 10"));
        let mut negative = curve(6);
        negative.damping_ratio[..3].fill(-1e-3);
        assert!(negative.points().unwrap_err().to_string().contains("3 usable"));
        negative.damping_ratio.fill(0.0);
        assert!(negative.points().unwrap_err().to_string().contains("0 or less in all entries"));
    }
}
