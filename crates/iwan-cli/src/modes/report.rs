//! The report of `iwan modes`: the mesh, the frequencies, the shapes.

use iwan_fem::NamedMode;
use maud::{Markup, html};

use super::summary::{ModesSummary, Pair};
use crate::failure::VERSION;
use crate::page::html::{page, warnings};
use crate::page::numbers::short;
use crate::page::solid::{Deformation, Solid, by_share, length};
use crate::structures::Linear;
use crate::structures::picture::{MOST_FACES, mesh_picture};

/// Most pictures of shapes on the page; all shapes are in `modes.vtu`.
const MOST_SHAPES: usize = 12;
/// Largest displacement of a picture as a part of the mesh's diagonal. From 0.05 to 0.1 the shape is visible and the structure still recognisable.
const EXAGGERATION: f64 = 0.07;
/// Most slips named below a picture, the largest first: they fill one line.
const MOST_SLIPS: usize = 4;

/// The page.
pub(super) fn render(linear: &Linear, summary: &ModesSummary) -> String {
    let mesh = &linear.file.structure.mesh;
    let solid = Solid::new(mesh);
    let shapes = (MOST_FACES / solid.pieces().max(1)).clamp(1, MOST_SHAPES);
    let body = html! {
        h1 { (summary.structure) }
        p.about {
            "Linear modes with all joints stuck (the limit of small amplitudes) and with all joints slipping. Written by iwan "
            (VERSION) "."
        }
        (summary.size.paragraph())
        (warnings(&summary.warnings))
        nav { a href="#modes" { "Modes" } a href="#mesh" { "Mesh" } a href="#shapes" { "Shapes" } }
        h2 id="modes" { "Modes" }
        p {
            (summary.zero_modes.stuck) " zero modes stuck, " (summary.zero_modes.slipping) " slipping. K_T = \u{3c9}\u{2080}\u{b2} \u{2212} \
            \u{3c9}\u{221e}\u{b2} is the modal joint stiffness; MAC tells how alike the stuck and the slipping shape are (1 = the same)."
        }
        (table(&summary.modes))
        h2 id="mesh" { "Mesh" }
        (mesh_picture(&solid, mesh))
        h2 id="shapes" { "Shapes" }
        p { "All joints stuck; the largest displacement is drawn as " (format!("{:.0}", 100.0 * EXAGGERATION)) " % of the structure's size. "
            @if shapes < linear.elastic.len() { "The first " (shapes) " modes; all are in " code { "modes.vtu" } " for ParaView." }
        }
        div.figures { @for mode in linear.elastic.iter().take(shapes) { (shape(linear, &solid, mode)) } }
    };
    page(&format!("{} \u{2013} iwan modes", summary.structure), &body)
}

fn table(modes: &[Pair]) -> Markup {
    html! {
        div.wide { table {
            thead { tr { th { "mode" } th { "stuck, Hz" } th { "slipping, Hz" } th { "K_T, 1/s\u{b2}" } th { "MAC" } } }
            tbody { @for m in modes { tr {
                th { (m.name) }
                td { (format!("{:.4}", m.frequency_stuck)) }
                td { (format!("{:.4}", m.frequency_slipping)) }
                td { (short(m.k_t)) }
                td { (format!("{:.4}", m.mac)) }
            } } }
        } }
    }
}

fn shape(linear: &Linear, solid: &Solid<'_>, mode: &NamedMode) -> Markup {
    let vector = linear.stuck.shape(mode.pair.stuck);
    let shape = linear.assembled.displacements(vector);
    let sizes: Vec<f64> = shape.chunks_exact(3).map(length).collect();
    let largest = sizes.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let colour = |_: usize, corners: [usize; 4]| {
        by_share(corners.iter().map(|n| sizes[*n]).sum::<f64>() / (4.0 * largest))
    };
    let title = format!("{}: {:.3} Hz", mode.name, linear.frequency_stuck(mode));
    html! {
        figure {
            figcaption { strong { (title) } }
            (solid.draw(Some(Deformation { shape: &shape, part: EXAGGERATION }), &title, &colour))
            p.caption { (slips(linear, vector, largest)) }
        }
    }
}

/// Names the joints that slip most in a mode.
fn slips(linear: &Linear, shape: &[f64], largest: f64) -> String {
    let mut slips: Vec<(f64, &str)> = linear
        .assembled
        .slips()
        .iter()
        .map(|s| ((shape[s.unknown] / largest).abs(), s.name.as_str()))
        .collect();
    slips.sort_by(|a, b| b.0.total_cmp(&a.0));
    slips.truncate(MOST_SLIPS);
    if slips.is_empty() {
        return "No joint slips.".into();
    }
    let listed: Vec<_> = slips.iter().map(|(share, name)| format!("{name} {share:.1e}")).collect();
    format!("Largest slips over the largest displacement: {}.", listed.join(", "))
}
