//! Finite-element truth model of bolted structures with discrete Iwan joints.
//!
//! The flow of data: [`mesh`] → matrices → modes → reduced model → joints → response → modal filter → record.
//! Units are the user's own consistent set.

// Ground floor, which the other modules use: errors, vectors and matrices.
mod error;
mod algebra;

// The structure: nodes and elements, the matrices of one element, the user's description of the whole.
pub mod mesh;
mod element;
mod structure;

// Equations: from the description to stiffness, mass and slips.
mod matrices;

// Linear vibration: all joints stuck, or all slipping.
mod modes;

// With friction: transients, static loads, and steady vibration.
mod transient;
mod quasi_static;
mod steady;

// Fits to measurements: joints and stiffness as unknowns, with derivatives.
mod adjust;

pub use adjust::{
    Adjustable, Adjusted, AdjustedMode, Blow, Correction, CurvePoint, InCoordinates, Kinematic, Stiffness,
    Struck,
};
pub use algebra::Symmetric;
pub use element::{ElementMatrices, Formulation, Inertia, Material};
pub use error::Error;
pub use matrices::{Assembled, SlipUnknown, Unknown};
pub use modes::{Class, JointMode, Limit, ModalFilter, Modes, NamedMode, NamedModes};
pub use quasi_static::{ModalCurves, QuasiStatic, SlipFlexibility, SlipGroup, SlipStatics};
pub use steady::{SteadyCoordinate, SteadyModel, SteadySlip};
pub use structure::{
    Given, Interface, Joint, Kept, KeptModes, Law, Lump, Patch, Recovered, RelativeSlip, Row, Slip,
    Structure, Support, check, paper,
};
pub use transient::{
    Basis, BasisError, Converged, Extras, Frame, History, Integrated, ModalVelocity, Model, Output, Reduced,
    Run, SlipHistory, StepErrors, StructureResponse, Transient, Watch,
};

// How joints are evaluated in time, and how long work tells of itself, is the same for a mode and for a structure.
pub use iwan_core::{Progress, Representation};
