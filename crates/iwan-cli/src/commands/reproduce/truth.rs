//! The truth model: the paper's beam with its discrete joints under blows of all levels, in both configurations.

use std::cell::Cell;
use std::ops::ControlFlow;

use iwan_core::Pulse;
use iwan_fem::{Basis, History, NamedMode, Output, Population, Reduced, Transient, TruthResponse};
use iwan_input::{BUILT_IN_STRUCTURES, Source, StructureFile};

use super::counterpart::distance;
use crate::failure::Failure;
use crate::structures::linear::{Linear, explain};

/// Peak forces of the blows, lbf (Sec. 3).
pub(crate) const LEVELS: [f64; 6] = [1.0, 10.0, 100.0, 1000.0, 5000.0, 10_000.0];
/// Duration of a blow, s.
pub(crate) const BLOW: f64 = 1.6e-3;
/// Time step, s, and number of steps.
pub(crate) const DT: f64 = 1e-5;
pub(crate) const STEPS: usize = 20_000;
/// Modes of the reduced model, beside the attachment vectors of the slips.
pub(crate) const BASIS: usize = 50;
/// NamedMode modes among which bending modes are looked up.
pub(super) const NAMED: usize = 40;

/// One configuration of the beam.
#[derive(Debug)]
pub(crate) struct Side {
    /// `A` or `B`.
    pub(crate) name: &'static str,
    pub(crate) linear: Linear,
    /// Bending modes 1 to 3.
    pub(crate) bending: Vec<NamedMode>,
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
        let bending = linear.first_bending();
        let runs = Runs::new(&linear, &bending, progress);
        let responses = runs.and_then(|runs| runs.all());
        let (tip, responses) = responses.map_err(|error| explain(&linear.source, &error))?;
        let Responses { blows, modes_alone, alone, reduction, filters } = responses;
        Ok(Self { name, linear, bending, tip, responses: blows, modes_alone, alone, reduction, filters })
    }

    /// Largest energy error of all blows, relative.
    pub(crate) fn energy_error(&self) -> f64 {
        self.responses.iter().map(|response| response.energy.error()).fold(0.0, f64::max)
    }
}

/// What one configuration is put through.
struct Runs<'a> {
    linear: &'a Linear,
    bending: &'a [NamedMode],
    load: Vec<f64>,
    outputs: Vec<Output>,
    progress: &'a dyn Fn(f64) -> ControlFlow<()>,
    done: Cell<usize>,
}

/// What comes of it.
struct Responses {
    blows: Vec<TruthResponse>,
    modes_alone: TruthResponse,
    alone: Vec<TruthResponse>,
    reduction: Vec<(f64, Vec<f64>)>,
    filters: Vec<Filter>,
}

impl<'a> Runs<'a> {
    fn new(
        linear: &'a Linear,
        bending: &'a [NamedMode],
        progress: &'a dyn Fn(f64) -> ControlFlow<()>,
    ) -> Result<Self, iwan_fem::Error> {
        let assembled = &linear.assembled;
        let output = |mode: &NamedMode| assembled.modal_output(&mode.name, &linear.stuck, mode.pair.stuck);
        let outputs = bending.iter().map(output).collect();
        let load = assembled.load("tip", [0.0, 0.0, 1.0])?;
        Ok(Self { linear, bending, load, outputs, progress, done: Cell::new(0) })
    }

    /// The blow of level `n`.
    fn blow(&self, n: usize, steps: usize) -> Transient<'static> {
        Transient {
            dt: DT,
            steps,
            pulse: blow(LEVELS[n]),
            load: self.load.clone(),
            initial_velocity: None,
            population: Population::default(),
            outputs: self.outputs.clone(),
        }
    }

    /// A run, which counts for the progress.
    fn run(
        &self,
        integrate: impl FnOnce(iwan_fem::Progress<'_>) -> Result<TruthResponse, iwan_fem::Error>,
    ) -> Result<TruthResponse, iwan_fem::Error> {
        let pieces = LEVELS.len() + 1 + COMPARED.len() + self.bending.len();
        let share = |share: f64| (self.done.get() as f64 + share) / pieces as f64;
        let response = integrate(&mut |part| (self.progress)(share(part)));
        self.done.set(self.done.get() + 1);
        response
    }

    /// Mean shapes at the loaded edge, and all runs.
    fn all(&self) -> Result<(Vec<f64>, Responses), iwan_fem::Error> {
        let assembled = &self.linear.assembled;
        let shape = |mode: &NamedMode| self.linear.stuck.shape(mode.pair.stuck);
        let at_tip = |mode| shape(mode).iter().zip(&self.load).map(|(a, b)| a * b).sum();
        let tip = self.bending.iter().map(at_tip).collect();
        let reduced = assembled.reduce(BASIS, Basis::default())?;
        let blow = |n: usize| self.run(|report| reduced.transient_observed(&self.blow(n, STEPS), report));
        let blows: Vec<TruthResponse> = (0..LEVELS.len()).map(blow).collect::<Result<_, _>>()?;
        let modes = assembled.reduce(BASIS, Basis::Modes)?;
        let modes_alone = self.run(|report| modes.transient_observed(&self.blow(3, STEPS), report))?;
        let pairs = self.bending.iter().zip(&blows[ALONE].outputs);
        let alone = pairs.map(|(mode, history)| self.ring_down(&reduced, shape(mode), history));
        let alone = alone.collect::<Result<_, _>>()?;
        let reduction =
            COMPARED.into_iter().map(|n| self.reduction(n, &blows[n])).collect::<Result<_, _>>()?;
        Ok((tip, Responses { blows, modes_alone, alone, reduction, filters: filters(&reduced)? }))
    }

    /// Starts in one mode with the largest velocity it had after a blow.
    fn ring_down(
        &self,
        reduced: &Reduced<'_>,
        shape: &[f64],
        history: &History,
    ) -> Result<TruthResponse, iwan_fem::Error> {
        let after = history.velocity.iter().skip((BLOW / DT) as usize);
        let speed = after.fold(0.0, |most: f64, v| most.max(v.abs()));
        let initial_velocity = Some(shape.iter().map(|x| speed * x).collect());
        let of = Transient { pulse: Pulse::None, initial_velocity, ..self.blow(0, STEPS) };
        self.run(|report| reduced.transient_observed(&of, report))
    }

    /// Distances from the full model.
    fn reduction(&self, n: usize, reduced: &TruthResponse) -> Result<(f64, Vec<f64>), iwan_fem::Error> {
        let full =
            self.run(|report| self.linear.assembled.transient_observed(&self.blow(n, FULL), report))?;
        let pairs = reduced.outputs.iter().zip(&full.outputs);
        let distances = pairs.map(|(a, b)| distance(&a.acceleration[..=FULL], &b.acceleration));
        Ok((LEVELS[n], distances.collect()))
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
