//! Writes a scenario with all defaults filled in; reading it again gives the same bits.

use std::fmt::Write;

use iwan_core::{Grid, Pulse, ResidualStiffness};
use iwan_sim::{Method, Representation, Settings};

use crate::text::quoted;
use crate::written_law::WrittenLaw;
use iwan_fem::Model;

use super::force::Force;
use super::joint::ScenarioJoint;
use super::mode::ScenarioMode;
use super::part;
use super::read::Scenario;
use super::structure::{OnStructure, Origin};
use super::sweep::SweepTable;

/// The scenario as TOML; where the force comes from a file, it is named `force_file`.
#[must_use]
pub fn to_toml(scenario: &Scenario, force_file: &str) -> String {
    let mut out =
        format!("# Written by iwan {}: the run with all defaults filled in.\n", env!("CARGO_PKG_VERSION"));
    if let Some(title) = &scenario.title {
        line(&mut out, "title", &quoted(title));
    }
    for mode in &scenario.modes {
        write_mode(&mut out, mode);
    }
    for joint in &scenario.joints {
        write_joint(&mut out, joint, scenario);
    }
    if let Some(structure) = &scenario.structure {
        write_structure(&mut out, structure);
    }
    write_force(&mut out, &scenario.force, force_file);
    write_time(&mut out, &scenario.settings);
    write_method(&mut out, &scenario.settings.method);
    if let Some(table) = &scenario.sweep {
        write_sweep(&mut out, table);
    }
    out
}

/// Appends a line `key = value`. Writing to a string cannot fail.
fn line(out: &mut String, key: &str, value: &str) {
    let _ = writeln!(out, "{key} = {value}");
}

fn number(out: &mut String, key: &str, value: f64) {
    line(out, key, &format!("{value:?}"));
}

/// An inline table `{ key = value, ... }`.
fn inline(pairs: &[(&str, String)]) -> String {
    let pairs: Vec<_> = pairs.iter().map(|(key, value)| format!("{key} = {value}")).collect();
    format!("{{ {} }}", pairs.join(", "))
}

fn write_mode(out: &mut String, ScenarioMode { mode, joint, informed }: &ScenarioMode) {
    out.push_str("\n[[mode]]\n");
    line(out, "name", &quoted(&mode.name));
    if let Some(curves) = &mode.curves {
        line(out, "curves", &curves_table(curves));
    } else {
        number(out, "frequency", mode.frequency);
        number(out, "damping_ratio", mode.damping_ratio);
    }
    if let Some(joint) = joint {
        line(out, "joint", &joint_table(joint));
    }
    if !mode.parts.is_empty() {
        let parts: Vec<_> = mode.parts.iter().map(part_table).collect();
        line(out, "parts", &format!("[\n    {},\n]", parts.join(",\n    ")));
    }
    number(out, "shape_at_force", mode.shape_at_force);
    if !mode.outputs.is_empty() {
        let names: Vec<_> = mode.outputs.iter().map(|p| quoted(&p.name)).collect();
        let pairs: Vec<_> = names
            .iter()
            .zip(&mode.outputs)
            .map(|(name, p)| (name.as_str(), format!("{:?}", p.shape)))
            .collect();
        line(out, "outputs", &inline(&pairs));
    }
    let iwan_core::Motion { displacement, velocity } = mode.initial;
    let initial = [("displacement", format!("{displacement:?}")), ("velocity", format!("{velocity:?}"))];
    line(out, "initial", &inline(&initial));
    if mode.residual == ResidualStiffness::Any {
        line(out, "allow_negative_residual", "true");
    }
    if let Some(informed) = informed {
        line(out, "informed", &format!("{informed:?}"));
    }
}

fn write_joint(out: &mut String, ScenarioJoint { joint, law }: &ScenarioJoint, scenario: &Scenario) {
    out.push_str("\n[[joint]]\n");
    line(out, "name", &quoted(&joint.name));
    line(out, "law", &joint_table(law));
    let by_name = |names: Vec<&str>, values: &[f64]| {
        let named = names.iter().zip(values).filter(|(_, value)| **value != 0.0);
        let pairs: Vec<_> = named.map(|(name, value)| format!("{} = {value:?}", quoted(name))).collect();
        format!("{{ {} }}", pairs.join(", "))
    };
    let modes = scenario.modes.iter().map(|m| m.mode.name.as_str()).collect();
    line(out, "participation", &by_name(modes, &joint.participation));
    let own = scenario.joints.iter().position(|j| j.joint.name == joint.name).unwrap_or(0);
    if joint.compliance.iter().enumerate().all(|(l, rho)| l == own || *rho == 0.0) {
        number(out, "compliance", joint.compliance.get(own).copied().unwrap_or(0.0));
    } else {
        let joints = scenario.joints.iter().map(|j| j.joint.name.as_str()).collect();
        line(out, "compliance", &by_name(joints, &joint.compliance));
    }
    number(out, "slip_at_force", joint.slip_at_force);
}

fn part_table(part: &iwan_core::Part) -> String {
    let (law, keys, count) = part::written(part);
    let keys = keys.iter().take(count).map(|(key, value)| (*key, format!("{value:?}")));
    inline(&[("law", quoted(law))].into_iter().chain(keys).collect::<Vec<_>>())
}

/// A table with the points of the curves themselves, even where they were read from a file.
fn curves_table(curves: &iwan_sim::Curves) -> String {
    let [amplitude, frequency, damping_ratio] = curves.table().map(|column| format!("{column:?}"));
    inline(&[
        ("amplitude", amplitude),
        ("frequency", frequency),
        ("damping_ratio", damping_ratio),
        ("extrapolate", curves.extrapolates().to_string()),
    ])
}

fn write_structure(out: &mut String, structure: &OnStructure) {
    out.push_str("\n[structure]\n");
    match &structure.origin {
        // An absolute path where it can be determined, because the scenario is written into another folder.
        Origin::File(path) => {
            let path = path.canonicalize().unwrap_or_else(|_| path.clone());
            line(out, "path", &quoted(&path.display().to_string()));
        }
        Origin::BuiltIn(name) => line(out, "name", &quoted(name)),
        Origin::Reduced(folder) => {
            let folder = folder.canonicalize().unwrap_or_else(|_| folder.clone());
            line(out, "reduced", &quoted(&folder.display().to_string()));
        }
    }
    line(out, "model", if structure.model == Model::Full { "\"full\"" } else { "\"reduced\"" });
    match structure.model {
        Model::Full | Model::Kept => {}
        Model::Basis(modes) => line(out, "basis", &modes.to_string()),
        Model::Tolerance(tolerance) => number(out, "tolerance", tolerance),
    }
    if !structure.modes.is_empty() {
        let names: Vec<String> = structure.modes.iter().map(|name| quoted(name)).collect();
        line(out, "modes", &format!("[{}]", names.join(", ")));
    }
    if structure.frames > 0 {
        line(out, "frames", &structure.frames.to_string());
    }
}

fn joint_table(joint: &WrittenLaw) -> String {
    let kind = |name| ("kind", quoted(name));
    let n = |key: &'static str, value: &f64| (key, format!("{value:?}"));
    let list = |key: &'static str, values: &[f64]| (key, format!("{values:?}"));
    match joint {
        WrittenLaw::FourParameter { k_t, f_s, chi, beta } => {
            inline(&[kind("four-parameter"), n("k_t", k_t), n("f_s", f_s), n("chi", chi), n("beta", beta)])
        }
        WrittenLaw::FiveParameter { k_t, f_s, chi, beta, theta } => inline(&[
            kind("five-parameter"),
            n("k_t", k_t),
            n("f_s", f_s),
            n("chi", chi),
            n("beta", beta),
            n("theta", theta),
        ]),
        WrittenLaw::Jenkins { k_t, f_s } => inline(&[kind("jenkins"), n("k_t", k_t), n("f_s", f_s)]),
        WrittenLaw::Uniform { k_t, f_s, width } => {
            inline(&[kind("uniform"), n("k_t", k_t), n("f_s", f_s), n("width", width)])
        }
        WrittenLaw::Tabulated { strength, density, dirac } => inline(&[
            kind("tabulated"),
            list("strength", strength),
            list("density", density),
            n("dirac", dirac),
        ]),
    }
}

fn write_force(out: &mut String, force: &Force, force_file: &str) {
    out.push_str("\n[force]\n");
    let Force::Formula(kind, pulse) = force else {
        line(out, "kind", "\"file\"");
        line(out, "path", &quoted(force_file));
        return;
    };
    line(out, "kind", &quoted(kind));
    match *pulse {
        Pulse::Haversine { amplitude, duration }
        | Pulse::HalfSine { amplitude, duration }
        | Pulse::Step { amplitude, duration } => {
            number(out, "amplitude", amplitude);
            number(out, "duration", duration);
        }
        Pulse::Sine { amplitude, frequency, duration } => {
            number(out, "amplitude", amplitude);
            number(out, "frequency", frequency);
            number(out, "duration", duration);
        }
        Pulse::None | Pulse::Sampled { .. } => {}
    }
}

fn write_time(out: &mut String, settings: &Settings) {
    out.push_str("\n[time]\n");
    number(out, "step", settings.dt);
    number(out, "duration", settings.duration);
}

fn write_method(out: &mut String, method: &Method) {
    out.push_str("\n[method]\n");
    match *method {
        Method::Newmark { beta, gamma, prewarp, joint } => {
            line(out, "kind", "\"newmark\"");
            match joint {
                Representation::Sliders { bins, grid } => {
                    line(out, "joint", "\"sliders\"");
                    write_bins(out, bins, grid);
                }
                Representation::Continuum => line(out, "joint", "\"continuum\""),
            }
            line(out, "prewarp", &prewarp.to_string());
            number(out, "beta", beta);
            number(out, "gamma", gamma);
        }
        Method::HalfCycle => line(out, "kind", "\"half-cycle\""),
        Method::Averaging => line(out, "kind", "\"averaging\""),
        Method::Event { bins, grid } => {
            line(out, "kind", "\"event\"");
            write_bins(out, bins, grid);
        }
    }
}

fn write_bins(out: &mut String, bins: usize, grid: Grid) {
    line(out, "sliders", &bins.to_string());
    line(out, "grid", if grid == Grid::Uniform { "\"uniform\"" } else { "\"graded\"" });
}

fn write_sweep(out: &mut String, SweepTable { sweep, at, damping_ratio, direction }: &SweepTable) {
    out.push_str("\n[sweep]\n");
    number(out, "from", sweep.from);
    number(out, "to", sweep.to);
    line(out, sweep.control.name(), &format!("{:?}", sweep.levels));
    if let Some(at) = at {
        line(out, "at", &quoted(at));
    }
    line(out, "harmonics", &sweep.harmonics.to_string());
    line(out, "points", &sweep.points.to_string());
    if let Some(direction) = direction {
        line(out, "direction", &format!("{direction:?}"));
    }
    if let Some(ratio) = damping_ratio {
        number(out, "damping_ratio", *ratio);
    }
}
