//! `*PART`, `*ASSEMBLY` and `*INSTANCE`: each part is copied for each of its instances, shifted and rotated.

use super::super::axes::{Axes, turned};
use super::super::error::MeshError;
use super::super::topology::Element;
use super::definition::{Definition, Pending, SurfaceText};
use super::fields::number;
use super::keyword::Keyword;
use super::lines::Lines;
use super::reader::{Body, Reader, within};
use iwan_machine::listed;

/// Largest number of nodes and nodes of elements of all instances together, because a small file can demand any number of them; more are
/// refused. So many take some gigabytes.
const MOST: usize = 50_000_000;

impl Reader {
    /// Reads `*PART` to `*END INSTANCE`.
    pub(super) fn part_or_instance(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        let source = lines.source;
        let misplaced = |expected: &str| {
            Err(source.malformed(keyword.place(source), format!("*{}", keyword.name), expected))
        };
        match keyword.name.as_str() {
            "PART" | "INSTANCE" if self.part.is_some() || self.in_instance => {
                misplaced("*END PART or *END INSTANCE first")
            }
            "PART" => {
                let name = keyword.required(source, "NAME")?.to_uppercase();
                if self.parts.contains_key(&name) {
                    return misplaced("a part of another name: this one is there already");
                }
                self.part = Some((name, Body::default()));
                self.axes = Axes::default();
                no_data(lines, keyword)
            }
            "END PART" => {
                let Some((name, body)) = self.part.take() else { return misplaced("*PART before it") };
                self.parts.insert(name, body);
                self.axes = Axes::default();
                no_data(lines, keyword)
            }
            "INSTANCE" => self.instance(lines, keyword),
            "END INSTANCE" => {
                if !self.in_instance {
                    return misplaced("*INSTANCE before it");
                }
                self.in_instance = false;
                self.axes = Axes::default();
                no_data(lines, keyword)
            }
            _ => no_data(lines, keyword),
        }
    }

    fn instance(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        let source = lines.source;
        keyword.only(source, &["NAME", "PART"])?;
        let name = keyword.required(source, "NAME")?.to_string();
        if self.instances.iter().any(|known| known.eq_ignore_ascii_case(&name)) {
            let expected = "a name of its own for every instance";
            return Err(source.malformed(
                keyword.place(source),
                format!("the instance {name:?} twice"),
                expected,
            ));
        }
        let place = Placement::read(lines, keyword)?;
        self.instances.push(name.clone());
        self.in_instance = true;
        let Some(part) = keyword.value("PART") else { return Ok(()) };
        let Some(body) = self.parts.get(&part.to_uppercase()) else {
            let known = listed(self.parts.keys());
            let expected = format!("a part defined above ({known})");
            return Err(source.malformed(keyword.place(source), format!("PART={part}"), expected));
        };
        let size =
            |body: &Body| body.node_labels.len() + body.elements.iter().map(|e| e.nodes.len()).sum::<usize>();
        if size(&self.main) + size(body) > MOST {
            let found = format!(
                "*INSTANCE, with which all instances have more than {MOST} nodes and nodes of elements,"
            );
            return Err(keyword.refused(source, &found, "write fewer instances, or coarser parts"));
        }
        let index = self.instances.len();
        self.main.add(body, index, &name, &place);
        Ok(())
    }
}

impl Body {
    /// Adds a part as an instance: its nodes are moved, its numbers are marked with the instance, and its names get the instance's name in
    /// front.
    fn add(&mut self, part: &Self, index: usize, instance: &str, place: &Placement) {
        let named = |name: &str| format!("{instance}.{name}");
        self.positions.extend(part.positions.iter().map(|p| place.global(*p)));
        self.node_labels.extend(part.node_labels.iter().map(|label| within(index, *label)));
        self.node_lines.extend(&part.node_lines);
        self.elements.extend(part.elements.iter().map(|element| Element {
            label: within(index, element.label),
            shape: element.shape,
            nodes: element.nodes.iter().map(|node| within(index, *node as u64) as usize).collect(),
        }));
        self.element_lines.extend(&part.element_lines);
        for (set, nodes) in &part.mass_elements {
            let nodes = nodes.iter().map(|node| within(index, *node)).collect();
            self.mass_elements.insert(named(set).to_uppercase(), nodes);
        }
        self.definitions.extend(part.definitions.iter().map(|definition| Definition {
            name: named(&definition.name),
            within: index,
            ..definition.clone()
        }));
        self.surfaces.extend(part.surfaces.iter().map(|surface| SurfaceText {
            name: named(&surface.name),
            text: Pending { within: index, ..surface.text.clone() },
        }));
        self.pending.extend(part.pending.iter().map(|pending| Pending { within: index, ..pending.clone() }));
    }
}

/// Placement of an instance: first shifted, then rotated about a line (Abaqus Keywords Guide, *INSTANCE).
#[derive(Debug, Clone, Copy, Default)]
struct Placement {
    shift: [f64; 3],
    /// Two points of the line, and the angle of rotation in degrees.
    turn: Option<([f64; 3], [f64; 3], f64)>,
}

impl Placement {
    fn read(lines: &mut Lines, keyword: &Keyword) -> Result<Self, MeshError> {
        let source = lines.source;
        let mut place = Self::default();
        let values = |lines: &mut Lines| -> Result<Option<Vec<f64>>, MeshError> {
            let Some(line) = lines.next_data() else { return Ok(None) };
            let fields = line.fields().filter(|f| !f.is_empty());
            fields
                .map(|f| number(source, &line, f, "a number of *INSTANCE"))
                .collect::<Result<_, _>>()
                .map(Some)
        };
        if let Some(shift) = values(lines)? {
            for (own, value) in place.shift.iter_mut().zip(shift) {
                *own = value;
            }
        }
        if let Some(turn) = values(lines)? {
            let [ax, ay, az, bx, by, bz, angle] = turn[..] else {
                let found = format!("a rotation of {} numbers", turn.len());
                let expected = "two points of the axis and the angle in degrees: seven numbers";
                return Err(source.malformed(keyword.place(source), found, expected));
            };
            place.turn = Some(([ax, ay, az], [bx, by, bz], angle));
            if [ax, ay, az] == [bx, by, bz] {
                let expected = "two different points of the axis";
                return Err(source.malformed(keyword.place(source), "a rotation about no axis", expected));
            }
        }
        Ok(place)
    }

    fn global(&self, p: [f64; 3]) -> [f64; 3] {
        let moved = std::array::from_fn(|a| p[a] + self.shift[a]);
        match self.turn {
            Some((a, b, angle)) => turned(moved, a, b, angle),
            None => moved,
        }
    }
}

/// Refuses data lines after a keyword that has none.
fn no_data(lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
    match lines.next_data() {
        Some(line) => {
            let expected = format!("a keyword: *{} takes no data", keyword.name);
            Err(lines.source.malformed(line.place(lines.source), line.quoted(), expected))
        }
        None => Ok(()),
    }
}
