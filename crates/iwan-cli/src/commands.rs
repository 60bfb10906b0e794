//! One file per subcommand.

pub(crate) mod completions;
pub(crate) mod envelope;
pub(crate) mod fit;
pub(crate) mod man;
pub(crate) mod scenario;
pub(crate) mod simulate;
