//! Figures of the records beside the responses of the fitted models.

use iwan_ident::coupled::{CoupledFit, CoupledRecord, FittedSharing, Sharing};
use iwan_ident::curves::Quantity;

use crate::page::decimate::{STRETCHES, history};
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};

/// Measured and modelled responses, record by record: first the figures of the fitted records, then those of the held-out ones.
pub(super) fn figures(
    fit: &CoupledFit,
    records: &[CoupledRecord],
    names: &[String],
    quantity: Quantity,
) -> Vec<Figure> {
    let mut all = Vec::new();
    for (k, record) in records.iter().enumerate() {
        for (m, measured) in record.motions.iter().enumerate() {
            let points = |values: &[f64]| history(values, record.dt, STRETCHES);
            let difference = |model: &FittedSharing| -> Vec<(f64, f64)> {
                let own = &model.motions[k][m];
                points(&own.iter().zip(measured).map(|(a, b)| a - b).collect::<Vec<_>>())
            };
            let mut layers = vec![Layer::new(Mark::Line, colour::GREY, points(measured)).named("record")];
            let chosen = fit.best().sharing;
            let others = [(Sharing::Uncoupled, colour::BLUE), (chosen, colour::VERMILLION)];
            for (sharing, colour) in others.into_iter().skip(usize::from(chosen == Sharing::Uncoupled)) {
                if let Some(model) = fit.of(sharing) {
                    let name = format!("{} less record", sharing.name());
                    layers.push(Layer::new(Mark::Line, colour, difference(model)).named(name));
                }
            }
            let title = if record.motions.len() > 1 {
                format!("{}: {}", record.name, names[m])
            } else {
                record.name.clone()
            };
            all.push(Figure {
                title,
                caption: String::new(),
                x: Axis::linear("t", "s"),
                y: Axis::linear(label(quantity), ""),
                layers,
                marker: None,
            });
        }
    }
    all
}

const fn label(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Acceleration => "acceleration",
        Quantity::Velocity => "velocity",
        Quantity::Displacement => "displacement",
    }
}
