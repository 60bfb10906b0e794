//! The time from which the decay of the hardest hit is linear, by zeroed spectra: spectra of the decay with a growing part of its beginning set to
//! zero.

use iwan_modal::measure::Hit;
use iwan_modal::{Zeroed, zeroed};

use super::hits::Test;

/// The decay of a hit at one sensor, with its zeroed spectra.
pub(super) struct Decay {
    /// Names of hit and channel.
    pub(super) place: String,
    /// Time from the first sample of the hit to the first sample of the decay, s.
    pub(super) start: f64,
    pub(super) zeroed: Zeroed,
}

/// The pulse has ended once the force stays below this part of its peak.
const OVER: f64 = 0.01;

/// The decay of the hardest hit at the point of the hit or, where no sensor is there, at the sensor that moves most; none where no mode can be
/// identified in the late half.
pub(super) fn hardest(test: &Test, band: (f64, f64)) -> Option<Decay> {
    let used = test.hits.iter().filter(|h| !h.left_out).map(|h| &h.hit);
    let hit = used.max_by(|a, b| a.peak_force().total_cmp(&b.peak_force()))?;
    let (start, peak) = (end_of_pulse(hit), |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs())));
    let drive = hit.responses.iter().find(|c| c.freedom.is_at(&hit.force.freedom));
    let loudest = || hit.responses.iter().max_by(|a, b| peak(&a.samples).total_cmp(&peak(&b.samples)));
    let channel = drive.or_else(loudest)?;
    let zeroed = zeroed(&channel.samples[start..], hit.dt, band).ok()?;
    let place = format!("{}, channel {}", hit.name, channel.name);
    Some(Decay { place, start: start as f64 * hit.dt, zeroed })
}

/// Index of the first sample after the pulse of the hammer.
fn end_of_pulse(hit: &Hit) -> usize {
    let force = &hit.force.samples;
    let peak = hit.peak_force();
    force.iter().rposition(|f| f.abs() > OVER * peak).map_or(0, |n| (n + 1).min(force.len() - 1))
}
