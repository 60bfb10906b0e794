//! `iwan reproduce`: the paper's tables and figures beside ours.

mod counterpart;
mod findings;
mod lab;
mod modal;
mod noise;
mod printed;
mod summary;
mod truth;

use std::fmt::Write;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use iwan_io::Table;

use crate::args::{Format, ReproduceArgs};
use crate::failure::Failure;
use crate::output;
use crate::page::numbers::short;
use crate::parallel::in_parallel;
use crate::progress::{self, Progress};
use crate::report;
use crate::session::Results;
pub(crate) use counterpart::{Counterpart, FITTED, Interval, SHOWN};
pub(crate) use findings::{Finding, Kind, bounds};
pub(crate) use lab::{Hit, HitSummary, Lab, LabSummary, Row4};
pub(crate) use modal::Study;
pub(crate) use printed::{TABLE_1, TABLE_2};
pub(crate) use summary::{FigureEntry, LevelSummary, ModeSummary, Row2, Summary, Truth};
pub(crate) use truth::{DT, Filter, LEVELS, STEPS, Side};

/// Folder for results when none was given.
const DEFAULT_FOLDER: &str = "iwan-reproduce";
const FILES: [&str; 4] = ["reproduce.json", "figures.json", "curves.csv", "report.html"];
/// Pieces of work: configurations, their modes, the laboratory's hits.
const PIECES: usize = 2 + 6 + 3;

/// A mode with its counterpart, where it has a joint.
pub(crate) type Studied = (Study, Option<Counterpart>);

/// All that was computed.
#[derive(Debug)]
pub(crate) struct Reproduction {
    /// Configurations A and B.
    pub(crate) sides: Vec<Side>,
    /// Bending modes 1 to 3 of each.
    pub(crate) studies: Vec<Vec<Studied>>,
    pub(crate) lab: Lab,
}

impl Reproduction {
    /// All modes of both configurations.
    pub(crate) fn modes(&self) -> impl Iterator<Item = (&Study, Option<&Counterpart>)> {
        self.studies.iter().flatten().map(|(study, counterpart)| (study, counterpart.as_ref()))
    }
}

/// Runs the command.
pub(crate) fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    progress::catch_interrupts();
    let results = Results::open(args.out.as_deref(), DEFAULT_FOLDER, args.force, &FILES)?;
    let clock = Instant::now();
    let bar = Arc::new(Progress::new("reproducing", args.common.quiet));
    let (shown, threads) = (Arc::clone(&bar), args.common.thread_count());
    // Identification cannot be asked to stop between two steps: the main thread watches for Ctrl-C.
    let found = bar.wait(move || compute(threads, &Tally::new(&shown)))??;
    drop(bar);
    let plates = report::reproduce::plates(&found);
    let mut summary = Summary::new(&found).map_err(|error| Failure::Computation(error.to_string()))?;
    summary.figures = plates.iter().map(report::reproduce::Plate::entry).collect();
    summary.files = FILES.iter().map(ToString::to_string).collect();
    let folder = results.path().to_path_buf();
    write(results, &found, &summary, &plates)?;

    if !args.common.quiet {
        output::message(&format!("results: {}", folder.display()));
        output::message(&format!("figures: {}", folder.join("report.html").display()));
    }
    summary.folder = Some(folder);
    summary.seconds = Some(clock.elapsed().as_secs_f64());
    output::result(&if args.common.json { summary.json() } else { table(&summary) })
}

/// Counts pieces of work that are done.
struct Tally<'a> {
    bar: &'a Progress,
    done: AtomicUsize,
}

impl<'a> Tally<'a> {
    fn new(bar: &'a Progress) -> Self {
        Self { bar, done: AtomicUsize::new(0) }
    }

    /// Shows what is done and the share of the piece under way; breaks off after Ctrl-C.
    fn share(&self, share: f64) -> ControlFlow<()> {
        self.bar.report((self.done.load(Ordering::Relaxed) as f64 + share) / PIECES as f64)
    }

    fn one_more(&self) -> Result<(), Failure> {
        self.done.fetch_add(1, Ordering::Relaxed);
        if self.share(0.0).is_break() { Err(Failure::Interrupted) } else { Ok(()) }
    }
}

/// All computations; the same bits for any number of threads.
fn compute(threads: usize, tally: &Tally<'_>) -> Result<Reproduction, Failure> {
    let side = |name: &&'static str| {
        let side = Side::new(name, &|share| tally.share(share))?;
        tally.one_more().map(|()| side)
    };
    let sides: Vec<Side> =
        in_parallel(&["A", "B"], threads, &side).into_iter().collect::<Result<_, Failure>>()?;
    // The longest first: mode 3 has the most cycles.
    let modes: Vec<(usize, usize)> = [2, 0, 1].into_iter().flat_map(|mode| [(0, mode), (1, mode)]).collect();
    let study = |&(side, mode): &(usize, usize)| -> Result<Studied, Failure> {
        let mut study = Study::new(&sides[side], mode)?;
        let counterpart =
            if study.has_joint() { Some(Counterpart::new(&sides[side], &study)?) } else { None };
        let slip_forces = [
            counterpart.as_ref().map(|c| c.parameters.f_s),
            study.static_fit.map(|fit| fit.parameters.f_s),
            Some(TABLE_2[mode].f_s),
        ];
        if study.has_joint() {
            slip_forces.into_iter().flatten().for_each(|f_s| study.try_eq_14(f_s));
        }
        tally.one_more().map(|()| (study, counterpart))
    };
    let found: Vec<Studied> =
        in_parallel(&modes, threads, &study).into_iter().collect::<Result<_, Failure>>()?;
    let mut studies: Vec<Vec<Studied>> = vec![Vec::new(), Vec::new()];
    for ((side, _), studied) in modes.into_iter().zip(found) {
        studies[side].push(studied);
    }
    for side in &mut studies {
        side.sort_by_key(|(study, _)| study.index);
    }
    let lab = Lab::new(threads, &|| tally.one_more())?;
    Ok(Reproduction { sides, studies, lab })
}

/// Writes all files; they appear together.
fn write(
    mut results: Results,
    found: &Reproduction,
    summary: &Summary,
    plates: &[report::reproduce::Plate],
) -> Result<(), Failure> {
    results.add("reproduce.json", summary.json().as_bytes())?;
    results.add("figures.json", report::reproduce::data(plates).as_bytes())?;
    let columns = columns(found);
    let table = columns.iter().map(|(name, values)| ((*name).to_string(), values.as_slice())).collect();
    let table = Table::new(table).map_err(|error| Failure::Computation(error.to_string()))?;
    results.add_table("curves.csv", &table, Format::Csv)?;
    results.add("report.html", report::reproduce::render(found, summary, plates).as_bytes())?;
    progress::check_interrupt()?;
    results.commit()
}

/// Curves of all modes under all blows below each other; configuration 1 is A, 2 is B.
fn columns(found: &Reproduction) -> Vec<(&'static str, Vec<f64>)> {
    let names = [
        "configuration",
        "mode",
        "level",
        "t",
        "displacement",
        "frequency",
        "damping_ratio",
        "dissipation",
        "modal_force",
    ];
    let mut columns: Vec<(&'static str, Vec<f64>)> = names.map(|name| (name, Vec::new())).to_vec();
    for (study, _) in found.modes() {
        let configuration = if study.configuration == "A" { 1.0 } else { 2.0 };
        for (curves, level) in study.curves.iter().zip(LEVELS) {
            for i in 0..curves.t.len() {
                let row = [
                    configuration,
                    (study.index + 1) as f64,
                    level,
                    curves.t[i],
                    curves.displacement[i],
                    curves.frequency[i],
                    curves.damping_ratio[i],
                    curves.dissipation[i],
                    curves.force[i],
                ];
                columns.iter_mut().zip(row).for_each(|((_, column), value)| column.push(value));
            }
        }
    }
    columns
}

/// What the terminal shows: Table 2 and the findings.
fn table(summary: &Summary) -> String {
    let mut text = format!(
        "{:<3}{:<11}{:<12}{:>12}{:>11}{:>9}{:>9}\n",
        "", "mode", "", "K_T, 1/s^2", "F_S", "chi", "beta"
    );
    let mut line = |head: [&str; 3], p: Option<summary::Parameters>| {
        let cells = p.map_or_else(
            || ["linear".into(), "-".into(), "-".into(), "-".into()],
            |p| [p.k_t, p.f_s, p.chi, p.beta].map(short),
        );
        let [a, b, c] = head;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{a:<3}{b:<11}{c:<12}{:>12}{:>11}{:>9}{:>9}",
            cells[0], cells[1], cells[2], cells[3]
        );
    };
    for row in &summary.table_2 {
        line([row.configuration, &row.mode, "identified"], row.identified);
        if row.configuration == "B" {
            line(["", &row.mode, "printed"], Some(row.printed));
        }
    }
    for finding in &summary.findings {
        let _ = writeln!(text, "\n{}: {}\n  {}", finding.kind.word(), finding.title, finding.text);
    }
    text
}
