//! Tables of the report.

use iwan_study::beam::{FilterQuality, ReductionError};
use iwan_study::findings::bounds;
use iwan_study::laboratory::{HitSummary, Laboratory, LaboratorySummary};
use iwan_study::modes::Interval;
use iwan_study::summary::{ConfigurationSummary, LevelSummary, ModeSummary, Table2Row};
use iwan_study::{Span, Summary};
use maud::{Markup, html};

use crate::page::numbers::{error, short};

/// A table with its head.
fn table(head: &[&str], rows: &[Vec<String>]) -> Markup {
    html! {
        div.wide { table {
            thead { tr { @for cell in head { th { (cell) } } } }
            tbody { @for row in rows { tr {
                @for (n, cell) in row.iter().enumerate() { @if n == 0 { th { (cell) } } @else { td { (cell) } } }
            } } }
        } }
    }
}

const EMPTY: &str = "\u{2013}";

fn shown(value: Option<f64>) -> String {
    value.map_or_else(|| EMPTY.into(), short)
}

pub(super) fn table_1(summary: &Summary) -> Markup {
    let t = &summary.table_1;
    let row = [
        "each joint, x and y".into(),
        short(t.k_t),
        short(t.f_s),
        short(t.chi),
        short(t.beta),
        short(t.phi_max),
        short(t.r),
        short(t.s),
    ];
    html! {
        (table(&["Table 1", "K_T, lbf/in", "F_S, lbf", "\u{3c7}", "\u{3b2}", "\u{3c6}_max, in", "R", "S, lbf/in"], &[row.to_vec()]))
        p.caption { "The first four are printed and used as they are; the density's \u{3c6}_max, R and S follow from them." }
    }
}

pub(super) fn modes(summary: &Summary) -> Markup {
    html! { @for truth in &summary.truth { (configuration(truth)) } }
}

fn configuration(truth: &ConfigurationSummary) -> Markup {
    let row = |mode: &ModeSummary| {
        vec![
            mode.name.clone(),
            format!("{:.4}", mode.frequency_stuck),
            format!("{:.4}", mode.frequency_slipping),
            format!("{:.3e}", mode.k_t),
            format!("{:.5}", mode.mac),
            format!("{:.4}", mode.tip),
        ]
    };
    let rows: Vec<Vec<String>> = truth.modes.iter().map(row).collect();
    let level = |level: &LevelSummary| {
        let peaks = level.peak_acceleration.iter().map(|peak| short(*peak));
        std::iter::once(format!("{} lbf", level.force))
            .chain(peaks)
            .chain([short(level.slip_ratio)])
            .collect()
    };
    let levels: Vec<Vec<String>> = truth.levels.iter().map(level).collect();
    let filter = |f: &FilterQuality| {
        format!("{}: rank {} of {}, condition {}", f.sensors, f.rank, f.modes, short(f.condition))
    };
    let filters: Vec<String> = truth.filters.iter().map(filter).collect();
    let others: Vec<String> =
        truth.frequencies.iter().map(|f| format!("{} {:.3}", f.name, f.frequency)).collect();
    let reduced = |off: &ReductionError| {
        let worst = off.modes.iter().copied().fold(0.0, f64::max);
        format!("{} of the full model at {} lbf", error(worst), off.level)
    };
    let reduced: Vec<String> = truth.reduction_error.iter().map(reduced).collect();
    html! {
        h3 { "Configuration " (truth.configuration) }
        p {
            (truth.nodes) " nodes, " (truth.unknowns) " unknowns, mass " (format!("{:.6e}", truth.total_mass)) " lbf\u{b7}s\u{b2}/in; "
            (truth.zero_modes.stuck) " zero modes stuck, " (truth.zero_modes.slipping) " slipping. Elastic frequencies stuck, Hz: "
            (others.join(", ")) ". Energy balance of all blows closes to " (error(truth.energy_error)) "."
        }
        (table(&["mode", "stuck, Hz", "slipping, Hz", "K_T, 1/s\u{b2}", "MAC", "shape at the tip"], &rows))
        (table(
            &["blow", "peak |q''| 1, \u{221a}(lbf\u{b7}in)/s", "2", "3", "largest slip / \u{3c6}_max"],
            &levels,
        ))
        p.caption {
            "Modal filter: " (filters.join("; ")) ". Left without attachment vectors the reduced model is off at 1000 lbf by "
            (truth.without_attachments.iter().map(|d| format!("{:.0} %", 100.0 * d.whole)).collect::<Vec<_>>().join(", "))
            " in the three modes; with them it is within "
            (reduced.join(" and "))
            " over the first 20 ms."
        }
    }
}

fn interval(row: &Table2Row, parameter: &str) -> String {
    let found: Option<&Interval> = row.intervals.iter().find(|i| i.parameter == parameter);
    found.map_or_else(|| EMPTY.into(), bounds)
}

pub(super) fn table_2(summary: &Summary) -> Markup {
    let mut rows = Vec::new();
    for row in &summary.table_2 {
        let p = row.identified;
        rows.push(vec![
            format!("{}, {}: identified", row.configuration, row.mode),
            p.map_or_else(|| "linear".into(), |p| format!("{:.3e}", p.k_t)),
            shown(p.map(|p| p.f_s)),
            shown(p.map(|p| p.chi)),
            shown(p.map(|p| p.beta)),
        ]);
        if row.identified.is_some() {
            rows.push(vec![
                "95 % interval from the records".into(),
                "given".into(),
                interval(row, "f_s"),
                interval(row, "chi"),
                interval(row, "beta"),
            ]);
            rows.push(vec![
                "read off: slope over F_J, static plateau".into(),
                EMPTY.into(),
                shown(row.static_f_s),
                shown(row.graphical_chi),
                EMPTY.into(),
            ]);
        }
        let printed = row.printed;
        rows.push(vec![
            "printed".into(),
            format!("{:.3e}", printed.k_t),
            short(printed.f_s),
            short(printed.chi),
            short(printed.beta),
        ]);
    }
    html! {
        (table(&["mode", "K_T, 1/s\u{b2}", "F_S, \u{221a}(lbf\u{b7}in)/s", "\u{3c7}", "\u{3b2}"], &rows))
        p.caption {
            "Identified: least squares on dissipation and frequency of the blows up to 1000 lbf, with \u{3c9}\u{2080} and K_T of the \
             structure's modes. Intervals: simulation in the loop on the records at 100 and 1000 lbf; they hold as \
             far as the model does (verdicts below)."
        }
        ul.notes { @for row in &summary.table_2 { li { (row.configuration) ", " (row.mode) ": " (row.verdict) "." } } }
    }
}

pub(super) fn figure_8(summary: &Summary, configuration: char) -> Markup {
    let mut rows = Vec::new();
    let percent = |x: f64| format!("{:.2} %", 100.0 * x);
    for truth in summary.truth.iter().filter(|t| t.configuration.starts_with(configuration)) {
        for mode in &truth.modes {
            for (ours, printed) in mode.figure_8.iter().zip(&mode.figure_8_printed) {
                let head = format!("{}, {} lbf", mode.name, ours.level);
                let cells = [ours.early, ours.whole, printed.early, printed.whole].map(percent);
                rows.push(std::iter::once(head).chain(cells).collect());
            }
        }
    }
    let head = [
        "difference, root mean square",
        "fitted, 0\u{2013}50 ms",
        "0\u{2013}200 ms",
        "F_S, \u{3c7}, \u{3b2} as printed, 0\u{2013}50 ms",
        "0\u{2013}200 ms",
    ];
    table(&head, &rows)
}

pub(super) fn laboratory(lab: &LaboratorySummary) -> Markup {
    let row = |hit: &HitSummary| {
        let pair = |span: Span| format!("{} \u{2192} {}", short(span.from), short(span.to));
        vec![
            format!("{} N", hit.force),
            short(hit.peak_acceleration),
            format!("{:.3} \u{2192} {:.3}", hit.frequency.from, hit.frequency.to),
            pair(hit.damping_ratio),
            pair(hit.modal_force),
            format!("{} of {}", hit.outliers, lab.sensors),
        ]
    };
    let rows: Vec<Vec<String>> = lab.hits.iter().map(row).collect();
    html! {
        p {
            "Synthetic measurements on configuration " (lab.configuration) ", whose first mode lies in the paper's band of "
            (lab.band.from) " to " (lab.band.to) " Hz: " (lab.sensors) " sensors on the top face, " (lab.sampling_rate) " samples a second for "
            (lab.seconds) " s, noise of " (lab.noise) " m/s\u{b2}, a suspension that takes " (short(100.0 * lab.damping_ratio_given))
            " % in every mode. The sensors tell bending modes 1 to 3 apart (rank " (lab.filter_rank) ", condition " (short(lab.filter_condition)) ")."
        }
        (table(
            &["hit", "largest, m/s\u{b2}", "frequency, Hz", "damping ratio", "modal force, \u{221a}kg\u{b7}m/s\u{b2}", "points off > 25 %"],
            &rows,
        ))
    }
}

pub(super) fn tables_3_and_4(summary: &Summary, lab: &Laboratory) -> Markup {
    // The percentages as the paper prints them, without trailing zeros.
    let percent = |ratio: f64| format!("{} %", (1e4 * ratio * 1e2).round() / 1e4);
    let rows_3: Vec<Vec<String>> = summary
        .table_3
        .iter()
        .map(|row| {
            vec![
                row.mode.clone(),
                format!("{:.3}", row.frequency),
                format!("{:.3} \u{b1} {:.1e}", row.frequency_found, row.frequency_sd),
                format!(
                    "{:.4} \u{b1} {:.0e} %",
                    100.0 * row.damping_ratio_found,
                    100.0 * row.damping_ratio_sd
                ),
                format!("{:.0e}", 1.0 - row.mac),
                format!("{:+.2} %", 100.0 * row.scale_error),
                row.printed_damping_ratios.map(percent).join(", "),
            ]
        })
        .collect();
    let rows_4: Vec<Vec<String>> = lab
        .table_4
        .iter()
        .map(|row| {
            vec![
                format!("{} N", row.hit),
                format!("{} \u{2192} {}", short(row.force.from), short(row.force.to)),
                format!("{:.3}", row.slope),
                format!("{:.3}", row.slope_without_viscous),
                shown(row.step),
                shown(row.step_without_viscous),
                shown(row.printed),
            ]
        })
        .collect();
    let found = &summary.lab;
    html! {
        h3 { "Table 3" }
        p {
            "The modal test: " (lab.test.hits()) " hits of " (lab.test.force) " N, responses of " (lab.test.responses.functions.len()) " sensors, mode isolation in " (format!("{:.0}", lab.test.fit.band.0)) " to "
            (format!("{:.0}", lab.test.fit.band.1)) " Hz. The suspension takes " (percent(summary.lab.damping_ratio_given)) " of every mode. Its shapes are those that the records of Figs. 14 to 17 are divided by."
        }
        (table(
            &[
                "mode", "true frequency, Hz", "by the test", "damping by the test", "1 \u{2212} MAC", "scale of the shape", "printed damping",
            ],
            &rows_3,
        ))
        p.caption { "True frequencies are those at rest; under the hits joints soften the modes, and take the damping that is above the suspension's. MAC and scale of the mass-normalised shape \
             are against the true one. Printed: with the link at 50 in-lbf without bungees, and at 5 in-lbf with them; without the link 0.01, 0.025, 0.02 %, on \
             bungees 0.016, 0.055, 0.045 %." }
        h3 { "Table 4" }
        (table(
            &["hit", "modal force, \u{221a}kg\u{b7}m/s\u{b2}", "slope within the record", "less viscous", "slope from the softer hit", "less viscous", "printed"],
            &rows_4,
        ))
        p.caption {
            "Slopes of ln D over ln force. Comparing hits at equal times: damping ratio " (format!("{:.3e}", found.damping_ratio_found)) " (given "
            (format!("{:.3e}", found.damping_ratio_given)) "), slope " (format!("{:.3}", found.slope_found)) " to "
            (format!("{:.1} %", 100.0 * found.slope_misfit)) ". For comparison, one joint with a damper in parallel fitted to all curves: "
            (format!("{:.3e}", found.damping_ratio_fitted)) ", " (format!("{:.3}", found.frequency_fitted)) " Hz, \u{3c7} = "
            (short(found.chi_fitted)) "; " (found.misfit) ". Printed (Table 4): 2.398, 2.168 and 2.096 at 1, 0.7 and 0.5 of the largest force."
        }
    }
}
