//! Reader of Abaqus input files: nodes, elements, sets, surfaces, parts with their instances, and constraints (Abaqus Keywords Reference;
//! CalculiX reads the same format).
//!
//! Keywords that are known to leave the model unchanged are passed over with a warning; keywords that change the model are obeyed or
//! refused by name, unless the user asks to ignore them.

mod lines;
mod fields;
mod keyword;
mod known;
mod definition;
mod reader;
mod parts;
mod system;
mod nodes;
mod elements;
mod sets;
mod surfaces;
mod constraints;
mod include;

use std::collections::BTreeMap;

use super::error::{MeshError, MeshWarning};
use super::file::{FileBytes, MeshFile};
use super::labels::{Labels, Twice};
use super::topology::Mesh;
use constraints::Lookup;
use definition::{Pending, Row, SetKind, SurfaceText};
use keyword::Keyword;
use lines::Lines;
use reader::{PassedOver, ReadAs, Reader, instance_of, number_of};
use surfaces::Surfaces;

pub(in crate::mesh) use include::INCLUDE;

/// Mesh and warnings of an Abaqus input file in which all includes are already inserted.
///
/// `ignored` lists keywords that are passed over although they change the model.
pub(super) fn parse(source: FileBytes, ignored: &[String]) -> Result<MeshFile, MeshError> {
    let mut lines = Lines::new(source);
    let mut ignored: Vec<String> = ignored.iter().map(|name| keyword::name(name.as_bytes())).collect();
    if ignored.iter().any(|name| name == "COUPLING") {
        ignored.extend(["KINEMATIC".into(), "DISTRIBUTING".into()]);
    }
    let mut reader = Reader { ignored, ..Reader::default() };
    while let Some(line) = lines.next() {
        if !line.is_keyword() {
            return Err(source.malformed(line.place(source), line.quoted(), "a keyword (*NAME)"));
        }
        let keyword = Keyword::parse(&mut lines, line)?;
        reader.keyword(&mut lines, &keyword)?;
    }
    reader.finish(source)
}

impl Reader {
    fn keyword(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        match keyword.name.as_str() {
            name if self.ignored.iter().any(|ignored| ignored == name) => {
                let first = PassedOver { line: keyword.line, times: 0 };
                self.passed_over.entry(name.to_string()).or_insert(first).times += 1;
                while lines.next_data().is_some() {}
                Ok(())
            }
            "NODE" => self.nodes(lines, keyword),
            "SYSTEM" => {
                self.axes = system::read(lines, keyword)?;
                Ok(())
            }
            "ELEMENT" => self.elements(lines, keyword),
            "NSET" => self.set(lines, keyword, SetKind::Nodes),
            "ELSET" => self.set(lines, keyword, SetKind::Elements),
            "PART" | "END PART" | "ASSEMBLY" | "END ASSEMBLY" | "INSTANCE" | "END INSTANCE" => {
                self.part_or_instance(lines, keyword)
            }
            "SURFACE" => {
                let name = self.named(keyword.required(lines.source, "NAME")?);
                let text = self.kept(lines, keyword)?;
                self.body().surfaces.push(SurfaceText { name, text });
                Ok(())
            }
            name if constraints::KEPT.contains(&name) => {
                let text = self.kept(lines, keyword)?;
                self.body().pending.push(text);
                Ok(())
            }
            name => {
                let stressed = keyword.value("TYPE").is_some_and(|kind| kind.eq_ignore_ascii_case("STRESS"));
                if !known::is_harmless(name) || (name == "INITIAL CONDITIONS" && stressed) {
                    let found = format!("*{name}, which may change the model,");
                    return Err(keyword.refused(lines.source, &found, &known::remedy(name)));
                }
                self.steps += usize::from(name == "STEP");
                let first = PassedOver { line: keyword.line, times: 0 };
                self.passed_over.entry(name.to_string()).or_insert(first).times += 1;
                while lines.next_data().is_some() {}
                Ok(())
            }
        }
    }

    /// Keeps a keyword with its data until all names are known.
    fn kept(&self, lines: &mut Lines, keyword: &Keyword) -> Result<Pending, MeshError> {
        let mut rows = Vec::new();
        while let Some(line) = lines.next_data() {
            let fields = line.fields().map(keyword::label).collect();
            rows.push(Row { line: line.number, fields });
        }
        let within = self.named_instance(lines.source, keyword)?;
        Ok(Pending { keyword: keyword.clone(), rows, within, step: self.steps })
    }

    /// Refuses a part that is not closed, and `*BOUNDARY` inside a step if there are several steps, as each step may hold other nodes.
    fn whole(&self, source: FileBytes) -> Result<(), MeshError> {
        if let Some((name, _)) = &self.part {
            return Err(source.malformed(
                "the end of the file",
                format!("part {name} still open"),
                "*END PART",
            ));
        }
        let in_step = |text: &&Pending| text.keyword.name == "BOUNDARY" && text.step > 0;
        match self.main.pending.iter().find(in_step) {
            Some(text) if self.steps > 1 => {
                let found = format!("*BOUNDARY in one of {} steps", self.steps);
                let remedy = "put it before the first *STEP if it holds in all of them; or fix the nodes with [[support]] in the \
                              structure file and pass over it with ignore = [\"BOUNDARY\"] in [mesh]";
                Err(text.keyword.refused(source, &found, remedy))
            }
            _ => Ok(()),
        }
    }

    /// Refuses sections of surface and line elements: with a section these elements would have a stiffness.
    fn no_skin_has_a_section(&self, source: FileBytes) -> Result<(), MeshError> {
        let parts = self.parts.values().flat_map(|body| &body.pending);
        for text in self.main.pending.iter().chain(parts) {
            let Some(set) = text.keyword.value("ELSET").filter(|_| text.keyword.name == "SOLID SECTION")
            else {
                continue;
            };
            let same = |name: &str| {
                name.eq_ignore_ascii_case(set)
                    || name.rsplit('.').next().is_some_and(|n| n.eq_ignore_ascii_case(set))
            };
            if let Some(skin) = self.skins.iter().find(|skin| skin.set.as_deref().is_some_and(same)) {
                let found = format!("a section of elements {} (set {set})", skin.kind);
                let remedy = "shells, plane elements and trusses come in by [matrices]";
                return Err(text.keyword.refused(source, &found, remedy));
            }
        }
        Ok(())
    }

    fn finish(mut self, source: FileBytes) -> Result<MeshFile, MeshError> {
        self.whole(source)?;
        self.no_skin_has_a_section(source)?;
        let mut main = std::mem::take(&mut self.main);
        let twice = |what: &str, double: Twice, lines: &[usize]| {
            let place = |at: usize| source.at_line(source.line(lines[at]));
            let label = self.shown(double.label);
            let found = format!("{what} {label}, which stands in {} already", place(double.first));
            let expected = format!("a number of its own for every {what}");
            source.malformed(place(double.second), found, expected)
        };
        let nodes = Labels::new(main.node_labels.iter().copied());
        let nodes = nodes.map_err(|double| twice("node", double, &main.node_lines))?;
        let elements = Labels::new(main.elements.iter().map(|e| e.label));
        let elements = elements.map_err(|double| twice("element", double, &main.element_lines))?;
        let mut mesh = Mesh { positions: main.positions, node_labels: main.node_labels, ..Mesh::default() };
        mesh.elements = main.elements;
        elements::resolve(source, &mut mesh.elements, &main.element_lines, &nodes)?;
        let sets = (&main.definitions[..], &self.instances[..]);
        let named = sets::resolve(source, &mesh, sets, &nodes, &elements)?;
        let surfaces = Surfaces::new(source, &self.instances, &main.surfaces);
        let index = |label| nodes.index(label);
        let mass_elements = std::mem::take(&mut main.mass_elements);
        let lookup = Lookup {
            source,
            named: &named,
            surfaces: &surfaces,
            mass_elements: &mass_elements,
            index: &index,
            instances: &self.instances,
        };
        let outcome = constraints::resolve(&lookup, &mut mesh, &main.pending)?;
        let of_surfaces = surface_nodes(&mesh, &surfaces, &lookup, &main.surfaces);
        mesh.node_sets = named.nodes.finish();
        mesh.element_sets = named.elements.finish();
        let of_ranges = named.warnings;
        for (name, nodes) in of_surfaces {
            mesh.node_sets.entry(name).or_insert(nodes);
        }
        let mut warnings = self.remarks(source);
        warnings.extend(of_ranges);
        warnings.extend(outcome.warnings);
        let mut sections = outcome.sections;
        self.number(&mut mesh, &mut sections, &mut warnings);
        let (constraints, masses) = (outcome.constraints, outcome.masses);
        Ok(MeshFile { mesh, warnings, constraints, masses, sections })
    }

    /// Warnings of keywords that were passed over, element types whose formulation is not taken over, and elements without a section.
    fn remarks(&mut self, source: FileBytes) -> Vec<MeshWarning> {
        let formulations = std::mem::take(&mut self.formulations).into_iter();
        let formulations = formulations.map(|(found, ReadAs { line, read_as })| MeshWarning::Formulation {
            place: source.at_line(line),
            found: found.into(),
            read_as,
        });
        let passed_over = std::mem::take(&mut self.passed_over).into_iter();
        let passed_over = passed_over.map(|(name, PassedOver { line, times })| {
            let place = source.at_line(line);
            if self.ignored.contains(&name) {
                MeshWarning::Ignored { name: format!("*{name}"), place, times }
            } else {
                MeshWarning::PassedOver { name: format!("*{name}"), place, times }
            }
        });
        let skins = std::mem::take(&mut self.skins).into_iter().map(|skin| MeshWarning::Skin {
            place: source.at_line(skin.line),
            found: skin.kind.into(),
            times: skin.elements,
            as_set: match skin.set {
                Some(name) => format!("their nodes are the node set {name}"),
                None => "they are passed over".into(),
            },
        });
        formulations.chain(passed_over).chain(skins).collect()
    }

    /// Final numbers of nodes and elements: the file's own if no two instances share a number; otherwise the numbers of each instance are
    /// shifted by a multiple of a power of ten. If there is a single instance, its name is removed from the names of the sets.
    fn number(
        &self,
        mesh: &mut Mesh,
        sections: &mut [super::constraint::Section],
        warnings: &mut Vec<MeshWarning>,
    ) {
        let own = |labels: &mut dyn Iterator<Item = u64>| {
            let mut plain: Vec<u64> = labels.map(number_of).collect();
            plain.sort_unstable();
            (plain.windows(2).any(|w| w[0] == w[1]), plain.last().copied().unwrap_or(0))
        };
        let (shared_nodes, last_node) = own(&mut mesh.node_labels.iter().copied());
        let (shared_elements, last_element) = own(&mut mesh.elements.iter().map(|e| e.label));
        let shared = shared_nodes || shared_elements;
        // A power of ten keeps the file's number readable as the last digits of the new number.
        let stride = if shared { 10_u64.pow(1 + last_node.max(last_element).max(1).ilog10()) } else { 0 };
        let numbered = |label: u64| number_of(label) + stride * instance_of(label) as u64;
        mesh.node_labels.iter_mut().for_each(|label| *label = numbered(*label));
        mesh.elements.iter_mut().for_each(|element| element.label = numbered(element.label));
        for (index, name) in self.instances.iter().enumerate() {
            let shift = stride * (index as u64 + 1);
            mesh.instances.insert(name.clone(), shift);
            if shift > 0 {
                warnings.push(MeshWarning::Renumbered { instance: name.clone(), shift });
            }
        }
        if let [only] = &self.instances[..] {
            let short = |name: &str| name.strip_prefix(&format!("{only}.")).map(str::to_owned);
            for sets in [&mut mesh.node_sets, &mut mesh.element_sets] {
                let taken = std::mem::take(sets);
                let (prefixed, plain): (BTreeMap<_, _>, _) =
                    taken.into_iter().partition(|(name, _)| short(name).is_some());
                *sets = plain;
                for (name, members) in prefixed {
                    let name = short(&name).filter(|short| !sets.contains_key(short)).unwrap_or(name);
                    sets.insert(name, members);
                }
            }
            for section in sections {
                if !mesh.element_sets.contains_key(&section.elements) {
                    section.elements = short(&section.elements).unwrap_or_default();
                }
            }
        }
    }
}

/// Nodes of all surfaces by name, as joints and ties of the structure file may name surfaces. A surface that cannot be looked up is left
/// out: it does no harm as long as nothing refers to it.
fn surface_nodes(
    mesh: &Mesh,
    surfaces: &Surfaces,
    lookup: &Lookup,
    texts: &[SurfaceText],
) -> Vec<(String, Vec<usize>)> {
    let nodes = |surface: &SurfaceText| {
        let found = surfaces.find(mesh, lookup.named, &surface.name, surface.text.within).ok()??;
        Some((surface.name.clone(), found.nodes))
    };
    texts.iter().filter_map(nodes).collect()
}
