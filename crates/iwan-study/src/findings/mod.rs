//! What is reproduced, what is not, and why: each finding with its computed numbers.

mod finding;
mod formulas;
mod eq_14;
mod bending_modes;
mod viscous_term;

use crate::error::Error;
use crate::reproduction::Reproduction;

pub use finding::{Finding, FindingKind, FindingNumber, bounds};

/// All findings; those about formulas come first.
///
/// # Errors
/// [`Error::Law`] and [`Error::Structure`] for invalid joints in the paper's tables: this does not happen.
pub fn findings(found: &Reproduction) -> Result<Vec<Finding>, Error> {
    let table_1 = iwan_fem::paper::joint().map_err(Error::structure("Table 1"))?;
    let mut findings =
        vec![formulas::eq_15(&table_1), formulas::eq_17(&table_1).map_err(Error::law("Table 2"))?];
    findings.extend(eq_14::eq_14(found));
    findings.extend(formulas::eqs_8_to_11(found));
    findings.extend([
        bending_modes::joint_stiffness(found),
        bending_modes::second_mode(found),
        bending_modes::slopes(found, &table_1),
        bending_modes::chi(found, &table_1),
        bending_modes::coupling(found),
        bending_modes::remedy(found),
        bending_modes::beta(found),
        bending_modes::figure_8(found),
        viscous_term::table_4(&found.laboratory),
    ]);
    Ok(findings)
}
