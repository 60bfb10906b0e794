//! Records of any origin, and what is identified from them: envelopes, curves, parameters with their intervals.

pub(crate) mod record;
pub(crate) mod reading;
pub(crate) mod mode_records;
pub(crate) mod envelope;
pub(crate) mod likelihood;
pub(crate) mod identified;
pub(crate) mod sweeps;
pub(crate) mod coupled_fit;
