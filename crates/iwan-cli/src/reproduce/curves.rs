//! `curves.csv`: the curves of all modes under all blows, below each other.

use iwan_fem::mesh::beam::Configuration;
use iwan_study::Reproduction;
use iwan_study::blows::LEVELS;

/// A column with its name.
type Column = (&'static str, Vec<f64>);

/// The columns; in `configuration` 1 stands for A and 2 for B.
pub(super) fn columns(found: &Reproduction) -> Vec<Column> {
    let names = [
        "configuration",
        "mode",
        "level",
        "t",
        "displacement",
        "frequency",
        "damping_ratio",
        "dissipation",
        "modal_force",
    ];
    let mut columns: Vec<Column> = names.map(|name| (name, Vec::new())).to_vec();
    for mode in found.modes().map(|studied| &studied.mode) {
        let configuration = match mode.configuration {
            Configuration::A => 1.0,
            Configuration::B => 2.0,
        };
        for (curves, level) in mode.curves.iter().zip(LEVELS) {
            for i in 0..curves.t.len() {
                let row = [
                    configuration,
                    (mode.index + 1) as f64,
                    level,
                    curves.t[i],
                    curves.displacement[i],
                    curves.frequency[i],
                    curves.damping_ratio[i],
                    curves.dissipation[i],
                    curves.force[i],
                ];
                columns.iter_mut().zip(row).for_each(|((_, column), value)| column.push(value));
            }
        }
    }
    columns
}
