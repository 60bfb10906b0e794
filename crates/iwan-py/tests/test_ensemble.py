"""Ensembles: members are single runs, whatever the number of threads or workers."""

import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

import iwan

BLOW = iwan.Haversine(amplitude=1000.0, duration=1.6e-3)
JOINT = {"k_t": 4.45e4, "f_s": 239.4, "chi": -0.183, "beta": 0.3}
RUN = {"frequency": 124.0, "dt": 1e-3, "duration": 0.1}


@pytest.mark.parametrize("method", ["half-cycle", "newmark", "averaging", "event"])
def test_members_are_single_runs(method):
    f_s, scale = np.array([100.0, 239.4, 1000.0]), np.array([[0.5], [2.0]])
    options = {"force": BLOW, "dt": 1e-4, "duration": 0.05, "method": method}
    many = iwan.ensemble.simulate(
        **(JOINT | {"f_s": f_s}), frequency=124.0, damping_ratio=1e-3, shape_at_force=scale, keep=["acceleration", "displacement"], **options
    )
    assert many.shape == (2, 3) and many.histories["acceleration"].shape == (2, 3, 501)
    for i, j in np.ndindex(2, 3):
        joint = iwan.FourParameter(**(JOINT | {"f_s": f_s[j]}))
        mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=1e-3, shape_at_force=scale[i, 0])
        one = iwan.simulate(mode, quality=False, **options)
        np.testing.assert_array_equal(many.histories["displacement"][i, j], one.displacement)
        np.testing.assert_array_equal(many.histories["acceleration"][i, j], one.acceleration)
        figures = one.statistics
        for name in ["peak_displacement", "final_displacement", "slip_ratio", "energy_error"]:
            assert getattr(many, name)[i, j] == figures[name]
    np.testing.assert_array_equal(many.t, one.t)


def random_sets(n):
    rng = np.random.default_rng(3)
    return {
        "k_t": 4.45e4 * rng.uniform(0.5, 1.5, n),
        "f_s": 239.4 * rng.uniform(0.1, 3.0, n),
        "chi": rng.uniform(-0.9, 0.2, n),
        "beta": rng.uniform(0.0, 3.0, n),
        "displacement": rng.normal(scale=1e-3, size=n),
    }


def same(a, b):
    for name in ["peak_displacement", "final_displacement", "slip_ratio", "energy_error", "t"]:
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)
    assert a.histories.keys() == b.histories.keys()
    for name, history in a.histories.items():
        np.testing.assert_array_equal(history, b.histories[name])


def test_threads_change_nothing():
    sets = random_sets(1000)
    one = iwan.ensemble.simulate(**sets, **RUN, keep=["velocity"], threads=1)
    for threads in [2, 3, 16, None]:
        same(one, iwan.ensemble.simulate(**sets, **RUN, keep=["velocity"], threads=threads))


def test_scalars_and_empty_arrays():
    one = iwan.ensemble.simulate(**JOINT, **RUN, displacement=1e-3)
    assert one.shape == () and one.peak_displacement.shape == ()
    none = iwan.ensemble.simulate(**(JOINT | {"f_s": np.empty((0, 3))}), **RUN, keep=["velocity"])
    assert none.shape == (0, 3) and none.histories["velocity"].shape == (0, 3, 101)
    strided = np.linspace(100.0, 300.0, 20)[::2]
    same(
        iwan.ensemble.simulate(**(JOINT | {"f_s": strided}), **RUN),
        iwan.ensemble.simulate(**(JOINT | {"f_s": strided.tolist()}), **RUN),
    )


@pytest.mark.parametrize("threads", [1, 4])
def test_the_first_bad_set_is_named(threads):
    f_s = np.full((40, 30), 239.4)
    f_s[7, 3] = f_s[30, 2] = -1.0
    with pytest.raises(iwan.InvalidValueError, match=r"parameter set \[7, 3\]: f_s = -1"):
        iwan.ensemble.simulate(**(JOINT | {"f_s": f_s}), **RUN, threads=threads)
    with pytest.raises(iwan.InvalidValueError, match=r"k_t\[1\] = NaN"):
        iwan.ensemble.simulate(**(JOINT | {"k_t": [1.0, np.nan]}), **RUN)
    with pytest.raises(iwan.InvalidValueError, match="keep = 'strain' is not known"):
        iwan.ensemble.simulate(**JOINT, **RUN, keep=["strain"])
    with pytest.raises(iwan.InvalidValueError, match="threads = 0"):
        iwan.ensemble.simulate(**JOINT, **RUN, threads=0)


def test_progress_is_told():
    told = []
    iwan.ensemble.simulate(**random_sets(3000), **RUN, progress=lambda done, total: told.append((done, total)))
    counts = [done for done, _ in told]
    assert counts == sorted(counts) and told[-1] == (3000, 3000)
    with pytest.raises(ZeroDivisionError):
        iwan.ensemble.simulate(**random_sets(20_000), **RUN, progress=lambda done, total: 1 // 0)


def test_progress_is_drawn_where_wanted(capsys):
    iwan.ensemble.simulate(**random_sets(10), **RUN)
    assert capsys.readouterr().err == ""
    iwan.ensemble.simulate(**random_sets(10), **RUN, progress=True)
    assert capsys.readouterr().err.endswith("] 10/10\n")


def decay(f):
    t = np.arange(8192) / 4096.0
    return np.exp(-t) * np.cos(2 * np.pi * f * t)


def test_envelopes_of_many_records():
    records = [iwan.Record(decay(f), dt=1 / 4096) for f in (60.0, 70.0, 80.0, 90.0)]
    for threads in [1, 3]:
        for many, record in zip(iwan.ensemble.envelope(records, threads=threads), records, strict=True):
            one = iwan.envelope(record)
            np.testing.assert_array_equal(many.frequency, one.frequency)
            np.testing.assert_array_equal(many.damping_ratio_sd, one.damping_ratio_sd)
    assert iwan.ensemble.envelope([]) == []
    with pytest.raises(iwan.IdentificationError, match=r"record 1 \(counted from 0\)"):
        iwan.ensemble.envelope([decay(60.0), decay(60.0)[:20]], dt=1 / 4096)


LAW = iwan.FourParameter(**JOINT)


def ring_down(ratio, seed, seconds=0.3):
    mode = iwan.Mode(frequency=124.0, joint=LAW, damping_ratio=1e-3)
    start = (ratio * LAW.phi_max, 0.0)
    a = iwan.simulate(mode, dt=5e-4, duration=seconds, initial=start, method="half-cycle", quality=False).acceleration
    return a + 1e-3 * np.abs(a).max() * np.random.default_rng(seed).standard_normal(a.size)


def same_fit(a, b):
    assert a.parameters == b.parameters and a.intervals == b.intervals and a.words == b.words
    for name in a.curves:
        np.testing.assert_array_equal(a.curves[name], b.curves[name])


RECORDS = [ring_down(0.5, 1), ring_down(1.5, 2)[:20], ring_down(1.5, 3), np.full(400, np.nan), [ring_down(0.5, 4), ring_down(1.5, 5)]]


@pytest.fixture(scope="module")
def fits():
    return iwan.ensemble.fit(RECORDS, dt=5e-4, threads=2)


def test_fits_of_many_records_are_those_of_each(fits):
    assert len(fits) == 5 and [one is None for one in fits.fits] == [False, True, False, True, False]
    same_fit(fits.fits[2], iwan.fit(RECORDS[2], dt=5e-4))
    assert len(fits.fits[4].envelopes) == 2
    f_s = fits.parameters["f_s"]
    assert np.isnan(f_s[[1, 3]]).all() and f_s[2] == fits.fits[2].joint.f_s and list(fits.parameters) == list(fits.fits[2].parameters)
    likelihood = iwan.log_likelihood(fits.fits[0])
    assert np.isfinite(likelihood(likelihood.best))


def test_failures_are_named_and_stop_nothing(fits):
    assert set(fits.failures) == {1, 3}
    assert isinstance(fits.failures[1], iwan.IdentificationError) and isinstance(fits.failures[3], iwan.InvalidValueError)
    assert "2 failed: 1, 3" in repr(fits) and "record 3: " in str(fits) and "NaN" in str(fits)
    assert set(pickle.loads(pickle.dumps(fits)).failures) == {1, 3}
    none = iwan.ensemble.fit([])
    assert len(none) == 0 and none.parameters["chi"].shape == (0,)
    with pytest.raises(iwan.InvalidValueError, match="method = 'fft'"):
        iwan.ensemble.fit(RECORDS[:1], dt=5e-4, method="fft")
    told = []
    iwan.ensemble.fit(RECORDS[1:2], dt=5e-4, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (1, 1)


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to a process of one's own")
def test_ctrl_c_ends_an_ensemble():
    program = """
        import iwan, numpy as np
        print("ready", flush=True)
        try:
            iwan.ensemble.simulate(frequency=124.0, k_t=4.45e4, f_s=np.full(10_000_000, 239.4), chi=-0.183, beta=0.3,
                                   displacement=1e-3, dt=1e-3, duration=0.2)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(program)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(0.8)
    os.kill(process.pid, signal.SIGINT)
    assert process.communicate(timeout=60)[0] == "interrupted\n"


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed")
    dask = pytest.importorskip("dask")
    with dask.config.set({"distributed.admin.tick.limit": "60s"}):
        cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
        with cluster, distributed.Client(cluster) as client:
            yield client


@pytest.mark.filterwarnings("default")
class TestWorkers:
    """On a cluster of two worker processes."""

    def test_workers_change_nothing(self, client):
        sets = random_sets(4000)
        threads = iwan.ensemble.simulate(**sets, **RUN, keep=["velocity"])
        told = []
        workers = iwan.ensemble.simulate(
            **sets, **RUN, keep=["velocity"], client=client, progress=lambda done, total: told.append(done)
        )
        same(threads, workers)
        assert told[-1] == 4000 and len(told) > 1
        records = [decay(f) for f in np.linspace(60.0, 90.0, 12)]
        ours = iwan.ensemble.envelope(records, dt=1 / 4096)
        theirs = iwan.ensemble.envelope(records, dt=1 / 4096, client=client)
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_array_equal(a.amplitude, b.amplitude)

    def test_fits_come_out_the_same(self, client, fits):
        workers = iwan.ensemble.fit(RECORDS, dt=5e-4, client=client)
        assert {i: str(error) for i, error in workers.failures.items()} == {i: str(error) for i, error in fits.failures.items()}
        for ours, theirs in zip(fits.fits, workers.fits, strict=True):
            assert (ours is None) == (theirs is None)
            if ours is not None:
                same_fit(ours, theirs)

    def test_errors_come_from_the_first_bad_set(self, client):
        f_s = np.full(2000, 239.4)
        f_s[[700, 1900]] = -1.0
        with pytest.raises(iwan.InvalidValueError, match=r"parameter set \[700\]"):
            iwan.ensemble.simulate(**(JOINT | {"f_s": f_s}), **RUN, client=client)

    def test_a_killed_worker_is_made_up_for(self, client):
        sets = random_sets(8000)
        pids = list(client.run(os.getpid).values())
        killed = []

        def kill_one(done, total):
            if not killed and done < total:
                killed.append(pids[0])
                os.kill(pids[0], signal.SIGKILL)

        workers = iwan.ensemble.simulate(**sets, **RUN, client=client, progress=kill_one)
        assert killed
        same(iwan.ensemble.simulate(**sets, **RUN), workers)


def test_a_killed_ensemble_goes_on_from_where_it_was(tmp_path):
    script = f"""
        import os, sys
        sys.path.insert(0, {os.path.dirname(__file__)!r})
        import iwan
        from test_ensemble import RUN, random_sets
        def told(done, members):
            if done > members // 3:
                os.kill(os.getpid(), 9)
        iwan.ensemble.simulate(**random_sets(1000), **RUN, keep=["displacement"], checkpoint="kept", progress=told)
    """
    ended = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], cwd=tmp_path)
    assert ended.returncode == -signal.SIGKILL
    kept = tmp_path / "kept"
    done = len(list(kept.glob("piece-*.pickle")))
    assert 10 < done < 64
    # One that is not whole counts as not done.
    last = sorted(kept.glob("piece-*.pickle"))[-1]
    last.write_bytes(last.read_bytes()[:100])
    told = []
    options = dict(**random_sets(1000), **RUN, keep=["displacement"])
    again = iwan.ensemble.simulate(**options, checkpoint=kept, progress=lambda done, _: told.append(done))
    same(again, iwan.ensemble.simulate(**options))
    assert told == sorted(told) and told[-1] == 1000
    # All is there now: nothing is computed any more.
    before = {path: path.stat().st_mtime_ns for path in kept.iterdir()}
    same(again, iwan.ensemble.simulate(**options, checkpoint=kept))
    assert before == {path: path.stat().st_mtime_ns for path in kept.iterdir()}


def test_half_written_files_of_killed_processes_are_cleared(tmp_path):
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    kept = tmp_path / "kept"
    kept.mkdir()
    # The first was killed before it had said what the work is, and every further call was refused.
    left = [kept / f"checkpoint.{ended.pid}", kept / f"piece-000000000.{ended.pid}"]
    alive = kept / f"piece-000000001.{os.getppid()}"
    for path in [*left, alive]:
        path.write_bytes(b"half")
    sets = random_sets(50)
    same(iwan.ensemble.simulate(**sets, **RUN, checkpoint=kept), iwan.ensemble.simulate(**sets, **RUN))
    assert alive.exists() and not any(path.exists() for path in left)


def test_a_checkpoint_of_other_work_is_refused(tmp_path):
    sets = random_sets(50)
    iwan.ensemble.simulate(**sets, **RUN, checkpoint=tmp_path / "kept")
    for changed in [RUN | {"dt": 2e-3}, RUN | {"frequency": 125.0}, RUN | {"keep": ["velocity"]}]:
        with pytest.raises(iwan.InvalidValueError, match="other work.*another folder"):
            iwan.ensemble.simulate(**sets, **changed, checkpoint=tmp_path / "kept")
    with pytest.raises(iwan.InvalidValueError, match="other work"):
        iwan.ensemble.fit([np.ones(100)], dt=1e-3, checkpoint=tmp_path / "kept")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("precious")
    with pytest.raises(iwan.InvalidValueError, match="a folder of its own"):
        iwan.ensemble.simulate(**sets, **RUN, checkpoint=tmp_path / "full")
    (tmp_path / "kept" / "checkpoint.json").write_text("{")
    with pytest.raises(iwan.InvalidValueError, match="damaged"):
        iwan.ensemble.simulate(**sets, **RUN, checkpoint=tmp_path / "kept")
    with pytest.raises(iwan.FileError):
        iwan.ensemble.simulate(**sets, **RUN, checkpoint=tmp_path / "full" / "mine.txt")
    with pytest.raises(iwan.InvalidValueError, match="client"):
        iwan.ensemble.simulate(**sets, **RUN, checkpoint=tmp_path / "new", client=object())


def test_fits_are_kept_with_their_failures(tmp_path):
    mode = iwan.Mode(frequency=124.0, joint=iwan.FourParameter(**JOINT), damping_ratio=1e-3)
    response = iwan.simulate(mode, dt=2e-4, duration=0.4, initial=(2e-3, 0.0), method="half-cycle")
    records = [response.acceleration, response.acceleration[:20], response.acceleration[50:]]
    plain = iwan.ensemble.fit(records, dt=2e-4)
    kept = [iwan.ensemble.fit(records, dt=2e-4, checkpoint=tmp_path / "kept") for _ in range(2)]
    for fits in kept:
        assert fits.failures.keys() == plain.failures.keys() == {1}
        assert str(fits.failures[1]) == str(plain.failures[1])
        np.testing.assert_array_equal(fits.parameters["f_s"], plain.parameters["f_s"])
        assert fits.fits[0].intervals == plain.fits[0].intervals
    kept[1].fits[2].report(tmp_path / "page.html")
    assert (tmp_path / "page.html").stat().st_size > 10_000
