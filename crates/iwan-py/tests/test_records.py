"""Records from files and arrays, and envelopes."""

import os
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import iwan


def decay(f=80.0, zeta=0.002, rate=4096.0, n=8192):
    t = np.arange(n) / rate
    return np.exp(-zeta * 2 * np.pi * f * t) * np.cos(2 * np.pi * f * np.sqrt(1 - zeta**2) * t)


def test_formats_agree(tmp_path):
    t, a, b = np.arange(8) / 4.0, np.sin(np.arange(8.0)), np.cos(np.arange(8.0))
    np.savetxt(tmp_path / "r.csv", np.column_stack([t, a, b]), delimiter=",", header="time,a,b", comments="", fmt="%.17g")
    np.savez(tmp_path / "r.npz", time=t, a=a, b=b)
    text, archive = iwan.read_record(tmp_path / "r.csv"), iwan.read_record(str(tmp_path / "r.npz"), time="time")
    for record in (text, archive):
        assert record.names == ["a", "b"] and record.dt == 0.25 and record.rate == 4.0 and len(record) == 8
        np.testing.assert_array_equal(record.samples, [a, b])
        np.testing.assert_array_equal(record.t, t)
    one = iwan.read_record(tmp_path / "r.csv", channels=["b"], quantity="velocity")
    assert one.quantity == "velocity" and one.names == ["b"]
    np.testing.assert_array_equal(one.channel(), b)


def test_errors_speak_python(tmp_path):
    with pytest.raises(FileNotFoundError) as missing:
        iwan.read_record(tmp_path / "none.csv")
    assert isinstance(missing.value, iwan.MissingFileError) and isinstance(missing.value, iwan.IwanError)
    assert missing.value.errno == 2 and missing.value.filename == tmp_path / "none.csv"
    with pytest.raises(iwan.FileError):
        iwan.read_record(tmp_path)
    (tmp_path / "r.csv").write_text("a\n1\n2\n3\n")
    with pytest.raises(iwan.RecordError, match="rate=") as no_time:
        iwan.read_record(tmp_path / "r.csv")
    assert "--" not in str(no_time.value) and isinstance(no_time.value, ValueError)
    with pytest.raises(iwan.RecordError, match="there is no channel 'b'"):
        iwan.read_record(tmp_path / "r.csv", rate=10.0, channels=["b"])
    with pytest.raises(iwan.InvalidValueError, match="format = 'doc' is not known"):
        iwan.read_record(tmp_path / "r.csv", format="doc")
    with pytest.raises(iwan.InvalidValueError, match="quantity = 'speed'"):
        iwan.read_record(tmp_path / "r.csv", quantity="speed")


def test_a_record_is_checked_and_frozen():
    record = iwan.Record(np.arange(6).reshape(2, 3), dt=0.5, names=["x", "y"])
    assert record.samples.dtype == np.float64 and not record.samples.flags.writeable
    with pytest.raises(ValueError):
        record.channel("x")[0] = 1.0
    np.testing.assert_array_equal(record.channel(-1), [3.0, 4.0, 5.0])
    np.testing.assert_array_equal(record.channel("x"), record.channel(0))
    assert np.shares_memory(record.channel(0), record.samples)
    for bad in [2, -3, "z"]:
        with pytest.raises(iwan.InvalidValueError):
            record.channel(bad)
    with pytest.raises(iwan.InvalidTypeError):
        record.channel(1.5)
    with pytest.raises(iwan.InvalidValueError, match="2 channels"):
        record.channel()
    with pytest.raises(TypeError):
        hash(record)


@pytest.mark.parametrize(
    ("samples", "options", "message"),
    [
        ([1.0], {}, "at least 2"),
        ([], {}, "at least 2"),
        (np.empty((0, 4)), {}, "no channel"),
        (np.empty((2, 0)), {}, "at least 2"),
        ([[[1.0]]], {}, "shape"),
        (1.0, {}, "shape"),
        ([1.0, np.nan], {}, "sample 1"),
        ([1.0, 2.0], {"dt": 0.0}, "interval is 0"),
        ([1.0, 2.0], {"names": ["a", "b"]}, "2 names for 1 channels"),
        ([1.0, 2.0], {"start": np.inf}, "start time"),
        ([1.0, 2.0], {"quantity": "speed"}, "quantity = 'speed'"),
    ],
)
def test_bad_records_are_named(samples, options, message):
    with pytest.raises(iwan.InvalidValueError, match=message):
        iwan.Record(samples, **({"dt": 0.1} | options))


def test_a_unit_of_another_quantity_is_refused():
    for quantity, unit, of in [("acceleration", "N", "force"), ("force", "m/s^2", "acceleration"), ("displacement", "mm/s", "velocity")]:
        said = f"unit = '{unit}' is a unit of {of}, and quantity = '{quantity}'"
        with pytest.raises(iwan.InvalidValueError, match=re.escape(said)):
            iwan.Record([1.0, 2.0], dt=0.1, quantity=quantity, unit=unit)
    # Volts of a sensor are a unit of whatever it measures; a unit that is not known contradicts nothing.
    for quantity, unit in [("acceleration", "g"), ("acceleration", "mV"), ("velocity", "counts"), ("unknown", "N"), ("force", "")]:
        record = iwan.Record([1.0, 2.0], dt=0.1, quantity=quantity, unit=unit)
        assert pickle.loads(pickle.dumps(record)) == record and record.unit == unit


def test_an_interval_that_may_be_a_rate_is_named(tmp_path):
    said = r"the samples are 1000 s apart: the record lasts 63000 s and holds no frequency above 0.0005 Hz; .* dt = 0.001 s"
    x = np.sin(np.arange(64.0))
    for call in [
        lambda: iwan.Record(x, dt=1000.0),
        lambda: iwan.as_record(x, dt=1000.0),
        lambda: iwan.as_record({"acc": x}, dt=1000.0),
    ]:
        with pytest.warns(UserWarning, match=said):
            record = call()
    # Said once, where the record is made; slow pendulums are sampled at 10 Hz, tides at 1 Hz.
    assert record.between(0.0, 10_000.0) and pickle.loads(pickle.dumps(record)) == record
    for dt in (0.1, 1.0):
        assert iwan.Record(x, dt=dt).dt == dt
    (tmp_path / "r.csv").write_text("a\n" + "".join(f"{v}\n" for v in x))
    with pytest.warns(UserWarning, match=said):
        iwan.read_record(tmp_path / "r.csv", rate=1e-3)


@pytest.mark.parametrize("method", ["hilbert", "peaks", "pff", "demodulation"])
def test_every_method_finds_a_linear_mode(method):
    envelope = iwan.envelope(decay(), dt=1 / 4096, method=method)
    assert envelope.method == method and len(envelope) == len(envelope.t) == len(envelope.amplitude)
    middle = slice(len(envelope) // 4, -len(envelope) // 4)
    np.testing.assert_allclose(envelope.frequency[middle], 80.0, atol=0.02)
    np.testing.assert_allclose(envelope.damping_ratio[middle], 0.002, rtol=0.05)
    expected = np.exp(-0.002 * 2 * np.pi * 80.0 * envelope.t)
    np.testing.assert_allclose(envelope.amplitude[middle], expected[middle], rtol=0.01)
    assert envelope.trusted[0] <= envelope.t[0] and envelope.t[-1] <= envelope.trusted[1]
    for deviation in [envelope.log_amplitude_sd, envelope.frequency_sd, envelope.damping_ratio_sd]:
        assert deviation.shape == envelope.t.shape and np.all(deviation >= 0)
    assert envelope.notes and envelope.order >= 1 and envelope.noise >= 0


def test_an_array_and_a_record_are_the_same_and_time_is_the_records_own():
    x = decay()
    bare = iwan.envelope(x, dt=1 / 4096)
    record = iwan.Record([np.ones_like(x) * np.sin(x), x], dt=1 / 4096, names=["other", "tip"], start=-1.0)
    named = iwan.envelope(record, channel="tip")
    np.testing.assert_array_equal(named.amplitude, bare.amplitude)
    np.testing.assert_allclose(named.t, bare.t - 1.0, atol=1e-12)
    np.testing.assert_array_equal(iwan.envelope(record, channel=1).frequency, bare.frequency)
    strided = np.zeros(2 * len(x))
    strided[::2] = x
    np.testing.assert_array_equal(iwan.envelope(strided[::2], dt=1 / 4096).amplitude, bare.amplitude)
    integers = (1e6 * x).astype(np.int32)
    scaled = iwan.envelope(integers, dt=1 / 4096)
    np.testing.assert_allclose(scaled.frequency[5:-5], bare.frequency[5:-5], rtol=1e-4)


def test_channels_are_combined_by_the_shape_that_dominates():
    x = decay()
    record = iwan.Record([x, -0.5 * x], dt=1 / 4096, names=["tip", "root"])
    both, one = iwan.envelope(record), iwan.envelope(record, channel="tip")
    np.testing.assert_allclose(both.amplitude, one.amplitude, rtol=1e-9)
    assert any("tip 1.0000, root -0.5000" in note for note in both.notes)


def test_bad_envelopes_are_named():
    x = decay()
    with pytest.raises(iwan.InvalidValueError, match="dt is missing"):
        iwan.envelope(x)
    with pytest.raises(iwan.InvalidValueError, match="a Record has its own"):
        iwan.envelope(iwan.Record(x, dt=0.1), dt=0.1)
    with pytest.raises(iwan.InvalidValueError, match="band"):
        iwan.envelope(x, dt=1 / 4096, band=(100.0, 50.0))
    with pytest.raises(iwan.InvalidValueError, match="method = 'fft'"):
        iwan.envelope(x, dt=1 / 4096, method="fft")
    with pytest.raises(iwan.IdentificationError, match="at least 64 needed"):
        iwan.envelope(x[:20], dt=1 / 4096)
    two = x + decay(f=81.5)
    with pytest.raises(iwan.IdentificationError):
        iwan.envelope(two, dt=1 / 4096, band=(70.0, 90.0))
    with pytest.raises(iwan.InvalidValueError, match="sample 3"):
        iwan.envelope(np.where(np.arange(8192) == 3, np.nan, x), dt=1 / 4096)


def test_a_measured_record():
    """Runs where IWAN_FIELD_DATA names the folder of measured records."""
    folder = os.environ.get("IWAN_FIELD_DATA")
    if folder is None:
        pytest.skip("IWAN_FIELD_DATA not set")
    if not (Path(folder) / "field").is_dir():
        pytest.skip("IWAN_FIELD_DATA has no such folder")
    file = Path(folder) / "field" / "brb_hammer_impact.mat"
    record = iwan.read_record(file, time="HIdata.time", channels=["HIdata.acc1"])
    assert len(record) > 1000 and np.isfinite(record.samples).all()


def test_times_units_and_stretches(tmp_path):
    rows = "".join(f"{i},{i % 3}\n" for i in range(8))
    (tmp_path / "r.csv").write_text("t [furlong],a [g]\n" + rows)
    with pytest.raises(iwan.RecordError, match="'furlong'") as unknown:
        iwan.read_record(tmp_path / "r.csv")
    assert "time_unit=" in str(unknown.value) and "--" not in str(unknown.value)
    record = iwan.read_record(tmp_path / "r.csv", time_unit="ms", unit="SI", start=0.002, stop=0.005)
    assert record.dt == pytest.approx(1e-3) and record.unit == "m/s^2" and len(record) == 4
    np.testing.assert_allclose(record.samples, [np.array([2.0, 0.0, 1.0, 2.0]) * 9.80665])
    with pytest.raises(iwan.InvalidValueError, match="no unit of time"):
        iwan.read_record(tmp_path / "r.csv", time_unit="furlong")
    again = record.between(stop=0.0041)
    assert len(again) == 3 and again.warnings == record.warnings
    with pytest.raises(iwan.InvalidValueError, match="at least 2"):
        record.between(start=1.0)


def test_what_is_no_motion_is_asked_for():
    t = np.arange(4000) / 2000.0
    decay = np.exp(-2.0 * t) * np.sin(2 * np.pi * 80.0 * t)
    for quantity, unit in (("pressure", "Pa"), ("voltage", "V"), ("unknown", "counts")):
        record = iwan.Record(decay, dt=5e-4, quantity=quantity, unit=unit)
        with pytest.raises(iwan.InvalidValueError, match="quantity="):
            iwan.fit(record)


def test_modes_by_their_peaks():
    t = np.arange(16000) / 4000.0
    decay = np.exp(-2.0 * t) * (np.sin(2 * np.pi * 100.0 * t) + 0.2 * np.sin(2 * np.pi * 151.0 * t))
    record = iwan.Record(decay, dt=1 / 4000.0)
    peaks = record.spectral_peaks()
    assert [round(p["frequency"]) for p in peaks] == [100, 151]
    assert peaks[0]["height"] == 1.0 and peaks[0]["damping_ratio"] == pytest.approx(2.0 / (2 * np.pi * 100.0), rel=0.05)
    envelope = iwan.envelope(record, mode=155.0)
    assert np.median(envelope.frequency) == pytest.approx(151.0, abs=0.05)
    with pytest.raises(iwan.InvalidValueError, match="one of them"):
        iwan.envelope(record, mode=155.0, band=(120.0, 180.0))
    with pytest.raises(iwan.IdentificationError, match="no spectral peak"):
        iwan.envelope(record, mode=400.0)
