//! Amplitude, frequency and damping of one mode against time.

use iwan_ident::curves::Quantity;
use iwan_ident::signal::{self, Event, Method, Options};
use numpy::PyArray1;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::exchange::arguments::{Call, in_python};
use crate::exchange::array::array;
use crate::exchange::errors::{identification_at, identification_of, value};
use crate::exchange::named;
use crate::exchange::options::{thread_count, unknown};
use crate::exchange::pickle::Remake;
use crate::exchange::work;
use crate::records::mode_records::{Modal, band_of_mode, modal, motion};

/// Amplitude, frequency and damping ratio of one mode against time. Made by `envelope`.
///
/// All arrays are float64 with one entry per cycle of the window in which the result can be trusted. Standard
/// deviations hold what scatters about the smooth curve, not what the method gets wrong: for that compare the methods.
#[pyclass(frozen, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Envelope {
    pub(crate) curves: signal::Envelope,
    pub(crate) start: f64,
    /// What the amplitude is of.
    pub(crate) quantity: Quantity,
}

#[pymethods]
impl Envelope {
    /// Times on the record's own clock, s.
    #[getter]
    fn t(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.t.iter().map(|t| self.start + t).collect())
    }

    /// What the amplitude is of: "acceleration", "velocity" or "displacement".
    #[getter]
    fn quantity(&self) -> &'static str {
        match self.quantity {
            Quantity::Displacement => "displacement",
            Quantity::Velocity => "velocity",
            Quantity::Acceleration => "acceleration",
        }
    }

    /// Amplitude, in the unit of the record.
    #[getter]
    fn amplitude(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.amplitude.clone())
    }

    /// Frequency, Hz.
    #[getter]
    fn frequency(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.frequency.clone())
    }

    /// Damping ratio (0.01 = 1 %).
    #[getter]
    fn damping_ratio(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.damping_ratio.clone())
    }

    /// Standard deviation of the logarithm of the amplitude.
    #[getter]
    fn log_amplitude_sd(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.log_amplitude_sd.clone())
    }

    /// Standard deviation of the frequency, Hz.
    #[getter]
    fn frequency_sd(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.frequency_sd.clone())
    }

    /// Standard deviation of the damping ratio.
    #[getter]
    fn damping_ratio_sd(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.damping_ratio_sd.clone())
    }

    /// Start and end of the window in which all this can be trusted, s.
    #[getter]
    fn trusted(&self) -> (f64, f64) {
        (self.start + self.curves.trusted.0, self.start + self.curves.trusted.1)
    }

    /// How it was found.
    #[getter]
    fn method(&self) -> &'static str {
        self.curves.method.name()
    }

    /// Degree of the polynomial (Hilbert), number of spline intervals (peaks), cycles in a neighbourhood (the others).
    #[getter]
    fn order(&self) -> usize {
        self.curves.order
    }

    /// Standard deviation of the noise in the band, in the unit of the record.
    #[getter]
    fn noise(&self) -> f64 {
        self.curves.noise
    }

    /// What was found and done, in words.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.curves.notes.clone()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remake<'py>> {
        let (py, this) = (slf.py(), slf.get());
        let e = &this.curves;
        let curves = [
            &e.t,
            &e.amplitude,
            &e.frequency,
            &e.damping_ratio,
            &e.log_amplitude_sd,
            &e.frequency_sd,
            &e.damping_ratio_sd,
        ];
        let figures = (this.start, e.trusted, e.order, e.noise);
        let arguments = (curves, figures, e.method.name(), &e.notes, this.quantity());
        Ok((py.import("iwan._native")?.getattr("_envelope")?, arguments.into_bound_py_any(py)?))
    }

    fn __len__(&self) -> usize {
        self.curves.t.len()
    }

    fn __repr__(&self) -> String {
        let (from, to) = self.trusted();
        let n = self.__len__();
        format!("<iwan.Envelope: {n} cycles by '{}', trusted from {from:.6} to {to:.6} s>", self.method())
    }
}

/// The envelope's figures in a pickle: start time, trusted window, order and noise.
type Figures = (f64, (f64, f64), usize, f64);

/// Makes a pickled `Envelope` again.
#[pyfunction]
#[pyo3(signature = (curves, figures, method, notes, quantity = "acceleration"))]
pub(crate) fn _envelope(
    curves: [Vec<f64>; 7],
    figures: Figures,
    method: &str,
    notes: Vec<String>,
    quantity: &str,
) -> PyResult<Envelope> {
    let [t, amplitude, frequency, damping_ratio, log_amplitude_sd, frequency_sd, damping_ratio_sd] = curves;
    let (start, trusted, order, noise) = figures;
    let envelope = signal::Envelope {
        t,
        amplitude,
        frequency,
        damping_ratio,
        log_amplitude_sd,
        frequency_sd,
        damping_ratio_sd,
        trusted,
        method: method_named(method)?,
        order,
        noise,
        notes,
    };
    Ok(Envelope { curves: envelope, start, quantity: motion(quantity)? })
}

/// Envelope and frequency of one mode of a record.
///
/// `record`: a `Record`, or real numbers in one dimension with `dt` (s); `channel`: name or number; without it, several
/// channels are combined by the shape that dominates in the band;
/// `mode`: frequency (Hz) to which the spectral peak of the mode is the nearest one, its band is found around it;
/// `band`: (low, high) in Hz, None: found around `near` (Hz), or around the highest spectral peak; `method`: "hilbert" (analytic
/// signal and polynomials, the paper's), "peaks" (Eq. 6-8), "pff" (peak finding and fitting, doi:10.1115/1.4047416) or
/// "demodulation"; `filter_order`: of the zero-phase Butterworth band-pass, 0 = none; `window`: (start, end) in s from the first
/// sample; `order`: degree of the polynomials (hilbert) or number of spline intervals (peaks), None: Schwarz's criterion.
///
/// Returns an `Envelope`. Raises `iwan.InvalidValueError` for a value out of range; `iwan.IdentificationError` for a record
/// that is too short, does not decay, is clipped to its end, or holds two modes in the band.
///
/// >>> import numpy as np
/// >>> t = np.arange(8192) / 4096.0
/// >>> decay = np.exp(-0.002 * 2 * np.pi * 80.0 * t) * np.cos(2 * np.pi * 80.0 * t)
/// >>> envelope = iwan.envelope(decay, dt=1 / 4096.0)
/// >>> print(f"{np.median(envelope.frequency):.2f} Hz, {np.median(envelope.damping_ratio):.4f}")
/// 80.00 Hz, 0.0020
#[pyfunction]
#[pyo3(signature = (
    record, *, dt = None, channel = None, band = None, near = None, method = "hilbert", filter_order = 3, window = None,
    order = None, mode = None
))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn envelope(
    record: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = named::dt)] dt: Option<f64>,
    channel: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = named::band)] band: Option<[f64; 2]>,
    #[pyo3(from_py_with = named::near)] near: Option<f64>,
    #[pyo3(from_py_with = named::method)] method: &str,
    #[pyo3(from_py_with = named::filter_order)] filter_order: usize,
    #[pyo3(from_py_with = named::window)] window: Option<[f64; 2]>,
    #[pyo3(from_py_with = named::order)] order: Option<usize>,
    #[pyo3(from_py_with = named::mode)] mode: Option<f64>,
) -> PyResult<Envelope> {
    let method = method_named(method)?;
    let band = match (mode, band, near) {
        (None, band, _) => band.map(Into::into),
        (Some(mode), None, None) => Some(band_of_mode(record, dt, channel, mode)?),
        _ => return Err(value("mode goes without band and near: give one of them")),
    };
    let window = window.map(Into::into);
    let options = Options { band, near, filter_order, window, order, ..Options::default() };
    let modal = one(record, dt, channel, &options)?;
    let made = work::run(record.py(), true, move |_| of_modal(modal, method, &options))?;
    made.map_err(|error| identification_of(Call::Envelope, "", error))
}

/// Envelopes of many records, on threads: `iwan.ensemble.envelope`.
#[pyfunction]
#[pyo3(signature = (records, *, dt, channel, band, near, method, filter_order, window, order, first, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn _envelopes(
    py: Python<'_>,
    records: Vec<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = named::dt)] dt: Option<f64>,
    channel: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = named::band)] band: Option<[f64; 2]>,
    #[pyo3(from_py_with = named::near)] near: Option<f64>,
    #[pyo3(from_py_with = named::method)] method: &str,
    #[pyo3(from_py_with = named::filter_order)] filter_order: usize,
    #[pyo3(from_py_with = named::window)] window: Option<[f64; 2]>,
    #[pyo3(from_py_with = named::order)] order: Option<usize>,
    #[pyo3(from_py_with = named::first)] first: usize,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Envelope>> {
    let (method, threads) = (method_named(method)?, thread_count(threads)?);
    let (band, window) = (band.map(Into::into), window.map(Into::into));
    let options = Options { band, near, filter_order, window, order, ..Options::default() };
    let channels = records.iter().map(|record| one(record, dt, channel, &options));
    let channels = channels.collect::<PyResult<Vec<_>>>()?;
    let made = work::watched(py, progress, move |control| {
        work::each(channels, threads, control, |modal| of_modal(modal, method, &options))
    })?;
    let made = made.unwrap_or_default().into_iter().enumerate();
    made.map(|(i, result)| result.map_err(|error| identification_at(Call::Envelope, first + i, error)))
        .collect()
}

/// The envelope of a mode, with the disturbances of its record among the notes.
fn of_modal(modal: Modal, method: Method, options: &Options) -> Result<Envelope, iwan_ident::Error> {
    let Modal { samples, dt, start, notes, quantity, windowed, .. } = modal;
    let mut envelope = signal::envelope(&samples, dt, method, &Options { windowed, ..*options })?;
    let mut before = notes;
    if options.window.is_none() {
        let seen = signal::overview(std::slice::from_ref(&samples), dt);
        if seen.hits.len() > 1 {
            let times: Vec<String> = seen.hits.iter().map(|hit| format!("{:.4}", start + hit.time)).collect();
            before.push(format!(
                "{} hits, at {} s: one envelope goes through all of them, and is none of a ring-down; take one hit (Record.hits, Record.between)",
                seen.hits.len(),
                times.join(", ")
            ));
        }
        // The envelope handles clipping itself, so that it needs no note here.
        let events = seen.events.iter().filter(|event| !matches!(event, Event::Clipped { .. }));
        before.extend(events.map(|event| {
            format!("{event}, at {:.6} s; cut there with Record.between", start + event.time())
        }));
    }
    envelope.notes.splice(..0, before);
    envelope.notes.iter_mut().for_each(|note| *note = in_python(note, Call::Envelope));
    Ok(Envelope { curves: envelope, start, quantity })
}

/// The mode of one record.
fn one(
    record: &Bound<'_, PyAny>,
    dt: Option<f64>,
    channel: Option<&Bound<'_, PyAny>>,
    options: &Options,
) -> PyResult<Modal> {
    let record = std::slice::from_ref(record);
    modal(record, dt, channel, None, None, options, Call::Envelope)?
        .pop()
        .ok_or_else(|| value("there is no record"))
}

/// The method with this name.
pub(crate) fn method_named(name: &str) -> PyResult<Method> {
    let names = || Method::ALL.map(Method::name);
    Method::ALL.into_iter().find(|m| m.name() == name).ok_or_else(|| unknown("method", name, &names()))
}
