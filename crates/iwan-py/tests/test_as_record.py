"""Records as other libraries hand them out."""

import numpy as np
import pandas
import pytest
import pyuff
import scipy.io
import xarray

import iwan

T = np.arange(200) / 100.0
A, B = np.sin(T), np.cos(T)


def check(record, names=("a", "b")):
    assert record.names == list(names) and record.dt == pytest.approx(0.01)
    np.testing.assert_allclose(record.samples, [A, B][: len(names)], rtol=1e-6, atol=1e-7)


def test_scipy_io(tmp_path):
    path = tmp_path / "r.mat"
    scipy.io.savemat(path, {"time": T, "a": A, "b": B})
    check(iwan.as_record(scipy.io.loadmat(path)))
    scipy.io.savemat(path, {"HIdata": {"time": T, "acc1": A, "acc3": B}, "note": "hammer"})
    for loaded in [scipy.io.loadmat(path), scipy.io.loadmat(path, simplify_cells=True)]:
        record = iwan.as_record(loaded, time="HIdata.time", channels=["HIdata.acc1", "HIdata.acc3"])
        check(record, ["HIdata.acc1", "HIdata.acc3"])
        assert record.quantity == "acceleration"
        np.testing.assert_array_equal(record.samples, iwan.read_record(path, time="HIdata.time").samples)


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_pyuff(tmp_path):
    """pyuff leaves its files open, which is why the warnings."""
    path = str(tmp_path / "r.uff")
    for name, x, kind in [("a", A, 12), ("b", B, 12)]:
        data = pyuff.prepare_58(
            binary=1, func_type=1, rsp_node=1, rsp_dir=3, ref_node=1, ref_dir=3, data=x, x=T, id1=name,
            ordinate_spec_data_type=kind, ordinate_axis_units_lab="m/s^2", abscissa_inc=0.01, abscissa_min=0.0,
            abscissa_spacing=1, num_pts=len(T), return_full_dict=True,
        )
        # pyuff leaves fields open that it cannot write.
        texts = ("name", "lab", "id2", "id3", "id4", "id5")
        data = {key: ("NONE" if key.endswith(texts) else 0) if value is None else value for key, value in data.items()}
        pyuff.UFF(path).write_sets(data, "add")
    sets = pyuff.UFF(path).read_sets()
    record = iwan.as_record(sets)
    check(record)
    assert record.quantity == "acceleration" and record.unit == "m/s^2"
    check(iwan.as_record(sets[0]), ["a"])
    np.testing.assert_allclose(iwan.read_record(path).samples, record.samples, rtol=1e-12)
    spectrum = dict(sets[0], func_type=4)
    with pytest.raises(iwan.RecordError, match="no time response"):
        iwan.as_record(spectrum)


def test_pandas_and_xarray():
    frame = pandas.DataFrame({"a": A, "b": B}, index=T + 1.0)
    record = iwan.as_record(frame, quantity="velocity")
    check(record)
    assert record.start == 1.0 and record.quantity == "velocity"
    check(iwan.as_record(frame["a"]), ["a"])
    check(iwan.as_record(frame.reset_index(drop=True), dt=0.01))
    array = xarray.DataArray([A, B], dims=["channel", "time"], coords={"channel": ["a", "b"], "time": T}, name="x")
    check(iwan.as_record(array))
    check(iwan.as_record(array.T))
    check(iwan.as_record(array[0]), ["x"])


def test_they_are_accepted_as_they_come():
    t = np.arange(8192) / 4096.0
    decay = np.exp(-t) * np.cos(2 * np.pi * 80.0 * t)
    expected = iwan.envelope(decay, dt=1 / 4096).amplitude
    for data in [pandas.Series(decay, index=t), {"t": t, "x": decay}, xarray.DataArray(decay, dims="t", coords={"t": t})]:
        np.testing.assert_allclose(iwan.envelope(data).amplitude, expected, rtol=1e-9)


def test_what_is_no_record_is_refused():
    with pytest.raises(iwan.InvalidTypeError, match="no vector"):
        iwan.as_record({"note": "hammer"})
    with pytest.raises(iwan.InvalidValueError, match="dt is missing"):
        iwan.as_record(A)
    with pytest.raises(iwan.RecordError, match="not uniform"):
        iwan.as_record(pandas.Series(A, index=T**2))
    with pytest.raises(iwan.RecordError):
        iwan.as_record({"a": A, "b": B})
    with pytest.raises(iwan.InvalidValueError, match="3 dimensions"):
        iwan.as_record(xarray.DataArray(np.zeros((2, 2, 2)), dims=["a", "b", "t"]))


def test_a_response_as_a_dataset():
    response = iwan.simulate(iwan.Mode(frequency=10.0), dt=1e-2, duration=1.0, initial=(1.0, 0.0))
    data = response.to_xarray()
    np.testing.assert_array_equal(data["velocity"], response.velocity)
    assert data.attrs["steps"] == 100 and data["t"].attrs["units"] == "s"


def test_tables_of_pandas_with_their_times_in_a_column():
    """The row number was taken for seconds, and `time` was ignored."""
    frame = pandas.DataFrame({"t": T, "a": A})
    assert iwan.as_record(frame).dt == pytest.approx(T[1] - T[0])
    assert iwan.as_record(frame).names == ["a"]
    frame = pandas.DataFrame({"clock": T, "a": A})
    assert iwan.as_record(frame, time="clock").dt == pytest.approx(T[1] - T[0])
    with pytest.raises(iwan.IwanError, match="rate|dt="):
        iwan.as_record(pandas.DataFrame({"a": A, "b": B}))
    with pytest.raises(iwan.RecordError, match="counts rows"):
        iwan.as_record(pandas.Series(A))


def test_durations_dates_and_units_of_time():
    """Nanoseconds were read as seconds, dates raised a bare TypeError, `ms` was read as s."""
    step = T[1] - T[0]
    durations = pandas.to_timedelta(T, unit="s")
    for index in [durations, pandas.Timestamp("2026-01-01") + durations, pandas.Timestamp("2026-01-01", tz="UTC") + durations]:
        assert iwan.as_record(pandas.Series(A, index=index)).dt == pytest.approx(step)
    assert iwan.as_record(pandas.Series(A, index=pandas.Index(1e3 * T, name="Time [ms]"))).dt == pytest.approx(step)
    array = xarray.DataArray(A, dims="time", coords={"time": ("time", 1e3 * T, {"units": "ms"})})
    assert iwan.as_record(array).dt == pytest.approx(step)
    assert iwan.as_record({"Time [ms]": 1e3 * T, "a": A}).dt == pytest.approx(step)
    with pytest.raises(iwan.InvalidTypeError, match="no times"):
        iwan.as_record(pandas.Series(A, index=[str(t) for t in T]))


def test_masked_samples_are_no_measurement():
    """The mask was lost without a word."""
    masked = np.ma.masked_array(A, mask=np.arange(len(A)) == 1)
    with pytest.raises(iwan.InvalidValueError, match="under a mask"):
        iwan.as_record(masked, dt=0.1)
    with pytest.raises(iwan.InvalidValueError, match="under a mask"):
        iwan.as_record({"t": T, "a": masked})
    assert iwan.as_record(np.ma.masked_array(A), dt=0.1).dt == 0.1


def test_times_in_an_index_and_in_a_column_are_the_same_record():
    t = 0.25 * np.arange(4)
    for name, scale in [("time [s]", 1.0), ("t_ms", 1e3), ("Time (ms)", 1e3)]:
        frame = pandas.DataFrame({name: scale * t, "velocity [mm/s]": [1.0, 2.0, 4.0, 3.0]})
        column, index = iwan.as_record(frame), iwan.as_record(frame.set_index(name))
        assert column == index and column.quantity == "velocity" and column.unit == "mm/s", name
        assert index.dt == pytest.approx(0.25)
    missing = pandas.DataFrame({"acc": pandas.array([1, None, 2, 3], dtype="Int64")}, index=t)
    with pytest.raises(iwan.RecordError, match="acc"):
        iwan.as_record(missing)


@pytest.mark.parametrize("unit", ["furlong", "fortnight", "minuets", "ps"])
def test_what_is_no_unit_of_time_is_refused_everywhere(unit):
    """Arrays called `Time [furlong]` were read in seconds."""
    array = xarray.DataArray(A, dims="time", coords={"time": ("time", T, {"units": unit})})
    name = f"Time [{unit}]"
    frame = pandas.DataFrame({name: T, "a": A})
    for data in [{name: T, "a": A}, {f"t ({unit})": T, "a": A}, frame, frame.set_index(name), frame.set_index(name)["a"], array,
                 {f"dt [{unit}]": 0.01, "a": A}]:
        with pytest.raises(iwan.RecordError, match=unit) as caught:
            iwan.as_record(data)
        assert caught.value.kind == "time-unit"
        assert "--" not in str(caught.value)


def test_units_of_time_are_obeyed_everywhere(tmp_path):
    """In whatever spelling the command line takes in a CSV file."""
    for unit, seconds in [("ms", 1e-3), ("µs", 1e-6), ("us", 1e-6), ("ns", 1e-9), ("Minutes", 60.0), ("min", 60.0), ("hrs", 3600.0), ("SEC", 1.0)]:
        t, name = T * 1e-3 / seconds, f"Time [{unit}]"
        (tmp_path / "r.csv").write_text(f"{name},a\n" + "".join(f"{x!r},{y!r}\n" for x, y in zip(t.tolist(), A.tolist())))
        expected = iwan.read_record(tmp_path / "r.csv")
        assert expected.dt == pytest.approx(1e-5)
        frame = pandas.DataFrame({name: t, "a": A})
        array = xarray.DataArray(A, dims="time", coords={"time": ("time", t, {"units": unit})}, name="a")
        for data in [{name: t, "a": A}, frame, frame.set_index(name), array, {f"dt [{unit}]": t[1], "a": A}]:
            record = iwan.as_record(data)
            assert record.dt == pytest.approx(expected.dt) and record.names == ["a"], (unit, type(data))
    assert iwan.as_record({"fs [kHz]": 2.0, "a": A}).dt == pytest.approx(5e-4)


def test_arguments_that_a_kind_of_data_goes_without_are_refused():
    """They were ignored without a word."""
    record = iwan.as_record({"t": T, "a": A})
    array = xarray.DataArray(A, dims="time", coords={"time": T})
    frame = pandas.DataFrame({"a": A}, index=T)
    for call in [
        lambda: iwan.as_record(record, quantity="velocity"),
        lambda: iwan.as_record(record, channels=["b"]),
        lambda: iwan.as_record(A, dt=0.1, channels=["b"]),
        lambda: iwan.as_record(A, dt=0.1, time="t"),
        lambda: iwan.as_record(A, dt=0.1, resample=True),
        lambda: iwan.as_record(array, time="clock"),
        lambda: iwan.as_record(array, channels=["b"]),
        lambda: iwan.as_record(frame, time="clock"),
    ]:
        with pytest.raises(iwan.InvalidValueError):
            call()
    assert iwan.as_record(frame.rename_axis("clock"), time="clock").dt == pytest.approx(0.01)


def test_arrays_without_times_are_no_records():
    """The numbers of rows were taken for seconds."""
    with pytest.raises(iwan.RecordError, match="no coordinate"):
        iwan.as_record(xarray.DataArray(A, dims="time"))
    filtered = pandas.DataFrame({"a": A, "b": B})[A > -2.0]
    filtered.index = np.arange(len(filtered))
    with pytest.raises(iwan.RecordError):
        iwan.as_record(filtered)
    assert iwan.as_record(xarray.DataArray(A, dims="time"), dt=0.01).dt == pytest.approx(0.01)
    response = iwan.simulate(iwan.Mode(frequency=10.0), dt=1e-2, duration=1.0, initial=(1.0, 0.0))
    with pytest.raises(iwan.InvalidTypeError, match="velocity"):
        iwan.as_record(response.to_xarray())
    velocity = iwan.as_record(response.to_xarray()["velocity"])
    assert velocity.dt == pytest.approx(1e-2) and velocity.quantity == "velocity"


def test_what_holds_no_numbers_is_named():
    """Text, truth values and complex numbers vanished without a word, as did the first of two columns of one name."""
    record = iwan.as_record({"t": T, "a": A, "b": A.astype(str), "c": A > 0.0, "d": A + 1j})
    assert record.names == ["a"]
    for name in "bcd":
        assert any(f"'{name}'" in warning for warning in record.warnings), record.warnings
    with pytest.raises(iwan.InvalidTypeError, match="'b'"):
        iwan.as_record({"t": T, "a": A, "b": A.astype(str)}, channels=["a", "b"])
    with pytest.raises(iwan.InvalidTypeError, match="complex"):
        iwan.as_record({"t": T, "a": A + 1j} | {"t": T.astype(str)})
    twice = pandas.DataFrame(np.column_stack([A, B]), columns=["a", "a"], index=T)
    for data in [twice, {1: A, "1": B, "t": T}, {"x.a": A, "x": {"a": B}, "t": T}]:
        with pytest.raises(iwan.RecordError, match="called"):
            iwan.as_record(data)
    for name in ["file", "allow_pickle", "args"]:
        assert iwan.as_record({"t": T, name: A}).names == [name]


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.longdouble, ">f8", ">i2", np.uint8])
def test_all_types_of_real_numbers_come_in(dtype):
    values = (100.0 * A + 20.0).astype(dtype)
    for data in [{"t": T, "a": values}, pandas.DataFrame({"t": T, "a": values.astype(values.dtype.newbyteorder("="))}), {"t": T, "a": values[::-1]}]:
        found = iwan.as_record(data).samples[0]
        np.testing.assert_array_equal(found, np.asarray(data["a"]).astype(np.float64))
