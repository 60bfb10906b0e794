//! One modal record out of many channels: modal filter (Eq. 18), band-pass-scale-average (Sec. 4.4), dominant shape.

use nalgebra::DMatrix;

use crate::error::{Error, check, check_length, check_samples};

/// Singular values below this fraction of the largest count as zero: shapes from a file have six digits or more, and rounding leaves
/// 1e-16. Shapes that the channels tell apart less well are refused with their rank.
const RANK_TOLERANCE: f64 = 1e-10;
/// A channel is an outlier where its record differs from its share of the average by more than this fraction of that share (root mean squares); it is named and not
/// dropped. Calibration and shapes together are good to a few per cent. A judgement.
const OUTLIER: f64 = 0.25;

/// The pseudo-inverse Φ⁺ of a matrix of mode shapes: q'' = Φ⁺ x'' (Eq. 18).
///
/// ```
/// // Two modes at three channels.
/// let shapes = vec![vec![1.0, 1.0, 1.0], vec![1.0, 0.0, -1.0]];
/// let filter = iwan_ident::channels::ModalFilter::new(&shapes)?;
/// assert_eq!(filter.rank(), 2);
/// // x = 2 of the first and 3 of the second mode.
/// let q = filter.apply(&[&[5.0], &[2.0], &[-1.0]])?;
/// assert!((q[0][0] - 2.0).abs() < 1e-12 && (q[1][0] - 3.0).abs() < 1e-12);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ModalFilter {
    inverse: DMatrix<f64>,
    rank: usize,
    condition: f64,
}

impl ModalFilter {
    /// From mode shapes: `shapes[mode][channel]`, mass-normalised.
    ///
    /// # Errors
    /// [`Error::Length`] for rows of different length; [`Error::NotFinite`]; [`Error::Refused`] when the channels
    /// cannot tell the modes apart (rank below the number of modes).
    pub fn new(shapes: &[Vec<f64>]) -> Result<Self, Error> {
        let modes = shapes.len();
        let channels = shapes.first().map_or(0, Vec::len);
        if modes == 0 {
            return Err(Error::TooShort {
                what: "mode shapes",
                found: 0,
                needed: 1,
                remedy: "give one per mode",
            });
        }
        for shape in shapes {
            check_length("shape", shape.len(), channels)?;
            check_samples("shape", shape, 1, "give one value per channel")?;
        }
        let matrix = DMatrix::from_fn(channels, modes, |i, j| shapes[j][i]);
        let singular = matrix.singular_values();
        let largest = singular.iter().copied().fold(0.0, f64::max);
        let smallest = singular.iter().copied().fold(f64::INFINITY, f64::min);
        let rank = singular.iter().filter(|s| **s > RANK_TOLERANCE * largest).count();
        if rank < modes {
            return Err(Error::Refused {
                finding: format!("{channels} channels tell only {rank} of {modes} mode shapes apart"),
                remedy: "use more channels, or fewer modes",
            });
        }
        let inverse = matrix
            .pseudo_inverse(RANK_TOLERANCE * largest)
            .map_err(|e| Error::Refused { finding: e.to_owned(), remedy: "check the mode shapes" })?;
        Ok(Self { inverse, rank, condition: largest / smallest })
    }

    /// Number of modes that the channels tell apart.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Largest over smallest singular value: the factor by which noise is amplified against the signal at worst.
    #[must_use]
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// The row of Φ⁺ for a mode (counted from 0), one weight per channel; none when there is no such mode.
    #[must_use]
    pub fn weights(&self, mode: usize) -> Option<Vec<f64>> {
        (mode < self.inverse.nrows()).then(|| self.inverse.row(mode).iter().copied().collect())
    }

    /// Modal records from channels of equal length, one per mode.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn apply(&self, channels: &[&[f64]]) -> Result<Vec<Vec<f64>>, Error> {
        check_length("channels", channels.len(), self.inverse.ncols())?;
        let samples = channels.first().map_or(0, |c| c.len());
        for channel in channels {
            check_length("channel", channel.len(), samples)?;
        }
        let mode = |row: usize| {
            let mut q = vec![0.0; samples];
            for (j, channel) in channels.iter().enumerate() {
                let factor = self.inverse[(row, j)];
                q.iter_mut().zip(*channel).for_each(|(q, x)| *q += factor * x);
            }
            q
        };
        Ok((0..self.inverse.nrows()).map(mode).collect())
    }
}

/// One modal record averaged over channels, and the channels that do not move with the shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Average {
    /// Modal record: Σ φ x / Σ φ².
    pub samples: Vec<f64>,
    /// For each channel the root mean square of x - φ q over that of φ q.
    pub misfit: Vec<f64>,
    /// Channels (by index) with a misfit above 25 %: named, and still part of the average.
    pub outliers: Vec<usize>,
}

/// Average of band-passed `channels`, each divided by its mode-shape value, with weights φ² (Sec. 4.4).
///
/// # Errors
/// [`Error::Length`]; [`Error::OutOfRange`] when all values of the shape are zero.
///
/// ```
/// let average = iwan_ident::channels::scaled_average(&[&[2.0, 4.0], &[-1.0, -2.0]], &[2.0, -1.0])?;
/// assert_eq!(average.samples, [1.0, 2.0]);
/// assert!(average.outliers.is_empty());
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn scaled_average(channels: &[&[f64]], shape: &[f64]) -> Result<Average, Error> {
    check_length("shape", shape.len(), channels.len())?;
    let n = channels.first().map_or(0, |c| c.len());
    let total: f64 = shape.iter().map(|p| p * p).sum();
    check("sum of squared mode-shape values", total, total > 0.0, "> 0", "give the mode shape")?;
    let mut samples = vec![0.0; n];
    for (channel, p) in channels.iter().zip(shape) {
        check_length("channel", channel.len(), n)?;
        samples.iter_mut().zip(*channel).for_each(|(q, x)| *q += p / total * x);
    }
    let energy: f64 = samples.iter().map(|q| q * q).sum();
    let misfit: Vec<f64> = channels
        .iter()
        .zip(shape)
        .map(|(x, p)| {
            let distance: f64 = x.iter().zip(&samples).map(|(x, q)| (x - p * q).powi(2)).sum();
            (distance / (p * p * energy).max(f64::MIN_POSITIVE)).sqrt()
        })
        .collect();
    let outliers = (0..misfit.len()).filter(|&i| misfit[i] > OUTLIER).collect();
    Ok(Average { samples, misfit, outliers })
}

/// Dominant spatial shape of band-passed channels.
#[derive(Debug, Clone, PartialEq)]
pub struct DominantShape {
    /// One value per channel, of unit length; the largest is positive.
    pub shape: Vec<f64>,
    /// Part of the channels' energy that moves in this shape: 1 for a single mode without noise.
    pub share: f64,
}

/// First singular vector of the channels, with the share of energy that moves in it; for records without mode shapes.
///
/// # Errors
/// [`Error::Length`]; [`Error::Refused`] for channels without motion.
///
/// ```
/// let wave: Vec<f64> = (0..100).map(|n| (0.3 * n as f64).sin()).collect();
/// let half: Vec<f64> = wave.iter().map(|x| -0.75 * x).collect();
/// let dominant = iwan_ident::channels::dominant_shape(&[&wave, &half])?;
/// assert!((dominant.shape[0] - 0.8).abs() < 1e-12 && (dominant.shape[1] + 0.6).abs() < 1e-12);
/// assert!((dominant.share - 1.0).abs() < 1e-12);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn dominant_shape(channels: &[&[f64]]) -> Result<DominantShape, Error> {
    let n = channels.first().map_or(0, |c| c.len());
    for channel in channels {
        check_length("channel", channel.len(), n)?;
    }
    let total: f64 = channels.iter().map(|x| product(x, x)).sum();
    if total <= 0.0 || !total.is_finite() {
        return Err(Error::Refused { finding: "the channels do not move".into(), remedy: "check the band" });
    }
    let (energy, mut shape) = dominant_eigenvector(channels.len(), |v| {
        let mut record = vec![0.0; n];
        for (channel, factor) in channels.iter().zip(v) {
            record.iter_mut().zip(*channel).for_each(|(sum, x)| *sum += factor * x);
        }
        channels.iter().map(|x| product(x, &record)).collect()
    });
    let largest = shape.iter().copied().fold(0.0, |m: f64, v| if v.abs() > m.abs() { v } else { m });
    for v in &mut shape {
        *v *= largest.signum();
    }
    Ok(DominantShape { shape, share: energy / total })
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Most directions in which [`dominant_eigenvector`] looks. A mode that holds most of the energy takes a handful; two shapes that hold the
/// same energy to some digits are not told apart when the limit is reached, and a mixture of them is returned.
const MOST_DIRECTIONS: usize = 200;
/// The search ends where the product of the matrix with the vector differs from their Rayleigh quotient times the vector by this part of the
/// quotient.
const SETTLED: f64 = 1e-14;

/// Largest eigenvalue of a positive semi-definite matrix of `size` rows, with its eigenvector of unit length, from products with the matrix
/// alone (C. Lanczos, J. Res. Natl. Bur. Stand. 45:255, 1950, doi:10.6028/jres.045.026, orthogonalised against all directions so far). Thousands of channels of thousands of samples need no matrix of all pairs.
fn dominant_eigenvector(size: usize, times: impl Fn(&[f64]) -> Vec<f64>) -> (f64, Vec<f64>) {
    // A start that is not orthogonal to the answer, whatever the channels: of random values, the same in every run.
    let mut random = iwan_core::SplitMix64::new(1);
    let mut next: Vec<f64> = (0..size).map(|_| 1.0 + 0.5 * random.next_symmetric()).collect();
    let mut beta = product(&next, &next).sqrt();
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let mut projected = DMatrix::zeros(0, 0);
    loop {
        for v in &mut next {
            *v /= beta;
        }
        let k = directions.len();
        directions.push(next);
        let mut image = times(&directions[k]);
        projected = projected.resize(k + 1, k + 1, 0.0);
        projected[(k, k)] = product(&directions[k], &image);
        if k > 0 {
            (projected[(k, k - 1)], projected[(k - 1, k)]) = (beta, beta);
        }
        // Twice: what rounding leaves of the first pass, the second takes away.
        for _ in 0..2 {
            for direction in &directions {
                let part = product(direction, &image);
                image.iter_mut().zip(direction).for_each(|(v, d)| *v -= part * d);
            }
        }
        beta = product(&image, &image).sqrt();
        next = image;
        let eigen = projected.clone().symmetric_eigen();
        let first = eigen.eigenvalues.imax();
        let (value, vector) = (eigen.eigenvalues[first], eigen.eigenvectors.column(first));
        let settled = beta * vector[k].abs() <= SETTLED * value;
        if settled || directions.len() == MOST_DIRECTIONS.min(size) {
            let mut sum = vec![0.0; size];
            for (direction, factor) in directions.iter().zip(vector.iter()) {
                sum.iter_mut().zip(direction).for_each(|(s, d)| *s += factor * d);
            }
            return (value, sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_that_cannot_tell_modes_apart_are_refused() {
        let error = ModalFilter::new(&[vec![1.0, 2.0], vec![2.0, 4.0]]).unwrap_err().to_string();
        assert!(error.contains("2 channels tell only 1 of 2"), "{error}");
        assert!(ModalFilter::new(&[vec![1.0], vec![1.0]]).is_err());
        assert!(ModalFilter::new(&[]).is_err());
        assert!(ModalFilter::new(&[vec![1.0, f64::NAN]]).is_err());
    }

    #[test]
    fn condition_of_orthogonal_shapes_is_the_ratio_of_their_lengths() {
        let filter = ModalFilter::new(&[vec![3.0, 0.0, 0.0], vec![0.0, 1.0, 0.0]]).unwrap();
        assert!((filter.condition() - 3.0).abs() < 1e-12);
        assert!(filter.apply(&[&[1.0]]).is_err());
    }

    /// Against the decomposition of the matrix of all pairs of channels, also where two shapes hold nearly the same energy.
    #[test]
    fn dominant_shapes_are_those_of_all_pairs_of_channels() {
        for (channels, ratio) in [(3, 0.1), (40, 0.9), (40, 0.999), (1, 0.5), (150, 0.99)] {
            let mut random = iwan_core::SplitMix64::new(7);
            let mut values = |n: usize| -> Vec<f64> { (0..n).map(|_| random.next_symmetric()).collect() };
            let (one, two) = (values(channels), values(channels));
            let wave = |rate: f64| (0..500).map(move |n| (rate * f64::from(n)).sin());
            let records: Vec<Vec<f64>> = (0..channels)
                .map(|i| {
                    let noise = values(500);
                    let parts = wave(0.3).zip(wave(0.7)).zip(noise);
                    parts.map(|((a, b), e)| one[i] * a + ratio * two[i] * b + 1e-3 * e).collect()
                })
                .collect();
            let records: Vec<&[f64]> = records.iter().map(Vec::as_slice).collect();
            let pairs = DMatrix::from_fn(channels, channels, |i, j| product(records[i], records[j]));
            let (total, eigen) = (pairs.trace(), pairs.symmetric_eigen());
            let expected = eigen.eigenvectors.column(eigen.eigenvalues.imax());
            let found = dominant_shape(&records).unwrap();
            let along: f64 = found.shape.iter().zip(expected.iter()).map(|(a, b)| a * b).sum();
            assert!((along.abs() - 1.0).abs() < 1e-12, "{channels}, {ratio}: {along}");
            assert!((found.share - eigen.eigenvalues.max() / total).abs() < 1e-12, "{}", found.share);
        }
    }

    #[test]
    fn a_channel_with_the_wrong_sign_is_named() {
        let wave: Vec<f64> = (0..200).map(|n| (0.3 * f64::from(n)).sin()).collect();
        let scale = |p: f64| -> Vec<f64> { wave.iter().map(|x| p * x).collect() };
        let (a, b, c) = (scale(1.0), scale(0.9), scale(-0.2));
        let average = scaled_average(&[&a, &b, &c], &[1.0, 0.9, 0.2]).unwrap();
        assert_eq!(average.outliers, [2]);
        assert!(scaled_average(&[&a], &[0.0]).is_err());
        assert!(scaled_average(&[&a, &b[..5]], &[1.0, 1.0]).is_err());
    }
}
