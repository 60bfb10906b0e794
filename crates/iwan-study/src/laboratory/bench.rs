//! The beam in the synthetic laboratory: where its sensors are, and what they measure.

use iwan_core::Pulse;
use iwan_fem::mesh::Mesh;
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Basis, History, Output, Representation, Transient};

use super::noise::Noise;
use crate::beam::{BASIS, PaperBeam, top_nodes};
use crate::blows::BLOW;
use crate::error::Error;

/// One pound-force in N, exactly.
const NEWTON: f64 = 4.448_221_615_260_5;
/// One inch in m, exactly.
const METRE: f64 = 0.0254;
/// One lbf s²/in in kg.
const KILOGRAM: f64 = NEWTON / METRE;
/// The configuration that is measured. Its first mode, at 122.5 to 127.1 Hz, lies in the middle of the paper's band of 120 to 135 Hz; that of
/// configuration A begins at 132.4 Hz, near the edge, where the filter would weaken it.
pub(super) const MEASURED: Configuration = Configuration::B;
/// Peak forces of the hammer, N. The paper's is 155 to 160 N; a tenth and a third of it show the slope of the dissipation over a decade of force.
pub const HITS: [f64; 3] = [15.0, 50.0, 157.5];
/// Sampling rate, Hz: 200 samples per cycle of mode 1.
pub(super) const RATE: f64 = 25_600.0;
/// Length of a record, s: 250 cycles of mode 1.
pub(super) const SECONDS: f64 = 2.0;
/// Root mean square of a sensor's noise, m/s²: 3e-4 of the largest acceleration under the softest hit.
pub(super) const NOISE: f64 = 0.05;
/// Damping of every elastic mode by the suspension, as a viscous damping ratio: the 0.025 % that the paper's Table 3 gives for the first mode with
/// the link bolted on and no bungees.
pub(super) const SUSPENSION: f64 = 2.5e-4;
/// Name of the node set that the hammer hits.
pub(super) const HAMMER: &str = "tip";
/// Number of sensors along each edge of the beam: one at every third mesh line.
const STATIONS: usize = 27;
/// Number of sensors on both edges.
pub(super) const SENSORS: usize = 2 * STATIONS;

/// The beam with its sensors.
pub(super) struct Bench {
    pub(super) beam: PaperBeam,
    /// Names of the sensors' node sets.
    pub(super) sensors: Vec<String>,
    /// True mass-normalised shapes of the bending modes at the sensors and, last, at the hammer, kg^-½.
    pub(super) shapes: Vec<Vec<f64>>,
}

/// Accelerations without noise (m/s²) that the sensors and, last, one at the hammer would measure under a hit.
pub(super) struct Clean(Vec<Vec<f64>>);

impl Bench {
    pub(super) fn new() -> Result<Self, Error> {
        let mut sensors = Vec::new();
        let beam = PaperBeam::prepared(MEASURED, |structure| sensors = place(&mut structure.mesh))?;
        let mut shapes = vec![Vec::new(); beam.bending.len()];
        for sensor in sensors.iter().map(String::as_str).chain([HAMMER]) {
            let output = output(&beam, sensor).map_err(Error::structure("laboratory"))?;
            for (shape, mode) in shapes.iter_mut().zip(&beam.bending) {
                let own = beam.modes.stuck.shape(mode.pair.stuck);
                let value: f64 = output.coefficients.iter().zip(own).map(|(c, x)| c * x).sum();
                shape.push(value / KILOGRAM.sqrt());
            }
        }
        Ok(Self { beam, sensors, shapes })
    }

    /// Computes the motions of the sensors under a hit with the peak `force` in N.
    pub(super) fn hit(&self, force: f64) -> Result<Clean, Error> {
        let place = format!("laboratory, hit of {force} N");
        let motions = self.respond(force).map_err(Error::structure(&place))?;
        let metres = |history: History| history.acceleration.iter().map(|a| METRE * a).collect();
        Ok(Clean(motions.into_iter().map(metres).collect()))
    }

    /// Motions of the sensors under a hit, in inches and seconds, without noise.
    fn respond(&self, force: f64) -> Result<Vec<History>, iwan_fem::Error> {
        let assembled = &self.beam.modes.assembled;
        let reduced = assembled.reduce(BASIS, Basis::default())?.with_damping(|_| SUSPENSION)?;
        let sensors = self.sensors.iter().map(String::as_str).chain([HAMMER]);
        let outputs = sensors.map(|name| output(&self.beam, name));
        let response = reduced.transient(&Transient {
            dt: 1.0 / RATE,
            steps: (SECONDS * RATE) as usize,
            pulse: Pulse::Haversine { amplitude: force / NEWTON, duration: BLOW },
            load: assembled.load(HAMMER, [0.0, 0.0, 1.0])?,
            initial_velocity: None,
            representation: Representation::DEFAULT_IN_A_STRUCTURE,
            outputs: outputs.collect::<Result<_, _>>()?,
        })?;
        Ok(response.outputs)
    }
}

impl Clean {
    /// The measured records, one for each sensor and, last, one for the hammer's point: `before` samples of rest ahead of the hit, and noise from the
    /// given seed.
    pub(super) fn measured(&self, seed: u64, before: usize) -> Vec<Vec<f64>> {
        let mut noise = Noise::new(seed);
        let mut noisy = |motion: &Vec<f64>| {
            let motion = std::iter::repeat_n(&0.0, before).chain(motion);
            motion.map(|a| a + NOISE * noise.normal()).collect()
        };
        self.0.iter().map(&mut noisy).collect()
    }
}

/// The output of a sensor, which measures the motion normal to the beam.
fn output(beam: &PaperBeam, sensor: &str) -> Result<Output, iwan_fem::Error> {
    beam.modes.assembled.output(sensor, sensor, [0.0, 0.0, 1.0])
}

/// Adds a node set for each sensor on the beam's top face, and returns the names of the sets.
fn place(mesh: &mut Mesh) -> Vec<String> {
    let top = top_nodes(mesh);
    let edge = top.iter().map(|&n| mesh.positions[n][1]).fold(f64::NEG_INFINITY, f64::max);
    let row = |y: f64| -> Vec<usize> {
        let mut row: Vec<usize> = top.iter().copied().filter(|&n| mesh.positions[n][1] == y).collect();
        row.sort_by(|&a, &b| mesh.positions[a][0].total_cmp(&mesh.positions[b][0]));
        let stride = row.len() / STATIONS;
        row.into_iter().skip(1).step_by(stride).take(STATIONS).collect()
    };
    let nodes: Vec<usize> = [-edge, edge].into_iter().flat_map(row).collect();
    let name = |(k, node): (usize, usize)| {
        let name = format!("point {}", k + 1);
        mesh.node_sets.insert(name.clone(), vec![node]);
        name
    };
    nodes.into_iter().enumerate().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use iwan_fem::mesh::beam::beam;

    #[test]
    fn sensors_sit_in_pairs_at_both_edges() {
        let mut mesh = beam(MEASURED, 1);
        let names = place(&mut mesh);
        assert_eq!((names.len(), names[0].as_str()), (SENSORS, "point 1"));
        let at = |k: usize| mesh.positions[mesh.node_sets[&names[k]][0]];
        for k in 0..STATIONS {
            let (left, right) = (at(k), at(k + STATIONS));
            assert_eq!((left[0], left[1], left[2]), (right[0], -right[1], 0.25));
            assert_eq!(left[0], -9.75 + 0.75 * k as f64);
        }
    }
}
