//! Mistakes that make curves useless and that show when the structure is known: wrong units, and curves of other modes.

use std::f64::consts::TAU;

use iwan_fem::NamedModes;

use super::fitted::JointUpdate;
use super::group::JointGroup;
use super::model::Said;
use super::task::Placed;
use crate::error::Error;

/// Factors by which other units change a frequency in Hz, with a sentence on each.
const UNITS: [(f64, &str); 4] = [
    (TAU, "it looks like an angular frequency in rad/s"),
    (60.0, "it looks like revolutions per minute"),
    (1e3, "it looks like mHz"),
    (1e-3, "it looks like kHz"),
];
/// A frequency is explained by a unit, or by another mode, where its logarithm agrees within this: even structures with guessed joints are nearer
/// than 10 %.
const NEAR: f64 = 0.1;
/// A frequency twice or half that of the mode cannot be the mode's: joints move the modes of assembled structures by less.
const OFF: f64 = 2.0;
/// Amplitudes above this multiple of the onset of macro-slip, or below its inverse, suggest another unit of length: metres and millimetres differ by
/// 1000, start values of slip forces by a factor of 3 or so.
const AMPLITUDES: f64 = 30.0;
/// Damping between these multiples of that of the joints as given suggests per cent: the factor is then 100, and start values are off by 3 or so
/// either way.
const PER_CENT: (f64, f64) = (30.0, 300.0);
/// A frequency counts as rising with amplitude where its mean over the upper third of the amplitudes exceeds that over the lower third by this part:
/// as much as temperature changes it from day to day.
const RISES: f64 = 1e-4;

/// Factor by which a frequency lies outside the range between the mode's frequencies with joints slipping and stuck; 1 within the range.
fn off(named: &NamedModes, mode: &iwan_fem::NamedMode, frequency: f64) -> f64 {
    let (a, b) = (named.frequency_slipping(mode), named.frequency_stuck(mode));
    frequency / frequency.clamp(a.min(b), a.max(b))
}

/// Refuses frequencies more than twice or less than half of the mode's, with the unit or the other mode that explains them, and damping ratios of 1
/// or more.
pub(super) fn refuse(named: &NamedModes, measured: &[Placed<'_>]) -> Result<(), Error> {
    for placed in measured {
        let refused = |finding, remedy| {
            let place = format!("{}, {}", placed.curve.source, placed.curve.mode);
            Err(Error::Update { place, finding, remedy })
        };
        let beyond = placed.points.iter().map(|p| p.log_damping.exp()).fold(0.0_f64, f64::max);
        if beyond >= 1.0 {
            return refused(
                format!(
                    "the damping ratio reaches {beyond:.3}, and a mode beyond 1 does not ring: it looks like per cent"
                ),
                "divide the damping ratio by 100, so that 0.01 is one per cent",
            );
        }
        let Some(frequency) = placed.points.first().map(|p| p.frequency) else { continue };
        let mode = named.named(&placed.curve.mode).map_err(Error::structure(&placed.curve.source))?;
        let ratio = off(named, mode, frequency);
        if (OFF.recip()..OFF).contains(&ratio) {
            continue;
        }
        let says = format!(
            "the frequency {frequency:.5} at the smallest amplitude is {ratio:.3} times that of the structure ({:.5} Hz with all joints stuck)",
            named.frequency_stuck(mode)
        );
        let unit = UNITS.iter().find(|(factor, _)| (ratio / factor).ln().abs() < NEAR);
        let other = nearest(named, frequency);
        match (unit, other) {
            (Some((factor, looks)), None) => {
                return refused(
                    format!("{says}: {looks}, {factor:.4} for each Hz"),
                    "give frequencies in Hz",
                );
            }
            (Some((_, looks)), Some(other)) => {
                return refused(
                    format!("{says}: {looks}, or it is that of {other}"),
                    "give frequencies in Hz, and before each file the modes in the order in which it has them",
                );
            }
            (None, Some(other)) => {
                return refused(
                    format!("{says}: it is that of {other}"),
                    "name the mode whose curve this is: two curves may have been exchanged",
                );
            }
            (None, None) => {}
        }
    }
    Ok(())
}

/// Name of the mode that has this frequency; none where no mode has.
fn nearest(named: &NamedModes, frequency: f64) -> Option<String> {
    let distance = |mode: &&iwan_fem::NamedMode| off(named, mode, frequency).ln().abs();
    let mode = named.elastic.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(&mode) < NEAR / 2.0)
        .then(|| format!("{} ({:.5} Hz with all joints stuck)", mode.name, named.frequency_stuck(mode)))
}

/// Sentences on groups whose slip forces look like those of another unit of length. Stiffness does not depend on that unit; curves in millimetres are
/// therefore described as well as those in metres, by joints a thousand times as strong.
pub(super) fn other_length(groups: &[JointGroup], found: &[JointUpdate]) -> Vec<String> {
    let of = |(group, found): (&JointGroup, &JointUpdate)| {
        let given = group.law.f_s();
        let above = found.f_s.low.is_some_and(|low| low > AMPLITUDES * given);
        let below = found.f_s.high.is_some_and(|high| high < given / AMPLITUDES);
        (above || below).then(|| {
            let (ratio, does) = (found.f_s.value / given, if above { "divided" } else { "multiplied" });
            format!(
                "the slip force of {} is {ratio:.3e} times that of the file: displacements in another unit of length (metres and millimetres) would make \
                 it so, and would be {does} by 1000; they are modal and mass-normalised, in the units of the structure",
                found.name
            )
        })
    };
    groups.iter().zip(found).filter_map(of).collect()
}

/// Possible mistakes in curves that the structure does not describe. `before` holds the structure's own curves with the joints of its file, where
/// these can be computed.
pub(super) fn hints(
    named: &NamedModes,
    measured: &[Placed<'_>],
    before: &[Option<Vec<Said>>],
) -> Vec<String> {
    let mut all = Vec::new();
    for (placed, before) in measured.iter().zip(before) {
        let (mode, points) = (&placed.curve.mode, &placed.points);
        let Ok(own) = named.named(mode) else { continue };
        let ratio = off(named, own, points[0].frequency);
        if !((-NEAR).exp()..NEAR.exp()).contains(&ratio) {
            let other = nearest(named, points[0].frequency);
            let other = other.map_or_else(String::new, |other| format!(", and is nearer to that of {other}"));
            all.push(format!(
                "the frequency of {mode} at the smallest amplitude is {ratio:.3} times that of the structure{other}"
            ));
        }
        if let Some(onset) = named.onset(own) {
            let reach = points[points.len() - 1].displacement / onset;
            if reach > AMPLITUDES {
                all.push(format!(
                    "the amplitudes of {mode} reach {reach:.3e} times the onset of macro-slip of the joints in the file: in another unit of length \
                     (millimetres for metres) they would be divided by 1000; displacements are modal and mass-normalised, in the units of the structure"
                ));
            } else if reach < AMPLITUDES.recip() {
                all.push(format!(
                    "the amplitudes of {mode} reach {reach:.3e} of the onset of macro-slip of the joints in the file: in another unit of length (metres \
                     for millimetres) they would be multiplied by 1000; displacements are modal and mass-normalised, in the units of the structure"
                ));
            }
        }
        if let Some(said) = before {
            let mut ratios: Vec<f64> =
                points.iter().zip(said).map(|(p, s)| (p.log_damping - s.log_damping).exp()).collect();
            ratios.sort_by(f64::total_cmp);
            let median = ratios[ratios.len() / 2];
            if (PER_CENT.0..PER_CENT.1).contains(&median) {
                all.push(format!(
                    "the damping ratio of {mode} is {median:.0} times that of the joints in the file: in per cent it would be divided by 100"
                ));
            }
        }
        let third = points.len().div_ceil(3);
        let mean = |part: &[super::measured::Point]| {
            part.iter().map(|p| p.frequency).sum::<f64>() / part.len() as f64
        };
        let (low, high) = (mean(&points[..third]), mean(&points[points.len() - third..]));
        if high > low * (1.0 + RISES) {
            all.push(format!(
                "the frequency of {mode} rises with the amplitude, from {low:.5} to {high:.5} Hz, and joints that slip let it fall: the amplitudes may \
                 stand in the opposite order to the frequencies"
            ));
        }
    }
    all
}
