//! The Python module `iwan._native`: every class and function wraps one of the libraries, with NumPy arrays at the door.
//!
//! No physics and no defaults of its own. The package around it is in `python/iwan`, its contract in `_native.pyi`.

#![allow(
    clippy::doc_link_with_quotes,
    clippy::needless_pass_by_value,
    reason = "documentation of Python; arguments come from Python by value"
)]

mod array;
mod command;
mod ensemble;
mod envelope;
mod errors;
mod fit;
mod joint;
mod laws;
mod modal;
mod mode;
mod options;
mod pulse;
mod record;
mod repr;
mod response;
mod simulate;
mod static_curves;
mod structure;
mod truth;
mod work;

/// What `iwan` is made of; users import it from there.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::command::_command;
    #[pymodule_export]
    use crate::ensemble::_ensemble;
    #[pymodule_export]
    use crate::envelope::{_envelope, _envelopes, Envelope, envelope};
    #[pymodule_export]
    use crate::fit::{_identify, _identify_many, Identified, Likelihood};
    #[pymodule_export]
    use crate::joint::Joint;
    #[pymodule_export]
    use crate::laws::{_four_parameter, FourParameter, Jenkins, Tabulated, Uniform};
    #[pymodule_export]
    use crate::mode::Mode;
    #[pymodule_export]
    use crate::pulse::{HalfSine, Haversine, Pulse, Sampled, Sine, Step};
    #[pymodule_export]
    use crate::record::{_read_bytes, _record, Record, read_record};
    #[pymodule_export]
    use crate::response::{_response, Response};
    #[pymodule_export]
    use crate::simulate::{simulate, superpose};
    #[pymodule_export]
    use crate::static_curves::_quasi_static;
    #[pymodule_export]
    use crate::structure::{_built_in_structure, _load_structure, _structure, Structure};
    #[pymodule_export]
    use crate::truth::_simulate_structure;

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "the name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
