//! The output of a coupled fit: summary, scenario and page.

use iwan_ident::coupled::{CoupledFit, CoupledRecord};
use iwan_input::scenario::to_toml;

use super::figures::figures;
use super::records::Measured;
use super::report::render;
use super::scenario::scenario;
use super::summary::CoupledSummary;

/// The outputs of one fit as texts.
#[derive(Debug)]
pub(crate) struct CoupledResults {
    pub(crate) summary: CoupledSummary,
    pub(super) toml: String,
    pub(crate) page: String,
}

impl CoupledResults {
    /// Makes the outputs from the measured records and the fit.
    pub(crate) fn new(measured: &Measured, found: &CoupledFit) -> Self {
        let names: Vec<String> = measured.modes.iter().map(|m| m.name.clone()).collect();
        let files = |records: &[CoupledRecord]| records.iter().map(|r| r.name.clone()).collect::<Vec<_>>();
        let (fitted, held_out) = (files(&measured.records), files(&measured.held_out));
        let summary = CoupledSummary::new(found, &names, [fitted, held_out], measured.warnings.clone());
        let scenario = scenario(&summary.title, found, &names, &measured.records, measured.seen);
        let toml = to_toml(&scenario, "");
        let all: Vec<CoupledRecord> = measured.records.iter().chain(&measured.held_out).cloned().collect();
        let drawn = figures(found, &all, &names, measured.quantity);
        let motions: usize = measured.records.iter().map(|r| r.motions.len()).sum();
        let page = render(&summary, [&drawn[..motions], &drawn[motions..]], &toml);
        Self { summary, toml, page }
    }
}
