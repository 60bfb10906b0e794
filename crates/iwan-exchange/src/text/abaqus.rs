//! Abaqus matrices: `*MATRIX OUTPUT` as MATRIX INPUT or COORDINATE, and the user element of `*SUBSTRUCTURE MATRIX OUTPUT`.
//!
//! MATRIX INPUT has lines `row node, its component, column node, its component, value`; the file holds the lower triangle or all entries
//! (Abaqus Analysis Guide, "Generating structural matrices"). COORDINATE has lines `row column value`. A substructure is
//! `*USER ELEMENT` with its nodes and components and `*MATRIX, TYPE=STIFFNESS` or `MASS` with the rows of the lower triangle.

use std::collections::HashMap;

use crate::error::ExchangeError;
use crate::matrix::{Component, Entry, Label, Matrix, Stored};
use crate::source::{Line, MOST_ROWS, Source};

/// Smallest and largest component. Abaqus numbers displacements 1 to 3 and rotations 4 to 6; larger numbers (temperatures, pressures) are
/// no motions, and are refused.
const COMPONENTS: [u64; 2] = [0, 6];

pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let user_element = |line: &Line| {
        if !line.text.starts_with(b"*") {
            return false;
        }
        let name: Vec<u8> = line.text.iter().filter(|b| !b.is_ascii_whitespace()).copied().collect();
        name.to_ascii_uppercase().starts_with(b"*USERELEMENT")
    };
    if source.lines().any(|line| user_element(&line)) {
        return substructure(source);
    }
    let mut data = source.lines().filter(|line| !line.text.starts_with(b"*") && !line.text.starts_with(b"%"));
    match data.next().map(|line| line.fields().count()) {
        Some(5) => labelled(source),
        Some(3) => coordinates(source),
        Some(_) => {
            let line = source.lines().find(|line| !line.text.starts_with(b"*"));
            let (place, found) = line.map_or((String::new(), String::new()), |l| (l.place(), l.quoted()));
            let expected = "row node, component, column node, component, value; or row, column, value";
            Err(source.malformed(place, found, expected))
        }
        None => Err(source.ends("entries of a matrix")),
    }
}

/// The labels found so far, and the row number of each.
#[derive(Default)]
struct Rows {
    numbers: HashMap<Label, u32>,
    labels: Vec<Label>,
}

impl Rows {
    /// The number of a label, which a new label gets here. `last` is the label at the same place of the line before: files sorted by rows
    /// or columns repeat it, which saves a look-up.
    fn number(&mut self, label: Label, last: &mut Option<(Label, u32)>) -> u32 {
        if let Some((_, number)) = last.filter(|last| last.0 == label) {
            return number;
        }
        let number = *self.numbers.entry(label).or_insert_with(|| {
            self.labels.push(label);
            self.labels.len() as u32 - 1
        });
        *last = Some((label, number));
        number
    }
}

/// Whether the entries hold both triangles or one: both, if there are entries below and above the diagonal.
fn stored(entries: &[Entry]) -> Stored {
    let (mut below, mut above) = (false, false);
    for (row, column, _) in entries {
        below |= row > column;
        above |= row < column;
    }
    if below && above { Stored::All } else { Stored::Triangle }
}

/// Reads MATRIX INPUT.
fn labelled(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let (mut rows, mut entries) = (Rows::default(), Vec::new());
    let (mut last_row, mut last_column) = (None, None);
    for line in source.lines().filter(|line| !line.text.starts_with(b"*") && !line.text.starts_with(b"%")) {
        let Some([a, i, b, j, value]) = line.exactly() else {
            let expected = "row node, component, column node, component, value";
            return Err(source.malformed(line.place(), line.quoted(), expected));
        };
        let label = |node: &[u8], component: &[u8], what: &str| -> Result<Label, ExchangeError> {
            let text = std::str::from_utf8(node).unwrap_or_default();
            // Internal nodes of Abaqus, such as those of Lagrange multipliers, have numbers below 0.
            if text.starts_with('-') {
                let found = format!("the internal node {text}");
                let remedy =
                    "model without Lagrange multipliers (hybrid elements, *TIE by penalty, connectors)";
                return Err(source.unsupported(line.place(), found, remedy));
            }
            let node = source.whole(&line, node, [0, u64::MAX], format_args!("the {what} node"))?;
            let number = source.whole(&line, component, COMPONENTS, format_args!("the {what} component"))?;
            Ok(Label { node, component: Component::numbered(number).unwrap_or(Component::Scalar) })
        };
        let (row, column) = (label(a, i, "row")?, label(b, j, "column")?);
        let place = (rows.number(row, &mut last_row), rows.number(column, &mut last_column));
        entries.push((place.0, place.1, source.number(&line, value, "the value")?));
    }
    let (labels, map) = ascending(&rows.labels);
    for entry in &mut entries {
        (entry.0, entry.1) = (map[entry.0 as usize], map[entry.1 as usize]);
    }
    let (n, stored) = (labels.len(), stored(&entries));
    Ok(vec![Matrix {
        name: String::new(),
        rows: n,
        columns: n,
        entries,
        stored,
        labels: Some(labels),
        complex: false,
    }])
}

/// The labels in ascending order, and for each old number the new number.
fn ascending(labels: &[Label]) -> (Vec<Label>, Vec<u32>) {
    let mut order: Vec<u32> = (0..labels.len() as u32).collect();
    order.sort_by_key(|&old| labels[old as usize]);
    let mut map = vec![0; labels.len()];
    order.iter().enumerate().for_each(|(new, &old)| map[old as usize] = new as u32);
    (order.into_iter().map(|old| labels[old as usize]).collect(), map)
}

/// Reads COORDINATE: lines `row column value`, counted from 1.
pub(crate) fn coordinates(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let (mut entries, mut most) = (Vec::new(), 0);
    for line in source.lines().filter(|line| !line.text.starts_with(b"*") && !line.text.starts_with(b"%")) {
        let Some([row, column, value]) = line.exactly() else {
            return Err(source.malformed(line.place(), line.quoted(), "row, column and value"));
        };
        let index =
            |field: &[u8], what: &str| source.whole(&line, field, [1, MOST_ROWS], format_args!("the {what}"));
        let (row, column) = (index(row, "row")?, index(column, "column")?);
        most = most.max(row).max(column);
        entries.push((row as u32 - 1, column as u32 - 1, source.number(&line, value, "the value")?));
    }
    if entries.is_empty() {
        return Err(source.ends("entries: row, column and value"));
    }
    let (n, stored) = (most as usize, stored(&entries));
    Ok(vec![Matrix {
        name: String::new(),
        rows: n,
        columns: n,
        entries,
        stored,
        labels: None,
        complex: false,
    }])
}

/// A line `*KEYWORD` with its parameters, in capitals and without blanks.
fn keyword(line: &Line) -> String {
    let text = String::from_utf8_lossy(line.text).to_ascii_uppercase();
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

/// Value of a parameter of a keyword line.
fn parameter<'k>(keyword: &'k str, name: &str) -> Option<&'k str> {
    keyword.split(',').find_map(|field| field.strip_prefix(name)?.strip_prefix('='))
}

/// Reads the user element of a substructure: nodes, components, and lower triangles row by row.
fn substructure(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let mut lines = source.lines().peekable();
    let (mut nodes, mut labels, mut matrices) = (Vec::new(), Vec::<Label>::new(), Vec::new());
    while let Some(line) = lines.next() {
        if line.text.starts_with(b"**") {
            nodes.extend(commented_nodes(&line));
            continue;
        }
        let head = keyword(&line);
        let mut data = Vec::new();
        while let Some(next) = lines.next_if(|next| !next.text.starts_with(b"*")) {
            data.push(next);
        }
        if head.starts_with("*USERELEMENT") {
            // Rows of one element do not belong to another, and a comment of nodes does not say to which element it belongs.
            if !labels.is_empty() {
                return Err(source.unsupported(
                    line.place(),
                    "a second *USER ELEMENT",
                    "give each a file of its own",
                ));
            }
            labels = degrees(source, &line, &data)?;
        } else if head.starts_with("*MATRIX") {
            let name = parameter(&head, "TYPE").unwrap_or_default().to_string();
            matrices.push(lower(source, &line, name, &data, labels.len())?);
        } else if head.starts_with("*ELEMENT") {
            nodes = element_nodes(source, &data)?;
        }
    }
    for label in &mut labels {
        // Positions in the element are replaced by numbers of nodes where the file states which nodes these are.
        if label.component != Component::Scalar
            && let Some(node) = nodes.get(label.node as usize - 1)
        {
            label.node = *node;
        }
    }
    for matrix in &mut matrices {
        matrix.labels = Some(labels.clone());
    }
    if matrices.is_empty() {
        return Err(source.ends("*MATRIX, TYPE=STIFFNESS or MASS"));
    }
    Ok(matrices)
}

/// The numbers of a comment line; behind a comment `** ELEMENT NODES` they are the nodes of the element. Empty where anything else stands
/// in the line.
fn commented_nodes(line: &Line) -> Vec<u64> {
    let text = line.text.trim_ascii_start();
    let body = text.strip_prefix(b"**").unwrap_or(text);
    let fields: Vec<&[u8]> = Line { number: line.number, text: body }.fields().collect();
    let number = |field: &&[u8]| std::str::from_utf8(field).ok()?.parse::<u64>().ok();
    let numbers: Option<Vec<u64>> = fields.iter().map(number).collect();
    numbers.unwrap_or_default()
}

/// Rows of the element from the lines under `*USER ELEMENT`: first the components of the first nodes, then `position, components` where the
/// components change.
fn degrees(source: &Source, head: &Line, data: &[Line]) -> Result<Vec<Label>, ExchangeError> {
    let keyword = keyword(head);
    let count = parameter(&keyword, "NODES").unwrap_or_default();
    // Each node takes at least one byte of the file, with or without a line of its own.
    let count = source.whole(head, count.as_bytes(), [1, source.bytes.len() as u64], "NODES")?;
    let mut changes: Vec<(u64, Vec<u64>)> = Vec::new();
    for (n, line) in data.iter().enumerate() {
        let mut fields = line.fields();
        let position = match n {
            0 => 1,
            _ => source.whole(line, fields.next().unwrap_or_default(), [1, count], "a position")?,
        };
        let components: Result<Vec<u64>, _> =
            fields.map(|field| source.whole(line, field, COMPONENTS, "a component")).collect();
        changes.push((position, components?));
    }
    let mut labels = Vec::new();
    for position in 1..=count {
        let Some((_, components)) = changes.iter().rev().find(|(from, _)| *from <= position) else {
            continue;
        };
        for &number in components {
            let component = Component::numbered(number).unwrap_or(Component::Scalar);
            labels.push(Label { node: position, component });
        }
        if labels.len() > source.bytes.len() {
            return Err(source.malformed(
                head.place(),
                "more rows than the file has bytes",
                "as many as its matrices",
            ));
        }
    }
    Ok(labels)
}

/// Nodes of the first element under `*ELEMENT`, without the element's number.
fn element_nodes(source: &Source, data: &[Line]) -> Result<Vec<u64>, ExchangeError> {
    let mut nodes = Vec::new();
    for line in data {
        for field in line.fields() {
            nodes.push(source.whole(line, field, [1, u64::MAX], "a node of the element")?);
        }
    }
    Ok(nodes.into_iter().skip(1).collect())
}

/// A matrix from the rows of its lower triangle, one after another.
fn lower(
    source: &Source,
    head: &Line,
    name: String,
    data: &[Line],
    order: usize,
) -> Result<Matrix, ExchangeError> {
    let (mut entries, mut row, mut column) = (Vec::new(), 0_usize, 0_usize);
    for line in data {
        for field in line.fields() {
            let value = source.number(line, field, "an entry of the lower triangle")?;
            if row == order {
                return Err(source.malformed(
                    line.place(),
                    "further entries",
                    format!("{order} rows, as *USER ELEMENT says"),
                ));
            }
            if value != 0.0 {
                entries.push((row as u32, column as u32, value));
            }
            column += 1;
            if column > row {
                (row, column) = (row + 1, 0);
            }
        }
    }
    if row != order || order == 0 {
        let found = format!("{row} rows of *MATRIX, TYPE={name}");
        return Err(source.malformed(head.place(), found, format!("{order} rows, as *USER ELEMENT says")));
    }
    Ok(Matrix {
        name,
        rows: order,
        columns: order,
        entries,
        stored: Stored::Triangle,
        labels: None,
        complex: false,
    })
}
