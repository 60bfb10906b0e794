//! Nastran: OP4 files and DMIG entries.

mod op4;
pub(crate) mod op4_text;
pub(crate) mod op4_binary;
pub(crate) mod dmig;
