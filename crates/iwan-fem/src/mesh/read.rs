//! Reading of a mesh in any of the formats.

use std::path::Path;

use super::error::MeshError;
use super::file::{FileBytes, MeshFile, expand, quote};
use super::{abaqus, gmsh, nastran};

/// Reads a mesh: Gmsh MSH 4.1 or 2.2 (ASCII or binary), Abaqus input, or Nastran bulk data. The format is recognised from the content or,
/// if that is not conclusive, from the extension.
///
/// Elements: hexahedra of 8 and 20, tetrahedra of 4 and 10, wedges of 6 and 15 nodes, also mixed. Gmsh: a physical group of volumes gives a
/// set of elements and a set of their nodes; a group of points, curves or surfaces gives a set of nodes. Abaqus: nodes, elements (C3D8 and
/// its variants, C3D20, C3D4, C3D10, C3D6, C3D15), sets, surfaces, parts with their instances, includes, ties, couplings, equations, rigid
/// bodies, boundary conditions, masses, materials with their sections. Nastran: grids in any system, solid elements, RBE2, RBE3, MPC, SPC,
/// CONM2, MAT1. Contents that leave the model as it is, by a list, are passed over with a remark; everything else is refused by name.
///
/// Memory: at most 160 bytes per byte of the file, plus 64 KiB. Memory is never allocated by a count that a file merely states.
///
/// # Errors
/// [`MeshError`] with the file, the place in it, what is there, what is allowed and what helps.
pub fn read(path: impl AsRef<Path>) -> Result<MeshFile, MeshError> {
    read_ignoring(path, &[])
}

/// [`read`], passing over the keywords `ignored` although they change the model; the caller must take care of their content. Each keyword
/// passed over in this way gives a warning.
///
/// # Errors
/// The errors of [`read`].
pub fn read_ignoring(path: impl AsRef<Path>, ignored: &[String]) -> Result<MeshFile, MeshError> {
    let file = path.as_ref();
    let bytes =
        iwan_machine::read_file(file).map_err(|source| MeshError::Io { file: file.into(), source })?;
    parse(file, &bytes, ignored, Some(file.parent().unwrap_or(Path::new(""))))
}

/// [`read`] from bytes in memory; `file` is used for its extension and for messages only.
///
/// # Errors
/// The errors of [`read`].
pub fn read_bytes(file: &Path, bytes: &[u8]) -> Result<MeshFile, MeshError> {
    parse(file, bytes, &[], None)
}

fn parse(
    file: &Path,
    bytes: &[u8],
    ignored: &[String],
    folder: Option<&Path>,
) -> Result<MeshFile, MeshError> {
    let source = FileBytes { file, bytes, pieces: &[] };
    let content = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    let bulk_data = ["bdf", "nas", "dat", "bulk", "blk"].iter().any(|known| extension == *known);
    let read = if content.starts_with(b"$MeshFormat") || extension == "msh" {
        gmsh::parse(source)
    } else if bulk_data || (extension != "inp" && nastran::is_bulk_data(content)) {
        let (bytes, pieces) = expand(source, folder, nastran::INCLUDE)?;
        nastran::parse(FileBytes { bytes: &bytes, pieces: &pieces, ..source }, ignored)
    } else if content.starts_with(b"$") {
        gmsh::parse(source)
    } else if content.starts_with(b"*") || extension == "inp" {
        let (bytes, pieces) = expand(source, folder, abaqus::INCLUDE)?;
        abaqus::parse(FileBytes { bytes: &bytes, pieces: &pieces, ..source }, ignored)
    } else {
        let found = format!("extension '{}', content {}", extension.display(), quote(content, 16));
        Err(MeshError::UnknownFormat { file: file.into(), found })
    }?;
    placed(source, read)
}

/// Refuses positions that are not finite. Coordinates in the file are finite, but coordinate systems and instances with very large numbers
/// can make positions overflow.
fn placed(source: FileBytes, read: MeshFile) -> Result<MeshFile, MeshError> {
    let mesh = &read.mesh;
    let lost = mesh.positions.iter().zip(&mesh.node_labels).find(|(p, _)| !p.iter().all(|x| x.is_finite()));
    let Some((position, label)) = lost else { return Ok(read) };
    let expected = "finite coordinates, with the systems and instances that they are in";
    Err(source.malformed(format!("node {label}"), format!("the position {position:?}"), expected))
}
