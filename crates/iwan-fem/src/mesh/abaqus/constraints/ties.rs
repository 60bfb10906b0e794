//! Reader of `*TIE`.

use super::super::super::error::{MeshError, MeshWarning};
use super::super::super::tie::Sides;
use super::super::super::topology::Mesh;
use super::super::definition::Pending;
use super::lookup::Lookup;
use super::outcome::Outcome;

/// Reads `slave surface, master surface`: nodes of the slave surface follow the faces of the master surface; unless ADJUST=NO, they are
/// first moved onto these faces.
pub(super) fn read(
    lookup: &Lookup,
    mesh: &mut Mesh,
    text: &Pending,
    out: &mut Outcome,
) -> Result<(), MeshError> {
    let source = lookup.source;
    text.keyword.only(source, &["NAME", "ADJUST", "POSITION TOLERANCE", "TYPE", "NO ROTATION"])?;
    let tolerance = match text.keyword.value("POSITION TOLERANCE").map(str::parse::<f64>) {
        None => None,
        Some(Ok(value)) if value > 0.0 && value.is_finite() => Some(value),
        Some(_) => {
            let found = "POSITION TOLERANCE that is no number > 0";
            return Err(source.malformed(text.keyword.place(source), found, "a number > 0"));
        }
    };
    let name = lookup.title(text, "NAME");
    for row in &text.rows {
        let [slave, master] = &row.fields[..] else {
            let expected = "two surfaces: the one that follows, then the one that leads";
            return Err(source.malformed(lookup.place(row), row.fields.join(", "), expected));
        };
        let (slave, master) = (lookup.surface(mesh, text, slave)?, lookup.surface(mesh, text, master)?);
        if master.faces.is_empty() {
            let found = format!("the leading surface {:?} of *TIE, which has no faces", row.fields[1]);
            return Err(source.unsupported(lookup.place(row), found, "give a *SURFACE of TYPE=ELEMENT"));
        }
        let sides = Sides { name: &name, nodes: &slave.nodes, faces: &master.faces, tolerance };
        let tied = mesh.tie(sides);
        let warn = |reason: String| MeshWarning::Constraint { name: name.clone(), reason };
        if tied.constraints.is_empty() {
            let found =
                format!("*TIE whose {} nodes are all too far from the leading faces", slave.nodes.len());
            return Err(source.unsupported(
                lookup.place(row),
                found,
                "check the surfaces, or give POSITION TOLERANCE=...",
            ));
        }
        if !tied.free.is_empty() {
            out.warnings.push(warn(format!(
                "{} of {} nodes are farther from the leading faces than the position tolerance and stay free",
                tied.free.len(),
                slave.nodes.len()
            )));
        }
        if text.keyword.value("ADJUST").is_some_and(|adjust| adjust.eq_ignore_ascii_case("NO")) {
            if tied.gap > 0.0 {
                out.warnings.push(warn(format!(
                    "with ADJUST=NO nodes stay up to {:.3e} off the faces they follow: the tie resists turning a little",
                    tied.gap
                )));
            }
        } else {
            for (node, position) in &tied.feet {
                mesh.positions[*node] = *position;
            }
            if tied.gap > 0.0 {
                out.warnings
                    .push(warn(format!("nodes were moved onto the leading faces by up to {:.3e}", tied.gap)));
            }
        }
        for constraint in tied.constraints {
            out.push(lookup, text, constraint)?;
        }
    }
    Ok(())
}
