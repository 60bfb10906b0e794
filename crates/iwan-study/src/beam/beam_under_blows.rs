//! The paper's beam with its discrete joints under blows of all levels: the truth with which modal models are compared.

use iwan_core::Progress;
use iwan_fem::StructureResponse;
use iwan_fem::mesh::beam::Configuration;

use super::filter_quality::FilterQuality;
use super::paper_beam::PaperBeam;
use super::runs::{ReductionError, Responses, Runs};
use crate::error::Error;

/// One configuration of the beam with its responses.
#[derive(Debug)]
pub struct BeamUnderBlows {
    /// The beam and its modes.
    pub beam: PaperBeam,
    /// Mean mass-normalised shape of each bending mode at the loaded edge.
    pub tip: Vec<f64>,
    /// One response for each of the [`LEVELS`](crate::blows::LEVELS); the outputs are the bending modes' coordinates.
    pub responses: Vec<StructureResponse>,
    /// The response to the blow of 1000 lbf of a reduced model without attachment vectors, which shows the error that their omission makes.
    pub without_attachments: StructureResponse,
    /// Ring-downs that start in one bending mode alone, with the largest velocity that the mode has after a blow of 100 lbf.
    pub alone: Vec<StructureResponse>,
    /// Differences of the reduced model from the full one, at two levels.
    pub reduction: Vec<ReductionError>,
    /// Rank and condition of modal filters for the modes of the reduced beam.
    pub filters: Vec<FilterQuality>,
}

impl BeamUnderBlows {
    /// Computes a configuration; `progress` receives the share done and may stop the work.
    ///
    /// # Errors
    /// [`Error::Structure`], and [`Error::Interrupted`].
    pub fn new(configuration: Configuration, progress: Progress<'_>) -> Result<Self, Error> {
        let beam = PaperBeam::new(configuration)?;
        let found = Runs::new(&beam, progress).and_then(|runs| runs.all());
        let found = found.map_err(Error::structure(&beam.title()))?;
        let Responses { tip, blows, without_attachments, alone, reduction, filters } = found;
        Ok(Self { beam, tip, responses: blows, without_attachments, alone, reduction, filters })
    }

    /// Largest error of the energy balance over all blows, relative to the largest energy in the response.
    #[must_use]
    pub fn energy_error(&self) -> f64 {
        self.responses.iter().map(|response| response.energy.error()).fold(0.0, f64::max)
    }
}
