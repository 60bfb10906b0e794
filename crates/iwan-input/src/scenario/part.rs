//! `parts = [...]` of a mode: dampers and springs beside its joint.

use iwan_core::{Coulomb, Error, Part, Pinning, PowerDamping, PowerSpring};

use crate::error::InputError;
use crate::section::{Section, TableKind};
use crate::text::InputText;

/// The laws of parts with their keys.
pub(crate) const KINDS: &[TableKind] = &[
    TableKind { name: "power-damping", keys: &["c", "n"] },
    TableKind { name: "coulomb", keys: &["force"] },
    TableKind { name: "spring", keys: &["k", "exponent"] },
    TableKind { name: "pinning", keys: &["k", "gap"] },
];

/// Reads and checks the parts of a mode; empty where the key is missing.
pub(super) fn read(source: &InputText, mode: &Section<'_>) -> Result<Vec<Part>, InputError> {
    let one = |(n, place)| {
        let title = format!("part {} of {}", n + 1, mode.title());
        let (section, kind) = Section::variant("law", source, title, place, KINDS, None)?;
        let number = |key| section.number(key);
        let part: Result<Part, Error> = match kind.name {
            "power-damping" => PowerDamping::new(number("c")?, number("n")?).map(Part::from),
            "coulomb" => Coulomb::new(number("force")?).map(Part::from),
            "spring" => PowerSpring::new(number("k")?, number("exponent")?).map(Part::from),
            _ => Pinning::new(number("k")?, number("gap")?).map(Part::from),
        };
        part.map_err(|error| section.out_of_range(error, str::to_string))
    };
    mode.tables("parts")?.into_iter().enumerate().map(one).collect()
}

/// Law of a part, its keys with their values (two places), and the number of keys in use.
pub(super) fn written(part: &Part) -> (&'static str, [(&'static str, f64); 2], usize) {
    match part {
        Part::PowerDamping(part) => ("power-damping", [("c", part.c()), ("n", part.n())], 2),
        Part::Coulomb(part) => ("coulomb", [("force", part.size()), ("", 0.0)], 1),
        Part::Spring(part) => ("spring", [("k", part.k()), ("exponent", part.exponent())], 2),
        Part::Pinning(part) => ("pinning", [("k", part.k()), ("gap", part.gap())], 2),
    }
}
