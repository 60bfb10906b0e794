//! `iwan fit` from records to its results.

use iwan_core::Pulse;
use iwan_core::progress::UNWATCHED;
use iwan_input::scenario::{Scenario, to_toml};
use iwan_io::Table;
use iwan_machine::checkpoint::Digest;
use iwan_machine::threads::at_once;
use iwan_sim::in_parallel;

use super::args::FitArgs;
use super::coupled;
use super::laws::{BY_CURVES, IWAN};
use super::modal::over_from_modal;
use super::report::{Reported, render};
use super::scenario::as_scenario;
use super::summary::FitSummary;
use super::sweeps::{self, RingDowns};
use crate::failure::Failure;
use crate::identified::{Identified, extract};
use crate::records::{self, Extraction, Recording, Units, Wanted};
use crate::session::{PAGE, SUMMARY, Session};
use crate::simulate::response_columns;

/// File with the whole summary, curves and densities included; `summary.json` leaves out these long lists.
const WHOLE: &str = "fit.json";
/// File with the fitted Iwan joint as a scenario.
const SCENARIO: &str = "scenario.toml";
/// File with the chosen law as a scenario, written where that law is not the Iwan joint.
const LAW: &str = "scenario-law.toml";
/// File with the curves (frequency and damping against amplitude) as a scenario.
const CURVES: &str = "scenario-curves.toml";

/// Runs the command.
pub(crate) fn run(mut args: FitArgs) -> Result<(), Failure> {
    let folder = args.modal.take();
    let measured = folder.map(|folder| over_from_modal(&mut args, &folder)).transpose()?;
    let args = &args;
    if args.keeping.checkpoint.is_some() && (args.coupled || args.fit.is_empty()) {
        let message = "--checkpoint keeps fits of ring-downs mode by mode, and is not for --coupled or for sweeps alone";
        return Err(Failure::input(message, "leave it out"));
    }
    if args.coupled {
        return coupled::fit(args);
    }
    if !args.sweeps.is_empty() || !args.backbones.is_empty() {
        return sweeps::fit(args, |session| ring_downs(args, session));
    }
    let recordings = records::read_all(&args.fit, &args.records, args.common.thread_count())?;
    let [curves, response] = ["curves", "response"].map(|stem| args.format.file(stem));
    let files = [WHOLE, SUMMARY, SCENARIO, LAW, CURVES, PAGE, &curves, &response];
    let mut session = Session::open(args.place(), &args.common, files)?;
    Recording::announce(&recordings, &mut session);

    let wanted = records::modes(&recordings, &args.records)?;
    let numbers: Vec<usize> = wanted.iter().map(|mode| mode.number).collect();
    let placed = |mut scenario: Scenario| {
        if let Some(measured) = &measured {
            measured.place(&mut scenario, &numbers);
        }
        scenario
    };
    let identified = identify_all(&recordings, wanted, args, &mut session)?;
    let (unit, quantity) = (recordings[0].record.unit(), recordings[0].quantity);
    let units = Units::new(unit, quantity, args.records.mass_normalised());
    let mut summary = FitSummary::new(&recordings, &identified, args.records.force_axis, &units);
    if let Some(law) = &args.law {
        summary.modes.iter_mut().for_each(|mode| mode.law = Some(law.clone()));
    }
    summary.judge();
    let asked = args.law.clone().filter(|law| law != IWAN);
    let scenario = placed(as_scenario(&identified, &summary.title(), |_| asked.clone())?);
    let toml = to_toml(&scenario, "");

    session.columns(&curves, &curve_columns(&identified), args.format)?;
    write_response(&mut session, &scenario, &response, args)?;
    session.file(SCENARIO, toml.as_bytes())?;
    write_others(&mut session, &identified, &summary, &placed)?;
    session.summary(WHOLE, &summary)?;
    session.summary(SUMMARY, &summary.without_curves())?;
    session.page(&render(&Reported {
        identified: &identified,
        summary: &summary,
        units: &units,
        toml: &toml,
    }))?;
    session.finish(&summary)
}

/// Reads and identifies the ring-downs that are fitted together with sweeps; none where no record is given.
fn ring_downs(args: &FitArgs, session: &mut Session) -> Result<Option<RingDowns>, Failure> {
    if args.fit.is_empty() {
        return Ok(None);
    }
    let recordings = records::read_all(&args.fit, &args.records, args.common.thread_count())?;
    Recording::announce(&recordings, session);
    let wanted = records::modes(&recordings, &args.records)?;
    if wanted.len() > 1 {
        let message = format!("{} modes are wanted, but sweeps and backbones are those of one", wanted.len());
        return Err(Failure::input(message, "choose one with --band LOW:HIGH or --mode HZ"));
    }
    let identified = identify_all(&recordings, wanted, args, session)?;
    Ok(identified.into_iter().next().map(|i| RingDowns {
        files: recordings.iter().map(|recording| recording.name.clone()).collect(),
        mode: i.name.clone(),
        informed: i.found.informed(),
        likelihood: i.found.likelihood.clone(),
    }))
}

/// Writes the chosen laws as a scenario where one of them is not the Iwan joint, and the curves as a scenario where every mode has curves.
fn write_others(
    session: &mut Session,
    identified: &[Identified],
    summary: &FitSummary,
    placed: &dyn Fn(Scenario) -> Scenario,
) -> Result<(), Failure> {
    let chosen = |i: &Identified| {
        let name = i.found.laws.as_ref().ok().map(|laws| laws.chosen().law.name.to_string());
        name.filter(|name| name != IWAN)
    };
    if identified.iter().any(|i| chosen(i).is_some()) {
        let scenario = placed(as_scenario(identified, &summary.title(), chosen)?);
        session.file(LAW, to_toml(&scenario, "").as_bytes())?;
    } else {
        session.omit(LAW);
    }
    if identified.iter().all(|i| i.found.laws.as_ref().is_ok_and(|laws| laws.backbone.is_curve())) {
        let scenario = placed(as_scenario(identified, &summary.title(), |_| Some(BY_CURVES.to_string()))?);
        session.file(CURVES, to_toml(&scenario, "").as_bytes())?;
    } else {
        session.omit(CURVES);
    }
    Ok(())
}

fn failed(error: &dyn std::fmt::Display) -> Failure {
    Failure::computation(error.to_string())
}

/// Identifies every mode. An identification computes up to a hundred thousand ring-downs; it therefore runs beside the main thread, which watches for
/// Ctrl-C.
fn identify_all(
    recordings: &[Recording],
    wanted: Vec<Wanted>,
    args: &FitArgs,
    session: &mut Session,
) -> Result<Vec<Identified>, Failure> {
    let (method, axis, threads) = (args.method.method(), args.records.force_axis, session.threads());
    let (recordings, hold) = (recordings.to_vec(), args.hold.clone());
    let kept = session.checkpoint(&args.keeping, "a fit", || {
        let options = Digest::default().text(&method).text(&axis).text(&hold).text(&wanted);
        let record = |digest: Digest, r: &Recording| digest.numbers(&[r.record.dt()]).text(&r.quantity);
        recordings.iter().fold(options, record)
    })?;
    let work = move || {
        let first = |mode: &Wanted| extract(&recordings, mode, method, threads);
        let extracted: Result<Vec<_>, Failure> = wanted.iter().map(first).collect();
        let pairs: Vec<_> = wanted.into_iter().zip(extracted?).collect();
        let then = |(mode, extractions): &(Wanted, Vec<Extraction>)| {
            Identified::new(&recordings, mode, extractions.clone(), axis, &hold, kept.as_ref())
        };
        in_parallel(&pairs, threads, &then).into_iter().collect()
    };
    session.busy("identifying").wait(work)?
}

/// Simulates the scenario and writes the response, as `iwan simulate` would.
fn write_response(
    session: &mut Session,
    scenario: &Scenario,
    name: &str,
    args: &FitArgs,
) -> Result<(), Failure> {
    let (modes, settings) = (scenario.modes(), &scenario.settings);
    let responses = iwan_sim::simulate_all(&modes, &Pulse::None, settings, at_once(), UNWATCHED);
    let responses = responses.map_err(|error| failed(&error))?;
    let times: Vec<f64> = responses.first().map(|r| r.times().collect()).unwrap_or_default();
    let columns = response_columns(&times, scenario, &responses, &[]);
    let table = Table::new(columns).map_err(|error| failed(&error))?;
    session.table(name, &table, args.format)
}

/// The columns of the curves: modes and records stand below each other, told apart by their numbers.
fn curve_columns(identified: &[Identified]) -> Vec<(&'static str, Vec<f64>)> {
    const NAMES: [&str; 12] = [
        "mode",
        "record",
        "t",
        "amplitude",
        "displacement",
        "frequency",
        "damping_ratio",
        "dissipation",
        "force",
        "frequency_sd",
        "log_dissipation_sd",
        "noise",
    ];
    let mut columns = NAMES.map(|name| (name, Vec::new()));
    for (mode, i) in identified.iter().enumerate() {
        for (record, c) in i.curves.iter().enumerate() {
            let n = c.t.len();
            let number = |k: f64| vec![k; n];
            let start = i.extractions[record].start;
            let envelope = &i.found.envelopes[record];
            let parts = [
                number((mode + 1) as f64),
                number((record + 1) as f64),
                c.t.iter().map(|t| start + t).collect(),
                envelope.amplitude.clone(),
                c.displacement.clone(),
                c.frequency.clone(),
                c.damping_ratio.clone(),
                c.dissipation.clone(),
                c.force.clone(),
                c.frequency_sd.clone(),
                c.log_dissipation_sd.clone(),
                number(envelope.noise),
            ];
            columns.iter_mut().zip(parts).for_each(|((_, all), part)| all.extend(part));
        }
    }
    columns.into()
}
