//! Sierra/SD: `Kaa.m` and `Maa.m` (lines `row column value` of the lower triangle), `ASetMap.m` and `gid.m` (lines `x(i) = value;`), as
//! `OUTPUTS Kaa Maa MFile` writes them.

use crate::error::ExchangeError;
use crate::matrix::{Component, Label, Matrix, Stored};
use crate::source::{Line, MOST_ROWS, Source, quote};

/// Components of a node in `ASetMap`: three displacements, three rotations and three more that solids do not have.
const PER_NODE: usize = 9;

pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let (mut name, mut order, mut stored) = (String::new(), None, Stored::All);
    let (mut entries, mut inside, mut closed) = (Vec::new(), false, false);
    for line in source.lines() {
        let text = line.text;
        if inside {
            if text.starts_with(b"]") {
                (inside, closed) = (false, true);
                continue;
            }
            let most = order.unwrap_or(MOST_ROWS);
            entries.push(entry(source, &line, most)?);
        } else if let Some(rest) = text.strip_prefix(b"function ") {
            name = String::from_utf8_lossy(rest).split(['=', '(']).nth(1).unwrap_or_default().trim().into();
        } else if text.starts_with(b"NumRows") {
            let digits: Vec<u8> = text.iter().copied().filter(u8::is_ascii_digit).collect();
            if order.is_some() {
                return Err(one_matrix(source, &line));
            }
            order = Some(source.whole(&line, &digits, [1, MOST_ROWS], "NumRows")?);
        } else if text.ends_with(b"[") {
            if closed {
                return Err(one_matrix(source, &line));
            }
            inside = true;
        } else if text.windows(16).any(|w| w == b"Lower Triangular") {
            stored = Stored::Triangle;
        }
    }
    if !closed {
        let expected =
            if inside { "`];` behind the entries" } else { "`a=[` and entries: row, column and value" };
        return Err(source.ends(expected));
    }
    let Some(order) = order else { return Err(source.ends("NumRows = ...")) };
    // NumRows may also stand behind the entries; these are then read before the number of rows is known, and checked here.
    if let Some((row, column, _)) = entries.iter().find(|e| u64::from(e.0.max(e.1)) >= order) {
        let found = format!("an entry in row {} and column {}", row + 1, column + 1);
        return Err(source.malformed("the entries", found, format!("numbers from 1 to NumRows = {order}")));
    }
    let order = order as usize;
    Ok(vec![Matrix { name, rows: order, columns: order, entries, stored, labels: None, complex: false }])
}

/// The error of a file that begins a second matrix.
fn one_matrix(source: &Source, line: &Line) -> ExchangeError {
    source.unsupported(
        line.place(),
        format!("a second matrix from {} on", line.quoted()),
        "give each a file of its own",
    )
}

fn entry(source: &Source, line: &Line, most: u64) -> Result<(u32, u32, f64), ExchangeError> {
    let Some([row, column, value]) = line.exactly() else {
        return Err(source.malformed(line.place(), line.quoted(), "row, column and value;"));
    };
    let index = |field: &[u8], what: &str| source.whole(line, field, [1, most], format_args!("the {what}"));
    let (row, column) = (index(row, "row")?, index(column, "column")?);
    Ok((row as u32 - 1, column as u32 - 1, source.number(line, value, "the value")?))
}

/// The vector in a file of lines `x(i) = value;`; entries without a line are 0.
fn vector(source: &Source) -> Result<Vec<u64>, ExchangeError> {
    let mut out: Vec<u64> = Vec::new();
    for line in source.lines() {
        let text = line.text;
        let Some(rest) = text.strip_prefix(b"x(") else { continue };
        let bad = || source.malformed(line.place(), line.quoted(), "x(INDEX) = VALUE;");
        let close = rest.iter().position(|b| *b == b')').ok_or_else(bad)?;
        // Entries without a line are zero: such a component is no unknown. Every node has at least one entry, so that the number of zeros
        // between two entries is limited, and the memory stays within a multiple of the file's size.
        let most = (out.len() + 4 * PER_NODE) as u64;
        let index =
            source.whole(&line, &rest[..close], [out.len() as u64 + 1, most], "the index, ascending")?;
        let value = rest[close + 1..].trim_ascii_start().strip_prefix(b"=").ok_or_else(bad)?;
        let value = value.trim_ascii().strip_suffix(b";").ok_or_else(bad)?.trim_ascii();
        out.resize(index as usize - 1, 0);
        out.push(source.whole(&line, value, [0, MOST_ROWS], "the value")?);
    }
    if out.is_empty() {
        return Err(source.ends("lines x(INDEX) = VALUE;"));
    }
    Ok(out)
}

/// The labels of the rows. Entry 9 n + c of the map is the row (from 1) of component c of node n, or 0; `numbers` holds the numbers of the
/// nodes.
pub(crate) fn rows(map: &Source, numbers: Option<&Source>) -> Result<Vec<Label>, ExchangeError> {
    let entries = vector(map)?;
    let numbers = numbers.map(vector).transpose()?;
    let rows = entries.iter().copied().max().unwrap_or(0) as usize;
    // Each row is an entry of the map: a row number above the number of entries leaves other rows without a label.
    let mut labels = vec![None; rows.min(entries.len())];
    for (at, &row) in entries.iter().enumerate().filter(|(_, row)| **row > 0) {
        let (node, component) = (at / PER_NODE, at % PER_NODE);
        let number = match &numbers {
            None => node as u64 + 1,
            Some(numbers) => *numbers.get(node).ok_or_else(|| {
                let found =
                    format!("{} numbers of nodes, but x({}) is of node {}", numbers.len(), at + 1, node + 1);
                map.malformed("the whole file", found, "the gid file of the same model")
            })?,
        };
        let component = Component::numbered(component as u64 + 1).ok_or_else(|| {
            let found = format!("x({}), component {} of a node", at + 1, component + 1);
            map.unsupported(format!("x({})", at + 1), found, "keep displacements and rotations in the a-set")
        })?;
        let label = Label { node: number, component };
        match labels.get_mut(row as usize - 1) {
            Some(place @ None) => *place = Some(label),
            Some(Some(first)) => {
                let found = format!("row {row} for {label} and for {first}");
                return Err(map.malformed(format!("x({})", at + 1), found, "each row once"));
            }
            None => {
                let found = format!("row {row}, beyond all entries of the map");
                return Err(map.malformed(format!("x({})", at + 1), found, "rows without gaps"));
            }
        }
    }
    let missing = labels.iter().position(Option::is_none);
    if let Some(row) = missing {
        let found = format!("no entry for row {}", row + 1);
        return Err(map.malformed(quote(b"x", 1), found, "an entry for each row"));
    }
    Ok(labels.into_iter().flatten().collect())
}
