//! All numbers of a reproduction, as `reproduce.json` holds them.

mod tables;
mod configuration;

use serde::Serialize;

use crate::error::Error;
use crate::findings::{Finding, findings};
use crate::laboratory::{LaboratorySummary, Table3Row, Table4Row};
use crate::reproduction::Reproduction;

pub use configuration::{
    ConfigurationSummary, LevelSummary, ModeSummary, NamedFrequency, StaticPoints, ZeroModes,
};
pub use tables::{JointParameters, Table1, Table2Row};

/// All results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Units of the truth and its modal models, and of the laboratory.
    pub units: [&'static str; 2],
    /// The discrete joint of the beam's interfaces (Table 1).
    pub table_1: Table1,
    /// The modal joints (Table 2).
    pub table_2: Vec<Table2Row>,
    /// The modes in the laboratory (Table 3).
    pub table_3: Vec<Table3Row>,
    /// Slopes of dissipation over force in the laboratory (Table 4).
    pub table_4: Vec<Table4Row>,
    /// One entry per configuration.
    pub truth: Vec<ConfigurationSummary>,
    /// The synthetic measurements.
    pub lab: LaboratorySummary,
    /// Findings: what is reproduced, what is not, and why.
    pub findings: Vec<Finding>,
}

impl Summary {
    /// Makes the summary of a reproduction.
    ///
    /// # Errors
    /// As [`findings`].
    pub fn new(found: &Reproduction) -> Result<Self, Error> {
        Ok(Self {
            units: [
                "lbf, in, s; modal quantities mass-normalised",
                "N, m, s; modal quantities mass-normalised",
            ],
            table_1: Table1::new()?,
            table_2: found.modes().map(Table2Row::new).collect(),
            table_3: found.laboratory.table_3.clone(),
            table_4: found.laboratory.table_4.clone(),
            truth: found.configurations.iter().map(ConfigurationSummary::new).collect(),
            lab: found.laboratory.summary(),
            findings: findings(found)?,
        })
    }
}
