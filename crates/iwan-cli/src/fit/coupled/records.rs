//! From files to records of several modes at once.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use iwan_core::Progress;
use iwan_ident::coupled::{CoupledFit, CoupledRecord, CoupledTask, Seen, UncoupledMode, fit_coupled};
use iwan_ident::curve_fit::{fit, start};
use iwan_ident::curves::Quantity;
use iwan_ident::signal::{Method, Treatment};
use iwan_ident::{Error, Parameters};
use iwan_io::{ReadOptions, Record, Warning};

use crate::failure::Failure;
use crate::fit::args::FitArgs;
use crate::identified::extract;
use crate::records::{self, Extraction, Recording, Wanted};
use crate::shown;

/// Start values of a mode whose curves give none. K_T is this share, 2 %, of the modal stiffness ω², and F_S = K_T times the largest displacement, so
/// that the record does not quite reach macro-slip. (`UNTOLD`: damping ratio, χ, β.)
const JOINT_SHARE: f64 = 0.02;
const UNTOLD: (f64, f64, f64) = (1e-3, -0.3, 0.1);

/// The records and modes of a coupled fit.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    pub(crate) records: Vec<CoupledRecord>,
    pub(crate) held_out: Vec<CoupledRecord>,
    pub(crate) modes: Vec<UncoupledMode>,
    pub(crate) quantity: Quantity,
    pub(crate) seen: Seen,
    pub(crate) warnings: Vec<String>,
    /// Whether a record was windowed, or filtered next to a mode, before it was given here.
    treated: bool,
}

impl Measured {
    /// Reads all files and identifies the modes in them by bands or shapes.
    pub(super) fn read(args: &FitArgs) -> Result<Self, Failure> {
        let load = args.load.as_deref();
        let fitted = files(&args.fit, args, load)?;
        let held = files(&args.held_out, args, load)?;
        let seen = if args.records.shapes.is_some() { Seen::Modes } else { Seen::Sum };
        // A channel for which the file of shapes has no value may be the load.
        let modes = |recordings: &[Recording]| {
            let found = records::modes(recordings, &args.records);
            found.map_err(|failure| match load {
                None if seen == Seen::Modes => failure.or("say --load CHANNEL if one of them is the load"),
                _ => failure,
            })
        };
        Self::new(&fitted, &held, (seen, args.method.method()), args.common.thread_count(), modes)
    }

    /// Extracts the modes from the recordings that are fitted and those that are held out.
    pub(crate) fn new(
        fitted: &[Loaded],
        held: &[Loaded],
        (seen, method): (Seen, Method),
        threads: usize,
        find: impl Fn(&[Recording]) -> Result<Vec<Wanted>, Failure>,
    ) -> Result<Self, Failure> {
        let mut recordings: Vec<Recording> = fitted.iter().map(|(r, _)| r.clone()).collect();
        let wanted = find(&recordings)?;
        if wanted.len() < 2 {
            let message = "modes that share joints are at least two, but one is wanted";
            return Err(Failure::input(
                message,
                "name them with --band LOW:HIGH or --mode HZ for each, or with --shapes",
            ));
        }
        let channels = recordings[0].record.names().len();
        if seen == Seen::Sum && channels > 1 {
            let message = format!("{channels} channels, and no mode shapes to tell the modes apart by");
            return Err(Failure::input(message, "give --shapes FILE, or choose one channel with --channel"));
        }
        let (mut modes, mut ends) = (Vec::new(), vec![0; recordings.len()]);
        let mut warnings: Vec<String> =
            fitted.iter().chain(held).flat_map(|(r, _)| r.warnings.clone()).collect();
        let mut treated = false;
        for one in &wanted {
            let extractions = extract(&recordings, one, method, threads)?;
            for ((end, x), recording) in ends.iter_mut().zip(&extractions).zip(&recordings) {
                *end = x.isolated.window.end.max(*end);
                let peak = x.isolated.band.peak;
                let Some(seen) = x.isolated.treatment.filter(|seen| seen.spoils(peak)) else { continue };
                treated = true;
                // What its file says is among the recording's warnings.
                if seen != Treatment::Declared {
                    warnings.push(format!("{}: {}", recording.name, seen.in_words(peak)));
                }
            }
            modes.push(UncoupledMode { name: one.name.clone(), parameters: by_itself(&extractions) });
        }
        let quantity = recordings[0].quantity;
        let slowest = modes.iter().map(|m| m.parameters.frequency).fold(f64::INFINITY, f64::min);
        let take = |(n, (recording, force)): (usize, &Loaded), wanted: &[Wanted], seen| {
            let motions = match seen {
                Seen::Modes => wanted.iter().map(|mode| mode.records[n].samples.clone()).collect(),
                Seen::Sum => vec![recording.record.samples()[0].clone()],
            };
            CoupledRecord {
                name: recording.name.clone(),
                dt: recording.record.dt(),
                motions,
                force: force.clone(),
            }
        };
        let mut records: Vec<CoupledRecord> =
            fitted.iter().enumerate().map(|one| take(one, &wanted, seen)).collect();
        for (record, end) in records.iter_mut().zip(ends) {
            cut(record, slowest, Some(end));
        }
        let mut held_out = Vec::new();
        if !held.is_empty() {
            recordings = held.iter().map(|(r, _)| r.clone()).collect();
            let wanted = find(&recordings)?;
            held_out = held.iter().enumerate().map(|one| take(one, &wanted, seen)).collect();
            let longest = records.iter().map(|r| r.dt * r.motions[0].len() as f64).fold(0.0, f64::max);
            for record in &mut held_out {
                let end = (longest / record.dt) as usize;
                cut(record, slowest, Some(end));
            }
        }
        Ok(Self { records, held_out, modes, quantity, seen, warnings, treated })
    }

    /// Fits linear modes, modes with joints of their own and modes that share joints; results do not depend on `threads`.
    ///
    /// # Errors
    /// Those of [`fit_coupled`].
    pub(crate) fn fit(
        &self,
        shape_at_force: Option<&[f64]>,
        threads: usize,
        stopped: &AtomicBool,
        progress: Progress<'_>,
    ) -> Result<CoupledFit, Error> {
        let found = fit_coupled(&CoupledTask {
            records: &self.records,
            held_out: &self.held_out,
            modes: &self.modes,
            quantity: self.quantity,
            seen: self.seen,
            shape_at_force,
            threads,
            stopped,
            progress,
        })?;
        Ok(if self.treated { found.of_treated() } else { found })
    }
}

/// A recording with its load, where that is known.
pub(crate) type Loaded = (Recording, Option<Vec<f64>>);

/// Reads the files; with `load`, the channel of that name becomes the force of each recording.
fn files(paths: &[std::path::PathBuf], args: &FitArgs, load: Option<&str>) -> Result<Vec<Loaded>, Failure> {
    let Some(load) = load else {
        let mut recordings = records::read_all(paths, &args.records, args.common.thread_count())?;
        if let Some(first) = recordings.first_mut() {
            first.warnings.extend(without_load(&first.record));
        }
        return Ok(recordings.into_iter().map(|recording| (recording, None)).collect());
    };
    let mut all = Vec::new();
    for path in paths {
        let name = shown::path(path);
        let force = channel(path, args, load)?;
        let mut own = args.records.clone();
        if own.channels.is_empty() {
            let everything = channels(path, args)?;
            own.channels = everything.into_iter().filter(|channel| channel != load).collect();
        }
        let recording = records::read(path, &own)?;
        let force = force.samples()[0].clone();
        if force.len() != recording.record.samples()[0].len() {
            let message =
                format!("{name}: channel \"{load}\" has {} samples, the others differ", force.len());
            return Err(Failure::input(message, "give the load on the clock of the motions"));
        }
        all.push((recording, Some(force)));
    }
    Ok(all)
}

/// A warning where a force channel is left out of the analysis and --load names no channel.
fn without_load(record: &Record) -> Option<String> {
    let left_out = |warning: &Warning| match warning {
        Warning::LeftOut { name, reason } if reason.contains(&iwan_io::Quantity::Force.to_string()) => {
            Some(name.clone())
        }
        _ => None,
    };
    let name = record.warnings().iter().find_map(left_out)?;
    Some(format!(
        "no load is named: the records are taken for free decays behind their blows; say --load {name} if that is the load"
    ))
}

/// Reads one channel of a file, whatever quantity it measures.
fn channel(path: &Path, args: &FitArgs, name: &str) -> Result<Record, Failure> {
    let options = options(args, vec![name.into()]);
    let place = shown::path(path);
    let record = iwan_io::read(path, &options).map_err(|e| Failure::read(&place, &e))?;
    record.between(args.records.from, args.records.to).map_err(|e| Failure::said(&place, &e))
}

/// Names of all channels of a file.
fn channels(path: &Path, args: &FitArgs) -> Result<Vec<String>, Failure> {
    let place = shown::path(path);
    let record = iwan_io::read(path, &options(args, Vec::new())).map_err(|e| Failure::read(&place, &e))?;
    Ok(record.names().to_vec())
}

fn options(args: &FitArgs, channels: Vec<String>) -> ReadOptions {
    ReadOptions {
        format: None,
        time: args.records.time.clone(),
        channels,
        rate: args.records.rate,
        quantity: None,
        resample: args.records.resample,
        time_unit: args.records.time_unit,
        unit: None,
    }
}

/// Parameters of the mode alone, fitted to its own curves: the start values of the coupled search.
fn by_itself(extractions: &[Extraction]) -> Parameters {
    let curves: Vec<_> = extractions.iter().map(|x| x.curves.clone()).collect();
    // The record with the largest displacement shows most of the joint.
    let largest = |c: &iwan_ident::curves::Curves| c.displacement.iter().copied().fold(0.0, f64::max);
    let loudest = curves.iter().max_by(|a, b| largest(a).total_cmp(&largest(b)));
    let first = loudest.and_then(|c| start(c).ok()).map(|s| s.parameters);
    if let Some(first) = first {
        return fit(&curves, &first, &[]).map_or(first, |found| found.parameters);
    }
    let frequency = extractions[0].isolated.band.peak;
    let k_t = JOINT_SHARE * (std::f64::consts::TAU * frequency).powi(2);
    let top = loudest.map_or(1.0, largest);
    let (damping_ratio, chi, beta) = UNTOLD;
    Parameters { frequency, damping_ratio, k_t, f_s: k_t * top.max(f64::MIN_POSITIVE), chi, beta }
}

/// Cuts a record to the samples that are used: a free decay begins once the blow is over, a forced record at its first sample; both end where the
/// modes sink into noise.
fn cut(record: &mut CoupledRecord, slowest: f64, end: Option<usize>) {
    let samples = record.motions[0].len();
    let mut first = 0;
    if record.force.is_none() {
        let size = |n: usize| record.motions.iter().map(|m| m[n].abs()).fold(0.0, f64::max);
        let largest = (0..samples).max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap_or(0);
        // A largest motion at the very beginning means that the blow was over before the record began. Otherwise half a period of the slowest mode is
        // skipped, which is longer than any hammer's pulse.
        let behind = (0.5 / (slowest * record.dt)).ceil() as usize;
        first = if largest < behind { largest } else { largest + behind };
    }
    let end = end.unwrap_or(samples).clamp((first + samples.min(64)).min(samples), samples);
    for motion in &mut record.motions {
        *motion = motion[first.min(end)..end].to_vec();
    }
    if let Some(force) = &mut record.force {
        *force = force[first..end].to_vec();
    }
}
