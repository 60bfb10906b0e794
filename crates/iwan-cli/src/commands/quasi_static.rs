//! `iwan quasi-static`: modal curves from static loads, and modal Iwan parameters from them.

mod summary;

use std::time::Instant;

use iwan_fem::{ModalCurves, NamedMode};
use iwan_ident::static_fit::{StaticCurves, StaticFit, fit_static};
use iwan_io::Table;

use crate::args::{Format, QuasiStaticArgs};
use crate::failure::Failure;
use crate::linear::{self, Linear};
use crate::output;
use crate::progress::{self, Progress};
use crate::report;
use crate::results::Results;
pub(crate) use summary::{ModeCurves, QuasiStaticSummary};

/// Folder for results when none was given.
const DEFAULT_FOLDER: &str = "iwan-quasi-static";
const FILES: [&str; 3] = ["curves.csv", "summary.json", "report.html"];
/// NamedMode modes among which names are looked up.
const MODES: usize = 40;

/// A mode with its curves and what fits them.
#[derive(Debug)]
pub(crate) struct Analysed {
    pub(crate) mode: NamedMode,
    pub(crate) curves: ModalCurves,
    /// Whether they reach the largest displacement.
    pub(crate) whole: bool,
    /// The modal Iwan joint, or why there is none.
    pub(crate) fit: Result<StaticFit, String>,
}

/// Runs the command.
pub(crate) fn run(args: &QuasiStaticArgs) -> Result<(), Failure> {
    let (source, file) = linear::load(&args.structure)?;
    progress::catch_interrupts();
    let results = Results::open(args.structure.out.as_deref(), DEFAULT_FOLDER, args.structure.force, &FILES)?;
    let note = |text: &str| {
        if !args.common.quiet {
            output::message(text);
        }
    };
    file.notes.iter().for_each(|n| note(&format!("note: {n}")));

    let clock = Instant::now();
    let bar = Progress::new("modes", args.common.quiet);
    let linear = Linear::observed(source, file, MODES, &mut |share| bar.report(share))?;
    drop(bar);
    let analysed = analyse(&linear, args)?;
    let seconds = clock.elapsed().as_secs_f64();
    let mut summary = QuasiStaticSummary::new(&linear, &analysed, seconds);
    summary.files = FILES.iter().map(ToString::to_string).collect();
    let folder = results.path().to_path_buf();
    write(results, &linear, &analysed, &summary)?;

    summary.warnings.iter().for_each(|w| note(&format!("warning: {w}")));
    note(&format!("results: {}", folder.display()));
    note(&format!("figures: {}", folder.join("report.html").display()));
    summary.folder = Some(folder);
    output::result(&if args.common.json { summary.json() } else { summary.table() })
}

fn analyse(linear: &Linear, args: &QuasiStaticArgs) -> Result<Vec<Analysed>, Failure> {
    if linear.assembled.slips().iter().all(|slip| slip.law.is_none()) {
        let message =
            format!("{}: the structure has no joint with a law: its modes are linear", linear.source);
        return Err(Failure::input(
            message,
            "add [[joint]] with slip = [{ direction = ..., law = { ... } }]",
        ));
    }
    let modes = linear.chosen(&args.modes).map_err(|error| linear.failed(&error))?;
    let bar = Progress::new("static loads", args.common.quiet);
    let mut analysed = Vec::new();
    for (n, mode) in modes.iter().enumerate() {
        if bar.report(n as f64 / modes.len() as f64).is_break() {
            return Err(Failure::Interrupted);
        }
        let displacements = displacements(linear, mode, args)?;
        // Where parts slide freely the curves end, which is an error only when the user asked for more.
        let curves = linear.static_curves(mode, &displacements, args.to.is_some());
        let curves = curves.map_err(|error| linear.failed(&error))?;
        let fit = fit(linear, mode, &curves);
        let whole = curves.displacement.len() == displacements.len();
        analysed.push(Analysed { mode: mode.clone(), curves, whole, fit });
    }
    Ok(analysed)
}

/// Displacements evenly spaced on a logarithmic scale.
fn displacements(linear: &Linear, mode: &NamedMode, args: &QuasiStaticArgs) -> Result<Vec<f64>, Failure> {
    let missing = linear.onset(mode).is_none() && (args.from.is_none() || args.to.is_none());
    if missing {
        let message = format!("{}: no joint slips in {}", linear.source, mode.name);
        return Err(Failure::input(message, "give --from and --to, or choose other modes with --mode"));
    }
    linear.amplitudes(mode, (args.from, args.to), args.points as usize).map_err(|error| {
        let message = format!("{}: {}: {error}", linear.source, mode.name);
        Failure::input(message, "give --from smaller than --to")
    })
}

/// The modal Iwan joint of the curves, or why there is none.
fn fit(linear: &Linear, mode: &NamedMode, curves: &ModalCurves) -> Result<StaticFit, String> {
    let parts = StaticCurves {
        displacement: &curves.displacement,
        frequency: &curves.frequency,
        dissipation: &curves.dissipation,
    };
    fit_static(&parts, linear.frequency_stuck(mode), mode.pair.k_t).map_err(|error| error.to_string())
}

/// Writes all files; they appear together.
fn write(
    mut results: Results,
    linear: &Linear,
    analysed: &[Analysed],
    summary: &QuasiStaticSummary,
) -> Result<(), Failure> {
    let columns = columns(linear, analysed);
    let table = columns.iter().map(|(name, values)| (name.clone(), values.as_slice())).collect();
    let table = Table::new(table).map_err(|e| Failure::Computation(e.to_string()))?;
    results.add_table("curves.csv", &table, Format::Csv)?;
    results.add("summary.json", summary.json().as_bytes())?;
    let page = report::quasi_static::render(&report::quasi_static::Input { linear, analysed, summary });
    results.add("report.html", page.as_bytes())?;
    progress::check_interrupt()?;
    results.commit()
}

/// The columns of the table: all modes below each other, told apart by their number.
fn columns(linear: &Linear, analysed: &[Analysed]) -> Vec<(String, Vec<f64>)> {
    let all = |of: &dyn Fn(&ModalCurves) -> &Vec<f64>| -> Vec<f64> {
        analysed.iter().flat_map(|a| of(&a.curves).iter().copied()).collect()
    };
    let number = |(n, a): (usize, &Analysed)| vec![(n + 1) as f64; a.curves.displacement.len()];
    let mut columns: Vec<(String, Vec<f64>)> = vec![
        ("mode".into(), analysed.iter().enumerate().flat_map(number).collect()),
        ("displacement".into(), all(&|c| &c.displacement)),
        ("frequency".into(), all(&|c| &c.frequency)),
        ("dissipation".into(), all(&|c| &c.dissipation)),
        ("joint_force".into(), all(&|c| &c.joint_force)),
    ];
    for (index, slip) in linear.assembled.slips().iter().enumerate() {
        columns.push((format!("{}.slip", slip.name), all(&|c| &c.slips[index])));
    }
    columns
}
