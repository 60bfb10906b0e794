//! From recordings of the same channels to the records of one mode: what a program does before it looks at a mode.

use super::combination::{Combination, strangers};
use crate::error::Error;
use crate::signal::Options;

/// The channels of one recording, sampled together.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording<'a> {
    /// Names of the channels.
    pub names: &'a [String],
    /// Samples of each channel.
    pub channels: Vec<&'a [f64]>,
    /// Sampling interval, s.
    pub dt: f64,
}

/// What is known of a mode's shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape<'a> {
    /// Nothing: a single channel stands for the mode; of several channels the shape that dominates in the band is taken.
    Unknown,
    /// One of several mass-normalised mode shapes.
    Known {
        /// `shapes[mode][channel]`: together the shapes make the modal filter, where they allow it.
        shapes: &'a [Vec<f64>],
        /// Which of them is wanted.
        mode: usize,
    },
}

/// The records of one mode.
#[derive(Debug, Clone, PartialEq)]
pub struct OneMode {
    /// One for each recording.
    pub records: Vec<Vec<f64>>,
    /// How the channels were combined, in words.
    pub notes: Vec<String>,
}

/// Why recordings cannot be combined, and whether shapes or a recording are the reason.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoMode {
    /// In the mode shapes.
    #[error(transparent)]
    Shapes(Error),
    /// In a recording.
    #[error("recording {index}: {error}")]
    Recording {
        /// Which one, counted from 0.
        index: usize,
        /// What is wrong with it.
        error: Error,
    },
}

/// The records of one mode from recordings of the same channels; the first recording decides how channels are combined.
///
/// # Errors
/// [`NoMode`] with what [`Combination::of_shape`], [`Combination::dominant`], [`strangers`] or [`Combination::apply`]
/// refuse.
///
/// # Panics
/// When there is no recording, or no mode shape of that number.
///
/// ```
/// use iwan_ident::channels::{Recording, Shape, one_mode};
/// let wave = |a: f64| -> Vec<f64> { (0..4000).map(|n| a * (-0.001 * n as f64).exp() * (0.5 * n as f64).sin()).collect() };
/// let (tip, root, names) = (wave(2.0), wave(-1.0), ["tip".to_string(), "root".to_string()]);
/// let recording = Recording { names: &names, channels: vec![&tip, &root], dt: 1e-3 };
/// let by_itself = one_mode(&[recording.clone()], Shape::Unknown, &Default::default())?;
/// // Amplitudes are those of the channel that moves most …
/// assert!((by_itself.records[0][3] / tip[3] - 1.0).abs() < 1e-9);
/// // … or those of the mode, where its shape is given: 2 = 0.5 q.
/// let shapes = [vec![0.5, -0.25]];
/// let known = one_mode(&[recording], Shape::Known { shapes: &shapes, mode: 0 }, &Default::default())?;
/// assert!((known.records[0][3] / (2.0 * tip[3]) - 1.0).abs() < 1e-9);
/// # Ok::<(), iwan_ident::channels::NoMode>(())
/// ```
pub fn one_mode(
    recordings: &[Recording<'_>],
    shape: Shape<'_>,
    options: &Options,
) -> Result<OneMode, NoMode> {
    let first = &recordings[0];
    let of_first = |error| NoMode::Recording { index: 0, error };
    let combination = match shape {
        Shape::Known { shapes, mode } => {
            let mut combination = Combination::of_shape(shapes, mode).map_err(NoMode::Shapes)?;
            combination.notes.extend(doubts(first, &shapes[mode], options).map_err(of_first)?);
            combination
        }
        Shape::Unknown if first.channels.len() == 1 => Combination::single(),
        Shape::Unknown => {
            Combination::dominant(&first.channels, first.names, first.dt, options).map_err(of_first)?
        }
    };
    let record = |(index, recording): (usize, &Recording<'_>)| {
        combination.apply(&recording.channels).map_err(|error| NoMode::Recording { index, error })
    };
    let records = recordings.iter().enumerate().map(record).collect::<Result<_, _>>()?;
    Ok(OneMode { records, notes: combination.notes })
}

/// A sentence on channels that do not move with the shape, if there are any. With one channel there is nothing to compare, and a shape of another length
/// is refused when the channels are combined.
fn doubts(recording: &Recording<'_>, shape: &[f64], options: &Options) -> Result<Option<String>, Error> {
    if recording.channels.len() < 2 || shape.len() != recording.channels.len() {
        return Ok(None);
    }
    strangers(&recording.channels, recording.names, shape, recording.dt, options)
}
