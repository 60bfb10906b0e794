//! State of the reader: everything that it has read of an Abaqus input file so far.

use iwan_machine::listed;
use std::collections::BTreeMap;

use super::super::axes::Axes;
use super::super::file::FileBytes;
use super::super::topology::Element;
use super::definition::{Definition, Pending, SurfaceText};
use super::keyword::Keyword;

/// Numbers of nodes and elements carry the number of their instance in the bits above this many; `fields::whole` refuses larger numbers.
pub(super) const BITS: u32 = 40;

/// Packs the number of a node or element together with the number of its instance.
pub(super) const fn within(instance: usize, number: u64) -> u64 {
    number | (instance as u64) << BITS
}

/// Number of a packed label as the file gives it.
pub(super) const fn number_of(label: u64) -> u64 {
    label & ((1 << BITS) - 1)
}

/// Instance of a packed label; 0 for labels outside all instances.
pub(super) const fn instance_of(label: u64) -> usize {
    (label >> BITS) as usize
}

/// Nodes, elements, sets and connections. Until the whole file is read, the nodes of elements and the members of sets are numbers of the
/// file, not indices.
#[derive(Debug, Clone, Default)]
pub(super) struct Body {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) node_labels: Vec<u64>,
    /// Byte offset of the line of each node.
    pub(super) node_lines: Vec<usize>,
    pub(super) elements: Vec<Element>,
    /// Byte offset of the line of each element.
    pub(super) element_lines: Vec<usize>,
    /// Nodes of the mass elements, by the name of their element set in capitals.
    pub(super) mass_elements: BTreeMap<String, Vec<u64>>,
    /// Nodes of each surface or line element, by the number of the element.
    pub(super) skin: BTreeMap<u64, Vec<u64>>,
    pub(super) definitions: Vec<Definition>,
    pub(super) surfaces: Vec<SurfaceText>,
    pub(super) pending: Vec<Pending>,
}

/// Contents of the whole file.
#[derive(Default)]
pub(super) struct Reader {
    /// Contents outside the parts, together with the instances of the parts.
    pub(super) main: Body,
    /// Part that is being read, as its name and its contents.
    pub(super) part: Option<(String, Body)>,
    /// Parts by name, in capitals.
    pub(super) parts: BTreeMap<String, Body>,
    /// Names of the instances, numbered from 1.
    pub(super) instances: Vec<String>,
    /// Whether an instance is being read.
    pub(super) in_instance: bool,
    /// Number of steps read so far.
    pub(super) steps: usize,
    /// Axes in which the following nodes are given.
    pub(super) axes: Axes,
    /// Names of the keywords that the user asks to ignore.
    pub(super) ignored: Vec<String>,
    /// Keywords passed over (without effect on the mesh, or ignored by the user), by name.
    pub(super) passed_over: BTreeMap<String, PassedOver>,
    /// Element types whose formulation is not taken over, by name.
    pub(super) formulations: BTreeMap<&'static str, ReadAs>,
    /// Blocks of surface and line elements.
    pub(super) skins: Vec<Skin>,
}

impl Reader {
    /// Contents to which nodes, elements and sets are added at present: those of the open part, or those of the file.
    pub(super) fn body(&mut self) -> &mut Body {
        match &mut self.part {
            Some((_, body)) => body,
            None => &mut self.main,
        }
    }

    /// Instance to which numbers belong at present; 0 inside parts and outside all instances.
    pub(super) fn within(&self) -> usize {
        if self.in_instance { self.instances.len() } else { 0 }
    }

    /// Instance named by INSTANCE=, or else the present instance.
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

    /// Number of a node or element as messages write it, with the name of its instance if there are several.
    pub(super) fn shown(&self, label: u64) -> String {
        let number = number_of(label);
        match instance_of(label).checked_sub(1).and_then(|at| self.instances.get(at)) {
            Some(name) if self.instances.len() > 1 => format!("{name}.{number}"),
            _ => number.to_string(),
        }
    }
}

/// A keyword that was passed over.
pub(super) struct PassedOver {
    /// Line of the first occurrence, counted from 1.
    pub(super) line: usize,
    /// Number of occurrences.
    pub(super) times: usize,
}

/// A block of surface or line elements.
pub(super) struct Skin {
    pub(super) kind: &'static str,
    /// Line of the keyword.
    pub(super) line: usize,
    pub(super) elements: usize,
    /// Name of the element set, preceded by that of the instance.
    pub(super) set: Option<String>,
}

/// An element type whose name implies a formulation that is not taken over.
pub(super) struct ReadAs {
    /// Line of the first block of elements of this type.
    pub(super) line: usize,
    pub(super) read_as: &'static str,
}
