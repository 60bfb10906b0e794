//! The finding of the laboratory on the viscous term.

use super::finding::{Finding, FindingKind, number};
use crate::laboratory::{HITS, Laboratory, Table4Row};

/// Slopes of the dissipation at each level, with and without the viscous term.
pub(super) fn table_4(laboratory: &Laboratory) -> Finding {
    let lab = laboratory.summary();
    let shown = |slope: fn(&Table4Row) -> Option<f64>| {
        let slopes: Vec<String> =
            laboratory.table_4.iter().filter_map(slope).map(|slope| format!("{slope:.2}")).collect();
        slopes.join(", ")
    };
    let mut numbers = vec![
        number("damping_ratio_given", lab.damping_ratio_given),
        number("damping_ratio_found", lab.damping_ratio_found),
        number("slope_found", lab.slope_found),
        number("drift", lab.drift),
        number("drift_without_viscous", lab.drift_without_viscous),
    ];
    for row in &laboratory.table_4 {
        numbers.push(number(format!("slope_{}_n", row.hit), row.slope));
        numbers.push(number(format!("slope_without_viscous_{}_n", row.hit), row.slope_without_viscous));
    }
    Finding {
        id: "table-4",
        kind: FindingKind::Reproduced,
        title: "A viscous damper in parallel makes the slope drift with the level",
        text: format!(
            "Hits of {} N: within each record dissipation over force has the slopes {}; from hit to hit at equal times {}, and {} with the \
             viscous term taken off, where one slope of {:.3} holds for all. The suspension was given a damping ratio of {:.3e}; comparing hits finds \
             {:.3e}. Within a record even that slope is steeper ({}), because the other modes fade while mode 1 rings.",
            HITS.map(|hit| hit.to_string()).join(", "),
            shown(|row| Some(row.slope)),
            shown(|row| row.step),
            shown(|row| row.step_without_viscous),
            lab.slope_found,
            lab.damping_ratio_given,
            lab.damping_ratio_found,
            shown(|row| Some(row.slope_without_viscous)),
        ),
        numbers,
    }
}
