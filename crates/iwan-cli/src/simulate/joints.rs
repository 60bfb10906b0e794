//! Joints in a response: their table and their hysteresis loops.

use maud::{Markup, html};

use super::summary::SlipSummary;
use crate::page::decimate::thin;
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};
use crate::page::numbers::short;

/// Most points of a joint's loops, drawn as one line over all cycles: some 70 kB of the page. Longer responses are thinned to this number, which
/// leaves 60 points to each of a hundred cycles.
const LOOP: usize = 6000;

/// The joints with their largest slips and forces.
pub(crate) fn table<'a>(slips: impl Iterator<Item = &'a SlipSummary>) -> Markup {
    html! {
        div.wide { table {
            thead { tr { th { "slip" } th { "largest slip" } th { "largest force" } th { "slip ratio" } } }
            tbody { @for slip in slips { tr {
                th { (slip.name) } td { (short(slip.peak_slip)) } td { (short(slip.peak_force)) } td { (short(slip.slip_ratio)) }
            } } }
        } }
        p.caption { "The slip ratio is the largest slip over \u{3c6}_max of the joint: it slips as a whole above 1." }
    }
}

/// Force over slip of a joint.
pub(crate) fn loops(name: &str, slip: &[f64], force: &[f64]) -> Figure {
    let points: Vec<(f64, f64)> = slip.iter().copied().zip(force.iter().copied()).collect();
    Figure {
        title: format!("Joint {name}"),
        caption: "Joint force over slip.".into(),
        x: Axis::linear("slip", ""),
        y: Axis::linear("force", ""),
        layers: vec![Layer::new(Mark::Line, colour::GREEN, thin(&points, LOOP))],
        marker: None,
    }
}
