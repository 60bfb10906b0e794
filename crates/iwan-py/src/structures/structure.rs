//! Finite-element structures with discrete joints, for `iwan.Structure`.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use iwan_fem::{Error, NamedModes};
use iwan_input::{InputText, ReducedFolder, StructureFile, built_in_structure};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exchange::array::{array, cube, frozen_rows};
use crate::exchange::errors::{fem, input, missing_file};
use crate::exchange::named;
use crate::exchange::pickle::Remake;
use crate::exchange::repr;
use crate::exchange::work::{self, Control};

/// What `iwan.Structure` is made of.
#[pyclass(frozen, module = "iwan._native", name = "_Structure")]
#[derive(Debug)]
pub(crate) struct Structure(pub(crate) Arc<Loaded>);

/// A structure file with the modes that were computed so far.
#[derive(Debug)]
pub(crate) struct Loaded {
    /// The text from which the structure was read.
    source: InputText,
    built_in: bool,
    /// The folder of the reduced model from which the structure was opened, if any.
    reduced: Option<PathBuf>,
    pub(crate) file: StructureFile,
    /// Modes by the number that was asked for. Each number has an entry of its own, so that the bits of modes do not depend on what was
    /// computed before.
    modes: Mutex<BTreeMap<usize, Arc<NamedModes>>>,
}

impl Loaded {
    fn read(source: InputText, built_in: bool) -> PyResult<Structure> {
        let file = StructureFile::read(&source).map_err(|error| input("", &error))?;
        Ok(Structure(Arc::new(Self { source, built_in, reduced: None, file, modes: Mutex::default() })))
    }

    /// Opens the folder of a reduced model.
    fn open_reduced(folder: PathBuf) -> PyResult<Structure> {
        let (source, file) = StructureFile::open_reduced(&folder).map_err(|error| input("", &error))?;
        let reduced = Some(folder);
        Ok(Structure(Arc::new(Self { source, built_in: false, reduced, file, modes: Mutex::default() })))
    }

    /// The text of the structure file.
    pub(crate) fn source(&self) -> &InputText {
        &self.source
    }

    /// Name for messages.
    pub(crate) fn name(&self) -> &str {
        &self.source.name
    }

    /// The first `count` elastic modes.
    pub(crate) fn named_modes(&self, count: usize, control: &Control) -> Result<Arc<NamedModes>, Error> {
        let known = |modes: &Mutex<BTreeMap<usize, Arc<NamedModes>>>| {
            modes.lock().unwrap_or_else(PoisonError::into_inner).get(&count).cloned()
        };
        if let Some(modes) = known(&self.modes) {
            return Ok(modes);
        }
        let modes = Arc::new(NamedModes::observed(&self.file.structure, count, &|_| control.stop())?);
        self.modes.lock().unwrap_or_else(PoisonError::into_inner).insert(count, modes.clone());
        Ok(modes)
    }
}

/// Reads a structure file.
#[pyfunction]
pub(crate) fn _load_structure(#[pyo3(from_py_with = named::path)] path: PathBuf) -> PyResult<Structure> {
    if let Err(error) = std::fs::metadata(&path) {
        return Err(missing_file(&path, &error));
    }
    if ReducedFolder::is_one(&path) {
        return Loaded::open_reduced(path);
    }
    let source = InputText::read(&path, "structure", "paper-a").map_err(|error| input("", &error))?;
    Loaded::read(source, false)
}

/// A structure that is built in.
#[pyfunction]
pub(crate) fn _built_in_structure(#[pyo3(from_py_with = named::name)] name: &str) -> PyResult<Structure> {
    Loaded::read(built_in_structure(name).map_err(|error| input("", &error))?, true)
}

/// Makes a pickled structure again, from the text of its file or the folder of its reduced model.
#[pyfunction]
pub(crate) fn _structure(
    #[pyo3(from_py_with = named::name)] name: String,
    #[pyo3(from_py_with = named::text)] text: String,
    #[pyo3(from_py_with = named::folder)] folder: PathBuf,
    #[pyo3(from_py_with = named::built_in)] built_in: bool,
    #[pyo3(from_py_with = named::reduced)] reduced: Option<PathBuf>,
) -> PyResult<Structure> {
    if let Some(folder) = reduced {
        return Loaded::open_reduced(folder);
    }
    Loaded::read(InputText { name, text, folder }, built_in)
}

#[pymethods]
impl Structure {
    /// What is known without any computation, as a dict.
    fn told<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (file, dict) = (&self.0.file, PyDict::new(py));
        let (structure, mesh) = (&file.structure, &file.structure.mesh);
        dict.set_item("name", self.0.name())?;
        dict.set_item("title", file.title.as_deref().unwrap_or(self.0.name()))?;
        dict.set_item("text", &self.0.source.text)?;
        dict.set_item("notes", &file.notes)?;
        let positions: Vec<Vec<f64>> = mesh.positions.iter().map(|p| p.to_vec()).collect();
        dict.set_item("nodes", frozen_rows(py, &positions)?)?;
        let faces = mesh.outer_faces().into_iter().map(|(_, corners)| corners.to_vec());
        dict.set_item("faces", faces.collect::<Vec<_>>())?;
        dict.set_item("elements", mesh.elements.len())?;
        dict.set_item("node_sets", mesh.node_sets.clone())?;
        dict.set_item("joints", names(structure.joints.iter().map(|joint| &joint.name)))?;
        dict.set_item("loads", names(file.loads.iter().map(|load| &load.name)))?;
        dict.set_item("outputs", names(file.outputs.iter().map(|output| &output.name)))?;
        Ok(dict)
    }

    /// The first `count` elastic modes, as a dict.
    fn modes<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = named::count)] count: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let this = self.0.clone();
        let modes = work::run(py, true, move |control| this.named_modes(count, control))?;
        let modes = modes.map_err(|error| fem(self.0.name(), &error))?;
        let dict = PyDict::new(py);
        let of_each =
            |f: &dyn Fn(&iwan_fem::NamedMode) -> f64| array(py, modes.elastic.iter().map(f).collect());
        dict.set_item("names", names(modes.elastic.iter().map(|mode| &mode.name)))?;
        dict.set_item("classes", modes.elastic.iter().map(|mode| mode.class.word()).collect::<Vec<_>>())?;
        dict.set_item("frequency", of_each(&|mode| modes.frequency_stuck(mode)))?;
        dict.set_item("frequency_slipping", of_each(&|mode| modes.frequency_slipping(mode)))?;
        dict.set_item("k_t", of_each(&|mode| mode.pair.k_t))?;
        dict.set_item("mac", of_each(&|mode| mode.pair.mac))?;
        dict.set_item("zero_modes", (modes.stuck.zero_modes(), modes.slipping.zero_modes()))?;
        let nodes = self.0.file.structure.mesh.positions.len();
        let shapes = |modes_of: &iwan_fem::Modes, index: &dyn Fn(&iwan_fem::NamedMode) -> usize| {
            let shape =
                |mode: &iwan_fem::NamedMode| modes.assembled.displacements(modes_of.shape(index(mode)));
            let values = modes.elastic.iter().flat_map(shape).collect();
            cube(py, [modes.elastic.len(), nodes, 3], values)
        };
        dict.set_item("shapes", shapes(&modes.stuck, &|mode| mode.pair.stuck)?)?;
        dict.set_item("shapes_slipping", shapes(&modes.slipping, &|mode| mode.pair.slipping)?)?;
        let (at_force, at_outputs) = self.at_ends(&modes)?;
        dict.set_item("shape_at_force", array(py, at_force))?;
        let outputs = PyDict::new(py);
        for (name, values) in at_outputs {
            outputs.set_item(name, array(py, values))?;
        }
        dict.set_item("outputs", outputs)?;
        dict.set_item("unknowns", modes.assembled.unknowns())?;
        dict.set_item("total_mass", modes.assembled.total_mass())?;
        dict.set_item("warnings", modes.warnings())?;
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let how = if self.0.built_in { "built_in" } else { "load" };
        format!("iwan.Structure.{how}({})", repr::text(self.0.name()))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remake<'py>> {
        let Loaded { source, built_in, reduced, .. } = &*slf.get().0;
        let arguments = (&source.name, &source.text, &source.folder, built_in, reduced);
        let made = slf.py().import("iwan._native")?.getattr("_structure")?;
        Ok((made, arguments.into_bound_py_any(slf.py())?))
    }
}

/// Values of the stuck mode shapes where the force acts, and at each output with its name.
type AtEnds = (Vec<f64>, Vec<(String, Vec<f64>)>);

impl Structure {
    fn at_ends(&self, modes: &NamedModes) -> PyResult<AtEnds> {
        let read = |coefficients: &[f64]| -> Vec<f64> {
            let value = |mode: &iwan_fem::NamedMode| {
                let shape = modes.stuck.shape(mode.pair.stuck);
                coefficients.iter().zip(shape).map(|(c, phi)| c * phi).sum()
            };
            modes.elastic.iter().map(value).collect()
        };
        let said = |error: &iwan_input::InputError| input(self.0.name(), error);
        let at_force = if self.0.file.loads.is_empty() {
            vec![0.0; modes.elastic.len()]
        } else {
            read(&self.0.file.forces(&modes.assembled).map_err(|error| said(&error))?)
        };
        let outputs = self.0.file.recorded(modes, &[]).map_err(|error| said(&error))?;
        Ok((at_force, outputs.into_iter().map(|o| (o.name, read(&o.coefficients))).collect()))
    }
}

fn names<'a>(all: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    all.map(String::as_str).collect()
}
