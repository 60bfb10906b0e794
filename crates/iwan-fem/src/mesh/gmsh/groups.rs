//! `$PhysicalNames` and `$Entities`: the physical groups to which each entity belongs.

use std::collections::{BTreeMap, BTreeSet};

use super::super::error::{MeshError, MeshWarning};
use super::super::file::quote;
use super::super::sets::Sets;
use super::cursor::Cursor;

/// Dimension and number of an entity or a physical group.
pub(super) type Key = (i32, i32);

const DIMENSIONS: [&str; 4] = ["point", "curve", "surface", "volume"];

/// Names of the physical groups, and the groups of each entity.
#[derive(Debug, Default)]
pub(super) struct Groups {
    names: BTreeMap<Key, String>,
    entities: BTreeMap<Key, Vec<i32>>,
}

impl Groups {
    /// Reads `$PhysicalNames`, which are ASCII lines in binary files too.
    pub(super) fn names(&mut self, cursor: &mut Cursor) -> Result<(), MeshError> {
        let place = cursor.place();
        let first = cursor.text_line();
        let count = std::str::from_utf8(first).ok().and_then(|t| t.trim().parse::<u64>().ok());
        let Some(count) = count else {
            return Err(cursor.source.malformed(place, quote(first, 60), "the number of physical names"));
        };
        for _ in 0..count {
            let start = cursor.offset();
            let line = cursor.text_line();
            let Some((key, name)) = name_of(line) else {
                let expected = "dimension (0 to 3), number and \"name\" of a physical group";
                return Err(cursor.source.malformed(cursor.place_at(start), quote(line, 60), expected));
            };
            self.names.insert(key, name);
        }
        Ok(())
    }

    /// Reads `$Entities`.
    pub(super) fn entities(&mut self, cursor: &mut Cursor) -> Result<(), MeshError> {
        let mut counts = [0; 4];
        for (count, dimension) in counts.iter_mut().zip(DIMENSIONS) {
            *count = cursor.count(format_args!("the number of {dimension} entities"), 5)?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                self.entity(cursor, dimension)?;
            }
        }
        Ok(())
    }

    fn entity(&mut self, cursor: &mut Cursor, dimension: i32) -> Result<(), MeshError> {
        let tag = cursor.integer("the number of an entity")?;
        let box_corners = if dimension == 0 { 3 } else { 6 };
        for _ in 0..box_corners {
            cursor.number("a coordinate of the entity")?;
        }
        let count = cursor.count("the number of physical groups of the entity", 1)?;
        let mut groups = Vec::new();
        for _ in 0..count {
            groups.push(cursor.integer("the number of a physical group")?.saturating_abs());
        }
        if !groups.is_empty() {
            self.entities.insert((dimension, tag), groups);
        }
        if dimension > 0 {
            for _ in 0..cursor.count("the number of bounding entities", 1)? {
                cursor.integer("the number of a bounding entity")?;
            }
        }
        Ok(())
    }

    /// Names of the sets to which the elements of an entity belong. A group without a name is called by its dimension and number, such as
    /// `surface 7`.
    pub(super) fn sets_of(&self, entity: Key) -> Vec<String> {
        let groups = self.entities.get(&entity).map_or(&[][..], Vec::as_slice);
        groups.iter().map(|group| self.name((entity.0, *group))).collect()
    }

    /// Name of a physical group: the given one, or one made of its dimension and number.
    pub(super) fn name(&self, group: Key) -> String {
        let made = || format!("{} {}", DIMENSIONS[group.0.clamp(0, 3) as usize], group.1);
        self.names.get(&group).cloned().unwrap_or_else(made)
    }

    /// Creates empty sets for group names without members, so that an item that refers to such a set is told that it is empty rather than
    /// missing. Returns warnings.
    pub(super) fn finish(&self, node_sets: &mut Sets, element_sets: &mut Sets) -> Vec<MeshWarning> {
        let mut dimensions: BTreeMap<&str, BTreeSet<i32>> = BTreeMap::new();
        for ((dimension, _), name) in &self.names {
            dimensions.entry(name).or_default().insert(*dimension);
            // Nothing is added to the sets, so their limit cannot be exceeded.
            let _ = node_sets.extend(name, std::iter::empty());
            if *dimension == 3 {
                let _ = element_sets.extend(name, std::iter::empty());
            }
        }
        let shared = dimensions.into_iter().filter(|(_, found)| found.len() > 1);
        let warning = |(name, _): (&str, _)| MeshWarning::Groups {
            place: "$PhysicalNames".into(),
            reason: format!(
                "the groups of different dimension called {} make one set of nodes; give them names of their own if that is not meant",
                quote(name.as_bytes(), 40)
            ),
        };
        shared.map(warning).collect()
    }
}

/// `dimension number "name"`.
fn name_of(line: &[u8]) -> Option<(Key, String)> {
    let text = String::from_utf8_lossy(line);
    let (numbers, rest) = text.split_once('"')?;
    let name = rest.trim_end().strip_suffix('"')?;
    let mut numbers = numbers.split_whitespace().map(str::parse::<i32>);
    let (dimension, tag) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
    let sound = numbers.next().is_none() && (0..=3).contains(&dimension) && !name.is_empty();
    sound.then(|| ((dimension, tag), name.to_string()))
}
