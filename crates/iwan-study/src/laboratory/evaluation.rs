//! All hits together: what they say about joints and suspension.

use iwan_core::Progress;
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
use super::modal_test::ModalTest;
use super::table_4::Table4Row;
use crate::error::Error;
use crate::printed::TABLE_3_WITH_LINK;
use crate::progress::Tally;

/// Frequency and damping of a mode by the modal test of the softest hits (Table 3).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table3Row {
    /// Such as `bending 1`.
    pub mode: String,
    /// Of the truth at small amplitude, Hz.
    pub frequency: f64,
    /// What the suspension takes.
    pub damping_ratio: f64,
    /// By the test, Hz.
    pub frequency_found: f64,
    /// Its standard deviation, Hz.
    pub frequency_sd: f64,
    /// By the test: of suspension and joints.
    pub damping_ratio_found: f64,
    /// Its standard deviation.
    pub damping_ratio_sd: f64,
    /// Modal assurance criterion of the shape against the true one.
    pub mac: f64,
    /// Scale of the mass-normalised shape over the true one, less 1.
    pub scale_error: f64,
    /// Factor by which the begin of the decay scales the shape more than all of it; none where the mode is linear.
    pub stretch: Option<f64>,
    /// Damping ratios as printed for the link at 50 in-lbf without bungees, and at 5 in-lbf with them.
    pub printed_damping_ratios: [f64; 2],
}

/// What was measured and found.
#[derive(Debug)]
pub struct Laboratory {
    /// The modal test of the softest hits.
    pub test: ModalTest,
    /// The bending modes as they are and as the test has them.
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
        let tally = Tally::new(observer, 1 + HITS.len());
        let bench = Bench::new()?;
        let said = Error::identification("laboratory");
        let test = ModalTest::new(&bench)?;
        tally.add(1)?;
        let shapes: Vec<Vec<f64>> = test.bending.iter().map(|found| found.shape.clone()).collect();
        let filter = ModalFilter::new(&shapes).map_err(&said)?;
        let one = |n: &usize| Hit::new(&bench, &shapes[0], *n).and_then(|hit| tally.add(1).map(|()| hit));
        let hits: Vec<Hit> = in_parallel(&[0, 1, 2], threads, &one).into_iter().collect::<Result<_, _>>()?;
        let curves: Vec<Curves> = hits.iter().map(|hit| hit.curves.clone()).collect();
        let fit = joint_fit(&curves).map_err(&said)?;
        let levels = compare_levels(&curves, fit.parameters.frequency).map_err(&said)?;
        let viscous = viscous(&levels, &fit);
        let steps = std::iter::once(None).chain(levels.steps.iter().copied().map(Some));
        let table_4 = hits.iter().zip(steps).filter_map(|(hit, step)| Table4Row::new(hit, viscous, step));
        Ok(Self {
            table_3: (0..test.bending.len()).map(|n| table_3_row(&bench, &test, n)).collect(),
            test,
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

fn table_3_row(bench: &Bench, test: &ModalTest, n: usize) -> Table3Row {
    let (named, found) = (&bench.beam.bending[n], &test.bending[n]);
    Table3Row {
        mode: named.name.clone(),
        frequency: bench.beam.modes.frequency_stuck(named),
        damping_ratio: SUSPENSION,
        frequency_found: found.mode.frequency,
        frequency_sd: found.mode.frequency_sd,
        damping_ratio_found: found.mode.damping_ratio,
        damping_ratio_sd: found.mode.damping_ratio_sd,
        mac: found.mac,
        scale_error: found.scale_error,
        stretch: found.mode.stretch,
        printed_damping_ratios: TABLE_3_WITH_LINK[n],
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
