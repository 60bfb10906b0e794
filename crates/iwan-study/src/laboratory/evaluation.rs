//! All hits together: what they say about joints and suspension.

use iwan_core::Progress;
use iwan_fem::NamedMode;
use iwan_ident::Parameters;
use iwan_ident::channels::ModalFilter;
use iwan_ident::curve_fit::start;
use iwan_ident::curve_fit::{Fit, fit_from};
use iwan_ident::curves::Curves;
use iwan_ident::levels::{Levels, compare_levels};
use iwan_sim::in_parallel;
use serde::Serialize;

use super::bench::{Bench, HITS, SUSPENSION};
use super::hit::{Hit, ViscousTerm};
use super::table_4::Table4Row;
use crate::error::Error;
use crate::progress::Tally;

/// Frequency and viscous damping of a mode (Table 3).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table3Row {
    /// Such as `bending 1`.
    pub mode: String,
    /// Of the truth at small amplitude, Hz.
    pub frequency: f64,
    /// What the suspension takes.
    pub damping_ratio: f64,
    /// Not to hand.
    pub printed_frequency: Option<f64>,
    /// Not to hand.
    pub printed_damping_ratio: Option<f64>,
}

/// What was measured and found.
#[derive(Debug, Clone)]
pub struct Laboratory {
    /// The bending modes as they are.
    pub table_3: Vec<Table3Row>,
    /// The hits, the softest first.
    pub hits: Vec<Hit>,
    /// Slopes of dissipation over force.
    pub table_4: Vec<Table4Row>,
    /// From hit to hit at equal times: this tells the viscous term.
    pub levels: Levels,
    /// One joint with a damper in parallel for all hits.
    pub fit: Fit,
    /// Of bending modes 1 to 3 at the sensors.
    pub filter: ModalFilter,
}

impl Laboratory {
    /// Measures and takes apart on up to `threads` threads: the same bits whatever their number.
    ///
    /// # Errors
    /// [`Error::Structure`], [`Error::Identification`], and [`Error::Interrupted`] when the observer broke off.
    pub fn new(threads: usize, observer: Progress<'_>) -> Result<Self, Error> {
        let tally = Tally::new(observer, HITS.len());
        let bench = Bench::new()?;
        let said = Error::identification("laboratory");
        let filter = ModalFilter::new(&bench.shapes).map_err(&said)?;
        let one = |n: &usize| Hit::new(&bench, *n).and_then(|hit| tally.add(1).map(|()| hit));
        let hits: Vec<Hit> = in_parallel(&[0, 1, 2], threads, &one).into_iter().collect::<Result<_, _>>()?;
        let curves: Vec<Curves> = hits.iter().map(|hit| hit.curves.clone()).collect();
        let fit = joint_fit(&curves).map_err(&said)?;
        let levels = compare_levels(&curves, fit.parameters.frequency).map_err(&said)?;
        let viscous = viscous(&levels, &fit);
        let steps = std::iter::once(None).chain(levels.steps.iter().copied().map(Some));
        let table_4 = hits.iter().zip(steps).filter_map(|(hit, step)| Table4Row::new(hit, viscous, step));
        Ok(Self {
            table_3: bench.beam.bending.iter().map(|mode| table_3_row(&bench, mode)).collect(),
            table_4: table_4.collect(),
            hits,
            levels,
            fit,
            filter,
        })
    }

    /// The viscous term as the hits tell it.
    #[must_use]
    pub fn viscous(&self) -> ViscousTerm {
        viscous(&self.levels, &self.fit)
    }
}

fn viscous(levels: &Levels, fit: &Fit) -> ViscousTerm {
    ViscousTerm { damping_ratio: levels.damping_ratio, frequency: fit.parameters.frequency }
}

fn table_3_row(bench: &Bench, mode: &NamedMode) -> Table3Row {
    Table3Row {
        mode: mode.name.clone(),
        frequency: bench.beam.modes.frequency_stuck(mode),
        damping_ratio: SUSPENSION,
        printed_frequency: None,
        printed_damping_ratio: None,
    }
}

/// One joint with a viscous damper in parallel for all hits, nothing held. The search begins where Sec. 2.5 leads, and at other
/// χ and K_T, since curves in micro-slip leave K_T open.
fn joint_fit(curves: &[Curves]) -> Result<Fit, iwan_ident::Error> {
    let loudest = curves.last().ok_or(iwan_ident::Error::Length { name: "hits", needed: 1, found: 0 })?;
    let mut first = start(loudest)?.parameters;
    let highest = curves.iter().flat_map(|c| c.frequency.iter().copied()).fold(0.0, f64::max);
    first.frequency = first.frequency.max(highest);
    let mut starts = vec![first];
    for (chi, k_t) in [(-0.5, 1.0), (-0.25, 1.0), (-0.25, 5.0), (-0.1, 2.0)] {
        starts.push(Parameters { chi, k_t: k_t * first.k_t, ..first });
    }
    fit_from(curves, &starts, &[])
}
