//! Lists of the keywords that may be passed over, and of those that may not, with a remedy for each of the latter.
//!
//! A keyword that is on neither list is refused too: the reader passes over only what is known to leave nodes, elements, sets, stiffness
//! and mass unchanged.

use crate::mesh::error::remedy_among;

/// Keywords that leave nodes, elements, sets and connections unchanged: titles, properties of materials that are not used here, laws of
/// contact (contact itself is refused), amplitudes, and steps with their procedures, loads and outputs.
static HARMLESS: &[&str] = &[
    // Titles and printing.
    "HEADING",
    "PREPRINT",
    "FILE FORMAT",
    "RESTART",
    "PHYSICAL CONSTANTS",
    // Properties of materials beyond stiffness and density, which the model does not use.
    "EXPANSION",
    "CONDUCTIVITY",
    "SPECIFIC HEAT",
    "PLASTIC",
    "DAMPING",
    // Behaviour of a material beyond its linear stiffness.
    "CREEP",
    "RATE DEPENDENT",
    "CYCLIC HARDENING",
    "DAMAGE INITIATION",
    "DAMAGE EVOLUTION",
    // Laws of interaction, which matter only to contact (refused below), and curves over time.
    "SURFACE INTERACTION",
    "SURFACE BEHAVIOR",
    "FRICTION",
    "AMPLITUDE",
    "TIME POINTS",
    // Steps, procedures, loads and outputs: the command line and the structure file define the computation.
    "STEP",
    "END STEP",
    "STATIC",
    "FREQUENCY",
    "DYNAMIC",
    "MODAL DYNAMIC",
    "STEADY STATE DYNAMICS",
    "COMPLEX FREQUENCY",
    "MODAL DAMPING",
    "GLOBAL DAMPING",
    "DAMPING CONTROLS",
    "SELECT EIGENMODES",
    "CONTROLS",
    "SOLVER CONTROLS",
    "CLOAD",
    "DLOAD",
    "DSLOAD",
    "OUTPUT",
    "NODE OUTPUT",
    "ELEMENT OUTPUT",
    "CONTACT OUTPUT",
    "ENERGY OUTPUT",
    "MODAL OUTPUT",
    "NODE PRINT",
    "NODE FILE",
    "EL PRINT",
    "EL FILE",
    "ENERGY PRINT",
    "ENERGY FILE",
    "MODAL PRINT",
    "MODAL FILE",
    "MONITOR",
    "PRINT",
    "MATRIX GENERATE",
    "MATRIX OUTPUT",
    "SUBSTRUCTURE GENERATE",
    "SUBSTRUCTURE MATRIX OUTPUT",
    "SUBSTRUCTURE LOAD CASE",
    "RETAINED NODAL DOFS",
    "MATRIX ASSEMBLE",
    "INITIAL CONDITIONS",
    "TEMPERATURE",
    "BASE MOTION",
    "BUCKLE",
    "VISCO",
    "HEAT TRANSFER",
    "UNCOUPLED TEMPERATURE-DISPLACEMENT",
    "COUPLED TEMPERATURE-DISPLACEMENT",
    "GREEN",
    "SENSITIVITY",
    "OBJECTIVE",
    "DESIGN RESPONSE",
    "DESIGNVARIABLES",
    "DESIGN VARIABLES",
    "DFLUX",
    "CFLUX",
    "FILM",
    "RADIATE",
    "VIEWFACTOR",
    "SECTION PRINT",
    "SECTION FILE",
    "CONTACT PRINT",
    "CONTACT FILE",
    "RADIATION PRINT",
    "FILTER",
    "INTEGRATED OUTPUT",
    "INCREMENTATION OUTPUT",
];

/// Keywords that change the model, each with a remedy for the message.
static CHANGES: &[(&str, &str)] = &[
    ("INITIAL CONDITIONS", "stress in the unloaded structure stiffens it, which is not computed here"),
    ("SHELL SECTION", "shells come in by [matrices]"),
    ("BEAM SECTION", "beams come in by [matrices]"),
    ("MEMBRANE SECTION", "membranes come in by [matrices]"),
    ("KINEMATIC COUPLING", "say the same with *COUPLING and *KINEMATIC"),
    ("DISTRIBUTING COUPLING", "say the same with *COUPLING and *DISTRIBUTING"),
    ("EMBEDDED ELEMENT", "mesh the two parts with common nodes"),
    ("TRANSFORM", "give loads, supports and directions of slip in global axes in the structure file"),
    ("ORIENTATION", "materials are isotropic here: delete it where a section refers to it"),
    ("CONTACT", "friction is computed by [[joint]] in the structure file"),
    ("CONTACT PAIR", "friction is computed by [[joint]] in the structure file"),
    ("CLEARANCE", "friction is computed by [[joint]] in the structure file"),
    ("PRE-TENSION SECTION", "the preload of a bolt is part of the joint law: give it in [[joint]]"),
    ("ROTARY INERTIA", "model the body with elements, or leave it out"),
    ("SPRING", "springs to the ground are [[lump]] with stiffness in the structure file"),
    ("DASHPOT", "give the damping of the modes where the structure is simulated"),
    (
        "NONSTRUCTURAL MASS",
        "add the mass with [[lump]] in the structure file, or to the density of the material",
    ),
    ("MODEL CHANGE", "write the model as it is after the change"),
    ("NGEN", "let the preprocessor write all nodes out"),
    ("NFILL", "let the preprocessor write all nodes out"),
    ("NCOPY", "let the preprocessor write all nodes out"),
    ("NMAP", "let the preprocessor write all nodes out"),
    ("ELGEN", "let the preprocessor write all elements out"),
    ("ELCOPY", "let the preprocessor write all elements out"),
];

/// Whether a keyword may be passed over.
pub(super) fn is_harmless(name: &str) -> bool {
    HARMLESS.contains(&name)
}

/// Remedy for a keyword that may not be passed over.
pub(super) fn remedy(name: &str) -> String {
    remedy_among(CHANGES, name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_keyword_is_on_both_lists() {
        // Initial conditions other than stresses are harmless, so this keyword is on both lists.
        assert!(CHANGES.iter().all(|(name, _)| !is_harmless(name) || *name == "INITIAL CONDITIONS"));
        assert!(remedy("SPRING").starts_with("springs to the ground") && remedy("XYZ").contains("not known"));
    }
}
