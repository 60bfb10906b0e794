//! Findings about the bending modes and their modal models.

use iwan_core::FourParameter;
use iwan_fem::mesh::beam::Configuration;

use super::finding::{Finding, FindingKind, FindingNumber, bounds, number};
use crate::beam::letter;
use crate::blows::LEVELS;
use crate::modes::{BendingMode, MICRO_SLIP, SHOWN, Slopes, StudiedMode};
use crate::printed::TABLE_2;
use crate::reproduction::Reproduction;
use iwan_sim::numbers::short;

/// The mode with this index in both configurations.
fn per_configuration(found: &Reproduction, index: usize) -> impl Iterator<Item = &BendingMode> {
    found.modes().map(|studied| &studied.mode).filter(move |mode| mode.index == index)
}

/// K_T of mode 1, compared with the printed value.
pub(super) fn joint_stiffness(found: &Reproduction) -> Finding {
    let printed = TABLE_2[0].k_t;
    let numbers: Vec<FindingNumber> = per_configuration(found, 0)
        .flat_map(|mode| {
            let name = letter(mode.configuration).to_lowercase();
            [number(format!("k_t_{name}"), mode.k_t), number(format!("off_{name}"), mode.k_t / printed - 1.0)]
        })
        .collect();
    let off = numbers.last().and_then(|n| n.value).unwrap_or_default();
    let values: Vec<String> = per_configuration(found, 0)
        .map(|mode| format!("{} in configuration {}", short(mode.k_t), letter(mode.configuration)))
        .collect();
    Finding {
        id: "k-t-1",
        kind: FindingKind::Reproduced,
        title: "Modal joint stiffness of mode 1",
        text: format!(
            "K_T = \u{3c9}\u{2080}\u{b2} \u{2212} \u{3c9}\u{221e}\u{b2} is {}; printed is {}. Configuration B is {:+.2} % off.",
            values.join(" and "),
            short(printed),
            100.0 * off
        ),
        numbers,
    }
}

/// The finding on mode 2, which has no joint: slipping does not soften it.
pub(super) fn second_mode(found: &Reproduction) -> Finding {
    let numbers: Vec<FindingNumber> = per_configuration(found, 1)
        .map(|mode| number(format!("k_t_{}", letter(mode.configuration).to_lowercase()), mode.k_t))
        .collect();
    let values: Vec<String> = per_configuration(found, 1)
        .map(|m| format!("{} ({})", short(m.k_t), letter(m.configuration)))
        .collect();
    Finding {
        id: "mode-2",
        kind: FindingKind::Limited,
        title: "Mode 2 is linear",
        text: format!(
            "Its K_T is negative, {}: slipping frees the link's inertia instead of softening the beam. No Iwan joint has that; printed are K_T = \
             {} with F_S = {}, a joint that never slips. We call the mode linear and fit nothing.",
            values.join(" and "),
            short(TABLE_2[1].k_t),
            short(TABLE_2[1].f_s)
        ),
        numbers,
    }
}

/// Modes with a joint (1 and 3), each with the slopes of its dissipation.
fn sloped(found: &Reproduction) -> impl Iterator<Item = (&BendingMode, &Slopes)> {
    let jointed = found.modes().map(|studied| &studied.mode).filter(|mode| mode.has_joint());
    jointed.filter_map(|mode| Some((mode, mode.slopes.as_ref()?)))
}

/// Beginning of the names of numbers for a mode, such as `a_mode_1`.
fn named(mode: &BendingMode) -> String {
    format!("{}_mode_{}", letter(mode.configuration).to_lowercase(), mode.index + 1)
}

/// Slopes of ln D over ln displacement in micro-slip.
pub(super) fn slopes(found: &Reproduction, table_1: &FourParameter) -> Finding {
    let numbers: Vec<FindingNumber> =
        sloped(found).map(|(mode, s)| number(named(mode), s.over_displacement)).collect();
    let values: Vec<String> = numbers.iter().filter_map(|n| n.value).map(|v| format!("{v:.3}")).collect();
    Finding {
        id: "slope",
        kind: FindingKind::Reproduced,
        title: "Dissipation follows a power of amplitude in micro-slip",
        text: format!(
            "From 1 to {MICRO_SLIP} lbf ln D over ln q has the slopes {} (modes 1 and 3 of A, then of B); the discrete joints' own is {}.",
            values.join(", "),
            table_1.chi() + 3.0
        ),
        numbers,
    }
}

/// χ as read off the slope over joint force.
pub(super) fn chi(found: &Reproduction, table_1: &FourParameter) -> Finding {
    let numbers: Vec<FindingNumber> = sloped(found).map(|(mode, s)| number(named(mode), s.chi)).collect();
    let first: Vec<String> = sloped(found)
        .filter(|(mode, _)| mode.index == 0)
        .map(|(mode, s)| format!("{:.3} in {}", s.chi, letter(mode.configuration)))
        .collect();
    Finding {
        id: "chi",
        kind: FindingKind::Reproduced,
        title: "\u{3c7} depends on the abscissa",
        text: format!(
            "Over the modal joint force (\u{3c9}\u{b2} \u{2212} \u{3c9}\u{221e}\u{b2}) q, which itself bends in micro-slip, \u{3c7} of mode 1 reads {}, near \
             the printed {}; over displacement it is nearer the joints' own {}.",
            first.join(" and "),
            TABLE_2[0].chi,
            table_1.chi()
        ),
        numbers,
    }
}

/// Dissipation of a mode under an impact, compared with that of the mode alone.
pub(super) fn coupling(found: &Reproduction) -> Finding {
    let mut numbers = Vec::new();
    let (mut words, mut alone) = (Vec::new(), Vec::new());
    for (mode, _) in sloped(found) {
        let quiet: Vec<f64> =
            mode.coupling.iter().filter(|c| c.level <= MICRO_SLIP).map(|c| c.mean).collect();
        let low = quiet.iter().copied().fold(f64::INFINITY, f64::min);
        let high = quiet.iter().copied().fold(0.0, f64::max);
        numbers.push(number(format!("{}_low", named(mode)), low));
        numbers.push(number(format!("{}_high", named(mode)), high));
        if let Some(own) = mode.alone {
            numbers.push(number(format!("{}_alone", named(mode)), own.mean));
            alone.push(format!("{:.2}", own.mean));
        }
        words.push(format!(
            "{:.2} to {:.2} times in mode {} of {}",
            low,
            high,
            mode.index + 1,
            letter(mode.configuration)
        ));
    }
    Finding {
        id: "coupling",
        kind: FindingKind::Limited,
        title: "Modes couple under an impact, even at 1 lbf",
        text: format!(
            "A blow moves all modes, and each keeps the joints moving for the others: a mode dissipates more than alone at the same amplitude, {} \
             from 1 to {MICRO_SLIP} lbf (means over a record). A ring-down that starts in \
             one mode alone has {} of what static loads promise. The slope stays near 2.7, so that logarithmic plots hide it. A modal model fitted to \
             impacts holds for such impacts only.",
            words.join(", "),
            alone.join(", ")
        ),
        numbers,
    }
}

/// Modes that share the link's joint, compared with modes that have joints of their own.
pub(super) fn remedy(found: &Reproduction) -> Finding {
    let (mut numbers, mut words) = (Vec::new(), Vec::new());
    for studied in &found.configurations {
        let Some(coupled) = &studied.coupled else { continue };
        for (StudiedMode { mode, counterpart }, with) in studied.modes.iter().zip(&coupled.modes) {
            let Some(counterpart) = counterpart else { continue };
            for (own, alone) in with.errors.iter().zip(&counterpart.errors) {
                numbers.push(number(format!("{}_{}_lbf", named(mode), own.level), own.whole));
                if mode.configuration == Configuration::A && SHOWN.iter().any(|n| LEVELS[*n] == own.level) {
                    let (own, alone) = (short(own.whole), short(alone.whole));
                    words.push(format!("mode {} {own} in place of {alone}", mode.index + 1));
                }
            }
        }
    }
    let without: Vec<&str> = found
        .configurations
        .iter()
        .filter(|studied| studied.coupled.is_none())
        .map(|studied| letter(studied.truth.beam.configuration))
        .collect();
    let missing = if without.is_empty() {
        String::new()
    } else {
        format!(" Of configuration {} three modes make no such model: it needs more.", without.join(", "))
    };
    Finding {
        id: "coupled-modes",
        kind: FindingKind::Limited,
        title: "The remedy: linear modes that share one joint",
        text: format!(
            "Three linear modes in their stuck frequencies and one joint, which feels the sum of their slips, with Table 1's law, the slips and the \
             static compliance of the structure and nothing fitted, leave over the whole record (configuration A, {} lbf): {}. \
             `iwan quasi-static` writes such a model, `iwan fit --coupled` finds one in records.{missing}",
            SHOWN.map(|n| LEVELS[n].to_string()).join(" and "),
            words.join(", "),
        ),
        numbers,
    }
}

/// How far the interval of β is open.
pub(super) fn beta(found: &Reproduction) -> Finding {
    let mut numbers = Vec::new();
    let mut words = Vec::new();
    for StudiedMode { mode, counterpart } in found.modes() {
        let Some(counterpart) = counterpart else { continue };
        let Some(interval) = counterpart.intervals.iter().find(|i| i.parameter == "beta") else { continue };
        numbers.push(number(format!("{}_on_curves", named(mode)), counterpart.parameters.beta));
        numbers.push(FindingNumber { name: format!("{}_low", named(mode)), value: interval.low });
        numbers.push(FindingNumber { name: format!("{}_high", named(mode)), value: interval.high });
        words.push(format!(
            "mode {} of {}: {} ({} on the curves)",
            mode.index + 1,
            letter(mode.configuration),
            bounds(interval),
            short(counterpart.parameters.beta)
        ));
    }
    Finding {
        id: "beta",
        kind: FindingKind::Limited,
        title: "How far records leave \u{3b2} open",
        text: format!(
            "95 % intervals of beta from the records at 100 and 1000 lbf, with frequency and K_T given: {}. Where interval and curves \
             contradict each other, no modal Iwan joint matches the mode (verdicts of Table 2). The paper calls F_S \
             and beta ambiguous; this is by how much.",
            words.join("; ")
        ),
        numbers,
    }
}

/// Differences between truth and modal model, as drawn in Figs. 8a and 8b.
pub(super) fn figure_8(found: &Reproduction) -> Finding {
    let mut numbers = Vec::new();
    let mut words = Vec::new();
    for StudiedMode { mode, counterpart } in found.modes() {
        let Some(counterpart) = counterpart else { continue };
        for n in SHOWN {
            let error = counterpart.errors[n];
            let name = format!("{}_{}_lbf", named(mode), LEVELS[n]);
            numbers.push(number(format!("{name}_early"), error.early));
            numbers.push(number(format!("{name}_whole"), error.whole));
            if mode.configuration == Configuration::A {
                words.push(format!(
                    "mode {} at {} lbf {} / {}",
                    mode.index + 1,
                    LEVELS[n],
                    short(error.early),
                    short(error.whole)
                ));
            }
        }
    }
    Finding {
        id: "figure-8",
        kind: FindingKind::Limited,
        title: "The modal model follows mode 1 well and mode 3 not under hard blows",
        text: format!(
            "Root mean square of the difference of accelerations over that of the truth, 0 to 50 ms / 0 to 200 ms, configuration A: {}.",
            words.join("; ")
        ),
        numbers,
    }
}
