//! The evaluation of one hit: band-pass, scaling, average, envelope, curves (Sec. 4.4).

use std::f64::consts::TAU;

use iwan_ident::channels::{Average, scaled_average};
use iwan_ident::curves::{Curves, ForceAxis, Quantity};
use iwan_ident::signal::{Butterworth, Envelope, Method, Options, Passband, envelope};

use super::bench::{Bench, HITS, RATE, SENSORS};
use crate::error::Error;
use crate::printed::BAND;
use crate::span::Span;

/// Order of the band-pass filter, and degree of the polynomials in the envelope: 3, as for the beam's records in micro-slip.
const ORDER: usize = 3;
/// Part of the record that is evaluated, s. The filter's slowest pole decays at the rate π times half the band of 15 Hz, 24 1/s. After 0.35 s, from
/// the blow and, for the backward pass, from the end of the record, 3e-4 of the filter's transients is left.
const WINDOW: Span = Span { from: 0.35, to: 1.65 };
/// Indices of the sensors whose band-passed records are drawn: the first, the middle and the last of one edge, and the last of the other.
const DRAWN: [usize; 4] = [0, 14, 26, 53];

/// One hit: the average of all sensors, and the curves evaluated from it.
#[derive(Debug, Clone)]
pub struct Hit {
    /// Peak force of the hammer, N.
    pub force: f64,
    /// Band-passed and scaled records of the sensors to be drawn.
    pub drawn: Vec<DrawnSensor>,
    /// Average of the scaled records over all sensors, with the misfit of each sensor.
    pub average: Average,
    /// Amplitude, frequency and damping of the average against time.
    pub envelope: Envelope,
    /// Curves of the average over modal force.
    pub curves: Curves,
    /// Largest acceleration of any sensor, m/s².
    pub peak: f64,
    /// Sampling interval, s.
    pub dt: f64,
}

/// The mode's motion as one sensor measures it.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnSensor {
    /// Name, such as `point 1`.
    pub name: String,
    /// Band-passed record of the sensor divided by the mode's shape value there, √kg·m/s².
    pub samples: Vec<f64>,
}

/// A viscous damper in parallel with a mode's joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViscousTerm {
    /// Viscous damping ratio ζ_v.
    pub damping_ratio: f64,
    /// Frequency ω0/2π, Hz.
    pub frequency: f64,
}

impl ViscousTerm {
    /// Energy that the damper dissipates per cycle, 2π ζ_v ω0 ω q², for the displacement amplitude `q` and the frequency ω/2π in Hz.
    ///
    /// ```
    /// use iwan_study::laboratory::ViscousTerm;
    /// let term = ViscousTerm { damping_ratio: 0.01, frequency: 2.0 };
    /// // 2π · 0.01 · (2π · 2)² · 3² for a mode that vibrates at ω0.
    /// assert!((term.dissipation(3.0, 2.0) - 89.298).abs() < 1e-3);
    /// ```
    #[must_use]
    pub fn dissipation(&self, q: f64, frequency: f64) -> f64 {
        TAU * self.damping_ratio * TAU * self.frequency * TAU * frequency * q * q
    }
}

impl Hit {
    /// Evaluates hit `n` of a bench with the mode's `shape` at the sensors from the modal test.
    pub(super) fn new(bench: &Bench, shape: &[f64], n: usize) -> Result<Self, Error> {
        let place = format!("laboratory, hit of {} N", HITS[n]);
        let mut channels = bench.hit(HITS[n])?.measured(n as u64, 0);
        channels.truncate(SENSORS);
        Self::take_apart(&bench.sensors, shape, HITS[n], &channels).map_err(Error::identification(&place))
    }

    fn take_apart(
        sensors: &[String],
        shape: &[f64],
        force: f64,
        channels: &[Vec<f64>],
    ) -> Result<Self, iwan_ident::Error> {
        let dt = 1.0 / RATE;
        let filter = Butterworth::new(ORDER, Passband::Band { low: BAND.from, high: BAND.to }, dt)?;
        let filtered: Result<Vec<Vec<f64>>, _> =
            channels.iter().map(|channel| filter.forward_backward(channel)).collect();
        let filtered = filtered?;
        let slices: Vec<&[f64]> = filtered.iter().map(Vec::as_slice).collect();
        let average = scaled_average(&slices, shape)?;
        // Filter and average commute. The average of the raw records is therefore taken, whose envelope applies the band-pass itself and knows how
        // far its transients reach.
        let raw: Vec<&[f64]> = channels.iter().map(Vec::as_slice).collect();
        let raw = scaled_average(&raw, shape)?.samples;
        let options = Options {
            band: Some(BAND.into()),
            filter_order: ORDER,
            window: Some(WINDOW.into()),
            order: Some(ORDER),
            ..Options::default()
        };
        let envelope = envelope(&raw, dt, Method::Hilbert, &options)?;
        let curves = Curves::new(&envelope, Quantity::Acceleration, ForceAxis::Modal)?;
        let scaled = |&k: &usize| DrawnSensor {
            name: sensors[k].clone(),
            samples: filtered[k].iter().map(|a| a / shape[k]).collect(),
        };
        let peak = channels.iter().flatten().fold(0.0, |most: f64, a| most.max(a.abs()));
        Ok(Self { force, drawn: DRAWN.iter().map(scaled).collect(), average, envelope, curves, peak, dt })
    }

    /// The dissipation per cycle without that of the viscous term.
    #[must_use]
    pub fn without(&self, viscous: ViscousTerm) -> Vec<f64> {
        let c = &self.curves;
        let left = |i: usize| c.dissipation[i] - viscous.dissipation(c.displacement[i], c.frequency[i]);
        (0..c.t.len()).map(left).collect()
    }
}
