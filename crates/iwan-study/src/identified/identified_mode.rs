//! A mode identified from one or several records, with everything that is shown of it.

use iwan_ident::curves::{Curves, ForceAxis};
use iwan_ident::density::{Evidence, FreeForm, density};
use iwan_ident::identify::Identification;
use iwan_machine::threads::{at_once, in_parallel};
use iwan_sim::Mode;

use super::comparison::{Comparison, RecordOfMode};
use super::ring_down::released;
use crate::error::Error;

/// A mode with all results of its identification.
#[derive(Debug, Clone)]
pub struct IdentifiedMode {
    /// Name.
    pub name: String,
    /// Parameters, intervals, verdict.
    pub found: Identification,
    /// Curves of each record, on the chosen axis of force.
    pub curves: Vec<Curves>,
    /// Free-form densities of slider strengths: fitted to frequency and dissipation together, and to dissipation alone.
    pub densities: Vec<FreeForm>,
    /// Record and model at the same times, one comparison per record.
    pub comparisons: Vec<Comparison>,
}

impl IdentifiedMode {
    /// Adds curves, densities and comparisons to what `iwan_ident::identify` found in these records, given in the same order.
    ///
    /// # Errors
    /// [`Error::Identification`] for the axis, [`Error::Simulation`] where the model cannot ring down.
    ///
    /// ```
    /// use iwan_core::{FourParameter, Pulse};
    /// use iwan_ident::curves::{ForceAxis, Quantity};
    /// use iwan_ident::identify::{Settings, ModeRecord, identify};
    /// use iwan_ident::signal::{Method, Options, isolate};
    /// use iwan_sim::{JointLaw, Mode, simulate};
    /// use iwan_study::identified::{IdentifiedMode, RecordOfMode};
    /// // Half a second of mode 1 of the paper's Table 2, from the onset of macro-slip on, at 10 kHz.
    /// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    /// let mode = Mode { initial: iwan_core::Motion::held_at(joint.phi_max()), ..Mode::new("first", 124.0, Some(JointLaw::FourParameter(joint))) };
    /// let half_cycles = iwan_sim::Settings { method: iwan_sim::Method::HalfCycle, ..iwan_sim::Settings::new(1e-4, 0.5) };
    /// let samples = simulate(&mode, &Pulse::None, &half_cycles)?.acceleration;
    /// let source = ModeRecord { samples: &samples, dt: 1e-4, quantity: Quantity::Acceleration };
    /// let options = Options::default();
    /// let isolated = isolate(&samples, 1e-4, &options)?;
    /// let found = identify(&[source], &Settings { options, method: Method::Hilbert, held: vec![] })?;
    /// let record = RecordOfMode { source, isolated: &isolated, start: 0.0 };
    /// let identified = IdentifiedMode::new("first", &[record], ForceAxis::Modal, found)?;
    /// // The record is the model's own ring-down.
    /// assert!(identified.comparisons[0].relative() < 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        name: &str,
        records: &[RecordOfMode<'_>],
        axis: ForceAxis,
        found: Identification,
    ) -> Result<Self, Error> {
        let on_axis = |c: &Curves| c.clone().on_axis(axis);
        let curves = found.curves.iter().map(on_axis).collect::<Result<Vec<_>, _>>();
        let curves = curves.map_err(Error::identification(name))?;
        // A density that does not explain the record says so by its misfit; where none can be computed, it is missing from the list.
        let evidence = [Evidence::Both, Evidence::Dissipation];
        let one = |evidence: &Evidence| density(&found.curves, *evidence).ok();
        let densities = in_parallel(&evidence, at_once(), &one).into_iter().flatten().collect();
        let numbered: Vec<_> = records.iter().enumerate().collect();
        let one = |(n, record): &(usize, &RecordOfMode<'_>)| Comparison::new(name, record, &found, *n);
        let comparisons = in_parallel(&numbered, at_once(), &one).into_iter().collect::<Result<Vec<_>, _>>();
        let comparisons = comparisons.map_err(Error::simulation(name))?;
        Ok(Self { name: name.to_owned(), found, curves, densities, comparisons })
    }

    /// Index of the record with the largest initial amplitude of the mode.
    #[must_use]
    pub fn loudest(&self) -> usize {
        let starts = &self.found.refined.starts;
        let size = |n: usize| starts[n].displacement.abs();
        (0..starts.len()).max_by(|&i, &j| size(i).total_cmp(&size(j))).unwrap_or(0)
    }

    /// The mode, released with the amplitude at which a record begins.
    ///
    /// # Errors
    /// [`iwan_core::Error::OutOfRange`] where the parameters make no joint.
    ///
    /// # Panics
    /// Where there is no record of this index.
    pub fn mode(&self, record: usize) -> Result<Mode, iwan_core::Error> {
        released(&self.name, &self.found.parameters, self.found.refined.starts[record].displacement)
    }
}
