//! The paper computed anew: both configurations under all blows, their modes with modal models, and the laboratory.

use iwan_core::Progress;
use iwan_fem::mesh::beam::Configuration;
use iwan_sim::in_parallel;

use crate::beam::BeamUnderBlows;
use crate::error::Error;
use crate::laboratory::{HITS, Laboratory};
use crate::modes::{CoupledModel, StudiedMode};
use crate::progress::Tally;

/// The configurations that are computed.
const CONFIGURATIONS: [Configuration; 2] = [Configuration::A, Configuration::B];
/// Indices of the bending modes of each configuration, those with the most cycles first: where several threads share the work, the longest piece must
/// not come last.
const MODES: [usize; 3] = [2, 0, 1];

/// All results of a reproduction.
#[derive(Debug)]
pub struct Reproduction {
    /// Configurations A and B.
    pub configurations: Vec<StudiedBeam>,
    /// The synthetic measurements.
    pub laboratory: Laboratory,
}

/// A configuration of the beam with its modes.
#[derive(Debug)]
pub struct StudiedBeam {
    /// The beam and its responses.
    pub truth: BeamUnderBlows,
    /// Bending modes 1 to 3.
    pub modes: Vec<StudiedMode>,
    /// Bending modes 1 to 3 with the joint that they share; none where these make no model that can be integrated.
    pub coupled: Option<CoupledModel>,
}

impl Reproduction {
    /// All modes of both configurations.
    pub fn modes(&self) -> impl Iterator<Item = &StudiedMode> {
        self.configurations.iter().flat_map(|configuration| &configuration.modes)
    }
}

/// Computes everything on up to `threads` threads, which takes seconds; the results have the same bits whatever the number of threads.
///
/// ```no_run
/// use std::ops::ControlFlow;
/// let found = iwan_study::reproduce(2, &|_| ControlFlow::Continue(()))?;
/// let summary = iwan_study::Summary::new(&found)?;
/// println!("{} findings", summary.findings.len());
/// # Ok::<(), iwan_study::Error>(())
/// ```
///
/// # Errors
/// [`Error::Interrupted`] where the observer stopped the work; any other error would be a fault of this program, because nothing is read in.
pub fn reproduce(threads: usize, observer: Progress<'_>) -> Result<Reproduction, Error> {
    let tally = Tally::new(observer, CONFIGURATIONS.len() * (1 + MODES.len()) + HITS.len());
    let blows = |configuration: &Configuration| {
        let truth = BeamUnderBlows::new(*configuration, &|share| tally.under_way(share))?;
        tally.add(1).map(|()| truth)
    };
    let truths: Vec<BeamUnderBlows> =
        in_parallel(&CONFIGURATIONS, threads, &blows).into_iter().collect::<Result<_, Error>>()?;
    let all: Vec<(usize, usize)> =
        MODES.into_iter().flat_map(|mode| (0..truths.len()).map(move |beam| (beam, mode))).collect();
    let study = |&(beam, mode): &(usize, usize)| {
        let studied = StudiedMode::new(&truths[beam], mode)?;
        tally.add(1).map(|()| studied)
    };
    let found: Vec<StudiedMode> =
        in_parallel(&all, threads, &study).into_iter().collect::<Result<_, Error>>()?;
    let coupled: Vec<Option<CoupledModel>> =
        in_parallel(&truths, threads, &CoupledModel::new).into_iter().collect::<Result<_, Error>>()?;
    let pairs = truths.into_iter().zip(coupled);
    let mut configurations: Vec<StudiedBeam> =
        pairs.map(|(truth, coupled)| StudiedBeam { truth, modes: Vec::new(), coupled }).collect();
    for ((beam, _), studied) in all.into_iter().zip(found) {
        configurations[beam].modes.push(studied);
    }
    for configuration in &mut configurations {
        configuration.modes.sort_by_key(|studied| studied.mode.index);
    }
    let laboratory = Laboratory::new(threads, &|share| tally.under_way(share * HITS.len() as f64))?;
    Ok(Reproduction { configurations, laboratory })
}
