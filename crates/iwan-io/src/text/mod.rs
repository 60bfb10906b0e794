//! Columns of numbers as text: comma, semicolon, tab or white space between them.
//!
//! Comments start with `#` or `%`. A header of names is optional, and so is a second header of units; units may also stand
//! behind the name as in `acc [m/s^2]`. Where the columns are not separated by commas, the decimal sign may be
//! a comma. A column of times of day, with dates or without, is read as seconds since midnight. Quoting follows RFC 4180. Only the columns that are
//! read as time and channels need to be complete, and they may end before others.

mod clock;
mod layout;
mod column;

use crate::assembly::units::{self, Label};
use crate::assembly::{Axis, Chooser, Raw, Variable};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::options::ReadOptions;
use crate::warning::Warning;
use column::{Column, Fault};
use iwan_machine::listed;
use layout::Layout;
use std::path::Path;

/// A file with more columns is taken for damaged, and refused: each column of a table becomes a vector in memory, and a line of a binary
/// file with commas in it may seem to have any number of columns. Modal tests have up to some hundred channels; any limit from a thousand
/// on does as well.
const MOST_COLUMNS: usize = 10_000;

/// Named columns of equal length, as read from a text file. NaN and infinite values are kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    names: Vec<String>,
    units: Vec<String>,
    values: Vec<Vec<f64>>,
    lines: Vec<u64>,
    warnings: Vec<Warning>,
}

impl Columns {
    /// Names in the order of the columns, without units; `column 1`, ... where the file has none.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Units in the order of the columns; empty where the file names none.
    #[must_use]
    pub fn units(&self) -> &[String] {
        &self.units
    }

    /// Values of the first column of this name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let at = self.names.iter().position(|n| n == name)?;
        Some(&self.values[at])
    }

    /// All columns.
    #[must_use]
    pub fn columns(&self) -> &[Vec<f64>] {
        &self.values
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }

    /// Line of the file in which a row stands, counted from 1 as an editor shows it; rows are counted from 0. None beyond the last row.
    ///
    /// ```
    /// let table = iwan_io::parse_table("one.csv".as_ref(), b"# a comment\nt;x\n0;1\n1;2\n")?;
    /// assert_eq!((table.line(1), table.line(2)), (Some(4), None));
    /// # Ok::<(), iwan_io::ReadError>(())
    /// ```
    #[must_use]
    pub fn line(&self, row: usize) -> Option<u64> {
        self.lines.get(row).copied()
    }

    /// What the reader noticed in the file.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}

/// Reads a text file of one or more columns, for instance a force history `t, force`.
///
/// # Errors
/// [`ReadError`] names the file, the row and column (counted from 1, as an editor shows them) and what stands there.
pub fn read_table(path: impl AsRef<Path>) -> Result<Columns, ReadError> {
    let file = path.as_ref();
    let bytes =
        iwan_machine::read_file(file).map_err(|source| ReadError::Io { file: file.into(), source })?;
    parse_table(file, &bytes)
}

/// Reads a table from bytes in memory; `file` serves the messages only.
///
/// ```
/// let table = iwan_io::parse_table("pulse.csv".as_ref(), b"t [s];force [N]\n0;0\n0,5;12,5\n")?;
/// assert_eq!(table.column("force"), Some(&[0.0, 12.5][..]));
/// # Ok::<(), iwan_io::ReadError>(())
/// ```
///
/// # Errors
/// As [`read_table`].
pub fn parse_table(file: &Path, bytes: &[u8]) -> Result<Columns, ReadError> {
    let source = FileBytes { file, bytes };
    let Table { columns, lines, labels, warnings } = read(&source)?;
    if let Some(fault) = columns.iter().filter_map(|c| c.fault.as_ref()).min_by_key(|f| f.line) {
        return Err(fault.refusal(&source));
    }
    let (names, units) = labels.into_iter().map(|label| (label.name, label.unit)).unzip();
    Ok(Columns { names, units, values: columns.into_iter().map(|c| c.values).collect(), lines, warnings })
}

/// The columns as they stand in the file, each with its own length.
struct Table {
    columns: Vec<Column>,
    /// Line of each row, counted from 1.
    lines: Vec<u64>,
    labels: Vec<Label>,
    warnings: Vec<Warning>,
}

fn read(source: &FileBytes) -> Result<Table, ReadError> {
    let layout = Layout::detect(source)?;
    if layout.fields > MOST_COLUMNS {
        let found = format!("{} columns", layout.fields);
        let place = format!("line {}", layout.first_row);
        return Err(source.malformed(place, found, format!("at most {MOST_COLUMNS}")));
    }
    let (columns, lines) = read_rows(source, &layout)?;
    let skipped = layout.preamble;
    let warnings = if skipped > 0 { vec![Warning::Preamble { lines: skipped }] } else { Vec::new() };
    let mut labels = label(&layout);
    for (label, _) in labels.iter_mut().zip(&columns).filter(|(_, column)| column.is_clock()) {
        label.unit = "s".into();
    }
    Ok(Table { columns, lines, labels, warnings })
}

/// Time and channels of a text file.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    let Table { columns, labels, warnings, .. } = read(&source)?;
    let mut faults: Vec<(String, Fault)> = Vec::new();
    let mut variables = Vec::new();
    for (Column { values, fault, hole, .. }, Label { name, unit }) in columns.into_iter().zip(labels) {
        let name = chosen_name(name, &unit, options);
        faults.extend(fault.filter(|_| hole).map(|fault| (name.clone(), fault)));
        variables.push(Variable::vector(name, unit, values));
    }
    let whole = |is_read: &dyn Fn(&String) -> bool| {
        let read = faults.iter().filter(|(name, _)| is_read(name)).map(|(_, fault)| fault);
        read.min_by_key(|f| f.line).map_or(Ok(()), |fault| Err(fault.refusal(&source)))
    };
    if options.channels.is_empty() {
        whole(&|_| true)?;
        one_length(&source, &variables, options)?;
    }
    let mut raw = Chooser { source, options, tabular: true }.choose(variables, warnings)?;
    let time = if let Axis::Times { name, .. } = &raw.axis { Some(name) } else { None };
    whole(&|name| Some(name) == time || raw.channels.iter().any(|c| c.name == *name))?;
    end_together(&source, &mut raw)?;
    Ok(raw)
}

/// Refuses columns of different lengths where the user has named no time; it is called where no channel is named.
fn one_length(source: &FileBytes, variables: &[Variable], options: &ReadOptions) -> Result<(), ReadError> {
    let uneven = variables.windows(2).any(|v| v[0].values.len() != v[1].values.len());
    if !uneven || options.time.is_some() {
        return Ok(());
    }
    let each: Vec<String> = variables.iter().map(|v| format!("{} {}", v.name, v.values.len())).collect();
    let found =
        format!("the columns have different numbers of rows ({})", listed(each.iter().map(String::as_str)));
    let names = listed(variables.iter().map(|v| v.name.as_str()));
    Err(ReadError::Ambiguous { file: source.file.into(), found, names })
}

/// Refuses channels that are read together but differ in length; the times are cut to the channels' length.
fn end_together(source: &FileBytes, raw: &mut Raw) -> Result<(), ReadError> {
    let Some((first, rest)) = raw.channels.split_first() else { return Ok(()) };
    let rows = first.values.len();
    if let Some(other) = rest.iter().find(|c| c.values.len() != rows) {
        return Err(ReadError::Mismatch {
            file: source.file.into(),
            name: other.name.clone(),
            found: format!("{} samples", other.values.len()),
            expected: format!("{rows} samples"),
            reference: first.name.clone(),
        });
    }
    if let Axis::Times { values, .. } = &mut raw.axis {
        values.truncate(rows);
    }
    Ok(())
}

/// The column's name as the user wrote it, where the user wrote name and unit as they stand in the file.
fn chosen_name(name: String, unit: &str, options: &ReadOptions) -> String {
    let asked = options.channels.iter().chain(&options.time);
    let letters = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
    let (bare, label) = (letters(&name), letters(unit));
    let around =
        [("[", "]"), ("(", ")"), ("{", "}"), ("<", ">"), ("_", ""), ("/", ""), (",", ""), ("in", "")];
    let full = around.map(|(open, close)| format!("{bare}{open}{label}{close}"));
    asked.into_iter().find(|a| !unit.is_empty() && full.contains(&letters(a))).cloned().unwrap_or(name)
}

/// Name and unit of each column; columns without a name are numbered.
fn label(layout: &Layout) -> Vec<Label> {
    let one = |i: usize| {
        let header = layout.names.get(i).map(String::as_str).unwrap_or_default();
        let Label { name, unit } = units::split_unit(header);
        let name = if name.is_empty() { format!("column {}", layout.settings + i + 1) } else { name };
        let row = layout.units.get(i).map(|u| u.trim_matches(['[', ']', '(', ')']).to_string());
        Label { name, unit: row.filter(|u| !u.is_empty()).unwrap_or(unit) }
    };
    (0..layout.fields).map(one).collect()
}

fn read_rows(source: &FileBytes, layout: &Layout) -> Result<(Vec<Column>, Vec<u64>), ReadError> {
    let body = layout.body(source.bytes);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(layout.separator.byte())
        .from_reader(&*body);
    let mut columns: Vec<Column> = (0..layout.fields).map(|_| Column::default()).collect();
    let mut lines = Vec::new();
    let mut record = csv::ByteRecord::new();
    let in_file = |line: u64| layout.first_row as u64 + line - 1;
    loop {
        let line = reader.position().line();
        match reader.read_byte_record(&mut record) {
            Ok(true) => {}
            Ok(false) => return Ok((columns, lines)),
            Err(e) => {
                let place = format!("line {}", in_file(line));
                return Err(source.malformed(place, e.to_string(), "a row of numbers"));
            }
        }
        let line = in_file(record.position().map_or(line, csv::Position::line));
        if push_row(source, layout, &record, line, &mut columns)? {
            lines.push(line);
        }
    }
}

/// Adds a line to the columns; returns whether the line holds a row (it may be empty or a comment).
fn push_row(
    source: &FileBytes,
    layout: &Layout,
    record: &csv::ByteRecord,
    line: u64,
    columns: &mut [Column],
) -> Result<bool, ReadError> {
    let fields = layout.count(record);
    if fields == 0 || layout::is_comment(&record[0]) {
        return Ok(false);
    }
    if fields != layout.all() {
        let expected = format!("{} as in line {}", layout.all(), layout.first_row);
        return Err(source.malformed(format!("line {line}"), format!("{fields} fields"), expected));
    }
    for (i, column) in columns.iter_mut().enumerate() {
        let at = layout.settings + i;
        column.push(layout, &record[at], (line, at));
    }
    Ok(true)
}
