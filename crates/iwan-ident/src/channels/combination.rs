//! Weights by which channels combine to the record of one mode: from mode shapes, or from the shape that dominates in its band.

use super::modal::{ModalFilter, dominant_shape, scaled_average};
use crate::error::{Error, check_length};
use crate::signal::{Butterworth, Options, Passband, automatic_band};

/// Largest noise of a modal filter over that of the average of channels; a filter that adds more is not used. A judgement: below this, a neighbour in the band costs more than
/// noise does.
const AMPLIFIED: f64 = 2.0;

/// Weights by which channels add up to the record of one mode, and how these were found.
///
/// A combination is found once and serves all records of the same channels: several force levels of one structure.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// One weight per channel.
    pub weights: Vec<f64>,
    /// What was found, in words: rank and condition, share of the energy, channels that do not move with the shape.
    pub notes: Vec<String>,
}

impl Combination {
    /// A single channel as it is.
    #[must_use]
    pub fn single() -> Self {
        Self { weights: vec![1.0], notes: Vec::new() }
    }

    /// The combination for the shape that carries most of the energy in the band of `options`; amplitudes are those of
    /// the channel that moves most. Where `options` name no band, the automatic band of the loudest channel is taken.
    ///
    /// # Errors
    /// [`Error::Length`]; [`Error::Refused`] for channels without motion or without a spectral peak; as
    /// [`automatic_band`] and [`Butterworth::new`].
    ///
    /// ```
    /// use iwan_ident::{channels::Combination, signal::Options};
    /// let wave: Vec<f64> = (0..4000).map(|n| (-0.001 * n as f64).exp() * (0.5 * n as f64).sin()).collect();
    /// let other: Vec<f64> = wave.iter().map(|x| -0.5 * x).collect();
    /// let names = ["tip".to_string(), "root".to_string()];
    /// let both = Combination::dominant(&[&wave, &other], &names, 1e-3, &Options::default())?;
    /// // Both channels know the tip's motion: weights 1/(1 + 0.5²) and -0.5/(1 + 0.5²).
    /// assert!((both.weights[0] - 0.8).abs() < 1e-9 && (both.weights[1] + 0.4).abs() < 1e-9);
    /// assert!(both.notes[0].contains("tip"));
    /// # Ok::<(), iwan_ident::Error>(())
    /// ```
    pub fn dominant(
        channels: &[&[f64]],
        names: &[String],
        dt: f64,
        options: &Options,
    ) -> Result<Self, Error> {
        check_length("names", names.len(), channels.len())?;
        let band = band_passed(channels, loudest(channels)?, dt, options)?;
        let filtered = band.slices();
        let dominant = dominant_shape(&filtered)?;
        let reference = largest(&dominant.shape);
        let unit = dominant.shape[reference];
        let shape: Vec<f64> = dominant.shape.iter().map(|p| p / unit).collect();
        let each: Vec<String> = names.iter().zip(&shape).map(|(name, p)| format!("{name} {p:.4}")).collect();
        let mut notes = vec![format!(
            "{} channels combined by the shape that carries {:.2} % of their energy between {:.6} and {:.6} Hz ({}); \
             amplitudes are those of {}",
            channels.len(),
            100.0 * dominant.share,
            band.low,
            band.high,
            each.join(", "),
            names[reference]
        )];
        notes.extend(outliers(&filtered, names, &shape)?);
        Ok(Self { weights: dominant.shape.iter().map(|p| p * unit).collect(), notes })
    }

    /// The combinations for mass-normalised mode shapes, `shapes[mode][channel]`: rows of the pseudo-inverse (Eq. 18).
    ///
    /// # Errors
    /// As [`ModalFilter::new`]; [`Error::Length`].
    ///
    /// ```
    /// use iwan_ident::channels::Combination;
    /// let both = Combination::of_shapes(&[vec![1.0, 1.0], vec![1.0, -1.0]])?;
    /// assert!((both[1].weights[0] - 0.5).abs() < 1e-12 && (both[1].weights[1] + 0.5).abs() < 1e-12);
    /// # Ok::<(), iwan_ident::Error>(())
    /// ```
    pub fn of_shapes(shapes: &[Vec<f64>]) -> Result<Vec<Self>, Error> {
        let filter = ModalFilter::new(shapes)?;
        let note = format!(
            "modal filter: {} channels, {} mode shapes, rank {}, condition {:.3}",
            shapes[0].len(),
            shapes.len(),
            filter.rank(),
            filter.condition()
        );
        let rows = (0..shapes.len()).filter_map(|mode| filter.weights(mode));
        Ok(rows.map(|weights| Self { weights, notes: vec![note.clone()] }).collect())
    }

    /// The combination for one of several mass-normalised mode shapes: the modal filter where the shapes allow it, else the average of all
    /// channels, each over its shape value and weighted by that value's square (Sec. 4.4); the band must then keep other modes out. The filter is not used where it
    /// amplifies noise more than twice as much as the average does, or where there are more modes than the channels tell apart.
    ///
    /// # Errors
    /// As [`ModalFilter::new`] except for a rank that is too low; [`Error::Length`] for a mode that is not there.
    ///
    /// ```
    /// use iwan_ident::channels::Combination;
    /// // Two shapes that differ in a hundredth at one of two channels.
    /// let alike = [vec![1.0, 1.0], vec![1.0, 0.99]];
    /// assert!(Combination::of_shape(&alike, 0)?.weights.iter().all(|w| (w - 0.5).abs() < 1e-12));
    /// let apart = [vec![1.0, 1.0], vec![1.0, -1.0]];
    /// assert!(Combination::of_shape(&apart, 1)?.notes[0].contains("modal filter"));
    /// # Ok::<(), iwan_ident::Error>(())
    /// ```
    pub fn of_shape(shapes: &[Vec<f64>], mode: usize) -> Result<Self, Error> {
        check_length("mode shapes", shapes.len().min(mode + 1), mode + 1)?;
        let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let own = length(&shapes[mode]);
        let average = |why: String| {
            let weights = shapes[mode].iter().map(|p| p / (own * own)).collect();
            Self {
                weights,
                notes: vec![format!(
                    "average of {} channels over the mode's shape: {why}",
                    shapes[mode].len()
                )],
            }
        };
        let alone = std::slice::from_ref(&shapes[mode]);
        match Self::of_shapes(shapes).map(|mut all| all.swap_remove(mode)) {
            Ok(filter) if length(&filter.weights) * own <= AMPLIFIED => Ok(filter),
            Ok(filter) => Ok(average(format!(
                "a modal filter of {} shapes would amplify noise {:.1} times",
                shapes.len(),
                length(&filter.weights) * own
            ))),
            // A shape that is no shape even by itself is refused; shapes that cannot be told apart leave the average.
            Err(Error::Refused { finding, .. }) if Self::of_shapes(alone).is_ok() => Ok(average(finding)),
            Err(error) => Err(error),
        }
    }

    /// The record of the mode.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn apply(&self, channels: &[&[f64]]) -> Result<Vec<f64>, Error> {
        check_length("channels", channels.len(), self.weights.len())?;
        let samples = channels.first().map_or(0, |c| c.len());
        let mut sum = vec![0.0; samples];
        for (channel, weight) in channels.iter().zip(&self.weights) {
            check_length("channel", channel.len(), samples)?;
            sum.iter_mut().zip(*channel).for_each(|(q, x)| *q += weight * x);
        }
        Ok(sum)
    }
}

/// A sentence on channels that do not move with a mode's shape in its band: they are named, and stay part of the average.
///
/// # Errors
/// As [`Combination::dominant`].
pub fn strangers(
    channels: &[&[f64]],
    names: &[String],
    shape: &[f64],
    dt: f64,
    options: &Options,
) -> Result<Option<String>, Error> {
    check_length("names", names.len(), channels.len())?;
    check_length("shape", shape.len(), channels.len())?;
    let band = band_passed(channels, largest(shape), dt, options)?;
    outliers(&band.slices(), names, shape)
}

fn outliers(filtered: &[&[f64]], names: &[String], shape: &[f64]) -> Result<Option<String>, Error> {
    let average = scaled_average(filtered, shape)?;
    let list: Vec<String> = average
        .outliers
        .iter()
        .map(|&i| format!("{} (by {:.0} % of its part)", names[i], 100.0 * average.misfit[i].min(1e4)))
        .collect();
    let said = || format!("channels that do not move with the shape: {}; they still count", list.join(", "));
    Ok((!list.is_empty()).then(said))
}

/// The channels in a band of frequencies.
struct BandPassed {
    /// Edges of the band, Hz.
    low: f64,
    high: f64,
    channels: Vec<Vec<f64>>,
}

impl BandPassed {
    fn slices(&self) -> Vec<&[f64]> {
        self.channels.iter().map(Vec::as_slice).collect()
    }
}

/// The channels in the band of `options`, or else in the automatic band of the `reference` channel.
fn band_passed(
    channels: &[&[f64]],
    reference: usize,
    dt: f64,
    options: &Options,
) -> Result<BandPassed, Error> {
    let (low, high) = match options.band {
        Some(band) => band,
        None => automatic_band(channels[reference], dt, options.near).map(|b| (b.low, b.high))?,
    };
    let filter = Butterworth::new(options.filter_order.max(1), Passband::Band { low, high }, dt)?;
    let channels = channels.iter().map(|c| filter.forward_backward(c)).collect::<Result<_, _>>()?;
    Ok(BandPassed { low, high, channels })
}

fn loudest(channels: &[&[f64]]) -> Result<usize, Error> {
    let power: Vec<f64> = channels
        .iter()
        .map(|c| {
            let mean = c.iter().sum::<f64>() / c.len().max(1) as f64;
            c.iter().map(|x| (x - mean).powi(2)).sum()
        })
        .collect();
    if power.is_empty() {
        let remedy = "name at least one";
        return Err(Error::TooShort { what: "channels", found: 0, needed: 1, remedy });
    }
    Ok(largest(&power))
}

/// Index of the value of largest magnitude.
fn largest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&i, &j| values[i].abs().total_cmp(&values[j].abs())).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(factor: f64) -> Vec<f64> {
        (0..4000).map(|n| factor * (-1e-3 * f64::from(n)).exp() * (0.5 * f64::from(n)).sin()).collect()
    }

    fn names(count: usize) -> Vec<String> {
        (1..=count).map(|n| format!("a{n}")).collect()
    }

    #[test]
    fn a_combination_of_one_force_level_serves_another() {
        let (soft, hard) = ([wave(1.0), wave(-0.5)], [wave(3.0), wave(-1.5)]);
        let [soft, hard] = [&soft, &hard].map(|r| r.each_ref().map(Vec::as_slice));
        let both = Combination::dominant(&soft, &names(2), 1e-3, &Options::default()).unwrap();
        let found = both.apply(&hard).unwrap();
        assert!(found.iter().zip(hard[0]).all(|(q, x)| (q - x).abs() < 1e-9));
        assert!(both.apply(&hard[..1]).is_err());
    }

    #[test]
    fn a_channel_with_the_wrong_sign_is_named() {
        let channels = [wave(1.0), wave(0.9), wave(-0.2)];
        let channels = channels.each_ref().map(Vec::as_slice);
        let shape = [1.0, 0.9, 0.2];
        let words = strangers(&channels, &names(3), &shape, 1e-3, &Options::default()).unwrap().unwrap();
        assert!(words.contains("a3") && !words.contains("a1"), "{words}");
        let fits = strangers(&channels, &names(3), &[1.0, 0.9, -0.2], 1e-3, &Options::default()).unwrap();
        assert_eq!(fits, None);
    }

    #[test]
    fn nothing_to_combine_is_refused() {
        assert!(Combination::dominant(&[], &[], 1e-3, &Options::default()).is_err());
        assert!(Combination::dominant(&[&[0.0; 500]], &names(1), 1e-3, &Options::default()).is_err());
        assert!(Combination::of_shapes(&[vec![1.0], vec![2.0]]).is_err());
    }
}
