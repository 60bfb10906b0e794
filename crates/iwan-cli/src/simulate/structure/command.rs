//! `iwan simulate` on a structure, from the scenario to its results.

use iwan_fem::mesh::vtu::{Field, grid, series};
use iwan_input::scenario::{OnStructure, Scenario, to_toml};
use iwan_machine::checkpoint::Digest;

use super::report::{self, Reported};
use super::run::{self, Truth};
use super::summary::summarise;
use crate::failure::Failure;
use crate::session::{SUMMARY, Session};
use crate::simulate::args::SimulateArgs;
use crate::simulate::files::{FORCE, names, write_input, write_response};

/// File that lists the frames of the animation, for ParaView.
const SERIES: &str = "response.pvd";

/// Runs the scenario and writes its results.
pub(crate) fn run(
    args: &SimulateArgs,
    name: &str,
    scenario: &Scenario,
    on: &OnStructure,
) -> Result<(), Failure> {
    let (source, file) = on.load()?;
    let frames = frame_names(on.frames);
    let mut files = names(scenario, args.format);
    if !frames.is_empty() {
        files.push(SERIES.into());
        files.extend_from_slice(&frames);
    }
    let mut session = Session::open(args.place(), &args.common, files)?;
    session.notes(scenario.notes());
    session.notes(&file.notes);

    let kept = session.checkpoint(&args.keeping, "a scenario on a structure", || {
        Digest::default().text(scenario).text(&file.structure).text(&file.laws)
    })?;

    let bar = session.bar("simulating");
    let truth = run::run(scenario, on, (source, file), &bar, kept)?;
    drop(bar);
    let summary = summarise(scenario, name, &truth);

    let times: Vec<f64> =
        (0..=summary.modes.first().map_or(0, |m| m.steps)).map(|n| n as f64 * truth.response.dt).collect();
    write_response(&mut session, args, columns(&times, &truth), "rename outputs or joints in the structure")?;
    session.summary(SUMMARY, &summary)?;
    let toml = to_toml(scenario, FORCE);
    session.page(&report::render(&Reported { scenario, toml: &toml, truth: &truth, summary: &summary }))?;
    write_input(&mut session, scenario, &toml)?;
    write_frames(&mut session, &truth, &frames)?;
    session.finish(&summary)
}

fn frame_names(count: usize) -> Vec<String> {
    let digits = count.to_string().len();
    (0..count).map(|n| format!("frame-{n:0digits$}.vtu")).collect()
}

/// Writes the pictures (frames) of the motion, where the scenario asks for them.
fn write_frames(session: &mut Session, truth: &Truth, frames: &[String]) -> Result<(), Failure> {
    if frames.is_empty() {
        return Ok(());
    }
    let mesh = &truth.linear.file.structure.mesh;
    for (name, frame) in frames.iter().zip(&truth.frames) {
        session.file(name, &grid(mesh, &[Field { name: "displacement", values: &frame.displacement }]))?;
    }
    let times = truth.frames.iter().map(|frame| frame.time);
    session.file(SERIES, series(times.zip(frames.iter().map(String::as_str))).as_bytes())
}

/// The columns of the response: time, modes, outputs, slips.
fn columns<'a>(times: &'a [f64], truth: &'a Truth) -> Vec<(String, &'a [f64])> {
    let mut columns = vec![("t".to_string(), times)];
    for (n, history) in truth.response.outputs.iter().enumerate() {
        let mut add = |quantity: &str, values: &'a [f64]| {
            columns.push((format!("{}.{quantity}", history.name), values));
        };
        add("displacement", &history.displacement);
        add("velocity", &history.velocity);
        add("acceleration", &history.acceleration);
        if let Some(force) = truth.joint_forces.get(n) {
            add("joint_force", force);
        }
    }
    for slip in &truth.response.slips {
        columns.push((format!("{}.slip", slip.name), &slip.slip));
        columns.push((format!("{}.force", slip.name), &slip.force));
    }
    columns
}
