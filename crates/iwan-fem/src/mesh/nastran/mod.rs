//! Nastran bulk data in small, large and free fields (MSC Nastran Quick Reference Guide).
//!
//! The cards `GRID` with `CORD2R`, `CORD2C` and `CORD2S`, `CHEXA`, `CPENTA`, `CTETRA`, `PSOLID` with `MAT1`, `RBE2`, `RBE3`, `MPC`,
//! `CONM2`, `SPC` and `SPC1` are read. Cards that leave the model as it is are passed over with a remark. All other cards are refused by
//! name, unless the user lets them be ignored.

mod include;
mod card;
mod known;
mod systems;
mod reader;
mod grids;
mod elements;
mod connections;

use std::collections::BTreeMap;

use super::error::{MeshError, MeshWarning};
use super::file::{FileBytes, MeshFile};
use super::topology::Mesh;
use card::Cards;
use grids::Grids;
use reader::Reader;

pub(in crate::mesh) use include::INCLUDE;

/// Whether a text looks like bulk data: it contains `BEGIN BULK` first, or its first card occurs only in bulk data and its control
/// sections.
pub(super) fn is_bulk_data(bytes: &[u8]) -> bool {
    const FIRST: [&str; 8] = ["GRID", "CEND", "SOL ", "SOL,", "CORD2", "CHEXA", "CTETRA", "BEGIN"];
    let lines = bytes.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    let first = lines.clone().find(|line| !line.starts_with(b"$"));
    let first = first.map(|line| String::from_utf8_lossy(&line[..line.len().min(8)]).to_uppercase());
    first.is_some_and(|word| FIRST.iter().any(|known| word.starts_with(known)))
}

/// Mesh and remarks from bulk data with all includes inserted; `ignored` are names of cards that are passed over although they change the
/// model.
pub(super) fn parse(source: FileBytes, ignored: &[String]) -> Result<MeshFile, MeshError> {
    let bytes = include::without_tabs(source.bytes);
    let source = FileBytes { bytes: &bytes, ..source };
    let ignored: Vec<String> = ignored.iter().map(|name| name.trim().to_uppercase()).collect();
    let mut reader = Reader::default();
    let mut cards = Cards::new(source);
    while let Some(card) = cards.next()? {
        reader.card(source, card, &ignored)?;
    }
    let selected = cards.selected;
    let systems = systems::resolve(source, &reader.systems)?;
    let mut mesh = Mesh::default();
    let grids = Grids::read(source, &reader, &systems, &mut mesh)?;
    let sections = elements::read(source, &reader, &grids, &mut mesh)?;
    let (constraints, masses) = connections::read(source, &reader, &selected, &systems, &grids, &mesh)?;
    let seen = |list: &BTreeMap<String, (usize, usize)>, ignored: bool| -> Vec<MeshWarning> {
        let warning = |(name, (line, times)): (&String, &(usize, usize))| {
            let (name, place, times) = (name.clone(), source.at_line(*line), *times);
            if ignored {
                MeshWarning::Ignored { name, place, times }
            } else {
                MeshWarning::PassedOver { name, place, times }
            }
        };
        list.iter().map(warning).collect()
    };
    let mut warnings = seen(&reader.passed_over, false);
    warnings.extend(seen(&reader.ignored, true));
    Ok(MeshFile { mesh, warnings, constraints, masses, sections })
}
