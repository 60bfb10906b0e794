//! Quasi-static modal curves of a structure: `Structure.quasi_static`.

use iwan_fem::{ModalCurves, NamedModes};
use iwan_ident::static_fit::{StaticCurves, StaticFit, fit_static};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::{fem, value};
use crate::exchange::named;
use crate::exchange::work::{self, Control};
use crate::structures::structure::{Loaded, Structure};

/// Curves of one mode with the parameters fitted to them.
struct Analysed {
    name: String,
    frequency_stuck: f64,
    frequency_slipping: f64,
    k_t: f64,
    mac: f64,
    curves: ModalCurves,
    slips: Vec<String>,
    whole: bool,
    fit: Result<StaticFit, String>,
}

/// The amplitudes at which the curves are wanted.
enum Range {
    At(Vec<f64>),
    Points(usize),
}

/// Quasi-static curves of a mode, as a dict.
#[pyfunction]
pub(crate) fn _quasi_static<'py>(
    structure: &Bound<'py, Structure>,
    #[pyo3(from_py_with = named::mode)] mode: &str,
    displacement: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::points)] points: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (py, this) = (structure.py(), structure.get().0.clone());
    let mut slips = this.file.structure.joints.iter().flat_map(|joint| &joint.slips);
    if slips.all(|slip| slip.law.is_none()) {
        let name = this.name();
        return Err(value(format!(
            "{name}: the structure has no joint with a law: its modes are linear; add [[joint]] with slip and law"
        )));
    }
    let range = match displacement {
        Some(given) => Range::At(Numbers::vector("displacement", given)?),
        None => Range::Points(points),
    };
    let (loaded, mode) = (this.clone(), mode.to_owned());
    let analysed = work::run(py, true, move |control| analyse(&loaded, &mode, range, control))?;
    told(py, analysed.map_err(|error| fem(this.name(), &error))?)
}

fn analyse(
    loaded: &Loaded,
    name: &str,
    range: Range,
    control: &Control,
) -> Result<Analysed, iwan_fem::Error> {
    let modes = loaded.named_modes(NamedModes::LOOKED_UP, control)?;
    let mode = modes.named(name)?;
    let (displacements, all) = match range {
        Range::At(given) => (given, true),
        Range::Points(points) => (modes.amplitudes(mode, (None, None), points)?, false),
    };
    let curves = modes.static_curves(mode, &displacements, all)?;
    let parts = StaticCurves {
        displacement: &curves.displacement,
        frequency: &curves.frequency,
        dissipation: &curves.dissipation,
    };
    let fit = fit_static(&parts, modes.frequency_stuck(mode), mode.pair.k_t);
    Ok(Analysed {
        name: mode.name.clone(),
        frequency_stuck: modes.frequency_stuck(mode),
        frequency_slipping: modes.frequency_slipping(mode),
        k_t: mode.pair.k_t,
        mac: mode.pair.mac,
        slips: modes.assembled.slips().iter().map(|slip| slip.name.clone()).collect(),
        whole: curves.displacement.len() == displacements.len(),
        fit: fit.map_err(|error| error.to_string()),
        curves,
    })
}

fn told(py: Python<'_>, found: Analysed) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", found.name)?;
    dict.set_item("frequency_stuck", found.frequency_stuck)?;
    dict.set_item("frequency_slipping", found.frequency_slipping)?;
    dict.set_item("k_t", found.k_t)?;
    dict.set_item("mac", found.mac)?;
    dict.set_item("whole", found.whole)?;
    let ModalCurves { displacement, force, frequency, dissipation, joint_force, slips } = found.curves;
    dict.set_item("displacement", array(py, displacement))?;
    dict.set_item("force", array(py, force))?;
    dict.set_item("frequency", array(py, frequency))?;
    dict.set_item("dissipation", array(py, dissipation))?;
    dict.set_item("joint_force", array(py, joint_force))?;
    let named = PyDict::new(py);
    for (name, slip) in found.slips.into_iter().zip(slips) {
        named.set_item(name, array(py, slip))?;
    }
    dict.set_item("slips", named)?;
    let fit = found.fit.as_ref().ok();
    let parameters =
        fit.map(|fit| (fit.parameters.k_t, fit.parameters.f_s, fit.parameters.chi, fit.parameters.beta));
    dict.set_item("parameters", parameters)?;
    dict.set_item("dissipation_misfit", fit.map(|fit| fit.dissipation_misfit))?;
    dict.set_item("frequency_misfit", fit.map(|fit| fit.frequency_misfit))?;
    dict.set_item("remark", found.fit.as_ref().err())?;
    Ok(dict)
}
