//! Everything that was read of an Abaqus input file so far.

use iwan_machine::listed;
use std::collections::BTreeMap;

use super::super::axes::Axes;
use super::super::file::FileBytes;
use super::super::topology::Element;
use super::definition::{Definition, Pending, SurfaceText};
use super::keyword::Keyword;

/// Numbers of nodes and elements carry the instance they belong to above this many bits.
pub(super) const BITS: u32 = 40;

/// A number with the instance it belongs to.
pub(super) const fn within(instance: usize, number: u64) -> u64 {
    number | (instance as u64) << BITS
}

/// The number of the file.
pub(super) const fn number_of(label: u64) -> u64 {
    label & ((1 << BITS) - 1)
}

/// The instance of a number; 0 outside of all.
pub(super) const fn instance_of(label: u64) -> usize {
    (label >> BITS) as usize
}

/// Nodes, elements, sets and what connects them; nodes of elements and members of sets are numbers of the file until all is read.
#[derive(Debug, Clone, Default)]
pub(super) struct Body {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) node_labels: Vec<u64>,
    /// Byte of the line of each node.
    pub(super) node_lines: Vec<usize>,
    pub(super) elements: Vec<Element>,
    /// Byte of the line of each element.
    pub(super) element_lines: Vec<usize>,
    /// Nodes of elements that are masses, by the name of their set in capitals.
    pub(super) mass_elements: BTreeMap<String, Vec<u64>>,
    /// Nodes of surface and line elements, by the number of the element.
    pub(super) skin: BTreeMap<u64, Vec<u64>>,
    pub(super) definitions: Vec<Definition>,
    pub(super) surfaces: Vec<SurfaceText>,
    pub(super) pending: Vec<Pending>,
}

/// All of the file.
#[derive(Default)]
pub(super) struct Reader {
    /// What stands outside of parts, with the instances of parts.
    pub(super) main: Body,
    /// The part that is being read, and its name.
    pub(super) part: Option<(String, Body)>,
    /// Parts by their names in capitals.
    pub(super) parts: BTreeMap<String, Body>,
    /// Names of the instances; the first is 1.
    pub(super) instances: Vec<String>,
    /// Whether an instance is being read.
    pub(super) in_instance: bool,
    /// Steps so far.
    pub(super) steps: usize,
    /// Axes in which nodes are given from now on.
    pub(super) axes: Axes,
    /// Names of keywords that the user wants to be passed over.
    pub(super) ignored: Vec<String>,
    /// Keywords that mean nothing to a mesh, by their names.
    pub(super) passed_over: BTreeMap<String, PassedOver>,
    /// Element types that name a formulation, by their names.
    pub(super) formulations: BTreeMap<&'static str, ReadAs>,
    /// Blocks of surface and line elements.
    pub(super) skins: Vec<Skin>,
}

impl Reader {
    /// Where nodes, elements and sets go at present.
    pub(super) fn body(&mut self) -> &mut Body {
        match &mut self.part {
            Some((_, body)) => body,
            None => &mut self.main,
        }
    }

    /// Instance to which numbers belong at present; 0 outside of all, and in parts.
    pub(super) fn within(&self) -> usize {
        if self.in_instance { self.instances.len() } else { 0 }
    }

    /// Instance named by INSTANCE=, or the present one.
    pub(super) fn named_instance(
        &self,
        source: FileBytes,
        keyword: &Keyword,
    ) -> Result<usize, super::super::error::MeshError> {
        let Some(name) = keyword.value("INSTANCE") else { return Ok(self.within()) };
        let at = self.instances.iter().position(|known| known.eq_ignore_ascii_case(name));
        at.map(|at| at + 1).ok_or_else(|| {
            let known = listed(&self.instances);
            let found = format!("the instance {name:?}");
            source.malformed(keyword.place(source), found, format!("an instance defined above ({known})"))
        })
    }

    /// A node or element as messages call it.
    pub(super) fn shown(&self, label: u64) -> String {
        let number = number_of(label);
        match instance_of(label).checked_sub(1).and_then(|at| self.instances.get(at)) {
            Some(name) if self.instances.len() > 1 => format!("{name}.{number}"),
            _ => number.to_string(),
        }
    }
}

/// A keyword that means nothing to a mesh.
pub(super) struct PassedOver {
    /// Line of the first one.
    pub(super) line: usize,
    /// How often it occurs.
    pub(super) times: usize,
}

/// A block of surface or line elements.
pub(super) struct Skin {
    pub(super) kind: &'static str,
    /// Line of the keyword.
    pub(super) line: usize,
    pub(super) elements: usize,
    /// Name of the set, that of the instance in front.
    pub(super) set: Option<String>,
}

/// An element type that is read in another sense than the file's.
pub(super) struct ReadAs {
    /// Line of the first block of elements of this type.
    pub(super) line: usize,
    pub(super) read_as: &'static str,
}
