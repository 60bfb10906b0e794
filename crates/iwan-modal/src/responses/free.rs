//! Free decays without a measured force: their Fourier transforms take the place of responses.

use rayon::prelude::*;

use super::set::{FiniteRecord, FrequencyResponses, Function};
use super::transform::{Record, Room, Transform};
use crate::error::{Error, check};
use crate::measure::{Channel, Freedom, Motion};

/// Least number of samples of a decay; shorter ones are refused.
const FEWEST: usize = 64;

/// Free decays, each a set of channels sampled together every `dt` seconds, as "responses": for each channel of each decay one function, its
/// transform, with the decay's number as the point of force. Such functions show poles and shapes of the modes as responses to a force do, but neither scale nor
/// participation.
///
/// # Errors
/// [`Error::OutOfRange`] for `dt`; [`Error::Refused`] without decays, for lengths that differ, and for less than 64 samples;
/// [`Error::NotFinite`].
///
/// ```
/// use iwan_modal::measure::{Channel, Freedom, Motion};
/// use iwan_modal::responses::free_responses;
/// let decay = (0..4096).map(|n| (-2e-4 * n as f64).exp() * (0.25 * n as f64).cos()).collect();
/// let tip = Channel { name: "tip".into(), freedom: Freedom::point("tip"), samples: decay };
/// let responses = free_responses(&[vec![tip]], 1e-3, Motion::Acceleration)?;
/// let fit = iwan_modal::modal_fit(&responses, Some((20.0, 80.0)), &iwan_modal::Analysis::Chart, 20)?;
/// assert!((fit.modes[0].pole.re + 0.2).abs() < 1e-6 && (fit.modes[0].pole.im - 250.0).abs() < 1e-6);
/// # Ok::<(), iwan_modal::Error>(())
/// ```
pub fn free_responses(decays: &[Vec<Channel>], dt: f64, motion: Motion) -> Result<FrequencyResponses, Error> {
    let samples = common_length(decays, dt)?;
    let transform = Transform::new(samples, dt);
    let numbered = decays.iter().enumerate().flat_map(|(n, decay)| decay.iter().map(move |c| (n, c)));
    let tasks: Vec<(usize, &Channel)> = numbered.collect();
    let functions = |room: &mut Room, two: &[(usize, &Channel)]| {
        let mut found = Vec::with_capacity(2);
        transform.each(
            two.iter().map(|(_, channel)| Record::of(&channel.samples)),
            None,
            room,
            |i, spectrum| {
                let (n, channel) = two[i];
                found.push(Function {
                    name: channel.name.clone(),
                    response: channel.freedom.clone(),
                    force: Freedom::point(format!("decay {}", n + 1)),
                    hits: 1,
                    values: spectrum.to_vec(),
                    coherence: Vec::new(),
                    variance: Vec::new(),
                });
            },
        );
        found
    };
    Ok(FrequencyResponses {
        step: 1.0 / (samples as f64 * dt),
        functions: tasks.par_chunks(2).map_init(|| transform.room(), functions).flatten_iter().collect(),
        motion,
        force: Vec::new(),
        decay: 0.0,
        record: Some(FiniteRecord::free(samples, dt)),
    })
}

/// The number of samples that all channels of all decays have; an error where they differ.
pub(crate) fn common_length(decays: &[Vec<Channel>], dt: f64) -> Result<usize, Error> {
    check("dt", dt, dt > 0.0, "a sampling interval > 0 s", "give the sampling interval in seconds")?;
    let samples = decays.first().and_then(|d| d.first()).map_or(0, |c| c.samples.len());
    if samples < FEWEST {
        let finding = format!("{samples} samples, at least {FEWEST} are needed");
        return Err(Error::refused("free decays", finding, "give decays that are longer"));
    }
    for (n, decay) in decays.iter().enumerate() {
        for channel in decay {
            let place = format!("decay {}, channel {}", n + 1, channel.name);
            if channel.samples.len() != samples {
                let finding = format!("{} samples, the first channel has {samples}", channel.samples.len());
                return Err(Error::refused(place, finding, "cut all decays to one length"));
            }
            if let Some(index) = channel.samples.iter().position(|x| !x.is_finite()) {
                return Err(Error::NotFinite { place, index, value: channel.samples[index] });
            }
        }
    }
    Ok(samples)
}
