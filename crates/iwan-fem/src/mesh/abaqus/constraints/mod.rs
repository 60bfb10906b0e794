//! Applies `*TIE`, `*EQUATION`, `*MPC`, `*COUPLING`, `*RIGID BODY`, `*BOUNDARY` and `*MASS`; unsupported variants are refused by name.

mod lookup;
mod outcome;
mod linear;
mod groups;
mod ties;
mod sections;

use super::super::error::MeshError;
use super::super::topology::Mesh;
use super::definition::Pending;
pub(super) use lookup::Lookup;
use outcome::Outcome;

/// Keywords whose data are kept until all names are known.
pub(super) const KEPT: &[&str] = &[
    "TIE",
    "EQUATION",
    "MPC",
    "COUPLING",
    "KINEMATIC",
    "DISTRIBUTING",
    "RIGID BODY",
    "BOUNDARY",
    "MASS",
    "MATERIAL",
    "ELASTIC",
    "DENSITY",
    "SOLID SECTION",
];

/// Applies the kept keywords in the order of the file. Tied nodes are moved onto the faces that they follow, unless ADJUST=NO.
pub(super) fn resolve(lookup: &Lookup, mesh: &mut Mesh, pending: &[Pending]) -> Result<Outcome, MeshError> {
    let mut outcome = Outcome::new(lookup, mesh);
    let mut rest = pending.iter().peekable();
    while let Some(text) = rest.next() {
        match text.keyword.name.as_str() {
            "TIE" => ties::read(lookup, mesh, text, &mut outcome)?,
            "EQUATION" => linear::equation(lookup, text, &mut outcome)?,
            "MPC" => linear::multi_point(lookup, mesh, text, &mut outcome)?,
            "BOUNDARY" => linear::boundary(lookup, text, &mut outcome)?,
            "RIGID BODY" => groups::rigid_body(lookup, mesh, text, &mut outcome)?,
            "MASS" => groups::mass(lookup, text, &mut outcome)?,
            "COUPLING" => {
                let kind =
                    rest.next_if(|next| matches!(next.keyword.name.as_str(), "KINEMATIC" | "DISTRIBUTING"));
                groups::coupling(lookup, mesh, (text, kind), &mut outcome)?;
            }
            "KINEMATIC" | "DISTRIBUTING" => {
                let found = format!("*{} without *COUPLING", text.keyword.name);
                return Err(lookup.source.malformed(
                    text.keyword.place(lookup.source),
                    found,
                    "*COUPLING before it",
                ));
            }
            _ => {}
        }
    }
    outcome.sections = sections::read(lookup, pending)?;
    Ok(outcome)
}
