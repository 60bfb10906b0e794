//! The evaluation of all hits together: joints and suspension.

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

/// Frequency and damping of a mode: the truth, and what the modal test of the softest hits finds (Table 3).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table3Row {
    /// Name of the mode, such as `bending 1`.
    pub mode: String,
    /// Frequency of the truth at small amplitude, Hz.
    pub frequency: f64,
    /// Damping ratio that the suspension gives the mode.
    pub damping_ratio: f64,
    /// Frequency by the test, Hz.
    pub frequency_found: f64,
    /// Standard deviation of that frequency, Hz.
    pub frequency_sd: f64,
    /// Damping ratio by the test, of suspension and joints together.
    pub damping_ratio_found: f64,
    /// Standard deviation of that damping ratio.
    pub damping_ratio_sd: f64,
    /// Modal assurance criterion between the found and the true shape.
    pub mac: f64,
    /// Scale of the found mass-normalised shape over that of the true one, minus 1.
    pub scale_error: f64,
    /// Ratio of the shape's scale by the beginning of the decay to that by the whole decay; none where the mode is linear.
    pub stretch: Option<f64>,
    /// Damping ratios as the paper prints them: for the link with bolts at 50 in-lbf and no bungees, and with bolts at 5 in-lbf and bungees.
    pub printed_damping_ratios: [f64; 2],
}

/// The synthetic measurements and their evaluation.
#[derive(Debug)]
pub struct Laboratory {
    /// The modal test of the softest hits.
    pub test: ModalTest,
    /// The bending modes: the truth beside the test's results.
    pub table_3: Vec<Table3Row>,
    /// The hits, the softest first.
    pub hits: Vec<Hit>,
    /// Slopes of dissipation over force, level by level.
    pub table_4: Vec<Table4Row>,
    /// Comparison of neighbouring levels at equal times after the hit, from which the viscous term is determined.
    pub levels: Levels,
    /// The fit of one joint with a viscous damper in parallel to all hits.
    pub fit: Fit,
    /// The modal filter of bending modes 1 to 3 at the sensors.
    pub filter: ModalFilter,
}

impl Laboratory {
    /// Measures and evaluates on up to `threads` threads; the results have the same bits whatever their number.
    ///
    /// # Errors
    /// [`Error::Structure`], [`Error::Identification`], and [`Error::Interrupted`] where the observer stopped the work.
    pub fn new(threads: usize, observer: Progress<'_>) -> Result<Self, Error> {
        let tally = Tally::new(observer, 1 + HITS.len());
        let bench = Bench::new()?;
        let said = Error::identification("laboratory");
        let test = ModalTest::new(&bench, threads)?;
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

    /// The viscous term as the comparison of hits determines it.
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

/// Fits one joint with a viscous damper in parallel to all hits, with no parameter held. The search begins at the values of Sec. 2.5 and at other
/// values of χ and K_T, because curves in micro-slip do not determine K_T.
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
