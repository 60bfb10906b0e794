//! Matrix Market: `coordinate` and `array`, `real`, `integer` and `double`, `general` and `symmetric`.
//!
//! R. F. Boisvert, R. Pozo and K. A. Remington, "The Matrix Market Exchange Formats: Initial Design", NISTIR 5935, 1996.

use crate::error::ExchangeError;
use crate::matrix::{Matrix, Stored};
use crate::source::{Line, MOST_ROWS, Source};

/// What the first line states about the matrix.
struct Banner {
    dense: bool,
    stored: Stored,
}

pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let mut lines = source.lines();
    let first = lines.next().ok_or_else(|| source.ends("%%MatrixMarket matrix ..."))?;
    let Banner { dense, stored } = banner(source, &first)?;
    let mut data = lines.filter(|line| !line.text.starts_with(b"%"));
    let sizes = data.next().ok_or_else(|| source.ends("the line of sizes"))?;
    let fields: Vec<&[u8]> = sizes.fields().collect();
    if fields.len() != if dense { 2 } else { 3 } {
        let expected = if dense { "rows and columns" } else { "rows, columns and entries" };
        return Err(source.malformed(sizes.place(), sizes.quoted(), expected));
    }
    let size = |at: usize, what| source.whole(&sizes, fields[at], [1, MOST_ROWS], what);
    let (rows, columns) = (size(0, "rows")?, size(1, "columns")?);
    if stored == Stored::Triangle && rows != columns {
        return Err(source.malformed(
            sizes.place(),
            sizes.quoted(),
            "as many columns as rows: it is symmetric",
        ));
    }
    let entries = if dense {
        array(source, data, [rows, columns], stored)?
    } else {
        let promised = source.whole(&sizes, fields[2], [0, u64::MAX], "the number of entries")?;
        coordinates(source, data, [rows, columns], promised)?
    };
    let (rows, columns) = (rows as usize, columns as usize);
    Ok(vec![Matrix { name: String::new(), rows, columns, entries, stored, labels: None, complex: false }])
}

fn banner(source: &Source, line: &Line) -> Result<Banner, ExchangeError> {
    let words: Vec<String> =
        line.fields().map(|word| String::from_utf8_lossy(word).to_ascii_lowercase()).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let ["%%matrixmarket", "matrix", layout, field, symmetry] = words[..] else {
        let expected = "%%MatrixMarket matrix coordinate real symmetric, or a like line";
        return Err(source.malformed(line.place(), line.quoted(), expected));
    };
    let refused = |word: &str, remedy: &str| {
        Err(source.unsupported(line.place(), format!("the word {word} of the first line"), remedy))
    };
    if !matches!(field, "real" | "integer" | "double") {
        return refused(field, "write real numbers");
    }
    let stored = match symmetry {
        "general" => Stored::All,
        "symmetric" => Stored::Triangle,
        other => return refused(other, "write the matrix as symmetric or general"),
    };
    match layout {
        "coordinate" => Ok(Banner { dense: false, stored }),
        "array" => Ok(Banner { dense: true, stored }),
        other => refused(other, "write it as coordinate or array"),
    }
}

fn coordinates<'a>(
    source: &Source,
    lines: impl Iterator<Item = Line<'a>>,
    [rows, columns]: [u64; 2],
    promised: u64,
) -> Result<Vec<(u32, u32, f64)>, ExchangeError> {
    let mut entries = Vec::new();
    for line in lines {
        let Some([row, column, value]) = line.exactly() else {
            return Err(source.malformed(line.place(), line.quoted(), "row, column and value"));
        };
        let row = source.whole(&line, row, [1, rows], "the row")?;
        let column = source.whole(&line, column, [1, columns], "the column")?;
        entries.push((row as u32 - 1, column as u32 - 1, source.number(&line, value, "the value")?));
    }
    if entries.len() as u64 != promised {
        let found = format!("{} entries", entries.len());
        return Err(source.malformed(
            "the end of the file",
            found,
            format!("{promised} entries, as the header says"),
        ));
    }
    Ok(entries)
}

fn array<'a>(
    source: &Source,
    lines: impl Iterator<Item = Line<'a>>,
    [rows, columns]: [u64; 2],
    stored: Stored,
) -> Result<Vec<(u32, u32, f64)>, ExchangeError> {
    let (mut entries, mut row, mut column) = (Vec::new(), 0, 0);
    for line in lines {
        for field in line.fields() {
            if column == columns {
                return Err(source.malformed(line.place(), line.quoted(), "no more values"));
            }
            let value = source.number(&line, field, "the value")?;
            if value != 0.0 {
                entries.push((row as u32, column as u32, value));
            }
            row += 1;
            if row == rows {
                column += 1;
                row = if stored == Stored::Triangle { column } else { 0 };
            }
        }
    }
    if column != columns {
        return Err(source.ends(format!("the values of column {}", column + 1)));
    }
    Ok(entries)
}
