"""What is refused is refused by an error of the package, whatever was given: no error of Python's, no panic, no silent reading."""

import re
import subprocess
import sys
import textwrap

import numpy as np
import pandas
import pytest

import iwan
import iwan.ensemble

JOINT = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
MODE = iwan.Mode(frequency=124.0, joint=JOINT, damping_ratio=1e-3)
RESPONSE = iwan.simulate(MODE, dt=2e-4, duration=0.1, initial=(0.2 * JOINT.phi_max, 0.0), method="half-cycle")
RECORD = iwan.Record(RESPONSE.acceleration, dt=2e-4)
SHORT = RESPONSE.acceleration[:20]
BEAM = iwan.Structure.built_in("paper-a")
STUCK = [iwan.Mode(frequency=132.35, name="bending 1"), iwan.Mode(frequency=719.6, name="bending 3")]
LINK = iwan.SharedJoint(joint=JOINT, participation=[1.0, -4.9], compliance=9.1e-6)
COUPLED = iwan.CoupledModes(STUCK, [LINK])


class Foreign:
    """An object that gives nothing of what it promises."""

    def fail(self, *_args, **_options):
        raise RuntimeError("no such thing")

    __array__ = __float__ = __index__ = __iter__ = __fspath__ = fail


BAD = [
    None, float("nan"), -1, 1e300, -1e300, 10**30, 10**400, -(10**30), "", "abc", "\ud800", b"x", [], [1, "a"], [[1, 2], [3]], {}, {1: 2}, (), 1j, True,
    np.array(1.0), np.array([]), np.ones((2, 2, 2)), np.array([1.0, None], dtype=object), np.ma.masked_array([1.0, 2.0], mask=[False, True]),
    np.ma.masked, np.array([True, False]), np.array(["1.0", "2.0"]), np.array([1j, 2]), np.float16(1.5), np.array([1, 2, 3], dtype=">f4"),
    np.arange(10.0)[::-2], np.datetime64("2020-01-01"), np.array([np.nan, 1.0]), object(), Foreign(), pandas.NA, pandas.Series([1.0, 2.0]), JOINT,
    np.zeros((0, 5)), range(3),
]  # fmt: skip


def shared(**other):
    joint = iwan.SharedJoint(**({"joint": JOINT, "participation": [1.0, -1.0]} | other))
    return iwan.CoupledModes(STUCK, [joint]).simulate(dt=1e-3, duration=0.01, initial=(1.0, 0.0))


BLOW = iwan.Haversine(amplitude=10.0, duration=1e-3)
SWEEP = {"frequency": [1.0, 2.0], "amplitude": [1.0, 2.0], "phase": [0.0, 1.0], "excitation": [1.0, 1.0]}
CURVE = {"displacement": [1e-4], "frequency": [132.0], "damping_ratio": [1e-3]}
LOOKED_AT = {"channel": None, "band": None, "near": None, "method": "hilbert", "filter_order": 3, "window": None, "order": None}
FITTED = LOOKED_AT | {
    "dt": 2e-4, "quantity": None, "shape": None, "mass": None, "mode": None, "start": None, "stop": None, "hits": "all", "force_axis": "modal",
    "hold": None,
}  # fmt: skip
CALLS = {
    "FourParameter": (iwan.FourParameter, {"k_t": 1.0, "f_s": 1.0, "chi": 0.0, "beta": 0.0}),
    "FiveParameter": (iwan.FiveParameter, {"k_t": 1.0, "f_s": 1.0, "chi": 0.0, "beta": 0.0, "theta": 0.8}),
    "from_density": (iwan.FourParameter.from_density, {"r": 2e5, "chi": 0.0, "phi_max": 0.01, "s": 500.0}),
    "Jenkins": (iwan.Jenkins, {"k_t": 1.0, "f_s": 1.0}),
    "Uniform": (iwan.Uniform, {"k_t": 1.0, "f_s": 1.0, "width": 0.5}),
    "Tabulated": (iwan.Tabulated, {"strength": [0.0, 1.0], "density": [1.0, 1.0], "dirac": 0.0}),
    "Haversine": (iwan.Haversine, {"amplitude": 1.0, "duration": 1.0}),
    "Step": (iwan.Step, {"amplitude": 1.0, "duration": 1.0}),
    "Sine": (iwan.Sine, {"amplitude": 1.0, "frequency": 1.0, "duration": 1.0}),
    "Sampled": (iwan.Sampled, {"samples": [0.0, 1.0], "dt": 1.0}),
    "PowerDamping": (iwan.PowerDamping, {"c": 1.0, "n": 2}),
    "Coulomb": (iwan.Coulomb, {"force": 1.0}),
    "Spring": (iwan.Spring, {"k": 1.0, "exponent": 3.0}),
    "Pinning": (iwan.Pinning, {"k": 1.0, "gap": 1.0}),
    "Mode": (
        iwan.Mode,
        {"frequency": 124.0, "joint": JOINT, "damping_ratio": 0.0, "name": "x", "shape_at_force": 1.0, "outputs": {"a": 1.0},
         "allow_negative_residual": False, "parts": [], "curves": None},
    ),  # fmt: skip
    "ModeCurves": (
        iwan.ModeCurves,
        {"amplitude": [1e-4, 1e-2], "frequency": [124.0, 122.0], "damping_ratio": [1e-3, 5e-3], "extrapolate": False},
    ),
    "force": (JOINT.force, {"u": 1e-3}),
    "density": (JOINT.density, {"phi": 1e-3}),
    "force_history": (JOINT.force_history, {"u": [0.0, 1e-3], "sliders": None, "grid": "graded"}),
    "discretise": (JOINT.discretise, {"sliders": 10, "grid": "graded"}),
    "at": (BLOW.at, {"t": 0.5}),
    "frequency_at": (MODE.frequency_at, {"a": 1.0}),
    "simulate": (
        iwan.simulate,
        {"mode": MODE, "force": None, "dt": 1e-3, "duration": 0.1, "method": "newmark", "sliders": 10, "grid": "graded", "prewarp": True,
         "beta": 0.25, "gamma": 0.5, "initial": (1.0, 0.0), "quality": True, "threads": 1},
    ),  # fmt: skip
    "superpose": (iwan.superpose, {"modes": [MODE], "responses": [RESPONSE]}),
    "Record": (
        iwan.Record,
        {"samples": [0.0, 1.0, 2.0], "dt": 0.1, "names": ["a"], "quantity": "unknown", "unit": "", "start": 0.0},
    ),
    "channel": (RECORD.channel, {"channel": 0}),
    "between": (RECORD.between, {"start": 0.0, "stop": 0.05}),
    "read_record": (
        iwan.read_record,
        {"path": "nowhere.csv", "format": None, "time": None, "channels": [], "rate": None, "quantity": None, "resample": False,
         "time_unit": None, "unit": None, "start": None, "stop": None},
    ),  # fmt: skip
    "as_record": (
        iwan.as_record,
        {"data": {"t": np.arange(20.0), "a": np.arange(20.0)}, "dt": None, "time": None, "channels": (), "quantity": None, "resample": False},
    ),
    "as_record of an array": (iwan.as_record, {"data": np.arange(20.0), "dt": 0.1}),
    "as_record of columns": (lambda t, a: iwan.as_record({"t": t, "a": a}), {"t": np.arange(3.0), "a": np.arange(3.0)}),
    "envelope": (iwan.envelope, LOOKED_AT | {"record": SHORT, "dt": 2e-4, "mode": None}),
    "ensemble.simulate": (
        iwan.ensemble.simulate,
        {"frequency": 124.0, "k_t": 4.45e4, "f_s": 100.0, "chi": -0.2, "beta": 0.3, "dt": 1e-3, "duration": 0.1, "method": "half-cycle",
         "sliders": 10, "keep": [], "client": None, "progress": False},
    ),  # fmt: skip
    "ensemble.envelope": (iwan.ensemble.envelope, LOOKED_AT | {"records": [SHORT], "dt": 2e-4, "progress": False}),
    "ensemble.fit": (iwan.ensemble.fit, FITTED | {"records": [SHORT], "client": None, "progress": False}),
    "frf": (iwan.frf, {"mode": MODE, "band": (112.0, 128.0), "force": [1.0], "at": None, "harmonics": 1, "points": 20, "threads": 1}),
    "backbone": (iwan.backbone, {"mode": MODE, "amplitude": [1e-4, 1e-3], "harmonics": 1, "threads": 1}),
    "CoupledModes": (iwan.CoupledModes, {"modes": STUCK, "joints": [LINK]}),
    "SharedJoint": (shared, {"joint": JOINT, "participation": [1.0, -1.0], "compliance": 9e-6, "slip_at_force": 0.0, "name": "x"}),
    "backbone of coupled modes": (iwan.backbone, {"mode": COUPLED, "of": 0, "amplitude": [1e-4], "harmonics": 1, "threads": 1}),
    "CoupledModes.backbone": (COUPLED.backbone, {"mode": 0, "amplitude": [1e-4], "harmonics": 1}),
    "Structure": (iwan.Structure, {"native": BEAM._native}),
    "load": (iwan.Structure.load, {"path": "nowhere.toml"}),
    "built_in": (iwan.Structure.built_in, {"name": "paper-a"}),
    "quasi_static": (BEAM.quasi_static, {"mode": "bending 1", "displacement": [1e-4, 1e-3], "points": 3}),
    "Structure.simulate": (
        BEAM.simulate,
        {"force": BLOW, "velocity": None, "dt": 1e-4, "duration": 1e-3, "modes": (), "model": "reduced", "basis": 10, "tolerance": None,
         "sliders": 10, "grid": None, "quality": False, "progress": False},
    ),  # fmt: skip
    "Structure.frf": (
        BEAM.frf,
        {"band": (131.0, 133.0), "force": [0.01], "direction": None, "at": None, "damping_ratio": 1e-3, "basis": 10, "points": 10},
    ),
    "modal_fit": (
        iwan.modal_fit,
        {"force": None, "responses": [SHORT], "dt": 1e-3, "names": ["tip"], "force_at": None, "quantity": "displacement", "estimator": "h1",
         "decay": 0.0, "whole_force": False, "band": (40, 160), "method": "chart", "order": 10, "poles": None, "add_poles": (), "drop_poles": ()},
    ),  # fmt: skip
    "update": (
        iwan.update,
        {"structure": BEAM, "curves": {"nothing": CURVE}, "records": (), "predict_records": (), "modes": None, "quantity": "acceleration",
         "predict": None, "groups": None, "correct": (), "undamped": True, "threads": 1, "progress": False},
    ),  # fmt: skip
    "fit": (iwan.fit, FITTED | {"record": SHORT, "law": None, "progress": False}),
    "fit of sweeps": (iwan.fit, {"sweeps": SWEEP, "backbones": None, "levels": None, "hold": None, "mass": None, "progress": False}),
    "fit of columns": (lambda a: iwan.fit(sweeps=SWEEP | {"amplitude": a}, progress=False), {"a": [1.0, 2.0]}),
    "fit_coupled": (
        iwan.fit_coupled,
        {"records": SHORT, "dt": 2e-4, "forces": None, "shapes": None, "frequencies": None, "bands": [(100.0, 140.0)], "near": None,
         "shape_at_force": None, "predict": (), "predict_forces": None, "quantity": None, "method": "hilbert", "start": None, "stop": None,
         "hits": "all", "threads": 1, "progress": False},
    ),  # fmt: skip
    "log_likelihood": (iwan.log_likelihood, {"fit": None}),
    "plot.ring_down": (iwan.plot.ring_down, {"response": RESPONSE, "quantity": "displacement", "channel": None, "envelope": None}),
    "plot.hysteresis": (iwan.plot.hysteresis, {"response": RESPONSE, "joint": JOINT}),
    "plot.frequency": (iwan.plot.frequency, {"envelopes": None, "mode": MODE}),
    "plot.dissipation": (iwan.plot.dissipation, {"joint": JOINT, "against": "force"}),
    "plot.density": (iwan.plot.density, {"joint": JOINT}),
    "plot.frf": (iwan.plot.frf, {"curves": [], "show": "amplitude"}),
    "plot.backbone": (iwan.plot.backbone, {"curves": {}, "show": "frequency"}),
    "plot.mode_shapes": (iwan.plot.mode_shapes, {"position": [0.0, 1.0], "shapes": [[0.0, 1.0]]}),
}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", CALLS)
def test_whatever_is_given_errors_are_those_of_the_package(name):
    """TypeError, OverflowError, KeyError and the like of Python itself came through."""
    plots = name.startswith("plot.")
    if plots:
        matplotlib = pytest.importorskip("matplotlib")
        matplotlib.use("Agg")
    call, good = CALLS[name]
    refused = 0
    for argument in good:
        for given in BAD:
            try:
                call(**(good | {argument: given}))
            except iwan.IwanError as error:
                refused += 1
                assert not re.search(r"\d{41}|[\x00-\x08\x1b]", str(error)) and len(str(error)) < 2000, str(error)
            if plots:
                matplotlib.pyplot.close("all")
    assert refused > len(BAD) // 2


WRONG_KINDS = [
    ("dt must be a real number", lambda: iwan.simulate(MODE, dt="1e-3", duration=0.1)),
    ("dt must be a real number", lambda: iwan.simulate(MODE, dt=True, duration=0.1)),
    ("dt must be one number", lambda: iwan.simulate(MODE, dt=np.array([1e-3]), duration=0.1)),
    ("force must hold real numbers, not bool", lambda: iwan.simulate(MODE, force=np.ones(9, dtype=bool), dt=1e-3, duration=0.1)),
    ("k_t must hold real numbers", lambda: iwan.ensemble.simulate(frequency=1.0, k_t=["1"], f_s=1, chi=0, beta=0, dt=1e-3, duration=1)),
    ("poles must be a sequence", lambda: iwan.modal_fit(None, np.ones((1, 1, 99)), 0.1, poles=b"x")),
    ("sliders must be a whole number", lambda: iwan.simulate(MODE, dt=1e-3, duration=0.1, sliders=10.0)),
    ("joint must be an iwan.Joint", lambda: iwan.Mode(frequency=1.0, joint={"k_t": 1.0})),
    ("parts\\[0\\] must be an iwan.Part", lambda: iwan.Mode(frequency=1.0, parts=[JOINT])),
    ("outputs\\['tip'\\] must be a real number", lambda: iwan.Mode(frequency=1.0, outputs={"tip": "2"})),
    ("channels must be a sequence", lambda: iwan.read_record("r.csv", channels="acc")),
    ("path must be a path", lambda: iwan.read_record(3)),
    ("damping_ratio must be a real number", lambda: BEAM.frf(band=(1.0, 2.0), force=[1.0], damping_ratio="0.1")),
    ("hold must be a mapping", lambda: iwan.fit(SHORT, dt=1e-3, hold=["chi"])),
]
OUT_OF_RANGE = [
    ("sliders = -1 is out of range", lambda: iwan.simulate(MODE, dt=1e-3, duration=0.1, sliders=-1)),
    ("threads = 1000000000000000000000000000000 is out of range", lambda: iwan.simulate(MODE, dt=1e-3, duration=0.1, threads=10**30)),
    ("n = -1 is out of range", lambda: BEAM.modes(-1)),
    ("dt = a number with more than 40 characters is out of range", lambda: iwan.simulate(MODE, dt=10**400, duration=0.1)),
    ("band has 3 numbers", lambda: iwan.frf(MODE, band=(1.0, 2.0, 3.0), force=[1.0])),
    ("shapes that do not go together", lambda: iwan.ensemble.simulate(
        frequency=[1.0, 2.0], k_t=[1.0, 2.0, 3.0], f_s=1.0, chi=0.0, beta=0.0, dt=1e-3, duration=1.0)),
    ("show = 'nonsense' is not known", lambda: iwan.plot.backbone({}, show="nonsense")),
]  # fmt: skip


@pytest.mark.parametrize("words, call", WRONG_KINDS, ids=[words for words, _ in WRONG_KINDS])
def test_a_wrong_type_is_named(words, call):
    with pytest.raises(iwan.InvalidTypeError, match=words) as caught:
        call()
    assert isinstance(caught.value, TypeError)


@pytest.mark.parametrize("words, call", OUT_OF_RANGE, ids=[words for words, _ in OUT_OF_RANGE])
def test_a_value_out_of_range_is_named(words, call):
    with pytest.raises(iwan.InvalidValueError, match=words) as caught:
        call()
    assert isinstance(caught.value, ValueError)


@pytest.mark.skipif(sys.platform != "linux", reason="bounds the addresses of a process")
def test_more_than_there_is_of_memory_is_refused_with_words():
    """Under a limit of the system, in a process of its own, which an abort would end."""
    script = """
        import resource, numpy as np, iwan, iwan.ensemble
        mode = iwan.Mode(frequency=124.0, joint=iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3))
        start = 0.01
        resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))
        many = dict(k_t=4.45e4, f_s=np.full(1000, 239.4), chi=-0.183, beta=0.3, frequency=124.0, displacement=1e-3, duration=200.0)
        for call in (
            lambda: iwan.simulate(mode, dt=1e-6, duration=1000.0, initial=(start, 0.0)),
            lambda: iwan.simulate([mode] * 1000, dt=1e-4, duration=1000.0, initial=(start, 0.0)),
            lambda: mode.joint.discretise(10**8),
            lambda: iwan.ensemble.simulate(**(many | {"duration": 2e4}), dt=1e-3, keep=["displacement"]),
            lambda: iwan.ensemble.simulate(**(many | {"frequency": np.full((10**6, 1), 124.0)}), dt=1e-3),
        ):
            try:
                call()
            except iwan.IwanError as error:
                print(type(error).__name__, error.kind)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    said = done.stdout.split("\n")[:-1]
    assert len(said) == 5, done.stdout
    assert all(line in ("ComputationError memory", "InvalidValueError value") for line in said), said
