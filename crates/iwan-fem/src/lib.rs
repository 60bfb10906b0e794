//! Finite-element truth model of bolted structures with discrete Iwan joints.
//!
//! The way of the data: [`mesh`] → matrices → modes → reduced model → joints → truth response → modal filter → record.
//! Units are the user's own consistent set.

pub mod mesh;
