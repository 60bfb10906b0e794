//! Cards that may be passed over, and remedies for cards that may not.

use crate::mesh::error::remedy_among;

/// Cards that leave nodes, elements, stiffness, mass and connections as they are: choices of the analysis, loads, tables, and sets for
/// these.
static HARMLESS: &[&str] = &[
    "EIGRL", "EIGR", "EIGB", "EIGC", "LOAD", "FORCE", "FORCE1", "FORCE2", "MOMENT", "PLOAD", "PLOAD1",
    "PLOAD2", "PLOAD4", "GRAV", "RFORCE", "TEMP", "TEMPD", "DLOAD", "DAREA", "DELAY", "DPHASE", "RLOAD1",
    "RLOAD2", "TLOAD1", "TLOAD2", "TABLED1", "TABLED2", "TABLED3", "TABLED4", "TABLEM1", "TABDMP1", "FREQ",
    "FREQ1", "FREQ2", "FREQ3", "FREQ4", "TSTEP", "TSTEPNL", "NLPARM", "SET1", "SET3", "ASET", "ASET1",
    "BSET", "BSET1", "CSET", "CSET1", "QSET", "QSET1", "OMIT", "OMIT1", "TSTEP1", "LSEQ", "MATT1", "PLOTEL",
    "DTI", "ECHOON", "ECHOOFF", "MDLPRM", "CORD3G", "RANDPS", "RANDT1", "TABRND1", "USET", "USET1", "SUPORT",
    "SUPORT1", "SPCD", "PLOTEL3", "PLOTEL4", "PLOTEL6", "PLOTEL8", "EIGP", "TABLES1", "TABLEST", "TEMPRB",
    "TEMPP1", "NLPCI", "NLPARM1", "MODTRAK", "SWLDPRM",
    // Materials for heat, and properties of elements that are refused themselves.
    "MAT4", "MAT5", "MATT4", "PSHELL", "PCOMP", "PCOMPG", "PBAR", "PBARL", "PBEAM", "PBEAML", "PROD", "PTUBE",
    "PSHEAR", "PBUSH", "PBUSHT", "PELAS", "PELAST", "PDAMP", "PVISC", "PGAP", "MAT2", "MAT8",
];

/// Cards that change the model, each with a remedy.
static CHANGES: &[(&str, &str)] = &[
    ("INCLUDE", "write it as INCLUDE 'FILE' on a line of its own"),
    ("CROD", "rods come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CONROD", "rods come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CQUAD8", "shells come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CTRIA6", "shells come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CQUADR", "shells come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CTRIAR", "shells come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CPYRAM", "mesh with hexahedra, wedges or tetrahedra"),
    ("CPYRA", "mesh with hexahedra, wedges or tetrahedra"),
    ("CQUAD4", "shells come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CTRIA3", "shells come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CBAR", "beams come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CBEAM", "beams come in as matrices: export K and M (DMIG or OP4) and give [matrices]"),
    ("CBUSH", "joints are [[joint]], springs to the ground [[lump]] in the structure file"),
    ("CELAS1", "joints are [[joint]], springs to the ground [[lump]] in the structure file"),
    ("CELAS2", "joints are [[joint]], springs to the ground [[lump]] in the structure file"),
    ("RBAR", "say the same with RBE2"),
    ("RBE1", "say the same with RBE2"),
    ("CORD1R", "say the same with CORD2R"),
    ("CORD1C", "say the same with CORD2C"),
    ("CORD1S", "say the same with CORD2S"),
    ("CONM1", "say the same with CONM2"),
    ("DMIG", "matrices come in by [matrices]"),
];

/// Whether a card may be passed over.
pub(super) fn is_harmless(name: &str) -> bool {
    HARMLESS.contains(&name)
}

/// A remedy for a card that may not be passed over.
pub(super) fn remedy(name: &str) -> String {
    remedy_among(CHANGES, name)
}
