"""Identification on records of known truth, and the likelihood behind it."""

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import sysconfig
import textwrap
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import iwan

JOINT = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
MODE = iwan.Mode(frequency=124.0, joint=JOINT, damping_ratio=1e-3)
DT = 2e-4


def ring_down(slip_ratio, seconds=0.5):
    start = (slip_ratio * JOINT.phi_max, 0.0)
    return iwan.simulate(MODE, dt=DT, duration=seconds, initial=start, method="half-cycle", quality=False)


@pytest.fixture(scope="module")
def loud():
    """Through macro-slip: everything is known."""
    return iwan.fit(ring_down(2.0).acceleration, dt=DT, quantity="acceleration")


@pytest.fixture(scope="module")
def quiet():
    """Micro-slip only."""
    return iwan.fit(ring_down(0.2).acceleration, dt=DT)


def test_a_record_through_macro_slip_tells_everything(loud):
    truth = {"frequency": 124.0, "damping_ratio": 1e-3, "k_t": 4.45e4, "f_s": 239.4, "chi": -0.183, "beta": 0.3}
    assert loud.parameters.keys() == truth.keys() == loud.intervals.keys() == loud.identifiable.keys()
    for name, value in truth.items():
        assert loud.parameters[name] == pytest.approx(value, rel=0.01, abs=1e-5), name
    assert loud.adequate and loud.joint_needed and loud.relative_residual < 1e-2
    assert loud.joint.f_s == loud.parameters["f_s"] and loud.mode.joint == loud.joint
    assert loud.frequency == loud.mode.frequency


def test_micro_slip_leaves_the_slip_force_open(quiet):
    assert quiet.identifiable["chi"] and quiet.joint.chi == pytest.approx(-0.183, abs=0.01)
    low, high = quiet.intervals["f_s"]
    assert high is None and not quiet.identifiable["f_s"] and not quiet.identifiable["beta"]
    assert any("no upper bound" in words for words in quiet.words)
    assert "open" in str(quiet) and "f_s" in str(quiet)


def test_curves_and_profiles_are_arrays(quiet):
    n = quiet.curves["t"].size
    for curves in (quiet.curves, quiet.model_curves):
        assert all(values.dtype == np.float64 for values in curves.values())
    assert all(values.shape == (n,) for values in quiet.curves.values())
    ratio = quiet.curves["force"] / quiet.curves["displacement"]
    np.testing.assert_allclose(ratio, (2 * np.pi * quiet.curves["frequency"]) ** 2, rtol=1e-12)
    values, deviances = quiet.profiles["chi"]
    assert np.all(np.diff(values) > 0) and deviances.min() == 0.0 and quiet.limit > 3.0
    joint = iwan.fit(ring_down(0.2).acceleration, dt=DT, force_axis="joint")
    assert joint.force_axis == "joint" and np.all(joint.curves["force"] < quiet.curves["force"])
    assert len(quiet.envelopes) == 1 and quiet.envelopes[0].method == "hilbert"


def test_several_levels_and_records_are_fitted_together():
    levels = [iwan.Record(ring_down(s, 0.3).velocity, dt=DT, quantity="velocity") for s in (0.1, 1.5)]
    both = iwan.fit(levels, hold={"damping_ratio": 1e-3})
    assert set(both.curves["record"]) == {0.0, 1.0} and len(both.envelopes) == 2
    assert both.joint.f_s == pytest.approx(239.4, rel=0.02)
    assert both.damping_ratio == 1e-3 and not both.identifiable["damping_ratio"]


def test_shapes_and_masses_scale():
    x = ring_down(0.2, 0.25).acceleration
    record = iwan.Record([20.0 * x, -10.0 * x], dt=DT, quantity="acceleration")
    shaped = iwan.fit(record, shape=[20.0, -10.0])
    plain = iwan.fit(x, dt=DT)
    np.testing.assert_allclose(shaped.curves["displacement"], plain.curves["displacement"], rtol=1e-6)
    heavy = iwan.fit(x, dt=DT, mass=4.0)
    np.testing.assert_allclose(heavy.curves["displacement"], 2.0 * plain.curves["displacement"], rtol=1e-6)


def test_a_fit_pickles(quiet):
    back = pickle.loads(pickle.dumps(quiet))
    assert back.parameters == quiet.parameters and back.intervals == quiet.intervals and str(back) == str(quiet)
    again, first = iwan.log_likelihood(back), iwan.log_likelihood(quiet)
    theta = first.best + 1e-4 * np.random.default_rng(0).standard_normal((5, len(first.names)))
    np.testing.assert_array_equal(again(theta), first(theta))


def test_a_likelihood_pickles(loud, tmp_path):
    """As samplers on several processes need it: another process evaluates it to the same bits, without a fit."""
    hits = [iwan.Record(ring_down(s, 0.3).velocity, dt=DT, quantity="velocity") for s in (0.3, 0.31)]
    for found in (loud, iwan.fit(hits, hold={"damping_ratio": 1e-3})):
        first = iwan.log_likelihood(found)
        kept = pickle.dumps(first)
        back = pickle.loads(kept)
        assert back.names == first.names and len(kept) < 500_000
        np.testing.assert_array_equal(back.best, first.best)
        theta = first.best + 1e-4 * np.random.default_rng(0).standard_normal((5, len(first.names)))
        np.testing.assert_array_equal(back(theta), first(theta))
        (tmp_path / "kept.pickle").write_bytes(pickle.dumps((first, theta)))
        program = "import pickle; f, x = pickle.load(open('kept.pickle', 'rb')); print(f(x).tobytes().hex())"
        run = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True, capture_output=True, text=True)
        assert run.stdout.strip() == first(theta).tobytes().hex()
        make, (version, json, free) = first._native.__reduce__()
        for broken in (("0.0.0", json, free), (version, json[:-1], free), (version, json[:40], free)):
            with pytest.raises(iwan.InvalidValueError, match="make it again with iwan.log_likelihood"):
                make(*broken)


@pytest.mark.parametrize("slip_ratio", [0.15, 0.3, 0.6])
def test_a_mode_by_curves_begins_at_the_largest_amplitude_that_was_measured(slip_ratio):
    """That of the first sample of the free decay; the curves ended at the next point of their grid, up to 7 % below."""
    found = iwan.fit(ring_down(slip_ratio, 0.8).acceleration, dt=DT)
    largest = found.backbone["amplitude"][-1]
    assert largest == pytest.approx(slip_ratio * JOINT.phi_max, rel=5e-3)
    assert largest >= found.curves["displacement"].max()
    again = iwan.simulate(found.curve_mode, dt=DT, duration=0.2, initial=(largest, 0.0))
    assert np.abs(again.displacement).max() == largest
    with pytest.raises(iwan.ComputationError, match="beyond the largest of the curves, ([-0-9.e]+),") as beyond:
        iwan.simulate(found.curve_mode, dt=DT, duration=0.2, initial=(1.01 * largest, 0.0))
    [said] = re.findall("largest of the curves, ([-0-9.e]+),", str(beyond.value))
    assert float(said) == pytest.approx(largest, rel=1e-12)


def test_a_fit_tells_a_terminal_for_how_long_it_has_been_at_work(capfd, mode):
    record = ring_down(0.2, 0.25).acceleration
    iwan.fit(record, dt=DT, progress=True)
    assert re.fullmatch(r"(\ridentifying, \d+ s)+\n", capfd.readouterr().err)
    shaker = iwan.frf(mode, band=(112.0, 128.0), force=[1.0, 100.0], points=40)
    iwan.fit(record, dt=DT, sweeps=[shaker], progress=True)
    assert re.fullmatch(r"(\rfitting, \d+ s)+\n", capfd.readouterr().err)
    # Nothing where standard error is no terminal.
    iwan.fit(record, dt=DT)
    assert capfd.readouterr().err == ""
    with pytest.raises(iwan.InvalidTypeError, match="cannot say how far it is"):
        iwan.fit(record, dt=DT, progress=print)


def test_a_law_that_is_none_is_refused_before_the_fit(monkeypatch):
    monkeypatch.setattr("iwan.identification._identify", lambda *_: pytest.fail("the fit has begun"))
    with pytest.raises(iwan.InvalidValueError, match="law = 'ivan' is not known: choose one of 'linear', .*'iwan'"):
        iwan.fit(ring_down(0.2).acceleration, dt=DT, law="ivan")


def test_bad_arguments_are_named():
    x = ring_down(0.2).acceleration
    for options, message in [
        ({"hold": {"k": 1.0}}, "hold = 'k' is not known"),
        ({"force_axis": "total"}, "force_axis = 'total'"),
        ({"quantity": "strain"}, "quantity = 'strain'"),
        ({"mass": -1.0}, "mass = -1"),
        ({"method": "fft"}, "method = 'fft'"),
        ({"shape": [0.0]}, "shape|rank|tell"),
    ]:
        with pytest.raises(iwan.InvalidValueError, match=message):
            iwan.fit(x, dt=DT, **options)
    with pytest.raises(iwan.InvalidValueError, match="is a force, not known as a motion"):
        iwan.fit(iwan.Record(x, dt=DT, quantity="force"))
    with pytest.raises(iwan.InvalidValueError, match="do not belong together"):
        iwan.fit([iwan.Record(x, dt=DT, names=["a"]), iwan.Record(x, dt=DT, names=["b"])])


def test_the_likelihood_is_largest_at_the_fit_and_the_same_on_all_threads(loud):
    likelihood = iwan.log_likelihood(loud)
    assert likelihood.names[-2:] == ["log_amplitude_0", "phase_0"] and likelihood.best.shape == (8,)
    best = likelihood(likelihood.best)
    assert best.shape == () and np.isfinite(best)
    rng = np.random.default_rng(1)
    theta = likelihood.best + 0.01 * np.abs(likelihood.best).clip(1e-3) * rng.standard_normal((20, 10, 8))
    logs = likelihood(theta, threads=1)
    assert logs.shape == (20, 10) and np.all(logs <= best + 1.0)
    np.testing.assert_array_equal(likelihood(theta, threads=3), logs)
    np.testing.assert_array_equal([likelihood(row) for row in theta[0]], logs[0])
    outside = likelihood.best.copy()
    outside[likelihood.names.index("chi")] = 1.5
    assert likelihood(outside) == -np.inf and likelihood(np.full(8, np.nan)) == -np.inf
    with pytest.raises(iwan.InvalidValueError, match="last axis must have 8 entries"):
        likelihood(np.zeros(3))
    walkers = likelihood.walkers(32)
    assert walkers.shape == (32, 8) and np.all(np.isfinite(likelihood(walkers)))


COMMAND = str(Path(sysconfig.get_path("scripts")) / "iwan")


def test_the_report_is_that_of_the_command(tmp_path, monkeypatch):
    """The same page, to the last character, from a file with two channels and units."""
    monkeypatch.chdir(tmp_path)
    clean = ring_down(1.5, 0.4)
    noise = 1e-3 * np.abs(clean.acceleration).max() * np.random.default_rng(5).standard_normal((2, len(clean)))
    table = np.column_stack([clean.t, clean.acceleration + noise[0], -0.4 * clean.acceleration + noise[1]])
    np.savetxt("a.csv", table, delimiter=",", header="time [s],tip [m/s^2],root [m/s^2]", comments="", fmt="%.17g")
    subprocess.run([COMMAND, "fit", "a.csv", "--out", "out", "--quiet"], check=True, capture_output=True)
    fit = iwan.fit(iwan.read_record("a.csv"))
    fit.report("ours.html", names=["a.csv"])
    assert Path("ours.html").read_text() == (Path("out") / "report.html").read_text()
    # And the same JSON, but for the names of the files beside it.
    told = fit.to_json("ours.json", names=["a.csv"])
    command = json.loads((Path("out") / "fit.json").read_text())
    assert command.pop("files") and json.loads(told) == command and Path("ours.json").read_text() == told
    with pytest.raises(iwan.ExistingFileError, match="force=True"):
        fit.to_json("ours.json")
    with pytest.raises(iwan.InvalidValueError, match="2 entries for 1 records"):
        fit.to_json(names=["a", "b"])
    assert json.loads(replace(fit, law="linear").to_json())["modes"][0]["law"] == "linear"
    assert pickle.loads(pickle.dumps(fit)).to_json(names=["a.csv"]) == told


def test_reports_appear_whole_or_not_at_all(quiet, tmp_path):
    path = tmp_path / "report.html"
    pickle.loads(pickle.dumps(quiet)).report(path)
    text = path.read_text()
    assert text.startswith("<!DOCTYPE html>") and "Fit of record" in text and "<svg" in text
    assert "http" not in re.sub(r"http://www\.w3\.org/\S+", "", text)
    path.write_text("mine")
    with pytest.raises(iwan.ExistingFileError, match="force=True") as exists:
        quiet.report(path)
    assert isinstance(exists.value, FileExistsError) and path.read_text() == "mine"
    quiet.report(str(path), force=True)
    assert path.read_text() == text
    with pytest.raises(iwan.FileError, match="none"):
        quiet.report(tmp_path / "none" / "report.html")
    with pytest.raises(iwan.InvalidValueError, match="2 entries for 1 records"):
        quiet.report(tmp_path / "other.html", names=["a", "b"])
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted by their names in /proc")
@pytest.mark.parametrize("call", ["iwan.fit(records, dt=2e-4)", "iwan.ensemble.fit(records, dt=2e-4, threads=2)"])
def test_ctrl_c_ends_a_fit_and_its_workers(call):
    """Records that would keep the workers busy for much longer than the test waits."""
    program = f"""
        import os, time, iwan, numpy as np
        from pathlib import Path

        joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
        mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=1e-3)
        rng, records = np.random.default_rng(0), []
        for ratio in np.geomspace(0.3, 3.0, 16):
            run = iwan.simulate(mode, dt=2e-4, duration=1.0, initial=(ratio * joint.phi_max, 0.0), method="half-cycle", quality=False)
            records.append(run.acceleration + 1e-2 * np.abs(run.acceleration).max() * rng.standard_normal(len(run)))

        def name(task):
            try:
                return (task / "comm").read_text()
            except OSError:
                return "ended"

        def workers():
            return [task for task in Path("/proc/self/task").iterdir() if name(task).startswith("iwan")]

        print("ready", flush=True)
        try:
            {call}
            print("finished", flush=True)
        except KeyboardInterrupt:
            busy = len(workers())
            until = time.monotonic() + 10.0
            while workers() and time.monotonic() < until:
                time.sleep(0.02)
            print("interrupted", busy > 0, len(workers()), flush=True)
    """
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(program)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(1.5)
    os.kill(process.pid, signal.SIGINT)
    assert process.communicate(timeout=120)[0] == "interrupted True 0\n"


def test_stretches_hits_and_the_mode_are_chosen_by_argument():
    damped = iwan.Mode(frequency=124.0, joint=JOINT, damping_ratio=5e-3)
    dt, start = 4e-4, (0.2 * JOINT.phi_max, 0.0)
    x = iwan.simulate(damped, dt=dt, duration=0.5, initial=start, method="half-cycle").acceleration
    quiet = np.zeros(200)
    several = iwan.Record(np.concatenate([quiet, x, 0.9 * x]), dt=dt, start=-200 * dt)
    found = several.hits()
    starts = [hit.start for hit in found]
    assert len(found) == 2 and abs(starts[0]) < 20 * dt and abs(starts[1] - len(x) * dt) < 20 * dt
    both = iwan.fit(several)
    assert len(both.envelopes) == 2 and "2 hits" in both.notes[0] and "each is used" in both.notes[0]
    second = iwan.fit(several, hits=2)
    assert len(second.envelopes) == 1 and "number 2 is used" in second.notes[0]
    cut = iwan.fit(several, start=starts[1], mode=124.0)
    assert len(cut.envelopes) == 1 and abs(cut.frequency - 124.0) < 0.5
    for wrong, word in [({"hits": 3}, "there is no hit 3"), ({"hits": 0}, "hits = 0"), ({"hits": "last"}, "'last'")]:
        with pytest.raises(iwan.InvalidValueError, match=word):
            iwan.fit(several, **wrong)
    with pytest.raises(iwan.InvalidValueError, match="mode goes without band"):
        iwan.fit(several, hits=1, mode=124.0, band=(100.0, 150.0))
    pulled = np.concatenate([np.linspace(0.0, x[0], 300), np.full(200, x[0]), x])
    released = iwan.fit(iwan.Record(pulled, dt=dt, start=0.0), hits="first")
    assert "the structure is pulled, held, handled or driven" in released.notes[0] and abs(released.frequency - 124.0) < 0.5
    broken = iwan.Record(x + 0.1 * np.concatenate([np.zeros(100), x[:-100]]), dt=dt, start=1.0)
    [seen] = broken.disturbances()
    assert seen["kind"] == "lost" and abs(seen["time"] - 1.0 - 100 * dt) < 2 * dt
    assert any("breaks off, as where samples are lost, at 1.04" in note for note in iwan.fit(broken).notes)
    many = iwan.ensemble.fit([several, x], hits="first")
    assert many.fits[0] is not None and "number 1 is used" in many.fits[0].notes[0]
    assert "dt is missing" in str(many.failures[1])
    with pytest.raises(iwan.InvalidValueError, match="'last'"):
        iwan.ensemble.fit([several], hits="last")


def test_names_that_are_none_are_refused_before_the_fit_and_a_fit_shows_itself_in_a_line(quiet):
    assert len(repr(quiet)) < 200 and "grade matches" in repr(quiet)
    record = ring_down(0.2).acceleration
    with pytest.raises(iwan.InvalidValueError, match="force_axis"):
        iwan.fit(record, dt=DT, force_axis="sideways")
    for order in (0, 31, 100):
        with pytest.raises(iwan.InvalidValueError, match=f"order = {order} is out of range: 1 to 30"):
            iwan.envelope(record, dt=DT, order=order)
    # A list is as good as a tuple.
    assert iwan.envelope(record, dt=DT, band=[100, 150], window=[0.0, 0.4]).method == "hilbert"


@pytest.mark.parametrize(
    ("given", "error", "said"),
    [
        ({"hold": ["damping_ratio"]}, iwan.InvalidTypeError, "hold must be a mapping from names"),
        ({"near": "124"}, iwan.InvalidTypeError, "near must be a real number, not str"),
        ({"order": -1}, iwan.InvalidValueError, "order = -1"),
        ({"band": (100.0, 140.0, 180.0)}, iwan.InvalidValueError, "band has 3 numbers: give 2"),
        ({"hits": 0}, iwan.InvalidValueError, "hits = 0"),
    ],
)
def test_arguments_that_cannot_be_meant_are_named(given, error, said):
    with pytest.raises(error, match=re.escape(said)):
        iwan.fit(ring_down(0.2).acceleration, dt=DT, **given)


def test_what_is_no_array_says_what_to_do():
    with pytest.raises(iwan.InvalidTypeError, match="read it with iwan.read_record"):
        iwan.fit("hit.csv")
    with pytest.raises(iwan.InvalidValueError, match="transpose it"):
        iwan.fit(np.zeros((1000, 2)), dt=DT)


def test_a_window_that_the_header_names_leaves_no_parameter_told(with_window):
    """Nothing in the samples shows an exponential window: the fit told what structure and window make together."""
    t = 5e-4 * np.arange(3000)
    plain, windowed = (with_window(np.exp(-3.0 * t) * np.cos(200.0 * np.pi * t), 5e-4, kind) for kind in (0, 4))
    assert np.array_equal(plain.samples, windowed.samples) and "exponential" in windowed.warnings[0]
    told = [any("as its file says" in note for note in iwan.envelope(record).notes) for record in (plain, windowed)]
    assert told == [False, True]
    free, bound = iwan.fit(plain), iwan.fit(pickle.loads(pickle.dumps(windowed.between(stop=1.4))))
    assert abs(free.intervals["frequency"][1] - 100.0) < 0.05
    assert bound.intervals["frequency"][1] is None and any("as its file says" in note for note in bound.notes), bound.notes
