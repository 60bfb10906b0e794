//! `iwan simulate --stream`: the response is written while it is computed, so that memory does not grow with its length.

use std::fs::File;
use std::io::{self, BufWriter};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use iwan_input::scenario::{Scenario, to_toml};
use iwan_io::{Growing, GrowingError, Table};
use iwan_sim::{Mode, Stretch, stream};
use maud::{Markup, html};

use super::args::SimulateArgs;
use super::explain::explain;
use super::figures::{of_force, of_points};
use super::files::{FORCE, column_names, names, write_input};
use super::report::{MOST, describe, errors, head, left_out, repeat, tables};
use super::summary::{PointSummary, SimulationSummary};
use crate::args::Format;
use crate::failure::Failure;
use crate::page::decimate::{Passing, STRETCHES};
use crate::page::figure::Figure;
use crate::page::html::{grid, page, verdict};
use crate::session::{SUMMARY, Session};

/// A force is drawn only up to this number of samples, because its history is computed whole (8 MB at this number).
const MOST_OF_FORCE: f64 = 1e6;

/// Runs a scenario of modes.
pub(super) fn run(args: &SimulateArgs, name: &str, scenario: &Scenario) -> Result<(), Failure> {
    check(name, scenario)?;
    let modes = scenario.modes();
    let mut points = points(&modes);
    let columns = column_names(scenario, &points.iter().map(|point| point.name.clone()).collect::<Vec<_>>());
    Table::new(columns.iter().map(|name| (name.clone(), &[][..])).collect())
        .map_err(|error| Failure::input(error.to_string(), "rename modes or points in the scenario"))?;
    let samples = scenario.settings.samples().map_err(|error| explain(name, &error.into()))?;
    let mut session = Session::open(args.place(), &args.common, names(scenario, args.format))?;
    session.notes(scenario.notes());

    let clock = Instant::now();
    let mut histories = Histories::new(samples, modes.len(), points.len());
    let (bar, staged) = (session.bar("simulating"), session.staged().to_path_buf());
    let mut ended = None;
    let written = session.written(&args.format.file("response"), |sink| {
        let mut rows = Rows::new(args, columns, sink, &staged, scenario.settings.dt)?;
        let mut broken = Ok(());
        let mut take = |stretch: &Stretch<'_>| {
            for point in &mut points {
                point.follow(stretch);
            }
            histories.add(stretch, &points);
            broken = rows.add(stretch, &points);
            if broken.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let force = scenario.force.pulse();
        let totals = stream(&modes, &force, &scenario.settings, &mut take, &|share| bar.report(share));
        broken?;
        // The error of the response is reported below; here the unfinished file is discarded.
        let failed = totals.is_err();
        ended = Some(totals);
        if failed { Err(io::Error::other("no response")) } else { rows.table.finish().map_err(plain) }
    });
    drop(bar);
    let totals = match ended {
        Some(Err(error)) => return Err(explain(name, &error)),
        Some(Ok(totals)) => written.map(|()| totals)?,
        None => return written,
    };
    let of_points = points.iter().map(|point| PointSummary::of_peaks(&point.name, point.peaks)).collect();
    let seconds = clock.elapsed().as_secs_f64();
    let summary = SimulationSummary::of(scenario, name, &totals, None, of_points, seconds);
    session.summary(SUMMARY, &summary)?;
    let toml = to_toml(scenario, FORCE);
    let body = render(scenario, &summary, histories, &points, &toml);
    session.page(&page(&format!("{} \u{2013} iwan simulate", summary.scenario), &body))?;
    write_input(&mut session, scenario, &toml)?;
    session.finish(&summary)
}

/// Refuses scenarios whose computation needs the whole response in memory.
fn check(name: &str, scenario: &Scenario) -> Result<(), Failure> {
    let what = match scenario {
        Scenario { structure: Some(_), .. } => "a [structure]",
        Scenario { joints, .. } if !joints.is_empty() => "a [[joint]]",
        _ => return Ok(()),
    };
    let remedy =
        "leave out --stream, or take --every N alone, which keeps every N-th sample of the response file";
    Err(Failure::input(
        format!("{name}: --stream is for modes without shared joints; this scenario has {what}"),
        remedy,
    ))
}

fn plain(error: GrowingError) -> io::Error {
    match error {
        GrowingError::Io(error) => error,
        other => io::Error::other(other),
    }
}

/// A named point, whose motion is a sum over modes.
struct Followed {
    name: String,
    /// Each mode that moves the point, by its index, and the mode's shape at the point.
    shapes: Vec<(usize, f64)>,
    /// Displacement, velocity and acceleration in the latest stretch of samples.
    motion: [Vec<f64>; 3],
    peaks: [f64; 3],
}

/// The named points, in the order in which the modes name them first.
fn points(modes: &[Mode]) -> Vec<Followed> {
    let mut points: Vec<Followed> = Vec::new();
    for (r, mode) in modes.iter().enumerate() {
        for output in &mode.outputs {
            let index = points.iter().position(|point| point.name == output.name).unwrap_or_else(|| {
                let motion = [const { Vec::new() }; 3];
                points.push(Followed { name: output.name.clone(), shapes: vec![], motion, peaks: [0.0; 3] });
                points.len() - 1
            });
            points[index].shapes.push((r, output.shape));
        }
    }
    points
}

impl Followed {
    fn follow(&mut self, stretch: &Stretch<'_>) {
        for (quantity, (motion, peak)) in self.motion.iter_mut().zip(&mut self.peaks).enumerate() {
            motion.clear();
            motion.resize(stretch.modes.first().map_or(0, |mode| mode[0].len()), 0.0);
            for (r, shape) in &self.shapes {
                motion.iter_mut().zip(stretch.modes[*r][quantity]).for_each(|(sum, q)| *sum += shape * q);
            }
            *peak = motion.iter().fold(*peak, |most, x| most.max(x.abs()));
        }
    }
}

/// The rows of the response table that are written.
struct Rows<'a> {
    table: Growing<&'a mut BufWriter<File>>,
    dt: f64,
    every: usize,
}

impl<'a> Rows<'a> {
    fn new(
        args: &SimulateArgs,
        columns: Vec<String>,
        sink: &'a mut BufWriter<File>,
        staged: &Path,
        dt: f64,
    ) -> io::Result<Self> {
        let table = match args.format {
            Format::Csv => Growing::csv(columns, sink),
            Format::Npz => Growing::npz(columns, sink, staged),
            Format::Parquet => Growing::parquet(columns, sink),
        };
        Ok(Self { table: table.map_err(plain)?, dt, every: args.every.get() })
    }

    fn add(&mut self, stretch: &Stretch<'_>, points: &[Followed]) -> io::Result<()> {
        let skipped = stretch.first.next_multiple_of(self.every) - stretch.first;
        let of_modes = stretch.modes.iter().flatten().copied();
        let of_points = points.iter().flat_map(|point| point.motion.iter().map(Vec::as_slice));
        let count = stretch.modes.first().map_or(0, |mode| mode[0].len());
        let times = (stretch.first..stretch.first + count).map(|n| n as f64 * self.dt).collect::<Vec<_>>();
        let all: Vec<&[f64]> = std::iter::once(times.as_slice()).chain(of_modes).chain(of_points).collect();
        if self.every == 1 {
            return self.table.push(&all).map_err(plain);
        }
        let thin = |values: &[f64]| values.iter().copied().skip(skipped).step_by(self.every).collect();
        let thinned: Vec<Vec<f64>> = all.into_iter().map(thin).collect();
        self.table.push(&thinned.iter().map(Vec::as_slice).collect::<Vec<_>>()).map_err(plain)
    }
}

/// The histories to draw: displacement and acceleration of each mode and each named point.
struct Histories {
    modes: Vec<[Passing; 2]>,
    points: Vec<[Passing; 2]>,
}

impl Histories {
    fn new(samples: usize, modes: usize, points: usize) -> Self {
        let pair = || [Passing::new(samples, STRETCHES), Passing::new(samples, STRETCHES)];
        let some = |count: usize| (0..count.min(MOST)).map(|_| pair()).collect();
        Self { modes: some(modes), points: some(points) }
    }

    fn add(&mut self, stretch: &Stretch<'_>, points: &[Followed]) {
        for ([displacement, acceleration], mode) in self.modes.iter_mut().zip(&stretch.modes) {
            displacement.add(mode[0]);
            acceleration.add(mode[2]);
        }
        for ([displacement, acceleration], point) in self.points.iter_mut().zip(points) {
            displacement.add(&point.motion[0]);
            acceleration.add(&point.motion[2]);
        }
    }
}

/// Displacement and acceleration over time.
fn figures([displacement, acceleration]: [Passing; 2], dt: f64, of: &str, caption: &str) -> [Figure; 2] {
    let draw = |quantity: &str, passing: Passing| {
        of_points(format!("{quantity}{of}"), &quantity.to_lowercase(), passing.points(dt), caption)
    };
    [draw("Displacement", displacement), draw("Acceleration", acceleration)]
}

/// The page, with those figures of `iwan simulate` that need only the histories to draw.
fn render(
    scenario: &Scenario,
    summary: &SimulationSummary,
    histories: Histories,
    points: &[Followed],
    toml: &str,
) -> Markup {
    let dt = scenario.settings.dt;
    let force = scenario.force.pulse();
    let shown = force.settled() > 0.0 && force.settled() / dt < MOST_OF_FORCE;
    let caption = "Applied force; each mode sees it times its shape at the load.";
    let force = if shown { of_force(&force, dt, summary.duration, caption) } else { None };
    let at_points =
        histories.points.into_iter().zip(points).flat_map(|(pair, point)| {
            figures(pair, dt, &format!(" at {}", point.name), "All modes together.")
        });
    let first: Vec<Figure> = force.into_iter().chain(at_points).collect();
    let modes: Vec<Vec<Figure>> =
        histories.modes.into_iter().map(|pair| figures(pair, dt, "", "Modal.").into()).collect();
    html! {
        (head(summary))
        (verdict(&summary.warnings, &errors(summary)))
        p {
            "The response was written as it was computed (--stream): envelope, loops and the curves against amplitude are those of "
            "iwan simulate without it, or of iwan envelope on the response file."
        }
        (tables(summary))
        h2 id="force" { "Force and points" }
        (grid(&first))
        (left_out(points.len(), "points"))
        @for (n, (figures, mode)) in modes.iter().zip(&summary.modes).enumerate() {
            h2 id=(format!("mode-{n}")) { (mode.name) }
            p { (describe(&scenario.modes[n].mode, mode, false)) }
            (grid(figures))
        }
        (left_out(summary.modes.len(), "modes"))
        (repeat(toml))
    }
}
