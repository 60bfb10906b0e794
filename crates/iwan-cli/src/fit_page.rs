//! `report.html` and `fit.json` of a fit that another program made with the library: those of `iwan fit`.

use iwan_ident::curves::Quantity;
use iwan_ident::identify::{Identification, Settings};
use iwan_input::scenario::to_toml;
use iwan_io::Record;
use iwan_machine::threads::at_once;

use crate::failure::Failure;
use crate::fit::{FitSummary, Reported, as_scenario, render};
use crate::identified::{Identified, extract};
use crate::records::{Axis, ModalRecord, Recording, Units, Wanted};
use crate::session::alone;

/// A record as the identification took it.
#[derive(Debug, Clone)]
pub struct FittedRecord {
    /// Name of the record on the page.
    pub name: String,
    /// Names of the channels from which the record was taken.
    pub channels: Vec<String>,
    /// Unit of the samples as text; empty where it is not known.
    pub unit: String,
    /// What was measured: displacement, velocity or acceleration.
    pub quantity: Quantity,
    /// Sampling interval, s.
    pub dt: f64,
    /// Time of the first sample, s.
    pub start: f64,
    /// Samples of the mode's record.
    pub samples: Vec<f64>,
}

/// A fit of one mode.
#[derive(Debug, Clone, Copy)]
pub struct FittedMode<'a> {
    /// The records.
    pub records: &'a [FittedRecord],
    /// The settings of the identification.
    pub settings: &'a Settings,
    /// The results of the identification.
    pub found: &'a Identification,
    /// Notes on how the channels were combined and what was assumed.
    pub notes: &'a [String],
    /// Whether the samples carry the root of a modal mass, as those of modal quantities do.
    pub mass_normalised: bool,
    /// Whether dissipation is drawn over the joint force in place of the modal force.
    pub joint_force: bool,
}

/// The page as self-contained HTML.
///
/// # Errors
/// A message in words: records that cannot be used, or a mode that cannot be drawn.
pub fn fit_page(mode: &FittedMode<'_>) -> Result<String, String> {
    page(mode).map_err(|failure| failure.to_string())
}

/// `fit.json`: everything that was found. `law` is the name of the law that was asked for in place of the chosen one.
///
/// # Errors
/// As [`fit_page`].
pub fn fit_json(mode: &FittedMode<'_>, law: Option<&str>) -> Result<String, String> {
    let Told { mut summary, .. } = Told::of(mode).map_err(|failure| failure.to_string())?;
    if let Some(law) = law {
        summary.modes.iter_mut().for_each(|mode| mode.law = Some(law.to_owned()));
    }
    summary.judge();
    Ok(alone(&summary))
}

/// What the page and the summary are made of.
struct Told {
    identified: [Identified; 1],
    summary: FitSummary,
    units: Units,
}

fn page(mode: &FittedMode<'_>) -> Result<String, Failure> {
    let Told { identified, summary, units } = Told::of(mode)?;
    let toml = to_toml(&as_scenario(&identified, &summary.title(), |_| None)?, "");
    Ok(render(&Reported { identified: &identified, summary: &summary, units: &units, toml: &toml }))
}

impl Told {
    fn of(mode: &FittedMode<'_>) -> Result<Self, Failure> {
        let recordings = mode
            .records
            .iter()
            .map(|record| recording(record, mode.settings.options.windowed))
            .collect::<Result<Vec<_>, _>>()?;
        let Some(first) = recordings.first() else {
            return Err(Failure::input("there is no record", "give at least one"));
        };
        let wanted = Wanted {
            name: "mode 1".into(),
            number: 0,
            options: mode.settings.options,
            records: (mode.records.iter().enumerate())
                .map(|(source, record)| ModalRecord { source, samples: record.samples.clone() })
                .collect(),
            notes: mode.notes.to_vec(),
        };
        let axis = if mode.joint_force { Axis::Joint } else { Axis::Modal };
        let extractions = extract(&recordings, &wanted, mode.settings.method, at_once())?;
        let identified = [Identified::of(&recordings, &wanted, extractions, axis, mode.found.clone())?];
        let units = Units::new(first.record.unit(), first.quantity, mode.mass_normalised);
        let mut summary = FitSummary::new(&recordings, &identified, axis, &units);
        for (told, record) in summary.records.iter_mut().zip(mode.records) {
            told.channels.clone_from(&record.channels);
        }
        Ok(Self { identified, summary, units })
    }
}

fn recording(record: &FittedRecord, windowed: bool) -> Result<Recording, Failure> {
    let quantity = match record.quantity {
        Quantity::Acceleration => iwan_io::Quantity::Acceleration,
        Quantity::Velocity => iwan_io::Quantity::Velocity,
        Quantity::Displacement => iwan_io::Quantity::Displacement,
    };
    let samples = Record::new(record.dt, vec![record.samples.clone()], vec![record.channels.join(", ")])
        .and_then(|samples| samples.with_start(record.start))
        .map_err(|error| Failure::said(&record.name, &error))?;
    let samples = samples.with_quantity(quantity, record.unit.clone());
    Ok(Recording {
        name: record.name.clone(),
        record: samples,
        quantity: record.quantity,
        warnings: Vec::new(),
        doubts: Vec::new(),
        windowed,
    })
}
