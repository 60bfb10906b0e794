//! Converts the names and numbers in the text of a constraint to nodes.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use super::super::super::error::MeshError;
use super::super::super::file::FileBytes;
use super::super::super::topology::Mesh;
use super::super::definition::{Pending, Row};
use super::super::sets::Named;
use super::super::surfaces::{Surface, Surfaces, nodes};

/// All named items of the file.
pub(in super::super) struct Lookup<'a> {
    pub(in super::super) source: FileBytes<'a>,
    pub(in super::super) named: &'a Named<'a>,
    pub(in super::super) surfaces: &'a Surfaces<'a>,
    /// Nodes of the mass elements, by the name of their element set in capitals, preceded by that of the instance.
    pub(in super::super) mass_elements: &'a BTreeMap<String, Vec<u64>>,
    /// Returns the index of a node from its label (number and instance).
    pub(in super::super) index: &'a dyn Fn(u64) -> Option<usize>,
    pub(in super::super) instances: &'a [String],
}

impl Lookup<'_> {
    pub(super) fn place(&self, row: &Row) -> String {
        self.source.at_line(row.line)
    }

    /// Nodes of a set, or the node with this number; ascending.
    pub(super) fn nodes(&self, text: &Pending, row: &Row, name: &str) -> Result<Vec<usize>, MeshError> {
        nodes(self.named, name, text.within).filter(|nodes| !nodes.is_empty()).ok_or_else(|| {
            let expected = "a node, or a node set with nodes, of this file";
            self.source.malformed(self.place(row), format!("{name:?}"), expected)
        })
    }

    /// The single node that a parameter names.
    pub(super) fn reference(&self, text: &Pending, parameter: &str) -> Result<usize, MeshError> {
        let name = text.keyword.required(self.source, parameter)?;
        match nodes(self.named, name, text.within).as_deref() {
            Some([node]) => Ok(*node),
            Some(several) => {
                let found = format!("{parameter}={name}, a set of {} nodes", several.len());
                Err(self.source.malformed(text.keyword.place(self.source), found, "one node"))
            }
            None => {
                let found = format!("{parameter}={name}");
                Err(self.source.malformed(
                    text.keyword.place(self.source),
                    found,
                    "a node or node set of this file",
                ))
            }
        }
    }

    /// Surface of this name, or a node set as a surface without faces.
    pub(super) fn surface(&self, mesh: &Mesh, text: &Pending, name: &str) -> Result<Surface, MeshError> {
        if let Some(surface) = self.surfaces.find(mesh, self.named, name, text.within)? {
            return Ok(surface);
        }
        let nodes = nodes(self.named, name, text.within);
        nodes.map(|nodes| Surface { nodes, ..Surface::default() }).ok_or_else(|| {
            let expected = "a *SURFACE or node set of this file";
            self.source.malformed(text.keyword.place(self.source), format!("the name {name:?}"), expected)
        })
    }

    /// Number in field `at` of a row.
    pub(super) fn number(&self, row: &Row, at: usize, what: &str) -> Result<f64, MeshError> {
        let text = row.fields.get(at).map(String::as_str).unwrap_or_default();
        let value = text.parse().or_else(|_| text.to_ascii_lowercase().replacen('d', "e", 1).parse::<f64>());
        value.ok().filter(|value| value.is_finite()).ok_or_else(|| {
            self.source.malformed(self.place(row), format!("{text:?}"), format!("{what}: a finite number"))
        })
    }

    /// Component 0 to 5, which the file writes as 1 to 6.
    pub(super) fn component(&self, row: &Row, at: usize) -> Result<usize, MeshError> {
        let text = row.fields.get(at).map(String::as_str).unwrap_or_default();
        let value = text.parse::<usize>().ok().filter(|value| (1..=6).contains(value));
        value.map(|value| value - 1).ok_or_else(|| {
            self.source.malformed(
                self.place(row),
                format!("the degree of freedom {text:?}"),
                "a number from 1 to 6",
            )
        })
    }

    /// Components from the one in field `at` of a row to the one in the next field; where that is empty, the one alone.
    pub(super) fn components(&self, row: &Row, at: usize) -> Result<RangeInclusive<usize>, MeshError> {
        let first = self.component(row, at)?;
        let given = row.fields.get(at + 1).is_some_and(|field| !field.is_empty());
        let last = if given { self.component(row, at + 1)? } else { first };
        if last < first {
            let found = format!("degrees of freedom from {} to {}", first + 1, last + 1);
            return Err(self.source.malformed(self.place(row), found, "first <= last"));
        }
        Ok(first..=last)
    }

    /// Name of the constraint for messages: keyword, own name and place.
    pub(super) fn title(&self, text: &Pending, parameter: &str) -> String {
        let keyword = &text.keyword;
        let own = keyword.value(parameter).map(|name| format!(" `{name}`")).unwrap_or_default();
        format!("*{}{own} of {}", keyword.name, keyword.place(self.source))
    }
}
