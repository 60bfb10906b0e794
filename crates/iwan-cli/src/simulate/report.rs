//! The report of `iwan simulate` on modes.

use iwan_core::Backbone;
use iwan_input::scenario::Scenario;
use iwan_sim::{CoupledResponse, Mode, cycles};
use maud::{Markup, html};

use super::figures::{Decay, of_force, of_history};
use super::files::PointResponse;
use super::joints::{loops, table as table_of_joints};
use super::summary::{ModeSummary, ROWS, Row, SimulationSummary};
use crate::failure::VERSION;
use crate::page::figure::Figure;
use crate::page::html::{grid, page, verdict};
use crate::page::numbers::{error, short};

/// Most modes, and most named points, that have figures of their own. Twenty modes take 2.5 MB of the page and twenty points 0.7 MB; of more, the
/// page says so, and the response file holds all.
pub(super) const MOST: usize = 20;

/// The contents of the report.
#[derive(Debug)]
pub(super) struct Reported<'a> {
    pub(crate) scenario: &'a Scenario,
    /// The scenario as run, as TOML.
    pub(crate) toml: &'a str,
    pub(crate) response: &'a CoupledResponse,
    /// Displacement, velocity and acceleration at the named points.
    pub(crate) points: &'a [PointResponse],
    pub(crate) summary: &'a SimulationSummary,
}

/// The page.
pub(super) fn render(run: &Reported<'_>) -> String {
    let summary = run.summary;
    let body = html! {
        (head(summary))
        (verdict(&summary.warnings, &errors(summary)))
        (navigation(summary))
        (tables(summary))
        (force_and_points(run))
        (joints(run))
        (modes(run))
        (repeat(run.toml))
    };
    page(&format!("{} \u{2013} iwan simulate", summary.scenario), &body)
}

pub(super) fn head(summary: &SimulationSummary) -> Markup {
    let plural = if summary.modes.len() == 1 { "" } else { "s" };
    html! {
        h1 { (summary.scenario) }
        p.about {
            "Ring-down of " (summary.modes.len()) " mode" (plural) " over " (summary.duration) " s at steps of "
            (short(summary.time_step)) " s, method " (summary.method) ". Written by iwan " (VERSION) "."
        }
        p.about {
            "Units are the user's own consistent set; times in s, frequencies in Hz. Modal quantities are "
            "mass-normalised: the modal displacement q is in \u{221a}mass \u{b7} length."
        }
    }
}

/// How exact the response is, in a sentence.
pub(super) fn errors(summary: &SimulationSummary) -> Markup {
    let worst = |estimate: fn(&ModeSummary) -> Option<f64>| {
        let estimates = summary.modes.iter().filter_map(estimate);
        estimates.fold(None, |most: Option<f64>, e| Some(most.map_or(e, |m| m.max(e))))
    };
    let shown = |estimate: Option<f64>| estimate.map_or_else(|| "not estimated".into(), error);
    let step = shown(worst(|m| m.time_step_error));
    let sliders = shown(worst(|m| m.discretisation_error));
    let energy = shown(worst(|m| Some(m.energy_error)));
    html! {
        "Largest estimated errors, relative to the peak displacement: time step " (step)
        ", cutting the joint into sliders " (sliders) "; the energy balance closes to " (energy) "."
    }
}

fn navigation(summary: &SimulationSummary) -> Markup {
    html! {
        nav {
            a href="#summary" { "Summary" }
            a href="#force" { "Force and points" }
            @for (n, mode) in summary.modes.iter().take(MOST).enumerate() {
                a href=(format!("#mode-{n}")) { (mode.name) }
            }
            a href="#repeat" { "Scenario" }
        }
    }
}

/// The energy balance, mode by mode.
const ENERGY: [Row; 8] = [
    Row { label: "at the start", cell: |m| short(m.energy.initial) },
    Row { label: "put in by the force", cell: |m| short(m.energy.input) },
    Row { label: "lost in viscous damping", cell: |m| short(m.energy.viscous) },
    Row { label: "lost in friction", cell: |m| short(m.energy.friction) },
    Row { label: "kinetic, at the end", cell: |m| short(m.energy.kinetic) },
    Row { label: "elastic, at the end", cell: |m| short(m.energy.elastic) },
    Row { label: "stored in the joint, at the end", cell: |m| short(m.energy.stored) },
    Row { label: "residual", cell: |m| short(m.energy.residual) },
];

/// A table with the modes side by side.
fn table(summary: &SimulationSummary, rows: &[Row]) -> Markup {
    html! {
        div.wide {
            table {
                thead { tr { th { "mode" } @for mode in &summary.modes { th { (mode.name) } } } }
                tbody {
                    @for row in rows {
                        tr { th { (row.label) } @for mode in &summary.modes { td { ((row.cell)(mode)) } } }
                    }
                }
            }
        }
    }
}

pub(super) fn tables(summary: &SimulationSummary) -> Markup {
    html! {
        div.tables {
        section { h2 id="summary" { "Summary" }
        (table(summary, &ROWS))
        p.caption {
            "The slip ratio is the peak displacement over \u{3c6}_max: the joint slips as a whole above 1. Errors are "
            "relative to the peak displacement, the energy error to the largest energy in play."
        } }
        section { h2 { "Energy balance" }
        (table(summary, &ENERGY))
        p.caption {
            "Start and input equal losses, what is left at the end, and the residual: what the integration gained or lost."
        } }
        }
    }
}

fn force_and_points(run: &Reported<'_>) -> Markup {
    let dt = run.scenario.settings.dt;
    let (force, duration) = (run.scenario.force.pulse(), run.summary.duration);
    let caption = "Applied force; each mode sees it times its shape at the load.";
    let mut figures: Vec<Figure> = of_force(&force, dt, duration, caption).into_iter().collect();
    for (name, [displacement, _, acceleration]) in run.points.iter().take(MOST) {
        let caption = "All modes together.";
        figures.push(of_history(
            format!("Displacement at {name}"),
            "displacement",
            displacement,
            dt,
            caption,
        ));
        figures.push(of_history(
            format!("Acceleration at {name}"),
            "acceleration",
            acceleration,
            dt,
            caption,
        ));
    }
    html! {
        h2 id="force" { "Force and points" }
        @if figures.is_empty() { p { "Free decay without force; the scenario names no points." } }
        (grid(&figures))
        (left_out(run.points.len(), "points"))
    }
}

pub(super) fn left_out(count: usize, what: &str) -> Markup {
    html! {
        @if count > MOST {
            p { "Figures of the first " (MOST) " of " (count) " " (what) "; the response file has them all." }
        }
    }
}

fn modes(run: &Reported<'_>) -> Markup {
    let settled = run.scenario.force.pulse().settled();
    let each = run.scenario.modes.iter().zip(&run.response.modes).zip(&run.summary.modes).take(MOST);
    html! {
        @for (n, ((mode, response), summary)) in each.enumerate() {
            h2 id=(format!("mode-{n}")) { (mode.mode.name) }
            @let shares = run.scenario.joints.iter().any(|joint| joint.joint.moved_by(n));
            p { (describe(&mode.mode, summary, shares)) }
            (grid(&Decay { mode: &mode.mode.after(response.peak_displacement()), response, cycles: cycles(response, settled), settled, shares }.figures()))
        }
        (left_out(run.response.modes.len(), "modes"))
    }
}

/// A description of the mode in a sentence.
pub(super) fn describe(mode: &Mode, summary: &ModeSummary, shares: bool) -> String {
    if shares {
        return describe_coupled(summary);
    }
    let strengths = mode.joint.as_ref().map(Backbone::strengths);
    let what = match (strengths, summary.slip_ratio) {
        (None, _) if mode.curves.is_some() => "known by its curves, without a law".into(),
        (None, _) if !mode.is_plain() => "without a joint".into(),
        (None, _) => "linear, without a joint".into(),
        (Some((weakest, _)), _) if summary.peak_displacement <= weakest => {
            format!("stuck: the peak does not reach the weakest slider's strength {}", short(weakest))
        }
        (Some((_, phi)), ratio) if ratio >= 1.0 => {
            format!("macro-slip: the peak is {} times \u{3c6}_max = {}", short(ratio), short(phi))
        }
        (Some((_, phi)), ratio) => {
            format!("micro-slip: the peak reaches {} of \u{3c6}_max = {}", short(ratio), short(phi))
        }
    };
    let parts = match mode.parts.len() {
        0 => String::new(),
        1 => " One part stands beside it.".into(),
        n => format!(" {n} parts stand beside it."),
    };
    let (viscous, friction) = (summary.energy.viscous, summary.energy.friction);
    let lost = viscous + friction;
    let share = if lost > 0.0 && (strengths.is_some() || !mode.parts.is_empty()) {
        format!(" Friction takes {:.1} % of the energy lost.", (100.0 * friction / lost).max(0.0))
    } else {
        String::new()
    };
    format!("{} Hz at small amplitude; {what}.{parts}{share}", short(summary.frequency))
}

/// A description, in a sentence, of a mode that shares joints.
fn describe_coupled(summary: &ModeSummary) -> String {
    let ratio = summary.slip_ratio;
    let reach = if ratio >= 1.0 { "beyond macro-slip" } else { "into micro-slip" };
    format!(
        "{} Hz with all joints stuck; shares joints with other modes. By itself its peak would bring a joint to {} times \
         \u{3c6}_max, {reach}. Work that it did on the joints: {} of {} that it was given.",
        short(summary.frequency),
        short(ratio),
        short(summary.energy.friction),
        short(summary.energy.initial + summary.energy.input)
    )
}

/// The section on the joints that modes share.
fn joints(run: &Reported<'_>) -> Markup {
    let Some(coupled) = &run.summary.coupled else { return html! {} };
    let histories = run.response.joints.iter().filter(|joint| joint.slip_ratio() > 0.0).take(MOST);
    let figures: Vec<Figure> = histories.map(|j| loops(&j.name, &j.slip, &j.force)).collect();
    let lost: f64 = coupled.joints.iter().map(|joint| joint.friction).sum();
    html! {
        h2 id="joints" { "Joints" }
        p {
            "Each joint feels the sum of the modes that move it. Friction in the joints took " (short(lost)) " of "
            (short(coupled.energy.initial + coupled.energy.input)) ", viscous damping " (short(coupled.energy.viscous))
            "; the energy balance of modes and joints closes to " (error(coupled.energy_error)) "."
        }
        (table_of_joints(coupled.joints.iter().map(|joint| &joint.slip)))
        (grid(&figures))
    }
}

pub(super) fn repeat(toml: &str) -> Markup {
    html! {
        h2 id="repeat" { "Scenario" }
        p {
            "The run with all defaults filled in, as in " code { "scenario.toml" } " beside this page. To repeat it to the "
            "last bit: " code { "iwan simulate scenario.toml --out again" }
        }
        pre { (toml) }
    }
}
