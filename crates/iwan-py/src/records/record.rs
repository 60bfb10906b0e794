//! Records: uniformly sampled channels, from files or arrays.

use iwan_ident::curves;
use iwan_ident::signal::{Event, SpectralPeak};
use iwan_io::{Quantity, quantity_of_unit};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};

use crate::exchange::arguments::{Call, in_python};
use crate::exchange::array::{Numbers, array, freeze, frozen_rows};
use crate::exchange::errors::{identification, no_record, value, value_of, warn, wrong_type};
use crate::exchange::named;
use crate::exchange::options::choose;
use crate::exchange::pickle::Remake;
use crate::exchange::work;

pub(super) const QUANTITIES: [(&str, Quantity); 8] = [
    ("acceleration", Quantity::Acceleration),
    ("velocity", Quantity::Velocity),
    ("displacement", Quantity::Displacement),
    ("force", Quantity::Force),
    ("pressure", Quantity::Pressure),
    ("voltage", Quantity::Voltage),
    ("strain", Quantity::Strain),
    ("unknown", Quantity::Unknown),
];

/// Interval in s beyond which a warning says what it means: structures of metres swing within seconds and are sampled many times in each
/// of their cycles. A judgement, and no refusal: what swings for minutes is sampled slowly.
const FAR_APART: f64 = 1.0;

/// One or many channels sampled together at a constant interval; checked once, frozen, picklable.
///
/// `samples`: real numbers, channels x samples (or one dimension for one channel), all finite, at least two;
/// `dt`: sampling interval > 0 (s), with a warning for more than 1 s, where a rate may have been meant; `names`: one for each channel;
/// `quantity`: "acceleration", "velocity", "displacement", "force", "pressure", "voltage", "strain" or "unknown"; `unit`: as text, and no unit
/// of another quantity, but for volts, in which sensors give whatever they measure; `start`: time of the first sample (s).
///
/// Raises `iwan.InvalidValueError` naming channel and sample.
///
/// >>> record = iwan.Record([[0.0, 1.0, 4.0]], dt=0.5, names=["tip"], quantity="displacement", unit="m")
/// >>> record.t, record.channel("tip")
/// (array([0. , 0.5, 1. ]), array([0., 1., 4.]))
#[pyclass(frozen, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Record {
    pub(crate) dt: f64,
    pub(crate) start: f64,
    pub(crate) names: Vec<String>,
    pub(crate) quantity: Quantity,
    pub(crate) unit: String,
    pub(super) warnings: Vec<String>,
    /// Whether the file says that a window lies over a channel.
    pub(super) windowed: bool,
    /// Channels x samples, float64, read-only.
    #[pyo3(get)]
    pub(crate) samples: Py<PyArray2<f64>>,
}

impl Record {
    pub(super) fn wrap(py: Python<'_>, record: &iwan_io::Record) -> PyResult<Self> {
        Ok(Self {
            dt: record.dt(),
            start: record.start(),
            names: record.names().to_vec(),
            quantity: record.quantity(),
            unit: record.unit().to_owned(),
            warnings: record.warnings().iter().map(|w| in_python(&w.to_string(), Call::File)).collect(),
            windowed: record.is_windowed(),
            samples: frozen_rows(py, record.samples())?,
        })
    }

    /// A part of this record, with what is noted of the whole.
    fn noted(&self, part: Self) -> Self {
        Self { warnings: self.warnings.clone(), windowed: self.windowed, ..part }
    }

    /// The record of the library, made from this one and checked again.
    pub(crate) fn whole(&self, py: Python<'_>) -> PyResult<iwan_io::Record> {
        let rows = self.samples.bind(py).readonly().as_array().outer_iter().map(|row| row.to_vec()).collect();
        let record = iwan_io::Record::new(self.dt, rows, self.names.clone());
        let record = record.and_then(|record| record.with_start(self.start));
        Ok(record.map_err(|error| no_record(&error))?.with_quantity(self.quantity, self.unit.clone()))
    }

    /// Index of a channel given by name or number; of the only channel when neither is given.
    pub(crate) fn index(&self, channel: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
        let n = self.names.len();
        let names = || format!("'{}'", self.names.join("', '"));
        let Some(channel) = channel else {
            let several =
                || value(format!("the record has {n} channels ({}): choose one with channel=", names()));
            return if n == 1 { Ok(0) } else { Err(several()) };
        };
        if let Ok(name) = channel.extract::<String>() {
            let found = self.names.iter().position(|other| *other == name);
            return found
                .ok_or_else(|| value(format!("there is no channel '{name}': there are {}", names())));
        }
        let number = (!channel.is_instance_of::<PyBool>()).then(|| channel.extract::<i64>().ok()).flatten();
        let Some(i) = number else {
            return Err(wrong_type("channel must be the name or the number of a channel"));
        };
        let size = usize::try_from(i.unsigned_abs()).ok();
        let index = if i < 0 { size.and_then(|size| n.checked_sub(size)) } else { size };
        let found = index.filter(|index| *index < n);
        found.ok_or_else(|| value(format!("channel {i} is out of range: the record has {n} channels")))
    }
}

impl Record {
    /// From an array, as it was given.
    fn of_samples(
        samples: &Bound<'_, PyAny>,
        dt: f64,
        names: Option<Vec<String>>,
        quantity: &str,
        unit: &str,
        start: f64,
    ) -> PyResult<Self> {
        let py = samples.py();
        let Numbers { values, shape } = Numbers::read("samples", samples)?;
        let (channels, length) = match shape[..] {
            [n] => (1, n),
            [channels, n] => (channels, n),
            _ => {
                return Err(value(format!(
                    "samples has the shape {shape:?}: give channels x samples, or one dimension for one channel"
                )));
            }
        };
        let rows: Vec<Vec<f64>> = if length == 0 {
            vec![Vec::new(); channels]
        } else {
            values.chunks(length).map(<[f64]>::to_vec).collect()
        };
        let names = names.unwrap_or_else(|| (0..channels).map(|i| format!("channel {i}")).collect());
        let record = iwan_io::Record::new(dt, rows, names).and_then(|record| record.with_start(start));
        let record = record.map_err(|error| no_record(&error))?;
        Self::wrap(py, &record.with_quantity(choose("quantity", quantity, &QUANTITIES)?, unit))
    }
    /// The record, with a warning where its samples lie so far apart that a rate may have been meant.
    pub(super) fn warned(self, py: Python<'_>) -> PyResult<Self> {
        if self.dt > FAR_APART {
            let (dt, seconds) = (self.dt, self.dt * (self.__len__(py) - 1) as f64);
            let message = format!(
                "the samples are {dt} s apart: the record lasts {seconds} s and holds no frequency above {} Hz; where {dt} is the sampling \
                 rate in Hz, the interval is dt = {} s",
                0.5 / dt,
                1.0 / dt
            );
            warn(py, &message)?;
        }
        Ok(self)
    }

    /// What motion was measured, and what had to be assumed, in the words of a call.
    pub(crate) fn motion(
        &self,
        given: Option<curves::Quantity>,
        call: Call,
    ) -> PyResult<(curves::Quantity, Vec<String>)> {
        match (given, self.quantity) {
            (Some(given), _) => Ok((given, Vec::new())),
            (_, Quantity::Acceleration) => Ok((curves::Quantity::Acceleration, Vec::new())),
            (_, Quantity::Velocity) => Ok((curves::Quantity::Velocity, Vec::new())),
            (_, Quantity::Displacement) => Ok((curves::Quantity::Displacement, Vec::new())),
            (_, other) if other != Quantity::Unknown || !self.unit.is_empty() => {
                let what = if other == Quantity::Unknown {
                    format!("is in '{}'", self.unit)
                } else {
                    format!("is a {other}")
                };
                let remedy =
                    "choose another channel, or say with --quantity what motion it is proportional to";
                Err(value_of(call, &format!("the record {what}, not known as a motion: {remedy}")))
            }
            _ => {
                let note = "what was measured is not known: taken as acceleration, --quantity says otherwise";
                Ok((curves::Quantity::Acceleration, vec![in_python(note, call)]))
            }
        }
    }
}

#[pymethods]
impl Record {
    #[new]
    #[pyo3(signature = (samples, *, dt, names = None, quantity = "unknown", unit = "", start = 0.0))]
    fn new(
        samples: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = named::dt)] dt: f64,
        #[pyo3(from_py_with = named::names)] names: Option<Vec<String>>,
        #[pyo3(from_py_with = named::quantity)] quantity: &str,
        #[pyo3(from_py_with = named::unit)] unit: &str,
        #[pyo3(from_py_with = named::start)] start: f64,
    ) -> PyResult<Self> {
        let record = Self::of_samples(samples, dt, names, quantity, unit, start)?;
        check_unit(record.quantity, unit)?;
        record.warned(samples.py())
    }

    /// Sampling interval, s.
    #[getter]
    fn dt(&self) -> f64 {
        self.dt
    }

    /// Sampling rate, Hz.
    #[getter]
    fn rate(&self) -> f64 {
        1.0 / self.dt
    }

    /// Time of the first sample, s.
    #[getter]
    fn start(&self) -> f64 {
        self.start
    }

    /// Names of the channels.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.names.clone()
    }

    /// What the samples measure: "acceleration", "velocity", "displacement", "force" or "unknown".
    #[getter]
    fn quantity(&self) -> String {
        self.quantity.to_string()
    }

    /// Unit of the samples as text; empty when not known.
    #[getter]
    fn unit(&self) -> &str {
        &self.unit
    }

    /// What the reader of the file noticed, in words.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Times of the samples, s, float64 array.
    #[getter]
    fn t(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, (0..self.__len__(py)).map(|i| self.start + i as f64 * self.dt).collect())
    }

    /// Samples of one channel by name or number: a read-only view of `samples`. Without an argument the only channel.
    ///
    /// Raises `iwan.InvalidValueError` naming the channels there are.
    ///
    /// >>> iwan.Record([[1.0, 2.0], [3.0, 4.0]], dt=0.1, names=["root", "tip"]).channel("tip")
    /// array([3., 4.])
    #[pyo3(signature = (channel = None))]
    fn channel<'py>(
        &self,
        py: Python<'py>,
        channel: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let row = self.samples.bind(py).get_item(self.index(channel)?)?;
        freeze(&row)?;
        Ok(row)
    }

    /// The samples between two times (s, on the record's own clock, both included; None: from the first, to the last) as a `Record`.
    ///
    /// Raises `iwan.InvalidValueError` where fewer than two samples are left.
    ///
    /// >>> record = iwan.Record([[0.0, 1.0, 4.0, 9.0]], dt=0.5, start=-0.5)
    /// >>> record.between(start=0.0).samples
    /// array([[1., 4., 9.]])
    #[pyo3(signature = (start = None, stop = None))]
    fn between(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = named::start)] start: Option<f64>,
        #[pyo3(from_py_with = named::stop)] stop: Option<f64>,
    ) -> PyResult<Self> {
        let cut = self.whole(py)?.between(start, stop).map_err(|error| no_record(&error))?;
        Ok(self.noted(Self::wrap(py, &cut)?))
    }

    /// The hits in the record, each from its blow to the next one, as a list of `Record` on the record's own clock; the record itself where
    /// there are fewer than two, from its release on where the structure is pulled, held, handled or driven before. `iwan.fit` uses each as a record of its own.
    ///
    /// >>> import numpy as np
    /// >>> t = np.arange(2000) / 1000.0
    /// >>> decay = np.exp(-4.0 * t) * np.sin(600.0 * t)
    /// >>> record = iwan.Record(np.concatenate([np.zeros(300), decay, 0.7 * decay]), dt=1e-3)
    /// >>> [round(hit.start, 2) for hit in record.hits()]
    /// [0.3, 2.3]
    fn hits(&self, py: Python<'_>) -> PyResult<Vec<Self>> {
        Ok(self.overview(py)?.0)
    }

    /// What disturbs the record from its release on: a list of dicts with `time` (s, on the record's own clock), `kind` ("clipped", "jump", "wild",
    /// "lost" or "driven") and `what` (the same in words). Samples stand at the end of their range, the zero line jumps, samples are wild or
    /// lost, the decay is driven again.
    ///
    /// >>> import numpy as np
    /// >>> t = np.arange(3000) / 1000.0
    /// >>> decay = np.exp(-t) * np.sin(200.0 * t)
    /// >>> record = iwan.Record(decay + np.where(t < 2.0, 0.0, 0.05), dt=1e-3)
    /// >>> [(seen["kind"], round(seen["time"], 1)) for seen in record.disturbances()]
    /// [('jump', 2.0)]
    fn disturbances<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        Ok(self.overview(py)?.1)
    }

    /// `hits` and `disturbances` for the time of one.
    #[pyo3(name = "_overview")]
    fn overview<'py>(&self, py: Python<'py>) -> PyResult<(Vec<Self>, Vec<Bound<'py, PyDict>>)> {
        let record = self.whole(py)?;
        let (record, seen) = work::run(py, true, move |_| {
            let seen = iwan_ident::signal::overview(record.samples(), record.dt());
            (record, seen)
        })?;
        let cut = |stretch: std::ops::Range<usize>| {
            let (first, last) = (record.time(stretch.start), record.time(stretch.end - 1));
            let cut = record.between(Some(first), Some(last)).map_err(|error| no_record(&error))?;
            Ok(self.noted(Self::wrap(py, &cut)?))
        };
        let told = |event: &Event| {
            let dict = PyDict::new(py);
            dict.set_item("time", record.start() + event.time())?;
            dict.set_item("kind", event.name())?;
            dict.set_item("what", event.to_string())?;
            Ok(dict)
        };
        let hits = seen.stretches().into_iter().map(cut).collect::<PyResult<_>>()?;
        Ok((hits, seen.events.iter().map(told).collect::<PyResult<_>>()?))
    }

    /// The peaks of the spectrum of the ring-down, all channels together, by frequency: a list of dicts with `frequency` (Hz), `height` (over
    /// that of the highest), `width` (Hz, at half the power; None where a neighbour hides it), `damping_ratio` (of a linear mode with
    /// a peak of that width; None where the record is too short to tell) and `prominence` (over the valleys beside it).
    ///
    /// Raises `iwan.IdentificationError` for a record of fewer than 64 samples.
    ///
    /// >>> import numpy as np
    /// >>> t = np.arange(8192) / 4096.0
    /// >>> record = iwan.Record(np.exp(-2.0 * t) * np.cos(2 * np.pi * 80.0 * t), dt=1 / 4096.0)
    /// >>> [round(peak["frequency"], 1) for peak in record.spectral_peaks()]
    /// [80.0]
    fn spectral_peaks<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let record = self.whole(py)?;
        let found = work::run(py, true, move |_| {
            let channels: Vec<&[f64]> = record.samples().iter().map(Vec::as_slice).collect();
            iwan_ident::signal::spectral_peaks(&channels, record.dt())
        })?;
        let peak = |peak: SpectralPeak| {
            let dict = PyDict::new(py);
            dict.set_item("frequency", peak.frequency)?;
            dict.set_item("height", peak.height)?;
            dict.set_item("width", peak.width)?;
            dict.set_item("damping_ratio", peak.damping_ratio)?;
            dict.set_item("prominence", peak.prominence)?;
            Ok(dict)
        };
        found.map_err(identification)?.into_iter().map(peak).collect()
    }

    /// Number of samples of each channel.
    fn __len__(&self, py: Python<'_>) -> usize {
        self.samples.bind(py).shape()[1]
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (n, channels, dt) = (self.__len__(py), self.names.len(), self.dt);
        let unit = if self.unit.is_empty() { String::new() } else { format!(" [{}]", self.unit) };
        format!("<iwan.Record: {} of {channels} channels{unit}, {n} samples every {dt:?} s>", self.quantity)
    }

    fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> bool {
        let Ok(other) = other.cast::<Self>() else { return false };
        let other = other.get();
        let same = |a: &Py<PyArray2<f64>>, b: &Py<PyArray2<f64>>| {
            a.bind(py).readonly().as_array() == b.bind(py).readonly().as_array()
        };
        (self.dt, self.start, &self.names, self.quantity, &self.unit)
            == (other.dt, other.start, &other.names, other.quantity, &other.unit)
            && same(&self.samples, &other.samples)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remake<'py>> {
        let (py, this) = (slf.py(), slf.get());
        let names = this.names.clone();
        let noted = (this.warnings.clone(), this.windowed);
        let described = (names, this.quantity.to_string(), &this.unit, noted);
        let arguments = (this.samples.clone_ref(py), this.dt, this.start, described);
        Ok((py.import("iwan._native")?.getattr("_record")?, arguments.into_bound_py_any(py)?))
    }
}

/// Refuses a unit that is known to be of another quantity than the one that was named. Volts are a unit of every quantity: sensors give them.
fn check_unit(quantity: Quantity, unit: &str) -> PyResult<()> {
    let of_unit = quantity_of_unit(unit);
    let fits = [quantity, Quantity::Unknown, Quantity::Voltage].contains(&of_unit);
    if fits || quantity == Quantity::Unknown {
        return Ok(());
    }
    Err(value(format!(
        "unit = '{unit}' is a unit of {of_unit}, and quantity = '{quantity}': give the unit in which the samples are, or quantity = '{of_unit}'"
    )))
}

/// Names, quantity, unit, and what is noted (warnings, and whether there is a window), as pickled.
type Described = (Vec<String>, String, String, (Vec<String>, bool));

/// Makes a pickled `Record` again.
#[pyfunction]
pub(crate) fn _record(
    samples: &Bound<'_, PyAny>,
    dt: f64,
    start: f64,
    described: Described,
) -> PyResult<Record> {
    let (names, quantity, unit, (warnings, windowed)) = described;
    Ok(Record {
        warnings,
        windowed,
        ..Record::of_samples(samples, dt, Some(names), &quantity, &unit, start)?
    })
}
