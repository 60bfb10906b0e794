//! The paper's beam in one configuration, with its named modes.

use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{NamedMode, NamedModes, Structure, paper};

use crate::error::Error;

/// Number of elastic modes among which the bending modes are found by name. Bending 3 is the third elastic mode, but further modes cost little, and
/// another mesh may place torsion below it; the names of the first eight modes stand in the results.
const NAMED: usize = 40;

/// The beam with its modes, all joints stuck and all slipping.
#[derive(Debug)]
pub struct PaperBeam {
    /// The configuration: one of two choices for what the paper leaves open.
    pub configuration: Configuration,
    /// All elastic modes that were computed.
    pub modes: NamedModes,
    /// Bending modes 1 to 3.
    pub bending: Vec<NamedMode>,
}

/// The name of a configuration: `A` or `B`.
#[must_use]
pub const fn letter(configuration: Configuration) -> &'static str {
    match configuration {
        Configuration::A => "A",
        Configuration::B => "B",
    }
}

impl PaperBeam {
    /// The beam as the paper describes it ([`paper::structure`] with 1,554 nodes).
    ///
    /// # Errors
    /// [`Error::Structure`].
    pub fn new(configuration: Configuration) -> Result<Self, Error> {
        Self::prepared(configuration, |_| ())
    }

    /// The beam after `prepare` has changed the structure, for example by adding node sets for sensors.
    pub(crate) fn prepared(
        configuration: Configuration,
        prepare: impl FnOnce(&mut Structure),
    ) -> Result<Self, Error> {
        let failed = Error::structure(&title(configuration));
        let mut structure = paper::structure(configuration, 1).map_err(&failed)?;
        prepare(&mut structure);
        let modes = NamedModes::new(&structure, NAMED).map_err(&failed)?;
        let bending = modes.first_bending();
        Ok(Self { configuration, modes, bending })
    }

    /// Name in messages: `configuration A`.
    pub(crate) fn title(&self) -> String {
        title(self.configuration)
    }
}

fn title(configuration: Configuration) -> String {
    format!("configuration {}", letter(configuration))
}
