//! The report of `iwan modes`: the mesh, the frequencies, the shapes.

use iwan_fem::NamedMode;
use iwan_fem::mesh::Mesh;
use maud::{Markup, html};

use super::page;
use super::solid::{Colour, Solid, by_share, length};
use crate::commands::modes::{ModesSummary, Pair, Size};
use crate::linear::Linear;
use crate::summary::short;

/// What the report is about.
#[derive(Debug)]
pub(crate) struct Input<'a> {
    pub(crate) linear: &'a Linear,
    pub(crate) summary: &'a ModesSummary,
}

/// Faces in all pictures together: keeps the page below a few megabytes.
const MOST_FACES: usize = 40_000;
/// Pictures of shapes at most.
const MOST_SHAPES: usize = 12;
/// Largest displacement of a picture over the diagonal of the mesh.
const EXAGGERATION: f64 = 0.07;
/// Slips named below a picture at most.
const MOST_SLIPS: usize = 4;

/// Pale colours for the parts of a mesh.
const PARTS: [Colour; 6] = [
    [176.0, 196.0, 214.0],
    [230.0, 190.0, 130.0],
    [160.0, 205.0, 180.0],
    [220.0, 170.0, 190.0],
    [205.0, 205.0, 150.0],
    [190.0, 180.0, 220.0],
];

/// The page.
pub(crate) fn render(input: &Input<'_>) -> String {
    let summary = input.summary;
    let mesh = &input.linear.file.structure.mesh;
    let solid = Solid::new(mesh);
    let shapes = (MOST_FACES / solid.faces().max(1)).clamp(1, MOST_SHAPES);
    let body = html! {
        h1 { (summary.structure) }
        p.about {
            "Linear modes with all joints stuck (the limit of small amplitudes) and with all joints slipping. Written by iwan "
            (summary.version) "."
        }
        (size(&summary.size))
        (super::warnings(&summary.warnings))
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
            @if shapes < input.linear.elastic.len() { "The first " (shapes) " modes; all are in " code { "modes.vtu" } " for ParaView." }
        }
        div.figures { @for mode in input.linear.elastic.iter().take(shapes) { (shape(input.linear, &solid, mode)) } }
    };
    page(&format!("{} \u{2013} iwan modes", summary.structure), &body)
}

/// How large the structure is.
pub(super) fn size(size: &Size) -> Markup {
    html! {
        p.about {
            (size.nodes) " nodes, " (size.elements) " elements, " (size.unknowns) " unknowns, " (size.joints) " joints with "
            (size.slips) " slips; total mass " (short(size.total_mass)) ". Units are the user's own consistent set."
        }
    }
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

/// The mesh with its element sets in colours.
pub(super) fn mesh_picture(solid: &Solid<'_>, mesh: &Mesh) -> Markup {
    let mut part = vec![0; mesh.elements.len()];
    for (index, set) in mesh.element_sets.values().enumerate() {
        for element in set {
            part[*element] = index;
        }
    }
    let names: Vec<&String> = mesh.element_sets.keys().collect();
    html! {
        figure {
            (solid.draw(None, "the mesh", &|element, _| PARTS[part[element] % PARTS.len()]))
            p.caption {
                @if names.is_empty() { "The mesh." } @else { "The mesh; element sets in colours: " }
                @for (n, name) in names.iter().enumerate() {
                    @let [r, g, b] = PARTS[n % PARTS.len()];
                    span.key style=(format!("background:rgb({r},{g},{b})")) {} (name) " "
                }
            }
        }
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
            (solid.draw(Some((&shape, EXAGGERATION)), &title, &colour))
            p.caption { (slips(linear, vector, largest)) }
        }
    }
}

/// Which joints slip most in a mode.
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
