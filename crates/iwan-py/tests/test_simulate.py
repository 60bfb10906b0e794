"""Simulations: physics, options, the same bits everywhere, interruption."""

import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import iwan

RUN = {"dt": 1e-4, "duration": 0.1}


def test_the_exact_end_of_the_golden_run(joint):
    """Three independent codes: the continuum ends at -7.303701e-4 (mode 1 at 125 Hz, undamped, plain scheme)."""
    mode = iwan.Mode(frequency=125.0, joint=joint)
    blow = iwan.Haversine(amplitude=1000.0, duration=1.6e-3)
    options = {"force": blow, "dt": 1e-5, "duration": 0.2, "prewarp": False}
    exact = iwan.simulate(mode, sliders=None, **options)
    assert exact.displacement[-1] == pytest.approx(-7.303701e-4, abs=5e-11)
    uniform = iwan.simulate(mode, sliders=100, grid="uniform", **options)
    assert uniform.displacement[-1] == pytest.approx(-7.30157e-4, abs=5e-10)


def test_a_linear_mode_rings_as_the_textbook_says():
    zeta, f = 0.01, 20.0
    response = iwan.simulate(iwan.Mode(frequency=f, damping_ratio=zeta), dt=1e-4, duration=0.5, initial=(1.0, 0.0))
    w0 = 2 * np.pi * f
    w = w0 * np.sqrt(1 - zeta**2)
    t = response.t
    exact = np.exp(-zeta * w0 * t) * (np.cos(w * t) + zeta * w0 / w * np.sin(w * t))
    np.testing.assert_allclose(response.displacement, exact, atol=2e-5)


def test_the_arrays_obey_the_equation_of_motion(mode, blow, joint):
    response = iwan.simulate(mode, force=blow, **RUN)
    q, v, a, f = response.displacement, response.velocity, response.acceleration, response.joint_force
    w0 = 2 * np.pi * mode.frequency
    left = a + 2 * mode.damping_ratio * w0 * v + mode.k_inf * q + f
    np.testing.assert_allclose(left, blow.at(response.t), atol=1e-9 * np.abs(a).max())
    np.testing.assert_array_equal(response.t, np.arange(1001) * 1e-4)
    assert len(response) == 1001 and response.dt == 1e-4
    np.testing.assert_allclose(f, joint.force_history(q, sliders=100), atol=1e-9 * np.abs(f).max())
    assert q is response.displacement and response.t is response.t


def test_the_figures_are_those_of_the_arrays(mode, blow, joint):
    response = iwan.simulate(mode, force=blow, **RUN)
    figures = response.statistics
    assert figures["peak_displacement"] == np.abs(response.displacement).max()
    assert figures["final_displacement"] == response.displacement[-1]
    assert figures["slip_ratio"] == figures["peak_displacement"] / joint.phi_max
    assert figures["steps"] == 1000 and 0 < figures["seconds"] < 10
    assert figures["energy_error"] == response.energy_error < 1e-10
    assert 0 < figures["time_step_error"] < 0.05 and 0 < figures["discretisation_error"] < 0.01
    e = response.energy
    out = sum(e[key] for key in ["kinetic", "elastic", "stored", "viscous", "friction", "residual"])
    assert e["initial"] + e["input"] == pytest.approx(out, rel=1e-12)
    quick = iwan.simulate(mode, force=blow, quality=False, **RUN)
    assert quick.statistics["time_step_error"] is None
    np.testing.assert_array_equal(quick.displacement, response.displacement)


def test_methods_agree(mode, blow):
    reference = iwan.simulate(mode, force=blow, sliders=None, dt=1e-5, duration=0.1)
    peak = np.abs(reference.displacement).max()
    for method, sliders, tolerance in [("half-cycle", 100, 1e-4), ("event", 400, 1e-3), ("averaging", 100, 0.05)]:
        other = iwan.simulate(mode, force=blow, method=method, sliders=sliders, dt=1e-5, duration=0.1)
        assert np.abs(other.displacement - reference.displacement).max() < tolerance * peak, method
    general = iwan.simulate(mode, force=blow, dt=1e-5, duration=0.1, prewarp=False, beta=0.3025, gamma=0.6)
    assert general.energy_error > 1e-4  # numerical damping


def test_forces_come_in_many_forms(mode, blow):
    reference = iwan.simulate(mode, force=blow, **RUN)
    samples = blow.at(reference.t[:20])
    doubled = np.repeat(samples, 2)[::2]
    for force in [samples, list(samples), doubled, np.asfortranarray(samples), samples.astype(">f8")]:
        other = iwan.simulate(mode, force=force, **RUN)
        np.testing.assert_allclose(other.displacement, reference.displacement, atol=1e-12)
    sampled = iwan.simulate(mode, force=iwan.Sampled(samples=samples, dt=1e-4), **RUN)
    np.testing.assert_array_equal(sampled.displacement, iwan.simulate(mode, force=samples, **RUN).displacement)
    integers = iwan.simulate(mode, force=[0, 500, 0], **RUN)
    assert integers.acceleration[1] == pytest.approx(500.0, rel=0.05)
    rest = iwan.simulate(mode, **RUN)
    assert not rest.displacement.any() and rest.energy_error == 0.0


def test_modes_together_are_the_modes_alone_on_any_number_of_threads(mode, blow):
    modes = [mode, iwan.Mode(frequency=300.0, damping_ratio=0.01, outputs={"tip": 20.0, "root": 1.0})]
    modes += [iwan.Mode(frequency=50.0 + i, joint=iwan.Jenkins(k_t=100.0, f_s=0.01), outputs={"tip": 1.0}) for i in range(5)]
    alone = [iwan.simulate(m, force=blow, **RUN) for m in modes]
    for threads in [1, 2, 7]:
        together = iwan.simulate(modes, force=blow, threads=threads, **RUN)
        for a, b in zip(alone, together, strict=True):
            np.testing.assert_array_equal(a.displacement, b.displacement)
            np.testing.assert_array_equal(a.joint_force, b.joint_force)
    points = iwan.superpose(modes, alone)
    assert list(points) == ["tip", "root"]
    tip = 20.0 * alone[1].velocity + sum(r.velocity for r in alone[2:])
    np.testing.assert_allclose(points["tip"]["velocity"], tip, rtol=1e-12, atol=1e-15)
    each = iwan.simulate(modes[:2], initial=[[0.1, 0.0], [0.2, 1.0]], **RUN)
    assert [r.displacement[0] for r in each] == [0.1, 0.2] and each[1].velocity[0] == 1.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"dt": 0.0}, "dt = 0"),
        ({"dt": np.nan}, "dt = NaN"),
        ({"duration": -1.0}, "duration = -1"),
        ({"duration": 1e-9}, "duration / time step"),
        ({"method": "euler"}, "method = 'euler' is not known: choose one of 'newmark'"),
        ({"method": "event", "sliders": None}, "number of sliders"),
        ({"sliders": 0}, "sliders = 0"),
        ({"grid": "coarse"}, "grid = 'coarse'"),
        ({"threads": 0}, "threads = 0"),
        ({"initial": (np.nan, 0.0)}, r"initial\[0\] = NaN"),
        ({"initial": [0.0, 0.0, 0.0]}, r"initial has the shape \[3\]"),
        ({"force": [0.0, np.inf]}, r"force\[1\] = inf"),
        ({"force": [1.0]}, "force has 1 entries, 2 are needed"),
        ({"force": np.zeros((2, 2))}, "one dimension"),
        ({"beta": 0.3}, "prewarp goes with"),
        ({"force": iwan.Haversine(amplitude=1.0, duration=1e-5)}, "a quarter of the force's duration"),
    ],
)
def test_bad_options_are_named(mode, options, message):
    with pytest.raises(iwan.InvalidValueError, match=message):
        iwan.simulate(mode, **(RUN | options))


def test_bad_modes_are_named(joint, mode):
    with pytest.raises(iwan.InvalidValueError, match="K_inf"):
        iwan.Mode(frequency=10.0, joint=joint)
    assert iwan.Mode(frequency=10.0, joint=joint, allow_negative_residual=True).k_inf < 0
    with pytest.raises(iwan.InvalidValueError, match="outputs\\['tip'\\]"):
        iwan.Mode(frequency=10.0, outputs={"tip": np.nan})
    with pytest.raises(iwan.InvalidTypeError, match="iwan.Mode"):
        iwan.simulate("mode", **RUN)
    with pytest.raises(iwan.InvalidValueError, match="empty sequence"):
        iwan.simulate([], **RUN)
    with pytest.raises(iwan.InvalidValueError, match='mode "bending 1": '):
        iwan.simulate([mode], force=iwan.Haversine(amplitude=1.0, duration=1e-5), **RUN)
    with pytest.raises(iwan.InvalidValueError, match="a = 0"):
        mode.damping_ratio_at([1.0, 0.0])
    short, long = (iwan.simulate(mode, dt=1e-4, duration=d) for d in (0.1, 0.2))
    with pytest.raises(iwan.InvalidValueError, match="superposed"):
        iwan.superpose([mode, mode], [short, long])
    with pytest.raises(iwan.InvalidValueError, match="one response for each mode"):
        iwan.superpose([mode], [short, long])


def test_overflow_is_a_failed_computation(mode):
    with pytest.raises(iwan.ComputationError, match="not finite") as caught:
        iwan.simulate(mode, initial=(1e200, 0.0), **RUN)
    assert not isinstance(caught.value, ValueError)


def test_python_threads_get_the_same_bits(mode, blow):
    expected = iwan.simulate(mode, force=blow, **RUN).displacement
    results = [None] * 4

    def run(i):
        results[i] = iwan.simulate(mode, force=blow, **RUN).displacement

    workers = [threading.Thread(target=run, args=(i,)) for i in range(4)]
    [worker.start() for worker in workers]
    [worker.join() for worker in workers]
    for result in results:
        np.testing.assert_array_equal(result, expected)


def test_the_lock_is_released_during_long_work(mode, blow):
    """Another thread counts while a long run goes on: with the lock held it could not."""
    done, count = threading.Event(), 0

    def work():
        iwan.simulate(mode, force=blow, dt=1e-6, duration=2.0, quality=False)
        done.set()

    worker = threading.Thread(target=work)
    worker.start()
    while not done.is_set():
        count += 1
    worker.join()
    assert count > 1000


LONG = {
    "newmark": "iwan.simulate(mode, dt=1e-6, duration=25.0, initial=(1e-3, 0.0), sliders=None)",
    "companion runs": "iwan.simulate([mode] * 2, dt=1e-6, duration=12.0, initial=(1e-3, 0.0), sliders=None, threads=2)",
    "event": "iwan.simulate(mode, method='event', sliders=2000, dt=1e-5, duration=60.0, initial=(1e-2, 0.0))",
    "history": "joint.force_history(np.tile([0.0, 1e-3, -1e-2], 40_000_000))",
}


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to a process of one's own")
@pytest.mark.parametrize("call", LONG.values(), ids=LONG.keys())
def test_ctrl_c_is_honoured_at_once(call):
    """Interrupted from outside in mid-run, as a terminal does; the process itself measures how long it took."""
    program = f"""
        import signal, time
        import numpy as np
        import iwan
        joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
        mode = iwan.Mode(frequency=124.0, joint=joint)
        pressed = []
        def handler(number, frame):
            raise KeyboardInterrupt
        signal.signal(signal.SIGINT, handler)
        print("ready", flush=True)
        try:
            {call}
        except KeyboardInterrupt:
            print("interrupted", flush=True)
        else:
            print("finished", flush=True)
    """
    with subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        time.sleep(0.6)
        process.send_signal(signal.SIGINT)
        answer, errors = process.communicate(timeout=60)
    assert answer == "interrupted\n", answer + errors


def test_more_sliders_than_any_machine_has_are_refused(mode, joint):
    calls = [
        lambda n: iwan.simulate(mode, dt=1e-5, duration=0.01, sliders=n),
        lambda n: joint.force_history([1e-3, 2e-3], sliders=n),
        lambda n: joint.discretise(n),
    ]
    for call in calls:
        for number in (10_000_001, 10**12):
            with pytest.raises(iwan.InvalidValueError, match=f"sliders = {number} is out of range: at most 10000000"):
                call(number)
    with pytest.raises(iwan.InvalidValueError, match="points"):
        iwan.frf(mode, band=(112.0, 128.0), force=[1.0], points=10**12)
