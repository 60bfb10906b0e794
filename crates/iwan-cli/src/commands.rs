//! One file per subcommand.

pub(crate) mod completions;
pub(crate) mod envelope;
pub(crate) mod fit;
pub(crate) mod man;
pub(crate) mod modes;
pub(crate) mod quasi_static;
pub(crate) mod scenario;
pub(crate) mod simulate;
