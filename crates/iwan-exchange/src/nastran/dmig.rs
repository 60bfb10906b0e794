//! DMIG entries of bulk data and punch files: small, large and free fields (MSC Nastran Quick Reference Guide, DMIG).

use std::collections::BTreeMap;

use crate::error::ExchangeError;
use crate::matrix::{Component, Entry, Label, Matrix, Stored};
use crate::source::{Line, Source, number, quote};

/// One DMIG entry with its fields, those of continuation lines included; the first field is the name of the matrix.
struct Card<'a> {
    line: Line<'a>,
    fields: Vec<&'a [u8]>,
}

impl<'a> Card<'a> {
    fn field(&self, at: usize) -> &'a [u8] {
        self.fields.get(at).copied().unwrap_or_default()
    }

    /// A whole number >= 0; an empty field has the value `empty`.
    fn whole(
        &self,
        source: &Source,
        at: usize,
        empty: Option<u64>,
        what: &str,
    ) -> Result<u64, ExchangeError> {
        let field = self.field(at);
        match empty {
            Some(value) if field.is_empty() => Ok(value),
            _ => source.whole(&self.line, field, [0, i32::MAX as u64], what),
        }
    }

    fn label(&self, source: &Source, at: usize) -> Result<Label, ExchangeError> {
        let node = self.whole(source, at, None, "a grid or scalar point")?;
        let component = self.whole(source, at + 1, Some(0), "its component")?;
        let component = Component::numbered(component).ok_or_else(|| {
            let found = format!("component {component} of point {node}");
            source.malformed(self.line.place(), found, "a component from 0 to 6")
        })?;
        Ok(Label { node, component })
    }
}

/// Appends the fields of a line, its first field left out, to `out`; fields are free, 16 or 8 characters wide.
fn fields<'a>(text: &'a [u8], out: &mut Vec<&'a [u8]>) {
    if text.contains(&b',') {
        out.extend(text.split(|b| *b == b',').skip(1).take(8).map(<[u8]>::trim_ascii));
        return;
    }
    let first = &text[..text.len().min(8)];
    let wide = first.contains(&b'*');
    let (width, count) = if wide { (16, 4) } else { (8, 8) };
    for k in 0..count {
        let from = (8 + k * width).min(text.len());
        out.push(text[from..(from + width).min(text.len())].trim_ascii());
    }
}

/// The DMIG entries of a file; all other lines are passed over.
fn cards<'a>(source: &Source<'a>) -> Vec<Card<'a>> {
    let mut cards: Vec<Card> = Vec::new();
    let mut lines = source.lines();
    let mut inside = false;
    while let Some(line) = lines.raw() {
        let text = line.text.split(|b| *b == b'$').next().unwrap_or_default();
        if text.trim_ascii().is_empty() {
            continue;
        }
        let first = text.get(..4).unwrap_or_default();
        let begins = text.first().is_some_and(u8::is_ascii_alphabetic);
        if begins {
            let end = text.get(4).copied().unwrap_or(b' ');
            inside = first.eq_ignore_ascii_case(b"DMIG") && matches!(end, b' ' | b'*' | b',' | b'\t');
        }
        if !inside {
            continue;
        }
        if begins {
            cards.push(Card { line, fields: Vec::new() });
        }
        if let Some(card) = cards.last_mut() {
            fields(text, &mut card.fields);
        }
    }
    cards
}

/// A matrix of which only some entries are read so far.
struct Reading {
    /// 1 square, 2 and 9 rectangular, 6 symmetric.
    form: u64,
    complex: bool,
    entries: Vec<(Label, Label, f64)>,
}

/// All matrices of a file.
pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let mut found: BTreeMap<Vec<u8>, Reading> = BTreeMap::new();
    let mut names: Vec<Vec<u8>> = Vec::new();
    for card in cards(source) {
        let name = card.field(0).to_ascii_uppercase();
        if let Some(reading) = found.get_mut(&name) {
            column(source, &card, reading)?;
        } else {
            found.insert(name.clone(), header(source, &card)?);
            names.push(name);
        }
    }
    if names.is_empty() {
        return Err(source.ends("entries DMIG"));
    }
    let made = |name: &Vec<u8>| {
        let reading = found.remove(name).unwrap_or(Reading { form: 6, complex: false, entries: Vec::new() });
        assemble(String::from_utf8_lossy(name).into_owned(), &reading)
    };
    Ok(names.iter().map(made).collect())
}

fn header(source: &Source, card: &Card) -> Result<Reading, ExchangeError> {
    let name = quote(card.field(0), 16);
    if card.field(1) != b"0" {
        let found = format!("a column of {name} before its header");
        return Err(source.malformed(card.line.place(), found, "DMIG, name, 0, form, type first"));
    }
    let form = card.whole(source, 2, None, "the form")?;
    if !matches!(form, 1 | 2 | 6 | 9) {
        let found = format!("form {form} of {name}");
        return Err(source.malformed(
            card.line.place(),
            found,
            "1 (square), 2 or 9 (rectangular) or 6 (symmetric)",
        ));
    }
    let kind = card.whole(source, 3, None, "the type")?;
    if !(1..=4).contains(&kind) {
        let found = format!("type {kind} of {name}");
        return Err(source.malformed(card.line.place(), found, "1 or 2 (real), 3 or 4 (complex)"));
    }
    Ok(Reading { form, complex: kind > 2, entries: Vec::new() })
}

fn column(source: &Source, card: &Card, reading: &mut Reading) -> Result<(), ExchangeError> {
    let column = card.label(source, 1)?;
    for at in (4..card.fields.len()).step_by(4) {
        if card.field(at).is_empty() && card.field(at + 2).is_empty() {
            continue;
        }
        let row = card.label(source, at)?;
        let value = number(card.field(at + 2)).ok_or_else(|| {
            let expected = format!("the value in column {column}, row {row}: a finite number");
            source.malformed(card.line.place(), quote(card.field(at + 2), 40), expected)
        })?;
        reading.entries.push((row, column, value));
    }
    Ok(())
}

/// For each label its place in ascending order, counted from 0.
fn numbered(labels: impl Iterator<Item = Label>) -> BTreeMap<Label, u32> {
    let mut sorted: Vec<Label> = labels.collect();
    sorted.sort_unstable();
    sorted.dedup();
    sorted.into_iter().enumerate().map(|(k, label)| (label, k as u32)).collect()
}

fn assemble(name: String, reading: &Reading) -> Matrix {
    let rectangular = matches!(reading.form, 2 | 9);
    let of_rows = || reading.entries.iter().map(|e| e.0);
    let of_columns = || reading.entries.iter().map(|e| e.1);
    let rows = if rectangular { numbered(of_rows()) } else { numbered(of_rows().chain(of_columns())) };
    let columns = if rectangular { numbered(of_columns()) } else { rows.clone() };
    let entries: Vec<Entry> = reading.entries.iter().map(|(i, j, v)| (rows[i], columns[j], *v)).collect();
    let stored = if reading.form == 6 { Stored::Triangle } else { Stored::All };
    let labels = Some(rows.keys().copied().collect());
    Matrix {
        name,
        rows: rows.len(),
        columns: columns.len(),
        entries,
        stored,
        labels,
        complex: reading.complex,
    }
}
