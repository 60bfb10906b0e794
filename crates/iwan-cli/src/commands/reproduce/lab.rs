//! The laboratory's side (Sec. 4): synthetic measurements made from the truth model and taken apart as the paper does.
//!
//! SI units. The truth is configuration B, whose first mode lies in the paper's band. Sensors at 54 points of the top face,
//! a hammer at the tip, white sensor noise, and a suspension that takes what a viscous modal damper takes.

use std::f64::consts::TAU;

use iwan_core::Pulse;
use iwan_fem::{Basis, History, NamedMode, Output, Population, Transient};
use iwan_ident::Parameters;
use iwan_ident::channels::{Average, ModalFilter, scaled_average};
use iwan_ident::curve_fit::{Fit, fit_from, start};
use iwan_ident::curves::{Curves, ForceAxis, Quantity, straight_line};
use iwan_ident::levels::{Levels, compare_levels};
use iwan_ident::signal::{Butterworth, Envelope, Method, Options, Passband, envelope};
use serde::Serialize;

use super::noise::Noise;
use super::printed::BAND;
use super::summary::Row3;
use super::truth::{BASIS, BLOW, beam_nodes};
use crate::failure::Failure;
use crate::linear::{Linear, explain};
use crate::parallel::in_parallel;

/// One pound-force in N, one inch in m, one lbf s²/in in kg.
const NEWTON: f64 = 4.448_221_615_260_5;
const METRE: f64 = 0.0254;
const KILOGRAM: f64 = NEWTON / METRE;
/// Peak forces of the hammer, N: the paper's is 155 to 160.
pub(crate) const HITS: [f64; 3] = [15.0, 50.0, 157.5];
/// Samples a second, and seconds.
const RATE: f64 = 25_600.0;
const SECONDS: f64 = 2.0;
/// Root mean square of a sensor's noise, m/s².
const NOISE: f64 = 0.05;
/// What the suspension takes from every elastic mode, as a viscous damping ratio.
const SUSPENSION: f64 = 2.5e-4;
/// Stations of the sensors along the beam, every third mesh line, at both edges.
const STATIONS: usize = 27;
/// Order of the band-pass, and degree of the polynomials in the envelope.
const ORDER: usize = 3;
/// Stretch that is looked at, s: at its ends the filter, whose band is narrow, has long forgotten blow and end.
const WINDOW: (f64, f64) = (0.35, 1.65);
/// Sensors whose band-passed records are drawn.
const DRAWN: [usize; 4] = [0, 14, 26, 53];

/// What was measured and found.
#[derive(Debug)]
pub(crate) struct Lab {
    pub(crate) modes: Vec<Row3>,
    pub(crate) hits: Vec<Hit>,
    pub(crate) table_4: Vec<Row4>,
    /// From hit to hit at equal times: this tells the viscous term.
    pub(crate) levels: Levels,
    /// Joint fit of all hits.
    pub(crate) fit: Fit,
    pub(crate) filter: (usize, f64),
}

/// One hit: the average of all sensors, and what was read off it.
#[derive(Debug)]
pub(crate) struct Hit {
    /// N.
    pub(crate) force: f64,
    /// Band-passed and scaled records of the sensors [`DRAWN`], in √kg·m/s².
    pub(crate) drawn: Vec<(String, Vec<f64>)>,
    /// Their average over all sensors, with each one's misfit.
    pub(crate) average: Average,
    pub(crate) envelope: Envelope,
    /// Against modal force.
    pub(crate) curves: Curves,
    /// Largest acceleration of any sensor, m/s².
    pub(crate) peak: f64,
    /// Sampling interval, s.
    pub(crate) dt: f64,
}

/// Slopes of ln D over ln force at one level.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row4 {
    /// N.
    pub(crate) hit: f64,
    /// Modal forces between which the slope was taken, √kg·m/s².
    pub(crate) force: (f64, f64),
    /// Of the dissipation as measured.
    pub(crate) slope: f64,
    /// Of what is left when the viscous term is taken off.
    pub(crate) slope_without_viscous: f64,
    /// From the softer hit to this one at equal times, the same two; none for the softest.
    pub(crate) step: Option<f64>,
    pub(crate) step_without_viscous: Option<f64>,
    /// Not to hand.
    pub(crate) printed: Option<f64>,
}

/// What `reproduce.json` says about the laboratory.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LabSummary {
    pub(crate) configuration: &'static str,
    pub(crate) sensors: usize,
    pub(crate) sampling_rate: f64,
    pub(crate) seconds: f64,
    pub(crate) noise: f64,
    pub(crate) band: (f64, f64),
    /// Rank and condition of the modal filter of bending modes 1 to 3 at the sensors.
    pub(crate) filter_rank: usize,
    pub(crate) filter_condition: f64,
    pub(crate) hits: Vec<HitSummary>,
    pub(crate) damping_ratio_given: f64,
    /// By comparing hits at equal times.
    pub(crate) damping_ratio_found: f64,
    /// Power of the joints' dissipation over force by the same comparison, and what leaves it.
    pub(crate) slope_found: f64,
    pub(crate) slope_misfit: f64,
    /// By one joint with a damper in parallel on all curves.
    pub(crate) damping_ratio_fitted: f64,
    pub(crate) frequency_fitted: f64,
    pub(crate) chi_fitted: f64,
    pub(crate) misfit: String,
    /// What the slope from hit to hit changes by.
    pub(crate) drift: f64,
    pub(crate) drift_without_viscous: f64,
}

/// One hit in numbers.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct HitSummary {
    pub(crate) force: f64,
    pub(crate) peak_acceleration: f64,
    /// Largest misfit of a sensor to the average, relative, and how many are above a quarter.
    pub(crate) largest_misfit: f64,
    pub(crate) outliers: usize,
    pub(crate) trusted: (f64, f64),
    /// At the beginning and the end of the trusted stretch.
    pub(crate) frequency: (f64, f64),
    pub(crate) damping_ratio: (f64, f64),
    pub(crate) modal_force: (f64, f64),
}

/// The beam with its sensors.
struct Bench {
    linear: Linear,
    bending: Vec<NamedMode>,
    /// Names of the sensors' node sets.
    sensors: Vec<String>,
    /// Mass-normalised shapes of the bending modes at the sensors, kg^-½.
    shapes: Vec<Vec<f64>>,
}

impl Lab {
    /// Measures and takes apart; the same bits for any number of threads.
    pub(crate) fn new(
        threads: usize,
        progress: &(dyn Fn() -> Result<(), Failure> + Sync),
    ) -> Result<Self, Failure> {
        let bench = Bench::new()?;
        let said = |error: iwan_ident::Error| Failure::Computation(format!("laboratory: {error}"));
        let filter = ModalFilter::new(&bench.shapes).map_err(said)?;
        let one = |n: &usize| progress().and_then(|()| bench.hit(*n));
        let hits: Result<Vec<Hit>, Failure> = in_parallel(&[0, 1, 2], threads, &one).into_iter().collect();
        let hits = hits?;
        let fit = joint_fit(&hits).map_err(said)?;
        let curves: Vec<Curves> = hits.iter().map(|hit| hit.curves.clone()).collect();
        let levels = compare_levels(&curves, fit.parameters.frequency).map_err(said)?;
        let viscous = (levels.damping_ratio, fit.parameters.frequency);
        let steps = std::iter::once(None).chain(levels.steps.iter().map(|s| Some((s.total, s.friction))));
        let table_4 = hits.iter().zip(steps).filter_map(|(hit, step)| row_4(hit, viscous, step)).collect();
        let modes = bench.bending.iter().map(|mode| Row3 {
            mode: mode.name.clone(),
            frequency: bench.linear.frequency_stuck(mode),
            damping_ratio: SUSPENSION,
            printed_frequency: None,
            printed_damping_ratio: None,
        });
        Ok(Self {
            modes: modes.collect(),
            hits,
            table_4,
            levels,
            fit,
            filter: (filter.rank(), filter.condition()),
        })
    }

    /// Damping ratio and ω0 (Hz) of the viscous term.
    pub(crate) fn viscous(&self) -> (f64, f64) {
        (self.levels.damping_ratio, self.fit.parameters.frequency)
    }

    /// In numbers.
    pub(crate) fn summary(&self) -> LabSummary {
        let drift = |of: fn(&Row4) -> Option<f64>| {
            let slopes = self.table_4.iter().filter_map(of);
            slopes.clone().fold(f64::NEG_INFINITY, f64::max) - slopes.fold(f64::INFINITY, f64::min)
        };
        let p = &self.fit.parameters;
        LabSummary {
            configuration: "B",
            sensors: 2 * STATIONS,
            sampling_rate: RATE,
            seconds: SECONDS,
            noise: NOISE,
            band: BAND,
            filter_rank: self.filter.0,
            filter_condition: self.filter.1,
            hits: self.hits.iter().map(Hit::summary).collect(),
            damping_ratio_given: SUSPENSION,
            damping_ratio_found: self.levels.damping_ratio,
            slope_found: self.levels.slope,
            slope_misfit: self.levels.misfit,
            damping_ratio_fitted: p.damping_ratio,
            frequency_fitted: p.frequency,
            chi_fitted: p.chi,
            misfit: self.fit.verdict.misfit.clone(),
            drift: drift(|row| row.step),
            drift_without_viscous: drift(|row| row.step_without_viscous),
        }
    }
}

/// First and last.
fn ends(values: &[f64]) -> (f64, f64) {
    (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0))
}

impl Hit {
    fn summary(&self) -> HitSummary {
        HitSummary {
            force: self.force,
            peak_acceleration: self.peak,
            largest_misfit: self.average.misfit.iter().copied().fold(0.0, f64::max),
            outliers: self.average.outliers.len(),
            trusted: self.envelope.trusted,
            frequency: ends(&self.curves.frequency),
            damping_ratio: ends(&self.curves.damping_ratio),
            modal_force: ends(&self.curves.force),
        }
    }

    /// What the dissipation is without the viscous term 2π ζ ω0 ω q² of a damping ratio and ω0 in Hz.
    pub(crate) fn without_viscous(&self, (damping_ratio, frequency): (f64, f64)) -> Vec<f64> {
        let viscous = |q: f64, f: f64| TAU * damping_ratio * TAU * frequency * TAU * f * q * q;
        let c = &self.curves;
        (0..c.t.len()).map(|i| c.dissipation[i] - viscous(c.displacement[i], c.frequency[i])).collect()
    }
}

impl Bench {
    fn new() -> Result<Self, Failure> {
        let mut file = super::truth::structure("paper-b")?;
        let sensors = place(&mut file.1.structure.mesh);
        let linear = Linear::new(file.0, file.1, super::truth::NAMED)?;
        let bending = linear.first_bending();
        let failed = |error: iwan_fem::Error| explain(&linear.source, &error);
        let mut shapes = vec![Vec::new(); bending.len()];
        for sensor in &sensors {
            let output = linear.assembled.output(sensor, sensor, [0.0, 0.0, 1.0]).map_err(failed)?;
            for (shape, mode) in shapes.iter_mut().zip(&bending) {
                let own = linear.stuck.shape(mode.pair.stuck);
                let value: f64 = output.coefficients.iter().zip(own).map(|(c, x)| c * x).sum();
                shape.push(value / KILOGRAM.sqrt());
            }
        }
        Ok(Self { linear, bending, sensors, shapes })
    }

    /// Accelerations of the sensors under a hit, m/s², without noise.
    fn respond(&self, force: f64) -> Result<Vec<History>, iwan_fem::Error> {
        let assembled = &self.linear.assembled;
        let reduced = assembled.reduce(BASIS, Basis::default())?.with_damping(|_| SUSPENSION)?;
        let outputs: Result<Vec<Output>, _> =
            self.sensors.iter().map(|name| assembled.output(name, name, [0.0, 0.0, 1.0])).collect();
        let response = reduced.transient(&Transient {
            dt: 1.0 / RATE,
            steps: (SECONDS * RATE) as usize,
            pulse: Pulse::Haversine { amplitude: force / NEWTON, duration: BLOW },
            load: assembled.load("tip", [0.0, 0.0, 1.0])?,
            initial_velocity: None,
            population: Population::default(),
            outputs: outputs?,
        })?;
        Ok(response.outputs)
    }

    fn hit(&self, n: usize) -> Result<Hit, Failure> {
        let clean = self.respond(HITS[n]).map_err(|error| explain(&self.linear.source, &error))?;
        let mut noise = Noise::new(n as u64);
        let mut measured = |history: History| -> Vec<f64> {
            history.acceleration.iter().map(|a| METRE * a + NOISE * noise.normal()).collect()
        };
        let channels: Vec<Vec<f64>> = clean.into_iter().map(&mut measured).collect();
        self.take_apart(HITS[n], &channels)
            .map_err(|error| Failure::Computation(format!("laboratory, hit of {} N: {error}", HITS[n])))
    }

    /// Band-pass, scaling, averaging, envelope, curves.
    fn take_apart(&self, force: f64, channels: &[Vec<f64>]) -> Result<Hit, iwan_ident::Error> {
        let (dt, shape) = (1.0 / RATE, &self.shapes[0]);
        let filter = Butterworth::new(ORDER, Passband::Band { low: BAND.0, high: BAND.1 }, dt)?;
        let filtered: Result<Vec<Vec<f64>>, _> =
            channels.iter().map(|channel| filter.forward_backward(channel)).collect();
        let filtered = filtered?;
        let slices: Vec<&[f64]> = filtered.iter().map(Vec::as_slice).collect();
        let average = scaled_average(&slices, shape)?;
        // Filter and average change places freely: the envelope's own band-pass knows how far its ends reach.
        let raw: Vec<&[f64]> = channels.iter().map(Vec::as_slice).collect();
        let raw = scaled_average(&raw, shape)?.samples;
        let options = Options {
            band: Some(BAND),
            filter_order: ORDER,
            window: Some(WINDOW),
            order: Some(ORDER),
            ..Options::default()
        };
        let envelope = envelope(&raw, dt, Method::Hilbert, &options)?;
        let curves = Curves::new(&envelope, Quantity::Acceleration, ForceAxis::Modal)?;
        let scaled = |&k: &usize| {
            let samples = filtered[k].iter().map(|a| a / shape[k]).collect();
            (self.sensors[k].clone(), samples)
        };
        let peak = channels.iter().flatten().fold(0.0, |most: f64, a| most.max(a.abs()));
        Ok(Hit { force, drawn: DRAWN.iter().map(scaled).collect(), average, envelope, curves, peak, dt })
    }
}

/// Adds a node set for each sensor on the beam's top face; returns their names.
fn place(mesh: &mut iwan_fem::mesh::Mesh) -> Vec<String> {
    let beam = beam_nodes(mesh);
    let extreme =
        |axis: usize| beam.iter().map(|&n| mesh.positions[n][axis]).fold(f64::NEG_INFINITY, f64::max);
    let (top, edge) = (extreme(2), extreme(1));
    let row = |y: f64| -> Vec<usize> {
        let mut row: Vec<usize> = beam
            .iter()
            .copied()
            .filter(|&n| mesh.positions[n][2] == top && mesh.positions[n][1] == y)
            .collect();
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

/// One joint with a viscous damper in parallel for all hits, nothing held.
fn joint_fit(hits: &[Hit]) -> Result<Fit, iwan_ident::Error> {
    let curves: Vec<Curves> = hits.iter().map(|hit| hit.curves.clone()).collect();
    let loudest = curves.last().ok_or(iwan_ident::Error::Length { name: "hits", needed: 1, found: 0 })?;
    let mut first = start(loudest)?.parameters;
    let highest = curves.iter().flat_map(|c| c.frequency.iter().copied()).fold(0.0, f64::max);
    first.frequency = first.frequency.max(highest);
    let mut starts = vec![first];
    for (chi, k_t) in [(-0.5, 1.0), (-0.25, 1.0), (-0.25, 5.0), (-0.1, 2.0)] {
        starts.push(Parameters { chi, k_t: k_t * first.k_t, ..first });
    }
    fit_from(&curves, &starts, &[])
}

fn row_4(hit: &Hit, viscous: (f64, f64), step: Option<(f64, f64)>) -> Option<Row4> {
    let slope = |dissipation: &[f64]| {
        let points = hit.curves.force.iter().zip(dissipation).filter(|(_, d)| **d > 0.0);
        straight_line(&points.map(|(f, d)| (f.ln(), d.ln())).collect::<Vec<_>>()).map(|line| line.slope)
    };
    Some(Row4 {
        hit: hit.force,
        force: ends(&hit.curves.force),
        slope: slope(&hit.curves.dissipation)?,
        slope_without_viscous: slope(&hit.without_viscous(viscous))?,
        step: step.map(|s| s.0),
        step_without_viscous: step.map(|s| s.1),
        printed: None,
    })
}
