//! `*NSET`, `*ELSET`, and the sets named in `*NODE` and `*ELEMENT`.

use std::collections::BTreeMap;

use super::super::error::{MeshError, MeshWarning};
use super::super::file::{FileBytes, quote};
use super::super::labels::Labels;
use super::super::sets::{Sets, TooLarge};
use super::super::topology::Mesh;
use super::definition::{Definition, Item, SetKind};
use super::fields::whole;
use super::keyword::{Keyword, label};
use super::lines::Lines;
use super::reader::{Reader, within};

impl Reader {
    /// Reads `*NSET` or `*ELSET`.
    pub(super) fn set(
        &mut self,
        lines: &mut Lines,
        keyword: &Keyword,
        kind: SetKind,
    ) -> Result<(), MeshError> {
        let own = if kind == SetKind::Nodes { "NSET" } else { "ELSET" };
        keyword.only(lines.source, &["NSET", "ELSET", "GENERATE", "UNSORTED", "INSTANCE", "INTERNAL"])?;
        let name = self.named(keyword.required(lines.source, own)?);
        let instance = self.named_instance(lines.source, keyword)?;
        let mut items = Vec::new();
        if kind == SetKind::Nodes
            && let Some(elements) = keyword.value("ELSET")
        {
            items.push(Item::NodesOf(elements.into()));
        }
        while let Some(line) = lines.next_data() {
            if keyword.has("GENERATE") {
                let mut fields = line.fields().filter(|f| !f.is_empty());
                let mut number = |what| whole(lines.source, &line, fields.next().unwrap_or_default(), what);
                let (first, last) = (number("the first number")?, number("the last number")?);
                let step = fields.next().map_or(Ok(1), |f| whole(lines.source, &line, f, "the step"))?;
                items.push(Item::Range { first, last, step });
                continue;
            }
            for field in line.fields().filter(|f| !f.is_empty()) {
                items.push(match field[0] {
                    b'0'..=b'9' => Item::Number(whole(lines.source, &line, field, "a member of the set")?),
                    _ => Item::Set(label(field)),
                });
            }
        }
        if kind == SetKind::Elements && self.take_skin(&name, keyword.line, &mut items) && items.is_empty() {
            return Ok(());
        }
        let definition = Definition { kind, name, line: keyword.line, items, within: instance };
        self.body().definitions.push(definition);
        Ok(())
    }

    /// Removes surface and line elements from a set of elements, where Gmsh writes a physical group of a surface in this form. Their nodes
    /// become a set of nodes of the same name. Returns whether there were any.
    fn take_skin(&mut self, name: &str, line: usize, items: &mut Vec<Item>) -> bool {
        let mut nodes = Vec::new();
        let skin = &self.body().skin;
        items.retain(|item| match item {
            Item::Number(number) => match skin.get(number) {
                Some(of) => {
                    nodes.extend(of);
                    false
                }
                None => true,
            },
            Item::Range { first, last, step } if first <= last => {
                let step = (*step).max(1);
                let inside: Vec<_> =
                    skin.range(first..=last).filter(|(n, _)| (*n - first) % step == 0).collect();
                nodes.extend(inside.iter().flat_map(|(_, of)| *of));
                inside.len() as u64 <= (last - first) / step
            }
            Item::Range { .. } | Item::Set(_) | Item::NodesOf(_) => true,
        });
        if nodes.is_empty() {
            return false;
        }
        self.nodes_of_skin(name, line, nodes);
        true
    }
}

/// The sets of one kind while they are being filled.
pub(super) struct Filling<'a> {
    labels: &'a Labels,
    instances: &'a [String],
    sets: Sets,
    /// First spelling of each name, by the name in capitals: Abaqus does not distinguish capitals from small letters.
    spelling: BTreeMap<String, String>,
}

impl<'a> Filling<'a> {
    fn new(labels: &'a Labels, instances: &'a [String], length: usize) -> Self {
        Self { labels, instances, sets: Sets::new(length), spelling: BTreeMap::new() }
    }

    /// Members of a set by its name within an instance: the instance's own set, or one outside.
    pub(super) fn members(&self, name: &str, instance: usize) -> Option<&[usize]> {
        self.sets.get(&self.spelled(name, instance)?)
    }

    /// The name of that set in the mesh.
    pub(super) fn spelled(&self, name: &str, instance: usize) -> Option<String> {
        let own = instance.checked_sub(1).map(|at| format!("{}.{name}", self.instances[at]).to_uppercase());
        let own = own.and_then(|own| self.spelling.get(&own));
        own.or_else(|| self.spelling.get(&name.to_uppercase())).cloned()
    }

    /// Index of a node or element by its number within an instance, or by `INSTANCE.NUMBER`.
    pub(super) fn numbered(&self, text: &str, instance: usize) -> Option<usize> {
        if let Ok(number) = text.parse::<u64>() {
            return self.labels.index(within(instance, number));
        }
        let (name, number) = text.rsplit_once('.')?;
        let at = self.instances.iter().position(|known| known.eq_ignore_ascii_case(name))?;
        self.labels.index(within(at + 1, number.parse().ok()?))
    }

    pub(super) fn finish(self) -> BTreeMap<String, Vec<usize>> {
        self.sets.finish()
    }
}

/// Sets of nodes and of elements.
pub(super) struct Named<'a> {
    pub(super) nodes: Filling<'a>,
    pub(super) elements: Filling<'a>,
    pub(super) warnings: Vec<MeshWarning>,
}

/// Fills the sets of the mesh in the order of the file.
pub(super) fn resolve<'a>(
    source: FileBytes,
    mesh: &Mesh,
    (definitions, instances): (&[Definition], &'a [String]),
    nodes: &'a Labels,
    elements: &'a Labels,
) -> Result<Named<'a>, MeshError> {
    // The limit counts entries that instances repeat as if they were written in the file.
    let length = source.bytes.len().max(mesh.positions.len() + 8 * mesh.elements.len());
    let mut node_sets = Filling::new(nodes, instances, length);
    let mut element_sets = Filling::new(elements, instances, length);
    let mut warnings = Vec::new();
    for definition in definitions {
        let (own, other) = match definition.kind {
            SetKind::Nodes => (&mut node_sets, Some(&element_sets)),
            SetKind::Elements => (&mut element_sets, None),
        };
        let name =
            own.spelling.entry(definition.name.to_uppercase()).or_insert(definition.name.clone()).clone();
        own.sets.extend(&name, std::iter::empty()).map_err(|limit| too_large(source, definition, limit))?;
        for item in &definition.items {
            let members = members(source, mesh, definition, item, own, other)?;
            warnings.extend(beyond(source, definition, item, own.labels, members.len()));
            own.sets
                .extend(&name, members.into_iter())
                .map_err(|limit| too_large(source, definition, limit))?;
        }
    }
    let empty = definitions.iter().filter(|d| {
        let sets = if d.kind == SetKind::Nodes { &node_sets } else { &element_sets };
        // A range beyond the file is named already.
        let is_named = d.items.iter().any(|item| matches!(item, Item::Range { .. }));
        !is_named && sets.members(&d.name, 0).is_some_and(<[usize]>::is_empty)
    });
    warnings.extend(empty.map(|d| MeshWarning::EmptySet {
        place: source.at_line(d.line),
        word: d.kind.word(),
        set: d.name.clone(),
    }));
    Ok(Named { nodes: node_sets, elements: element_sets, warnings })
}

/// A warning for a range of which an end is not in the file: most likely the set was meant for another mesh.
fn beyond(
    source: FileBytes,
    definition: &Definition,
    item: &Item,
    labels: &Labels,
    found: usize,
) -> Option<MeshWarning> {
    let Item::Range { first, last, .. } = *item else { return None };
    let missing =
        [last, first].into_iter().find(|n| labels.index(within(definition.within, *n)).is_none())?;
    Some(MeshWarning::BeyondRange {
        place: source.at_line(definition.line),
        word: definition.kind.word(),
        set: definition.name.clone(),
        first,
        last,
        missing,
        found,
    })
}

/// Indices of the members that one item names.
fn members(
    source: FileBytes,
    mesh: &Mesh,
    definition: &Definition,
    item: &Item,
    own: &Filling,
    other: Option<&Filling>,
) -> Result<Vec<usize>, MeshError> {
    let (word, instance) = (definition.kind.word(), definition.within);
    let fail = |found: String, expected: &str| {
        let line = source.at_line(definition.line);
        let place = format!("{line}, {word} set {}", quote(definition.name.as_bytes(), 40));
        source.malformed(place, found, expected)
    };
    match item {
        Item::Number(number) => match own.labels.index(within(instance, *number)) {
            Some(index) => Ok(vec![index]),
            None => Err(fail(
                format!("{word} {number}"),
                &format!("one of the {word}s of this file, or of the instance named"),
            )),
        },
        Item::Range { first, last, .. } if last < first => {
            Err(fail(format!("the range {first} to {last}"), "first <= last"))
        }
        Item::Range { first, last, step } => {
            Ok(own.labels.range(within(instance, *first), within(instance, *last), *step).collect())
        }
        Item::Set(name) => match own.members(name, instance).map(<[usize]>::to_vec) {
            Some(members) => Ok(members),
            None => match own.numbered(name, instance) {
                Some(index) => Ok(vec![index]),
                None => Err(fail(format!("the name {name:?}"), &format!("a {word} set defined above"))),
            },
        },
        Item::NodesOf(name) => match other.and_then(|other| other.members(name, instance)) {
            Some(elements) => Ok(nodes_of(mesh, elements)),
            None => Err(fail(format!("ELSET={name}"), "an element set defined above")),
        },
    }
}

/// The nodes of some elements, in ascending order without repetitions.
pub(super) fn nodes_of(mesh: &Mesh, elements: &[usize]) -> Vec<usize> {
    let mut elements = elements.to_vec();
    elements.sort_unstable();
    elements.dedup();
    let mut nodes: Vec<usize> = elements.iter().flat_map(|e| &mesh.elements[*e].nodes).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

fn too_large(source: FileBytes, definition: &Definition, TooLarge { limit }: TooLarge) -> MeshError {
    let found = format!(
        "more than {limit} entries in all {} sets together, at {},",
        definition.kind.word(),
        quote(definition.name.as_bytes(), 40)
    );
    source.unsupported(source.at_line(definition.line), found, "write fewer sets of sets")
}
