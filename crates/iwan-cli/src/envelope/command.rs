//! `iwan envelope` from the record to its results.

use iwan_sim::in_parallel;

use super::args::EnvelopeArgs;
use super::peaks;
use super::report;
use super::summary::EnvelopeSummary;
use crate::failure::Failure;
use crate::records::{self, Extraction, Recording, Units, Wanted};
use crate::session::{PAGE, SUMMARY, Session};

/// Runs the command.
pub(crate) fn run(args: &EnvelopeArgs) -> Result<(), Failure> {
    let recordings =
        records::read_all(std::slice::from_ref(&args.record), &args.records, args.common.thread_count())?;
    if args.peaks {
        return peaks::run(args, &recordings[0]);
    }
    let table = args.format.file("envelope");
    let mut session = Session::open(args.place(), &args.common, [table.as_str(), SUMMARY, PAGE])?;
    let first = &recordings[0];
    Recording::announce(std::slice::from_ref(first), &mut session);

    let extractions = extract(&recordings, args, session.threads())?;
    let units = Units::new(first.record.unit(), first.quantity, args.records.mass_normalised());
    let summary = EnvelopeSummary::new(first, &extractions, &units);

    session.columns(&table, &columns(&extractions), args.format)?;
    session.summary(SUMMARY, &summary)?;
    session.page(&report::render(&extractions, &summary, &units))?;
    session.finish(&summary)
}

/// Extracts every mode that the options name, from the record or, where it holds several hits, from each hit.
fn extract(
    recordings: &[Recording],
    args: &EnvelopeArgs,
    threads: usize,
) -> Result<Vec<Extraction>, Failure> {
    let wanted = records::modes(recordings, &args.records)?;
    let (method, axis) = (args.method.method(), args.records.force_axis);
    let one = |(mode, hit): &(&Wanted, usize)| {
        let mut found = Extraction::new(recordings, mode, *hit, method, axis)?;
        if recordings.len() > 1 {
            found.name = format!("{}, hit {}", found.name, hit + 1);
        }
        Ok(found)
    };
    let all: Vec<_> =
        wanted.iter().flat_map(|mode| (0..recordings.len()).map(move |hit| (mode, hit))).collect();
    in_parallel(&all, threads, &one).into_iter().collect()
}

/// The columns of the table: all modes below each other, told apart by their number.
fn columns(extractions: &[Extraction]) -> Vec<(&'static str, Vec<f64>)> {
    const NAMES: [&str; 11] = [
        "mode",
        "t",
        "amplitude",
        "frequency",
        "damping_ratio",
        "log_amplitude_sd",
        "frequency_sd",
        "damping_ratio_sd",
        "displacement",
        "dissipation",
        "force",
    ];
    let mut columns = NAMES.map(|name| (name, Vec::new()));
    for (mode, x) in extractions.iter().enumerate() {
        let Some(e) = x.envelope() else { continue };
        let times: Vec<f64> = e.t.iter().map(|t| x.start + t).collect();
        let numbers = vec![(mode + 1) as f64; times.len()];
        let c = &x.curves;
        let parts = [
            &numbers,
            &times,
            &e.amplitude,
            &e.frequency,
            &e.damping_ratio,
            &e.log_amplitude_sd,
            &e.frequency_sd,
            &e.damping_ratio_sd,
            &c.displacement,
            &c.dissipation,
            &c.force,
        ];
        columns.iter_mut().zip(parts).for_each(|((_, all), part)| all.extend_from_slice(part));
    }
    columns.into()
}
