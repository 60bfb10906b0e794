//! The report of `iwan simulate` on a structure: the structure, its motion, its joints.

use iwan_fem::SlipHistory;
use iwan_input::scenario::Scenario;
use maud::{Markup, html};

use super::run::Truth;
use crate::failure::VERSION;
use crate::page::figure::Figure;
use crate::page::html::{grid, page, verdict};
use crate::page::numbers::{error, short};
use crate::page::solid::Solid;
use crate::simulate::figures::{of_force, of_history};
use crate::simulate::joints::{self, table};
use crate::simulate::summary::{ROWS, SimulationSummary, StructureSummary};
use crate::structures::picture::illustration;

/// The contents of the report.
#[derive(Debug)]
pub(super) struct Reported<'a> {
    pub(crate) scenario: &'a Scenario,
    /// The scenario as run, as TOML.
    pub(crate) toml: &'a str,
    pub(crate) truth: &'a Truth,
    pub(crate) summary: &'a SimulationSummary,
}

/// Most outputs with figures of their own: enough for three modes and nine points, at 37 kB for the two figures of each. The response file holds all
/// outputs.
const MOST_OUTPUTS: usize = 12;
/// Most joints with figures of their own, those that slip most: the others look alike, and the table lists them.
const MOST_SLIPS: usize = 4;

/// The page.
pub(super) fn render(run: &Reported<'_>) -> String {
    let summary = run.summary;
    let Some(structure) = &summary.structure else { return String::new() };
    let mesh = &run.truth.linear.file.structure.mesh;
    let solid = Solid::new(mesh);
    let body = html! {
        h1 { (summary.scenario) }
        p.about {
            (structure.title) ": response over " (summary.duration) " s at steps of " (short(summary.time_step)) " s, average acceleration, "
            (structure.model) " model. Written by iwan " (VERSION) "."
        }
        (structure.size.paragraph())
        (verdict(&summary.warnings, &errors(structure, summary)))
        nav {
            a href="#summary" { "Summary" } a href="#joints" { "Joints" } a href="#histories" { "Histories" }
            a href="#repeat" { "Scenario" }
        }
        (illustration(&solid, mesh))
        h2 id="summary" { "Modes" }
        p { "Modal coordinates of the structure's response (exact modal filter); energies and slip ratio are those of the whole structure." }
        (modes(summary))
        h2 id="joints" { "Joints" }
        (table(structure.slips.iter()))
        (grid(&loops(run.truth)))
        h2 id="histories" { "Histories" }
        (grid(&histories(run)))
        h2 id="repeat" { "Scenario" }
        p { "The run with all defaults filled in, as in " code { "scenario.toml" } " beside this page." }
        pre { (run.toml) }
    };
    page(&format!("{} \u{2013} iwan simulate", summary.scenario), &body)
}

/// How exact the response is, in a sentence or two.
fn errors(structure: &StructureSummary, summary: &SimulationSummary) -> Markup {
    let energy = summary.modes.first().map_or(0.0, |mode| mode.energy_error);
    let basis = match (structure.basis, structure.basis_error) {
        (Some(modes), Some(found)) => format!(
            " {modes} modes and the attachment vectors of the slips: estimated error {}.",
            error(found)
        ),
        (Some(modes), None) => format!(" {modes} modes and the attachment vectors of the slips."),
        _ => String::new(),
    };
    html! { "The energy balance closes to " (error(energy)) "." (basis) }
}

fn modes(summary: &SimulationSummary) -> Markup {
    html! {
        div.wide { table {
            thead { tr { th {} @for mode in &summary.modes { th { (mode.name) } } } }
            tbody { @for row in &ROWS { tr { th { (row.label) } @for mode in &summary.modes { td { ((row.cell)(mode)) } } } } }
        } }
    }
}

/// Force over slip of the joints that slip most.
fn loops(truth: &Truth) -> Vec<Figure> {
    let mut slips: Vec<&SlipHistory> = truth.response.slips.iter().collect();
    slips.sort_by(|a, b| b.slip_ratio.total_cmp(&a.slip_ratio));
    let figure = |slip: &&SlipHistory| joints::loops(&slip.name, &slip.slip, &slip.force);
    slips.iter().filter(|slip| slip.slip_ratio > 0.0).take(MOST_SLIPS).map(figure).collect()
}

fn histories(run: &Reported<'_>) -> Vec<Figure> {
    let (truth, dt) = (run.truth, run.truth.response.dt);
    let (force, duration) = (run.scenario.force.pulse(), run.summary.duration);
    let caption = "Force of the scenario; the loads take their shares of it.";
    let mut figures: Vec<Figure> = of_force(&force, dt, duration, caption).into_iter().collect();
    for (n, history) in truth.response.outputs.iter().take(MOST_OUTPUTS).enumerate() {
        let (modal, caption) =
            if n < truth.modes.len() { ("modal ", "Modal coordinate.") } else { ("", "Mean of its nodes.") };
        let name = &history.name;
        figures.push(of_history(
            format!("{name}: displacement"),
            &format!("{modal}displacement"),
            &history.displacement,
            dt,
            caption,
        ));
        figures.push(of_history(
            format!("{name}: acceleration"),
            &format!("{modal}acceleration"),
            &history.acceleration,
            dt,
            caption,
        ));
    }
    figures
}
