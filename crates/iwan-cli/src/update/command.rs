//! `iwan update` from files to joints.

use iwan_input::updated_structure;
use iwan_study::update::{MeasuredCurve, UpdateTask, update, update_from_blows};

use super::args::UpdateArgs;
use super::blows::blows;
use super::curves::read;
use super::groups::{corrections, groups};
use super::report;
use super::summary::UpdateSummary;
use crate::failure::Failure;
use crate::session::{PAGE, SUMMARY, Session};
use crate::structures::Linear;
use crate::structures::linear::{NAMED_MODES, load};

/// File with the whole summary, curves and front of compromises included; `summary.json` leaves out these long lists.
const WHOLE: &str = "update.json";
/// The structure with the joints found.
const UPDATED: &str = "updated.toml";

/// Runs the command.
pub(crate) fn run(args: &UpdateArgs) -> Result<(), Failure> {
    let all = |given: &[String]| -> Result<Vec<MeasuredCurve>, Failure> {
        Ok(given.iter().map(|one| read(one)).collect::<Result<Vec<_>, _>>()?.concat())
    };
    let (curves, held_out) = (all(&args.curves)?, all(&args.held_out)?);
    let (source, file) = load(&args.structure)?;
    let place = args.structure.place(args.out.as_deref(), "iwan-update");
    let mut session = Session::open(place, &args.common, [WHOLE, UPDATED, SUMMARY, PAGE])?;
    session.notes(&file.notes);
    let bar = session.bar("modes");
    let linear = Linear::computed(source.name.clone(), file, NAMED_MODES, &bar)?;
    drop(bar);
    let blows = blows(&linear, args, &curves)?;
    if let Some((_, notes)) = &blows {
        session.notes(notes);
    }
    let modes: Vec<&str> = match &blows {
        Some((blows, _)) => blows.modes.iter().map(String::as_str).collect(),
        None => curves.iter().map(|curve| curve.mode.as_str()).collect(),
    };
    let (groups, kept) = groups(&linear, args, &modes)?;
    session.notes(&kept);
    let corrections = corrections(&linear, args)?;
    let threads = session.threads();
    let task = UpdateTask {
        named: &linear,
        groups,
        corrections,
        viscous: !args.undamped,
        curves,
        held_out,
        threads,
    };
    let bar = session.bar("joints");
    let found = match &blows {
        Some((blows, _)) => update_from_blows(&task, blows, &|share| bar.report(share)),
        None => update(&task, &|share| bar.report(share)),
    };
    let found = found.map_err(|error| explained(&linear, &error))?;
    drop(bar);
    let summary = UpdateSummary::new(&linear, &found);
    match updated_structure(
        &source,
        &linear.file.changes(found.laws_of_joints(&task), found.factors_of_parts(&task)),
    ) {
        Ok(text) => session.file(UPDATED, text.as_bytes())?,
        // The values found stand in update.json; a note says why the structure file is missing.
        Err(error) => {
            session.spare(UPDATED);
            session.notes(&[format!("{} ({})", error.message, error.remedy)]);
        }
    }
    session.summary(WHOLE, &summary)?;
    session.summary(SUMMARY, &summary.without_curves())?;
    session.page(&report::render(&summary))?;
    session.finish(&summary)
}

/// A failed update in the user's terms: curves and names that do not fit the structure are bad input.
fn explained(linear: &Linear, error: &iwan_study::Error) -> Failure {
    use iwan_study::Error;
    match error {
        Error::Interrupted => Failure::Interrupted,
        Error::Update { place, .. } => Failure::said(place, error),
        Error::Structure { source, .. } => linear.failed(source),
        error => Failure::computation(format!("{}: {error}", linear.source)).of(error.kind()),
    }
}
