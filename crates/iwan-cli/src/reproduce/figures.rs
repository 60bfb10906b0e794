//! All figures of the report.

use iwan_study::Reproduction;

use super::plate::Plate;
use super::{blow_figures, laboratory_figures, schematics};

/// All figures, in the order of the report.
pub(super) fn plates(found: &Reproduction) -> Vec<Plate> {
    let mut plates = schematics::plates();
    plates.extend(found.configurations.iter().flat_map(blow_figures::plates));
    plates.extend(laboratory_figures::plates(&found.laboratory));
    plates
}
