//! The report of `iwan simulate` on a structure: the structure, its motion, its joints.

use iwan_core::Pulse;
use iwan_fem::SlipHistory;
use maud::{Markup, html};

use super::run::Truth;
use crate::page::decimate::thin;
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};
use crate::page::html::{grid, page, verdict};
use crate::page::numbers::{error, short};
use crate::page::solid::Solid;
use crate::scenario::Scenario;
use crate::session::VERSION;
use crate::simulate::figures::{of_force, of_history};
use crate::simulate::summary::{ROWS, SimulationSummary, StructureSummary};
use crate::structures::picture::mesh_picture;

/// What the report is about.
#[derive(Debug)]
pub(super) struct Reported<'a> {
    pub(crate) scenario: &'a Scenario,
    /// The scenario as run, as TOML.
    pub(crate) toml: &'a str,
    pub(crate) truth: &'a Truth,
    pub(crate) summary: &'a SimulationSummary,
}

/// Outputs with figures of their own.
const MOST_OUTPUTS: usize = 12;
/// Joints with figures of their own: those that slip most.
const MOST_SLIPS: usize = 4;
/// Points of a loop.
const LOOP: usize = 6000;
/// Meshes with more outer faces than this are not drawn.
const MOST_FACES: usize = 40_000;

/// The page.
pub(super) fn render(input: &Reported<'_>) -> String {
    let summary = input.summary;
    let Some(structure) = &summary.structure else { return String::new() };
    let mesh = &input.truth.linear.file.structure.mesh;
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
        @if solid.faces() <= MOST_FACES { (mesh_picture(&solid, mesh)) }
        h2 id="summary" { "Modes" }
        p { "Modal coordinates of the structure's response (exact modal filter); energies and slip ratio are those of the whole structure." }
        (modes(summary))
        h2 id="joints" { "Joints" }
        (slips(structure))
        (grid(&loops(input.truth)))
        h2 id="histories" { "Histories" }
        (grid(&histories(input)))
        h2 id="repeat" { "Scenario" }
        p { "The run with all defaults filled in, as in " code { "scenario.toml" } " beside this page." }
        pre { (input.toml) }
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
            tbody { @for (label, cell) in ROWS { tr { th { (label) } @for mode in &summary.modes { td { (cell(mode)) } } } } }
        } }
    }
}

fn slips(structure: &StructureSummary) -> Markup {
    html! {
        div.wide { table {
            thead { tr { th { "slip" } th { "largest slip" } th { "largest force" } th { "slip ratio" } } }
            tbody { @for slip in &structure.slips { tr {
                th { (slip.name) } td { (short(slip.peak_slip)) } td { (short(slip.peak_force)) } td { (short(slip.slip_ratio)) }
            } } }
        } }
        p.caption { "The slip ratio is the largest slip over \u{3c6}_max of the joint: it slips as a whole above 1." }
    }
}

/// Force over slip of the joints that slip most.
fn loops(truth: &Truth) -> Vec<Figure> {
    let mut slips: Vec<&SlipHistory> = truth.response.slips.iter().collect();
    slips.sort_by(|a, b| b.slip_ratio.total_cmp(&a.slip_ratio));
    let figure = |slip: &&SlipHistory| {
        let points: Vec<(f64, f64)> = slip.slip.iter().copied().zip(slip.force.iter().copied()).collect();
        Figure {
            title: format!("Joint {}", slip.name),
            caption: "Joint force over slip.".into(),
            x: Axis::linear("slip", ""),
            y: Axis::linear("force", ""),
            layers: vec![Layer::new(Mark::Line, colour::GREEN, thin(&points, LOOP))],
            marker: None,
        }
    };
    slips.iter().filter(|slip| slip.slip_ratio > 0.0).take(MOST_SLIPS).map(figure).collect()
}

fn histories(input: &Reported<'_>) -> Vec<Figure> {
    let (truth, dt) = (input.truth, input.truth.response.dt);
    let pulse = input.scenario.force.pulse();
    let mut figures = Vec::new();
    if pulse != Pulse::None {
        let end = match pulse.settled() {
            settled if settled > 0.0 => (1.25 * settled).min(input.summary.duration),
            _ => input.summary.duration,
        };
        let samples: Vec<f64> = (0..=(end / dt) as usize).map(|n| pulse.at(n as f64 * dt)).collect();
        figures.push(of_force(
            &samples,
            dt,
            "Force of the scenario; the loads take their shares of it.".into(),
        ));
    }
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
