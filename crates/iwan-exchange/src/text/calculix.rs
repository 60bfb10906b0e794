//! CalculiX: `.sti`, `.mas` (lines `row column value`) and `.dof` (one line `node.component` for each row), as `*FREQUENCY, SOLVER=MATRIXSTORAGE`
//! writes them (CalculiX CrunchiX User's Manual, *FREQUENCY).

use crate::error::ExchangeError;
use crate::matrix::{Component, Label, Matrix};
use crate::source::{Line, Source};

use super::abaqus::coordinates;

/// The matrix of a `.sti`, `.mas` or `.dam` file.
pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    coordinates(source)
}

/// The labels of the rows in a `.dof` file.
pub(crate) fn rows(source: &Source) -> Result<Vec<Label>, ExchangeError> {
    source.lines().map(|line| row(source, &line)).collect()
}

fn row(source: &Source, line: &Line) -> Result<Label, ExchangeError> {
    let text = line.text;
    let Some(at) = text.iter().position(|b| *b == b'.') else {
        return Err(source.malformed(line.place(), line.quoted(), "node.component, such as 17.3"));
    };
    let node = source.whole(line, &text[..at], [1, u64::MAX], "the node")?;
    let number = source.whole(line, &text[at + 1..], [1, 6], "the component")?;
    let component = Component::numbered(number).unwrap_or(Component::Scalar);
    Ok(Label { node, component })
}
