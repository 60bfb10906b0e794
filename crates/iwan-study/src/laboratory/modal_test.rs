//! The linear modal test that comes first: hits of the softest level, frequency responses, modes by mode isolation (M. S. Allen, J. H. Ginsberg,
//! Mech. Syst. Signal Process. 20:900, 2006; the paper's ref. 19), and with them the shapes at the sensors.

use iwan_core::Pulse;
use iwan_modal::measure::{Channel, Freedom, Hit, Motion};
use iwan_modal::modes::{Mode, mac};
use iwan_modal::responses::{Estimator, FrequencyResponses, Windows, frequency_responses};
use iwan_modal::{Analysis, Complex, ModalFit, modal_fit, on_threads};

use super::bench::{Bench, HAMMER, HITS, RATE, SENSORS};
use super::noise::Noise;
use crate::blows::BLOW;
use crate::error::Error;
use crate::span::Span;

/// Number of hits of the softest level that are averaged.
const AVERAGED: u64 = 5;
/// First seed of the noise in these hits, different from the seeds of the hits that are evaluated one by one.
const SEEDS: u64 = 100;
/// Samples recorded before the hit.
const BEFORE: usize = 64;
/// Root mean square of the hammer's noise over its peak force.
const HAMMER_NOISE: f64 = 1e-4;
/// Band of the test, Hz: it holds bending modes 1 to 3 and the modes between them.
const BAND: Span = Span { from: 60.0, to: 900.0 };
/// Order of a stabilisation chart, which mode isolation does not use.
const NO_CHART: usize = 2;

/// Frequency responses of the softest hits, and the modes identified from them.
#[derive(Debug)]
pub struct ModalTest {
    /// Peak force of the hits, N.
    pub force: f64,
    /// Responses of all sensors and of one at the hammer's point, m/s² per N.
    pub responses: FrequencyResponses,
    /// All modes in the band.
    pub fit: ModalFit,
    /// Bending modes 1 to 3 as the test finds them.
    pub bending: Vec<FoundMode>,
}

/// A bending mode as the test finds it, compared with the true one.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundMode {
    /// The mode found by the test.
    pub mode: Mode,
    /// Real mass-normalised shape at the sensors, kg^-½, with the sign of the true one.
    pub shape: Vec<f64>,
    /// Modal assurance criterion with the true shape.
    pub mac: f64,
    /// Scale of the shape over the true one, by least squares, minus 1.
    pub scale_error: f64,
}

impl ModalTest {
    /// Computes hits on the beam of a bench and identifies its modes, on up to `threads` threads.
    pub(super) fn new(bench: &Bench, threads: usize) -> Result<Self, Error> {
        let hits = hits(bench)?;
        let test = on_threads(threads, || Self::of_hits(&hits, bench)).and_then(|test| test);
        test.map_err(Error::modal("laboratory, modal test"))
    }

    /// Number of hits that were averaged.
    #[must_use]
    pub fn hits(&self) -> usize {
        self.responses.functions.first().map_or(0, |f| f.hits)
    }

    fn of_hits(hits: &[Hit], bench: &Bench) -> Result<Self, iwan_modal::Error> {
        let (motion, estimator) = (Motion::Acceleration, Estimator::H1);
        let whole = frequency_responses(hits, motion, estimator, Windows::default())?;
        let fit = modal_fit(&whole, Some((BAND.from, BAND.to)), &Analysis::Isolation, NO_CHART)?;
        let fit = fit.scaled_at_begin(hits, motion, estimator, false)?;
        let bending = bench.shapes.iter().filter_map(|shape| FoundMode::nearest(&fit.modes, shape)).collect();
        Ok(Self { force: HITS[0], responses: whole, fit, bending })
    }
}

impl FoundMode {
    /// The mode whose shape is most similar to the `truth`.
    fn nearest(modes: &[Mode], truth: &[f64]) -> Option<Self> {
        let complex: Vec<Complex<f64>> = truth.iter().map(|x| Complex::new(*x, 0.0)).collect();
        let like = |mode: &&Mode| mac(&mode.shape, &complex);
        let mode = modes.iter().max_by(|a, b| like(a).total_cmp(&like(b)))?;
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let scale = dot(&mode.real_shape, truth) / dot(truth, truth);
        let shape = mode.real_shape.iter().take(SENSORS).map(|x| x * scale.signum()).collect();
        Some(Self { mode: mode.clone(), shape, mac: like(&mode), scale_error: scale.abs() - 1.0 })
    }
}

/// The hits of the test, with the force as the hammer measures it.
fn hits(bench: &Bench) -> Result<Vec<Hit>, Error> {
    let clean = bench.hit(HITS[0])?;
    let pulse = Pulse::Haversine { amplitude: HITS[0], duration: BLOW };
    let one = |n: u64| {
        let mut noise = Noise::new(SEEDS + 2 * n);
        let motions = clean.measured(SEEDS + 2 * n + 1, BEFORE);
        let names = bench.sensors.iter().map(String::as_str).chain([HAMMER]);
        let responses: Vec<Channel> = names.zip(motions).map(|(name, x)| channel(name, x)).collect();
        let samples = responses[0].samples.len();
        let at = |k: usize| pulse.at((k as f64 - BEFORE as f64) / RATE);
        let force = (0..samples).map(|k| at(k) + HAMMER_NOISE * HITS[0] * noise.normal()).collect();
        let force = Channel { name: "hammer".into(), ..channel(HAMMER, force) };
        Hit { name: format!("hit {}", n + 1), dt: 1.0 / RATE, force, responses }
    };
    Ok((0..AVERAGED).map(one).collect())
}

fn channel(point: &str, samples: Vec<f64>) -> Channel {
    Channel { name: point.into(), freedom: Freedom::point(point), samples }
}
