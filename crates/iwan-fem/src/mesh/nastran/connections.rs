//! `RBE2`, `RBE3`, `MPC`, `SPC`, `SPC1` and `CONM2`.

use std::collections::{BTreeMap, BTreeSet};

use super::super::axes::Coordinates;
use super::super::constraint::{Constraint, Freedom, GLOBAL, PointMass, Rule, Weighted};
use super::super::error::MeshError;
use super::super::file::FileBytes;
use super::super::topology::Mesh;
use super::card::{Card, Selected, real};
use super::grids::Grids;
use super::reader::Reader;
use super::systems::Systems;

/// Data that every card needs, and the constraints collected so far.
struct Context<'a> {
    source: FileBytes<'a>,
    grids: &'a Grids,
    mesh: &'a Mesh,
    constraints: Vec<Constraint>,
    /// Components of each node that are already held.
    held: Vec<[bool; 6]>,
}

/// Number of characters of a card's number in the name of its constraint, as many as a large field has.
const NUMBER: usize = 16;

/// Constraints and point masses of the file.
pub(super) fn read(
    source: FileBytes,
    reader: &Reader,
    selected: &Selected,
    systems: &Systems,
    grids: &Grids,
    mesh: &Mesh,
) -> Result<(Vec<Constraint>, Vec<PointMass>), MeshError> {
    let held = vec![[false; 6]; mesh.positions.len()];
    let mut context = Context { source, grids, mesh, constraints: Vec::new(), held };
    let chosen = |names: [&str; 3], choice| sets(source, &reader.connections, names, choice);
    let spc = chosen(["SPC", "SPC1", "SPCADD"], selected.spc)?;
    let mpc = chosen(["MPC", "", "MPCADD"], selected.mpc)?;
    let mut masses = Vec::new();
    for (node, components, line) in &grids.held {
        context.hold(format!("GRID of {}", source.at_line(*line)), &[*node], *components);
    }
    for card in &reader.connections {
        let sid = || card.integer(source, 0, None);
        match card.name.as_str() {
            "RBE2" => context.rigid(card)?,
            "RBE3" => context.mean(card)?,
            "SPC" if spc.contains(&sid()?) => context.single_points(card)?,
            "SPC1" if spc.contains(&sid()?) => context.listed_points(card)?,
            "MPC" if mpc.contains(&sid()?) => context.equation(card)?,
            "CONM2" => masses.push(mass(&context, card, systems, reader.mass_factor.unwrap_or(1.0))?),
            _ => {}
        }
    }
    Ok((context.constraints, masses))
}

/// Numbers of the sets that apply: the selected set with all sets that it adds up, or the only set in the file.
fn sets(
    source: FileBytes,
    cards: &[Card],
    names: [&str; 3],
    chosen: Option<i64>,
) -> Result<BTreeSet<i64>, MeshError> {
    let own = cards.iter().filter(|card| names[..2].contains(&card.name.as_str()));
    let mut numbers: BTreeMap<i64, &Card> = BTreeMap::new();
    for card in own {
        numbers.entry(card.integer(source, 0, None)?).or_insert(card);
    }
    let Some(chosen) = chosen else {
        if let Some((second, card)) = numbers.iter().nth(1) {
            let found = format!("{} of a second set, {second},", names[0]);
            let remedy =
                format!("choose a set by {} = NUMBER before BEGIN BULK, or delete the others", names[0]);
            return Err(card.unsupported(source, found, remedy));
        }
        return Ok(numbers.into_keys().collect());
    };
    let mut all = BTreeSet::from([chosen]);
    for card in cards.iter().filter(|card| card.name == names[2]) {
        if card.integer(source, 0, None)? == chosen {
            for at in (1..card.fields.len()).filter(|at| !card.field(*at).is_empty()) {
                all.insert(card.integer(source, at, None)?);
            }
        }
    }
    Ok(all)
}

impl Context<'_> {
    fn title(&self, card: &Card) -> String {
        let number: String = card.field(0).chars().take(NUMBER).collect();
        format!("{} {number} of {}", card.name, card.place(self.source))
    }

    fn push(&mut self, name: String, rule: Rule) {
        self.constraints.push(Constraint { name, rule });
    }

    /// Holds components of nodes, each in the node's own directions, unless they are already held; all that are global become one
    /// constraint.
    fn hold(&mut self, name: String, nodes: &[usize], components: [bool; 6]) {
        let mut together = Vec::new();
        for &node in nodes {
            for component in (0..6).filter(|c| components[*c]) {
                if std::mem::replace(&mut self.held[node][component], true) {
                    continue;
                }
                let terms = self.terms(node, component, 1.0);
                let base = component / 3 * 3;
                match terms[..] {
                    [(freedom, _)] => together.push(freedom),
                    // A node that is held along all three directions, or about any direction, is held along or about all three global axes.
                    _ if base == 3 || components[..3] == [true; 3] => {
                        together.extend((base..base + 3).map(|component| Freedom { node, component }));
                    }
                    _ => self.push(name.clone(), Rule::Equation(terms)),
                }
            }
        }
        together.sort_unstable();
        together.dedup();
        if !together.is_empty() {
            self.push(name, Rule::Held(together));
        }
    }

    /// A component along one of the node's own directions, in terms of global components.
    fn terms(&self, node: usize, component: usize, factor: f64) -> Vec<(Freedom, f64)> {
        let direction = self.grids.directions(self.mesh, node)[component % 3];
        let base = component / 3 * 3;
        let term = |a: usize| (Freedom { node, component: base + a }, factor * direction[a]);
        (0..3).map(term).filter(|(_, c)| *c != 0.0).collect()
    }

    fn single_points(&mut self, card: &Card) -> Result<(), MeshError> {
        for at in [1, 4] {
            if card.field(at).is_empty() {
                continue;
            }
            let node = self.grids.node(self.source, card, at)?;
            if card.real(self.source, at + 2, Some(0.0))? != 0.0 {
                let remedy = "hold the node at zero: loads are given in the structure file";
                return Err(card.unsupported(self.source, "a displacement that is not zero", remedy));
            }
            let components = card.components(self.source, at + 1)?;
            self.hold(self.title(card), &[node], components);
        }
        Ok(())
    }

    fn listed_points(&mut self, card: &Card) -> Result<(), MeshError> {
        let components = card.components(self.source, 1)?;
        let mut nodes = Vec::new();
        if card.field(3).eq_ignore_ascii_case("THRU") {
            let (first, last) = (card.label(self.source, 2)?, card.label(self.source, 4)?);
            nodes.extend(self.grids.labels.range(first, last, 1));
        } else {
            for at in (2..card.fields.len()).filter(|at| !card.field(*at).is_empty()) {
                nodes.push(self.grids.node(self.source, card, at)?);
            }
        }
        self.hold(self.title(card), &nodes, components);
        Ok(())
    }

    fn rigid(&mut self, card: &Card) -> Result<(), MeshError> {
        let reference = self.grids.node(self.source, card, 1)?;
        let components = card.components(self.source, 2)?;
        for at in (3..card.fields.len()).filter(|at| !card.field(*at).is_empty()) {
            // A real number at the end of the card is a coefficient of thermal expansion.
            if card.field(at).parse::<i64>().is_err() && real(card.field(at)).is_some() {
                continue;
            }
            let node = self.grids.node(self.source, card, at)?;
            let directions = self.grids.directions(self.mesh, node);
            self.push(self.title(card), Rule::Rigid { reference, nodes: vec![node], components, directions });
        }
        Ok(())
    }

    fn mean(&mut self, card: &Card) -> Result<(), MeshError> {
        let source = self.source;
        let reference = self.grids.node(source, card, 2)?;
        let components = card.components(source, 3)?;
        let (mut nodes, mut group): (Vec<Weighted>, Option<(f64, [bool; 3])>) = (Vec::new(), None);
        let mut at = 4;
        while at < card.fields.len() {
            let text = card.field(at);
            if text.is_empty() {
                at += 1;
            } else if text.chars().next().is_some_and(char::is_alphabetic) {
                // After UM the card lists the components to be eliminated, after ALPHA a thermal expansion; neither changes the constraint.
                break;
            } else if text.parse::<i64>().is_err() {
                let weight = card.real(source, at, None)?;
                let chosen = card.components(source, at + 1)?;
                if weight <= 0.0 || chosen[3..].contains(&true) || !chosen[..3].contains(&true) {
                    let found = format!("weight {weight} on the components {:?}", card.field(at + 1));
                    return Err(card.unsupported(source, found, "give a weight > 0 on components among 1, 2 and 3: nodes of solid elements do not turn"));
                }
                group = Some((weight, [chosen[0], chosen[1], chosen[2]]));
                at += 2;
            } else {
                let node = self.grids.node(source, card, at)?;
                let Some((weight, components)) = group else {
                    return Err(card.malformed(
                        source,
                        format!("node {text} before a weight"),
                        "a weight (a real number) and components first",
                    ));
                };
                if components != [true; 3]
                    && self.grids.directions(self.mesh, node) != self.grids.directions(self.mesh, reference)
                {
                    let remedy =
                        "let all nodes of the RBE3 count components in one system, or take components 123";
                    return Err(card.unsupported(
                        source,
                        format!("node {text} in a system of its own"),
                        remedy,
                    ));
                }
                nodes.push(Weighted { node, weight, components });
                at += 1;
            }
        }
        let directions = self.grids.directions(self.mesh, reference);
        self.push(self.title(card), Rule::Mean { reference, components, nodes, directions });
        Ok(())
    }

    /// Terms of node, component and coefficient, two to a line; the first field and the last of each line are empty.
    fn equation(&mut self, card: &Card) -> Result<(), MeshError> {
        let mut terms = Vec::new();
        for line in 0..card.fields.len().div_ceil(8) {
            for at in [8 * line + 1, 8 * line + 4] {
                if card.field(at).is_empty() {
                    continue;
                }
                let node = self.grids.node(self.source, card, at)?;
                let components = card.components(self.source, at + 1)?;
                let Some(component) = (0..6).find(|c| components[*c]) else {
                    return Err(card.malformed(
                        self.source,
                        format!("node {} without a component", card.field(at)),
                        "a component from 1 to 6",
                    ));
                };
                let factor = card.real(self.source, at + 2, None)?;
                terms.extend(self.terms(node, component, factor));
            }
        }
        self.push(self.title(card), Rule::Equation(terms));
        Ok(())
    }
}

/// A point mass at a node. Its offset and inertia are in a coordinate system given by its number; for the number -1 the offset is a
/// position in global axes.
fn mass(context: &Context, card: &Card, systems: &Systems, factor: f64) -> Result<PointMass, MeshError> {
    let source = context.source;
    let node = context.grids.node(source, card, 1)?;
    let number = card.integer(source, 2, Some(0))?;
    let directions = match systems.get(&number) {
        Some(system) if system.axes.directions == GLOBAL || system.kind == Coordinates::Rectangular => {
            system.axes.directions
        }
        None if number == -1 => GLOBAL,
        _ => {
            let remedy = "give a CORD2R, 0 or -1";
            return Err(card.unsupported(source, format!("system {number} of CONM2"), remedy));
        }
    };
    let value = |at: usize| card.real(source, at, Some(0.0));
    let mass = factor * value(3)?;
    if mass < 0.0 {
        return Err(card.malformed(source, format!("the mass {mass}"), "a mass >= 0"));
    }
    let local = [value(4)?, value(5)?, value(6)?];
    let mut offset: [f64; 3] = std::array::from_fn(|i| (0..3).map(|k| local[k] * directions[k][i]).sum());
    if number == -1 {
        offset = std::array::from_fn(|i| local[i] - context.mesh.positions[node][i]);
    }
    let [xx, yx, yy, zx, zy, zz] = [value(8)?, value(9)?, value(10)?, value(11)?, value(12)?, value(13)?];
    // The card contains ∫xy dm with a positive sign; in the inertia matrix it is negative.
    let own = [[xx, -yx, -zx], [-yx, yy, -zy], [-zx, -zy, zz]];
    let mut inertia = [[0.0; 3]; 3];
    for (i, row) in inertia.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            for (p, along) in directions.iter().enumerate() {
                for (q, across) in directions.iter().enumerate() {
                    *entry += factor * along[i] * own[p][q] * across[j];
                }
            }
        }
    }
    Ok(PointMass { name: context.title(card), node, mass, offset, inertia })
}
