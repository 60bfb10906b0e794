//! Columns of numbers written as lines of CSV.

use std::borrow::Cow;
use std::io::{self, Write};

/// A name as spreadsheets show it. A name that begins like a formula gets an apostrophe in front, which marks it as text, as spreadsheets
/// themselves do (OWASP, "CSV injection").
fn as_text(name: &str) -> Cow<'_, str> {
    if name.starts_with(['=', '+', '-', '@']) { format!("'{name}").into() } else { name.into() }
}

/// The first line of a CSV file: the names.
pub(super) fn csv_header<'a>(names: impl IntoIterator<Item = &'a String>) -> io::Result<Vec<u8>> {
    let mut header = csv::Writer::from_writer(Vec::new());
    header
        .write_record(names.into_iter().map(|name| as_text(name).into_owned()))
        .map_err(io::Error::other)?;
    header.into_inner().map_err(|e| io::Error::other(e.to_string()))
}

/// Writes one line of CSV for each row.
pub(super) fn csv_rows(columns: &[&[f64]], sink: &mut impl Write) -> io::Result<()> {
    let (mut number, mut line) = (ryu::Buffer::new(), Vec::new());
    for row in 0..columns[0].len() {
        line.clear();
        for values in columns {
            line.extend_from_slice(number.format(values[row]).as_bytes());
            line.push(b',');
        }
        line.pop();
        line.push(b'\n');
        sink.write_all(&line)?;
    }
    Ok(())
}
