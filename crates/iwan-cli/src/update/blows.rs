//! Blows on several points from record files.

use iwan_machine::listed;
use std::path::Path;

use iwan_fem::{Kinematic, Output};
use iwan_io::{ReadOptions, Record, Warning};
use iwan_study::update::{BlowTask, MeasuredBlow, MeasuredCurve};

use super::args::UpdateArgs;
use crate::failure::Failure;
use crate::records::Motion;
use crate::shown;
use crate::structures::Linear;

/// The blows of `--records`, and notes on them; none without that option.
pub(super) fn blows(
    linear: &Linear,
    args: &UpdateArgs,
    curves: &[MeasuredCurve],
) -> Result<Option<(BlowTask, Vec<String>)>, Failure> {
    let Some(load) = args.load.as_deref().filter(|_| !args.records.is_empty()) else { return Ok(None) };
    let mut modes = args.modes.clone();
    for curve in curves.iter().filter(|_| args.modes.is_empty()) {
        if !modes.contains(&curve.mode) {
            modes.push(curve.mode.clone());
        }
    }
    if modes.is_empty() {
        let message = "--records: no mode to compare records and structure by";
        return Err(Failure::input(
            message,
            "name the modes that the records show: --mode bending-1 --mode bending-3",
        ));
    }
    let named = linear.chosen(&modes).map_err(|error| linear.failed(&error))?;
    let outputs = linear.file.recorded(linear, &named).map_err(|error| linear.refused(error))?;
    let mut notes = Vec::new();
    let mut all = |paths: &[std::path::PathBuf]| -> Result<Vec<MeasuredBlow>, Failure> {
        paths.iter().map(|path| blow(path, load, args.quantity, &outputs, &mut notes)).collect()
    };
    let (blows, held_out) = (all(&args.records)?, all(&args.held_out_records)?);
    let load = linear.file.forces(&linear.assembled).map_err(|error| linear.refused(error))?;
    Ok(Some((BlowTask { load, blows, held_out, modes }, notes)))
}

/// Kinds of motion with the endings of the names of channels that measure them, in the order in which they are tried.
const KINDS: [(Kinematic, &str); 3] = [
    (Kinematic::Acceleration, "acceleration"),
    (Kinematic::Velocity, "velocity"),
    (Kinematic::Displacement, "displacement"),
];

fn blow(
    path: &Path,
    load: &str,
    quantity: Option<Motion>,
    outputs: &[Output],
    notes: &mut Vec<String>,
) -> Result<MeasuredBlow, Failure> {
    let place = shown::path(path);
    let read = |channels: Vec<String>, quantity: Option<iwan_io::Quantity>| -> Result<Record, Failure> {
        iwan_io::read(path, &ReadOptions { channels, quantity, ..ReadOptions::default() })
            .map_err(|e| Failure::read(&place, &e))
    };
    let force = read(vec![load.to_owned()], None)?;
    // A first reading of all channels, of any quantity, gives their names.
    let names = read(Vec::new(), Some(iwan_io::Quantity::Unknown))?.names().to_vec();
    let asked = quantity.map(|quantity| match quantity {
        Motion::Acceleration => Kinematic::Acceleration,
        Motion::Velocity => Kinematic::Velocity,
        Motion::Displacement => Kinematic::Displacement,
    });
    let called = |ending: Option<&str>| -> Vec<(Output, String)> {
        let channel = |output: &Output| {
            let name =
                ending.map_or_else(|| output.name.clone(), |ending| format!("{}.{ending}", output.name));
            names.contains(&name).then(|| (output.clone(), name))
        };
        outputs.iter().filter_map(channel).collect()
    };
    // Channels whose names end with a kind of motion come first, then channels that have just the name of an output.
    let said = KINDS.iter().filter(|(kind, _)| asked.is_none_or(|asked| asked == *kind));
    let found = said.map(|(kind, ending)| (Some(*kind), called(Some(ending)))).find(|(_, c)| !c.is_empty());
    let (kind, channels) = found.unwrap_or_else(|| (asked, called(None)));
    if channels.is_empty() {
        let known: Vec<&str> = outputs.iter().map(|output| output.name.as_str()).collect();
        let message = format!(
            "{place}: no channel is called as a mode or an output of the structure; it has {}",
            listed(names)
        );
        let remedy = format!(
            "call channels {} (or NAME.acceleration), or add [[output]] to the structure",
            listed(known)
        );
        return Err(Failure::input(message, remedy));
    }
    let record = read(channels.iter().map(|(_, name)| name.clone()).collect(), None)?;
    for warning in record.warnings() {
        if matches!(warning, Warning::Windowed { .. }) {
            let message = format!("{place}: {warning}");
            return Err(Failure::input(message, "joints are found from records without a window only"));
        }
        notes.push(format!("{place}: {warning}"));
    }
    let of_file = match record.quantity() {
        iwan_io::Quantity::Acceleration => Some(Kinematic::Acceleration),
        iwan_io::Quantity::Velocity => Some(Kinematic::Velocity),
        iwan_io::Quantity::Displacement => Some(Kinematic::Displacement),
        _ => None,
    };
    let kinematic = kind.or(of_file).unwrap_or_else(|| {
        notes.push(format!(
            "{place}: the file does not say what it measures: taken as acceleration; --quantity says otherwise"
        ));
        Kinematic::Acceleration
    });
    let samples = |name: &str| record.channel_named(name).map(<[f64]>::to_vec).unwrap_or_default();
    let points = channels.into_iter().map(|(output, name)| (output, samples(&name))).collect();
    Ok(MeasuredBlow { source: place, dt: record.dt(), force: force.samples()[0].clone(), points, kinematic })
}
