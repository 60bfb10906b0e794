//! `iwan quasi-static`: modal curves from static loads, and modal Iwan parameters from them.

mod summary;

use std::time::Instant;

use iwan_fem::{Class, ModalCurves};
use iwan_ident::quasi_static::{StaticCurves, StaticFit, fit_static};
use iwan_io::Table;

use crate::args::{Format, QuasiStaticArgs};
use crate::failure::Failure;
use crate::linear::{self, Elastic, Linear};
use crate::output;
use crate::progress::{self, Progress};
use crate::report;
use crate::results::Results;
pub(crate) use summary::{ModeCurves, QuasiStaticSummary};

/// Folder for results when none was given.
const DEFAULT_FOLDER: &str = "iwan-quasi-static";
const FILES: [&str; 3] = ["curves.csv", "summary.json", "report.html"];
/// Elastic modes among which names are looked up.
const MODES: usize = 40;
/// Modes that are taken when none are named.
const DEFAULT_MODES: usize = 3;
/// Range of displacements over where the first joint begins macro-slip.
const RANGE: (f64, f64) = (1e-3, 10.0);
/// A joint stiffness below this part of ω0² is no joint's: the mode is linear.
const LEAST_STIFFNESS: f64 = 1e-6;

/// A mode with its curves and what fits them.
#[derive(Debug)]
pub(crate) struct Analysed {
    pub(crate) mode: Elastic,
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
    let linear = Linear::new(source, file, MODES)?;
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

/// The modes that were named; without names the first bending modes, or the first of all where nothing bends.
fn chosen(linear: &Linear, names: &[String]) -> Result<Vec<Elastic>, Failure> {
    if names.is_empty() {
        let bending = linear.elastic.iter().filter(|mode| mode.class == Class::Bending);
        let bending: Vec<Elastic> = bending.take(DEFAULT_MODES).cloned().collect();
        let first = || linear.elastic.iter().take(DEFAULT_MODES).cloned().collect();
        return Ok(if bending.is_empty() { first() } else { bending });
    }
    let one = |name: &String| {
        let wanted = name.replace('-', " ");
        linear.elastic.iter().find(|mode| mode.name == wanted).cloned().ok_or_else(|| {
            let known: Vec<_> = linear.elastic.iter().map(|mode| mode.name.as_str()).collect();
            let message = format!("{}: there is no mode \"{name}\"", linear.source);
            Failure::input(message, format!("choose --mode from {}", known.join(", ")))
        })
    };
    names.iter().map(one).collect()
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
    let modes = chosen(linear, &args.modes)?;
    let bar = Progress::new("static loads", args.common.quiet);
    let mut analysed = Vec::new();
    for (n, mode) in modes.iter().enumerate() {
        if bar.report(n as f64 / modes.len() as f64).is_break() {
            return Err(Failure::Interrupted);
        }
        let displacements = displacements(linear, mode, args)?;
        let curves = curves(linear, mode, &displacements, args.to.is_some())
            .map_err(|error| linear::explain(&linear.source, &error))?;
        let fit = fit(linear, mode, &curves);
        let whole = curves.displacement.len() == displacements.len();
        analysed.push(Analysed { mode: mode.clone(), curves, whole, fit });
    }
    Ok(analysed)
}

/// The curves up to where parts begin to slide freely, which is an error only when the user asked for more.
fn curves(
    linear: &Linear,
    mode: &Elastic,
    displacements: &[f64],
    all: bool,
) -> Result<ModalCurves, iwan_fem::Error> {
    let eigenvalue = linear.slipping.eigenvalue(mode.pair.slipping);
    let analysis = linear.assembled.quasi_static(&linear.stuck, mode.pair.stuck, eigenvalue)?;
    if all {
        return analysis.curves(displacements);
    }
    let mut curves = analysis.curves(&[])?;
    for displacement in displacements {
        match analysis.curves(&[*displacement]) {
            Ok(next) => append(&mut curves, next),
            Err(iwan_fem::Error::Analysis { .. }) if !curves.displacement.is_empty() => break,
            Err(error) => return Err(error),
        }
    }
    Ok(curves)
}

fn append(curves: &mut ModalCurves, next: ModalCurves) {
    curves.displacement.extend(next.displacement);
    curves.force.extend(next.force);
    curves.frequency.extend(next.frequency);
    curves.dissipation.extend(next.dissipation);
    curves.joint_force.extend(next.joint_force);
    for (slip, more) in curves.slips.iter_mut().zip(next.slips) {
        slip.extend(more);
    }
}

/// Displacements evenly spaced on a logarithmic scale.
fn displacements(linear: &Linear, mode: &Elastic, args: &QuasiStaticArgs) -> Result<Vec<f64>, Failure> {
    let onset = onset(linear, mode);
    let missing = || {
        let message = format!("{}: no joint slips in {}", linear.source, mode.name);
        Failure::input(message, "give --from and --to, or choose other modes with --mode")
    };
    let end = |given: Option<f64>, share: f64| given.or(onset.map(|q| share * q)).ok_or_else(missing);
    let (from, to) = (end(args.from, RANGE.0)?, end(args.to, RANGE.1)?);
    if from >= to {
        let message =
            format!("the range of modal displacements is empty: {from:e} to {to:e} for {}", mode.name);
        return Err(Failure::input(message, "give --from smaller than --to"));
    }
    let last = f64::from(args.points - 1);
    Ok((0..args.points).map(|i| from * (to / from).powf(f64::from(i) / last)).collect())
}

/// The modal displacement at which, linearly, the first joint reaches the strength of its strongest slider.
fn onset(linear: &Linear, mode: &Elastic) -> Option<f64> {
    let shape = linear.stuck.shape(mode.pair.stuck);
    let reach = linear.assembled.slips().iter().filter_map(|slip| {
        let law = slip.law.as_ref()?;
        Some(law.strengths().1 / shape[slip.unknown].abs())
    });
    Some(reach.fold(f64::INFINITY, f64::min)).filter(|q| q.is_finite())
}

/// The modal Iwan joint of the curves, or why there is none.
fn fit(linear: &Linear, mode: &Elastic, curves: &ModalCurves) -> Result<StaticFit, String> {
    let k_t = mode.pair.k_t;
    if k_t <= LEAST_STIFFNESS * linear.stuck.eigenvalue(mode.pair.stuck) {
        return Err(format!(
            "K_T = {k_t:.3e} is not positive: slipping does not soften this mode, it is linear in practice; nothing is fitted"
        ));
    }
    let parts = StaticCurves {
        displacement: &curves.displacement,
        frequency: &curves.frequency,
        dissipation: &curves.dissipation,
    };
    fit_static(&parts, linear.frequency_stuck(mode), k_t).map_err(|error| error.to_string())
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
