//! The Python module `iwan._native`: every class and function wraps one of the libraries, and takes and returns NumPy arrays.
//!
//! It holds no physics and no defaults of its own. The Python package around it is in `python/iwan`, its interface in `_native.pyi`.

#![allow(
    clippy::doc_link_with_quotes,
    clippy::needless_pass_by_value,
    reason = "documentation of Python; arguments come from Python by value"
)]

// The basis: conversions between Python and Rust.
mod exchange;

// Values that users make, ring-downs of modes, and steady vibration of modes.
mod values;
mod ring_down;
mod steady;

// Records and what is identified from them; hammer hits; structures.
mod records;
mod modal;
mod structures;

// The reproduction of the paper, and the whole command line.
mod study;
mod command;

/// What `iwan` is made of; users import it from there.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::command::_command;
    #[pymodule_export]
    use crate::exchange::files::_write_text;
    #[pymodule_export]
    use crate::exchange::named::{_number, _numbers, _whole};
    #[pymodule_export]
    use crate::exchange::options::_ask;
    #[pymodule_export]
    use crate::modal::_modal_fit;
    #[pymodule_export]
    use crate::records::coupled_fit::{_fit_coupled, FittedCoupled};
    #[pymodule_export]
    use crate::records::envelope::{_envelope, _envelopes, Envelope, envelope};
    #[pymodule_export]
    use crate::records::identified::{_check_law, _identify, _identify_many, Identified};
    #[pymodule_export]
    use crate::records::likelihood::{_likelihood, Likelihood};
    #[pymodule_export]
    use crate::records::reading::{_read_bytes, _seconds_in, read_record};
    #[pymodule_export]
    use crate::records::record::{_record, Record};
    #[pymodule_export]
    use crate::records::sweeps::{_fit_sweeps, FittedSweeps};
    #[pymodule_export]
    use crate::ring_down::coupled::_simulate_coupled;
    #[pymodule_export]
    use crate::ring_down::ensemble::_ensemble;
    #[pymodule_export]
    use crate::ring_down::response::{_response, Response};
    #[pymodule_export]
    use crate::ring_down::simulate::{simulate, superpose};
    #[pymodule_export]
    use crate::steady::backbone::_backbone;
    #[pymodule_export]
    use crate::steady::coupled::{_backbone_coupled, _frf_coupled};
    #[pymodule_export]
    use crate::steady::frf::_frf;
    #[pymodule_export]
    use crate::structures::blow::_simulate_structure;
    #[pymodule_export]
    use crate::structures::static_curves::_quasi_static;
    #[pymodule_export]
    use crate::structures::steady::{_backbone_structure, _frf_structure};
    #[pymodule_export]
    use crate::structures::structure::{_built_in_structure, _load_structure, _structure, Structure};
    #[pymodule_export]
    use crate::structures::update::_update;
    #[pymodule_export]
    use crate::structures::written::{_write_matrices, _write_reduced};
    #[pymodule_export]
    use crate::study::_reproduce;
    #[pymodule_export]
    use crate::values::joint_face::Joint;
    #[pymodule_export]
    use crate::values::joint_laws::{
        _four_parameter, FiveParameter, FourParameter, Jenkins, Tabulated, Uniform,
    };
    #[pymodule_export]
    use crate::values::mode::Mode;
    #[pymodule_export]
    use crate::values::mode_curves::ModeCurves;
    #[pymodule_export]
    use crate::values::parts::{Coulomb, Part, Pinning, PowerDamping, Spring};
    #[pymodule_export]
    use crate::values::pulse::{HalfSine, Haversine, Pulse, Sampled, Sine, Step};

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "the name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
