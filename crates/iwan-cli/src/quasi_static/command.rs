//! `iwan quasi-static` from the structure file to its results.

use std::time::Instant;

use iwan_fem::{ModalCurves, NamedMode};
use iwan_input::scenario::to_toml;
use iwan_input::{CoupledScenario, InputText};

use super::analysis::{Analysed, analyse};
use super::args::QuasiStaticArgs;
use super::report;
use super::summary::QuasiStaticSummary;
use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, SUMMARY, Session};
use crate::structures::Linear;
use crate::structures::linear::{NAMED_MODES, load};

/// Table of the curves.
const TABLE: &str = "curves.csv";

/// Scenario of the modes that share joints.
const COUPLED: &str = "coupled.toml";

/// Runs the command.
pub(crate) fn run(args: &QuasiStaticArgs) -> Result<(), Failure> {
    let (InputText { name: source, .. }, file) = load(&args.structure)?;
    let place = args.structure.place(args.out.as_deref(), "iwan-quasi-static");
    let mut session = Session::open(place, &args.common, [TABLE, SUMMARY, PAGE, COUPLED])?;
    session.notes(&file.notes);

    let clock = Instant::now();
    let bar = session.bar("modes");
    let linear = Linear::computed(source, file, NAMED_MODES, &bar)?;
    drop(bar);
    let analysed = analyse(&linear, args, &session.bar("static loads"))?;
    let summary = QuasiStaticSummary::new(&linear, &analysed, clock.elapsed().as_secs_f64());

    let modes: Vec<NamedMode> = analysed.iter().map(|a| a.mode.clone()).collect();
    let own = linear.clone();
    match session.bar("coupled modes").wait(move || own.file.coupled(&own, &modes))? {
        Ok(CoupledScenario { scenario, notes }) => {
            session.notes(&notes);
            session.file(COUPLED, to_toml(&scenario, "").as_bytes())?;
        }
        // The curves are valid without the scenario of shared joints; a note says why it is missing.
        Err(error) => {
            session.omit(COUPLED);
            session.notes(&[format!("{}: {} ({})", linear.source, error.message, error.remedy)]);
        }
    }
    session.columns(TABLE, &columns(&linear, &analysed), Format::Csv)?;
    session.summary(SUMMARY, &summary)?;
    session.page(&report::render(&linear, &analysed, &summary))?;
    session.finish(&summary)
}

/// The columns of the table: modes stand below each other, told apart by their numbers.
fn columns(linear: &Linear, analysed: &[Analysed]) -> Vec<(String, Vec<f64>)> {
    let all = |curve: &dyn Fn(&ModalCurves) -> &Vec<f64>| -> Vec<f64> {
        analysed.iter().flat_map(|a| curve(&a.curves).iter().copied()).collect()
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
