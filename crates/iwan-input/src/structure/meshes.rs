//! `[mesh]`: a mesh file, the paper's beam, or a block.

use iwan_fem::mesh::beam::{Configuration, beam};
use iwan_fem::mesh::block::{block, uniform};
use iwan_fem::mesh::{self, Mesh, MeshFile};

use super::sets::triple;
use crate::error::InputError;
use crate::section::{Section, TableKind};
use crate::text::InputText;

/// The sources of meshes, with their keys.
pub(super) const KINDS: &[TableKind] = &[
    TableKind { name: "file", keys: &["path", "ignore"] },
    TableKind { name: "paper-beam", keys: &["configuration", "refinement"] },
    TableKind { name: "block", keys: &["size", "cells"] },
];

/// Largest number of elements that are generated: six million unknowns, whose factor would take some 200 GB (extrapolated from the growth
/// for cubes of up to 28,000 unknowns). A mesh with more is refused before it is made; a mesh from a file is limited by its reader only.
const MOST_ELEMENTS: f64 = 2e6;

/// Bytes of the factor of the paper's beam without refinement (0.35 million numbers). It grows with the fourth power of the refinement: the
/// number of unknowns in the cuts of nested dissection grows with its square, and the dense triangles of these cuts with the square of
/// that.
const BEAM_FACTOR: f64 = 2.8e6;
/// Least number of bytes for each element of a block: its share of stiffness, mass and factor where the block is slender. The factor of a
/// cube is larger; memory for it is asked for again when the order of elimination is known.
const BLOCK_FACTOR: f64 = 6e3;

/// The mesh with everything else that its file states, and the reader's remarks.
pub(super) fn read(source: &InputText, top: &Section<'_>) -> Result<(MeshFile, Vec<String>), InputError> {
    let Some(place) = top.optional_table("mesh")? else {
        let remedy =
            "add [mesh] with path = \"FILE.msh\" (Gmsh), \"FILE.inp\" (Abaqus) or \"FILE.bdf\" (Nastran)";
        return Err(top.failure("mesh", "the table [mesh] is missing", remedy));
    };
    let (section, kind) = Section::kind(source, "[mesh]", place, KINDS, Some("file"))?;
    match kind.name {
        "file" => from_file(source, &section),
        "paper-beam" => paper_beam(&section).map(alone),
        _ => brick(&section).map(alone),
    }
}

/// A mesh whose source states nothing else.
fn alone(mesh: Mesh) -> (MeshFile, Vec<String>) {
    (MeshFile::plain(mesh, Vec::new()), Vec::new())
}

fn from_file(source: &InputText, section: &Section<'_>) -> Result<(MeshFile, Vec<String>), InputError> {
    let path = source.folder.join(section.text("path")?);
    let ignored = if section.has("ignore") { section.texts("ignore")? } else { Vec::new() };
    let read = mesh::read_ignoring(&path, &ignored).map_err(|error| {
        section
            .failure(
                "path",
                &error.to_string(),
                "the path is relative to the structure file; Gmsh, Abaqus and Nastran bulk data are read",
            )
            .of(error.kind())
    })?;
    let notes = read.warnings.iter().map(|warning| format!("{}: {warning}", path.display())).collect();
    Ok((read, notes))
}

fn paper_beam(section: &Section<'_>) -> Result<Mesh, InputError> {
    let configurations = [("A", Configuration::A), ("B", Configuration::B)];
    let configuration = section.choice("configuration", &configurations)?.ok_or_else(|| {
        section.failure(
            "configuration",
            "the key `configuration` is missing",
            "add configuration = \"A\" or \"B\"",
        )
    })?;
    let refinement = section.optional_count("refinement")?.unwrap_or(1);
    // The beam has 662 elements without refinement: 640 of the beam itself, 14 of the link, 8 of the washers.
    let refined = refinement as f64;
    size(section, "refinement", 662.0 * refined.powi(3))?;
    memory(section, "refinement", BEAM_FACTOR * refined.powi(4))?;
    Ok(beam(configuration, refinement))
}

fn brick(section: &Section<'_>) -> Result<Mesh, InputError> {
    let (sides, cells) = (triple(section, "size")?, triple(section, "cells")?);
    if sides.iter().any(|side| *side <= 0.0) {
        let message = format!("size = {sides:?} is out of range: all three must be > 0");
        return Err(section.failure("size", &message, "give the three lengths of the block"));
    }
    if cells.iter().any(|count| *count < 1.0 || count.fract() != 0.0) {
        let message = format!("cells = {cells:?} is out of range: all three must be whole numbers >= 1");
        return Err(section.failure("cells", &message, "give the number of elements along each side"));
    }
    size(section, "cells", cells.iter().product())?;
    memory(section, "cells", BLOCK_FACTOR * cells.iter().product::<f64>())?;
    let lines = |axis: usize| uniform(0.0, sides[axis], cells[axis] as usize);
    Ok(block(&[lines(0), lines(1), lines(2)]))
}

fn size(section: &Section<'_>, key: &str, elements: f64) -> Result<(), InputError> {
    if elements <= MOST_ELEMENTS {
        return Ok(());
    }
    let message =
        format!("{key} would give {elements:.0} elements; at most {MOST_ELEMENTS:.0} are computed with");
    Err(section.failure(key, &message, "take a coarser mesh"))
}

/// Refuses a mesh whose matrices do not fit into memory, before it is made.
fn memory(section: &Section<'_>, key: &str, bytes: f64) -> Result<(), InputError> {
    let asked =
        iwan_machine::memory::ask(format!("{key}: the structure"), bytes as u64, "take a coarser mesh");
    asked.map_err(|short| {
        let InputError { message, remedy, kind } = short.into();
        section.failure(key, &message, &remedy).of(kind)
    })
}
