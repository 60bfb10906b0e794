//! The truth model: the paper's beam with its discrete joints under blows of all levels, in both configurations.

use std::ops::ControlFlow;

use iwan_core::Pulse;
use iwan_fem::{Basis, History, Output, Population, Reduced, Transient, TruthResponse};
use iwan_input::{BUILT_IN_STRUCTURES, Source, StructureFile};

use super::counterpart::distance;
use crate::failure::Failure;
use crate::linear::{Elastic, Linear, explain};

/// Peak forces of the blows, lbf (Sec. 3).
pub(crate) const LEVELS: [f64; 6] = [1.0, 10.0, 100.0, 1000.0, 5000.0, 10_000.0];
/// Duration of a blow, s.
pub(crate) const BLOW: f64 = 1.6e-3;
/// Time step, s, and number of steps.
pub(crate) const DT: f64 = 1e-5;
pub(crate) const STEPS: usize = 20_000;
/// Modes of the reduced model, beside the attachment vectors of the slips.
pub(crate) const BASIS: usize = 50;
/// Elastic modes among which bending modes are looked up.
pub(super) const NAMED: usize = 40;

/// One configuration of the beam.
#[derive(Debug)]
pub(crate) struct Side {
    /// `A` or `B`.
    pub(crate) name: &'static str,
    pub(crate) linear: Linear,
    /// Bending modes 1 to 3.
    pub(crate) bending: Vec<Elastic>,
    /// Mean shape of each at the loaded edge.
    pub(crate) tip: Vec<f64>,
    /// One response per level; the outputs are the bending modes' coordinates.
    pub(crate) responses: Vec<TruthResponse>,
    /// The same without attachment vectors under the fourth level, as an example of how not to reduce.
    pub(crate) modes_alone: TruthResponse,
    /// Ring-downs that start in one bending mode alone, at what the blow of [`ALONE`] brings it to.
    pub(crate) alone: Vec<TruthResponse>,
    /// Distances of the reduced from the full model over the first [`FULL`] steps: level, then bending mode.
    pub(crate) reduction: Vec<(f64, Vec<f64>)>,
    pub(crate) filters: Vec<Filter>,
}

/// Level, by index, that tells the amplitudes of the ring-downs in one mode.
const ALONE: usize = 2;
/// Levels, by index, at which the full model is integrated too, and for how many steps.
const COMPARED: [usize; 2] = [1, 3];
const FULL: usize = 2000;

/// How well a modal filter (Eq. 18) tells the modes of the basis apart.
#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct Filter {
    pub(crate) sensors: &'static str,
    pub(crate) channels: usize,
    pub(crate) modes: usize,
    pub(crate) rank: usize,
    pub(crate) condition: f64,
}

/// A blow at the tip.
pub(crate) fn blow(amplitude: f64) -> Pulse<'static> {
    Pulse::Haversine { amplitude, duration: BLOW }
}

/// A built-in structure with its name.
pub(super) fn structure(name: &str) -> Result<(String, StructureFile), Failure> {
    let known = BUILT_IN_STRUCTURES.iter().find(|built_in| built_in.0 == name);
    let (name, _, text) =
        known.ok_or_else(|| Failure::Computation(format!("there is no built-in structure {name}")))?;
    let source = Source::built_in(name, text);
    Ok((source.name.clone(), StructureFile::read(&source)?))
}

impl Side {
    /// Computes the configuration `A` or `B`; `progress` hears the share done.
    pub(crate) fn new(
        name: &'static str,
        progress: &dyn Fn(f64) -> ControlFlow<()>,
    ) -> Result<Self, Failure> {
        let (source, file) = structure(if name == "A" { "paper-a" } else { "paper-b" })?;
        let linear = Linear::new(source, file, NAMED)?;
        let failed = |error: iwan_fem::Error| explain(&linear.source, &error);
        let assembled = &linear.assembled;
        let bending = linear.first_bending();
        let load = assembled.load("tip", [0.0, 0.0, 1.0]).map_err(failed)?;
        let at_tip =
            |mode: &Elastic| linear.stuck.shape(mode.pair.stuck).iter().zip(&load).map(|(a, b)| a * b).sum();
        let tip: Vec<f64> = bending.iter().map(at_tip).collect();
        let reduced = assembled.reduce(BASIS, Basis::default()).map_err(failed)?;
        let filters = filters(&reduced).map_err(failed)?;
        let outputs: Vec<Output> = bending
            .iter()
            .map(|mode| assembled.modal_output(&mode.name, &linear.stuck, mode.pair.stuck))
            .collect();
        let pieces = (LEVELS.len() + 1 + COMPARED.len() + bending.len()) as f64;
        let of = |n: usize, steps: usize| Transient {
            dt: DT,
            steps,
            pulse: blow(LEVELS[n]),
            load: load.clone(),
            initial_velocity: None,
            population: Population::default(),
            outputs: outputs.clone(),
        };
        let run = |reduced: &Reduced<'_>, n: usize| {
            let report = &mut |share: f64| progress((n as f64 + share) / pieces);
            reduced.transient_observed(&of(n, STEPS), report)
        };
        let responses: Result<Vec<_>, _> = (0..LEVELS.len()).map(|n| run(&reduced, n)).collect();
        let responses = responses.map_err(failed)?;
        let without = assembled.reduce(BASIS, Basis::Modes).map_err(failed)?;
        let modes_alone = run(&without, 3).map_err(failed)?;
        let alone = |(mode, history): (&Elastic, &History)| {
            let speed =
                history.velocity.iter().skip((BLOW / DT) as usize).fold(0.0, |m: f64, v| m.max(v.abs()));
            let shape = linear.stuck.shape(mode.pair.stuck);
            let initial_velocity = Some(shape.iter().map(|x| speed * x).collect());
            let report = &mut |share: f64| progress((LEVELS.len() as f64 + 1.0 + share) / pieces);
            reduced.transient_observed(
                &Transient { pulse: Pulse::None, initial_velocity, ..of(0, STEPS) },
                report,
            )
        };
        let alone: Result<Vec<_>, _> = bending.iter().zip(&responses[ALONE].outputs).map(alone).collect();
        let alone = alone.map_err(failed)?;
        let apart = |n: usize| {
            let report = &mut |share: f64| progress((pieces - 2.0 + share) / pieces);
            let full = assembled.transient_observed(&of(n, FULL), report)?;
            let pairs = responses[n].outputs.iter().zip(&full.outputs);
            let distances = pairs.map(|(a, b)| distance(&a.acceleration[..=FULL], &b.acceleration));
            Ok((LEVELS[n], distances.collect()))
        };
        let reduction: Result<Vec<_>, _> = COMPARED.into_iter().map(apart).collect();
        let reduction = reduction.map_err(failed)?;
        Ok(Self { name, linear, bending, tip, responses, modes_alone, alone, reduction, filters })
    }

    /// Largest energy error of all blows, relative.
    pub(crate) fn energy_error(&self) -> f64 {
        self.responses.iter().map(|response| response.energy.error()).fold(0.0, f64::max)
    }
}

/// With all displacements, and with those across the beam's top face alone.
fn filters(reduced: &Reduced<'_>) -> Result<Vec<Filter>, iwan_fem::Error> {
    let (assembled, modes) = (reduced.assembled(), reduced.modes());
    let mesh = &assembled.structure().mesh;
    let beam: Vec<usize> = beam_nodes(mesh);
    let thickness = beam.iter().map(|&n| mesh.positions[n][2]).fold(0.0, f64::max);
    let top = beam.iter().filter(|&&n| mesh.positions[n][2] == thickness).map(|n| 3 * n + 2);
    let sets = [
        ("all displacements", (0..3 * mesh.positions.len()).collect::<Vec<_>>()),
        ("across the top face", top.collect()),
    ];
    let one = |(sensors, dofs): (&'static str, Vec<usize>)| {
        let filter = assembled.modal_filter(modes, &dofs)?;
        let (rank, condition) = (filter.rank(), filter.condition());
        Ok(Filter { sensors, channels: dofs.len(), modes: modes.len(), rank, condition })
    };
    sets.into_iter().map(one).collect()
}

/// Nodes of the beam without link and washers.
pub(crate) fn beam_nodes(mesh: &iwan_fem::mesh::Mesh) -> Vec<usize> {
    let elements = mesh.element_sets.get("beam").map_or(&[][..], Vec::as_slice);
    let mut nodes: Vec<usize> = elements.iter().flat_map(|&e| mesh.elements[e].nodes.clone()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
