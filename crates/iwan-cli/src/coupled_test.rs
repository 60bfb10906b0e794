//! Records of several modes at once, handed over by other programs (the Python package): fitted and drawn as `iwan fit --coupled` does with files.

use std::sync::atomic::AtomicBool;

use iwan_core::Progress;
use iwan_ident::Error;
use iwan_ident::coupled::{CoupledFit, Seen};
use iwan_ident::curves::Quantity;
use iwan_ident::signal::Method;
use iwan_io::Record;
use iwan_machine::threads::at_once;

use crate::failure::Failure;
use crate::fit::{CoupledResults, Loaded, Measured};
use crate::records::{Recording, Shapes, Sought};
use crate::session::alone;

/// A record with the force that acted, where it is known.
#[derive(Debug, Clone)]
pub struct StruckRecord {
    /// Name of the record in messages and results.
    pub name: String,
    /// The measured channels.
    pub record: Record,
    /// What the channels measure: displacement, velocity or acceleration.
    pub quantity: Quantity,
    /// What had to be assumed about the record, in words.
    pub warnings: Vec<String>,
    /// Whether a window lies over the samples, as their file says.
    pub windowed: bool,
    /// Force at each sample; none for a free decay.
    pub force: Option<Vec<f64>>,
}

/// Which modes are to be found, and how they are told apart.
#[derive(Debug, Clone)]
pub struct ModesSought {
    /// Mass-normalised shapes, one row per mode with one value per channel. Without shapes there is one channel, which measures the sum of all modes.
    pub shapes: Option<Vec<Vec<f64>>>,
    /// Frequency of the mode of each row of `shapes`, Hz.
    pub frequencies: Option<Vec<f64>>,
    /// Frequency band of each mode, Hz.
    pub bands: Vec<(f64, f64)>,
    /// Rough frequency of each mode, Hz, where there are neither bands nor shapes.
    pub near: Vec<f64>,
    /// Method that extracts amplitude and frequency of each mode alone; the start values of the fit come from these curves.
    pub method: Method,
}

/// Several modes of several records, ready to be fitted.
#[derive(Debug, Clone)]
pub struct CoupledTest(Measured);

impl CoupledTest {
    /// Extracts the modes from the records that are fitted and from the `held_out` records, which are only predicted.
    ///
    /// # Errors
    /// A message in words where records, channels and modes do not fit together.
    pub fn new(
        records: Vec<StruckRecord>,
        held_out: Vec<StruckRecord>,
        sought: ModesSought,
    ) -> Result<Self, String> {
        made(records, held_out, sought).map(Self).map_err(|failure| failure.to_string())
    }

    /// Names of the modes, in their order.
    #[must_use]
    pub fn modes(&self) -> Vec<String> {
        self.0.modes.iter().map(|mode| mode.name.clone()).collect()
    }

    /// Measured motion of each mode, or of the one sensor, in the samples that are used: `[record][series][sample]`, the fitted records first, then
    /// the held-out ones.
    #[must_use]
    pub fn motions(&self) -> Vec<Vec<Vec<f64>>> {
        self.0.records.iter().chain(&self.0.held_out).map(|record| record.motions.clone()).collect()
    }

    /// Fits linear modes, modes with joints of their own and modes that share joints; results do not depend on `threads`.
    ///
    /// # Errors
    /// Those of [`fit_coupled`](iwan_ident::coupled::fit_coupled).
    pub fn fit(
        &self,
        shape_at_force: Option<&[f64]>,
        threads: usize,
        stopped: &AtomicBool,
        progress: Progress<'_>,
    ) -> Result<CoupledFit, Error> {
        self.0.fit(shape_at_force, threads, stopped, progress)
    }

    /// The text of `fit.json`, as `iwan fit --coupled` writes it.
    #[must_use]
    pub fn json(&self, fit: &CoupledFit) -> String {
        alone(&CoupledResults::new(&self.0, fit).summary)
    }

    /// The report of `iwan fit --coupled` as self-contained HTML.
    #[must_use]
    pub fn page(&self, fit: &CoupledFit) -> String {
        CoupledResults::new(&self.0, fit).page
    }
}

fn made(
    records: Vec<StruckRecord>,
    held_out: Vec<StruckRecord>,
    sought: ModesSought,
) -> Result<Measured, Failure> {
    if records.is_empty() {
        return Err(Failure::input("there is no record", "give at least one"));
    }
    let (fitted, held) = (loaded(records)?, loaded(held_out)?);
    let seen = if sought.shapes.is_some() { Seen::Modes } else { Seen::Sum };
    let channels = fitted[0].0.record.names().len();
    let method = sought.method;
    let shapes = sought.shapes.map(|rows| {
        if let Some(row) = rows.iter().find(|row| row.len() != channels) {
            let message = format!("a shape has {} values for {channels} channels", row.len());
            return Err(Failure::input(message, "give one value for each channel of the records"));
        }
        if let Some(all) = sought.frequencies.as_ref().filter(|all| all.len() != rows.len()) {
            let message = format!("{} frequencies for {} shapes", all.len(), rows.len());
            return Err(Failure::input(message, "give one for each"));
        }
        Ok(Shapes::given(rows, sought.frequencies))
    });
    let modes = Sought { shapes: shapes.transpose()?, bands: sought.bands, near: sought.near, mass: 1.0 };
    Measured::new(&fitted, &held, (seen, method), at_once(), |recordings| modes.modes(recordings))
}

fn loaded(records: Vec<StruckRecord>) -> Result<Vec<Loaded>, Failure> {
    let one = |given: StruckRecord| {
        let StruckRecord { name, record, quantity, warnings, windowed, force } = given;
        let samples = record.samples()[0].len();
        if let Some(force) = force.as_ref().filter(|force| force.len() != samples) {
            let message = format!("{name}: the force has {} samples, the record {samples}", force.len());
            return Err(Failure::input(message, "give the force on the clock of the motions"));
        }
        Ok((Recording { name, record, quantity, warnings, doubts: Vec::new(), windowed }, force))
    };
    records.into_iter().map(one).collect()
}
