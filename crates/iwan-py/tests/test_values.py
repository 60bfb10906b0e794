"""Values: `repr` reads back, pickles come back, equal values hash alike."""

import copy
import pickle

import numpy as np
import pytest

import iwan

JOINT = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
VALUES = [
    JOINT,
    iwan.FourParameter.from_density(r=12345.678, chi=-0.3, phi_max=1 / 3, s=0.1),
    iwan.FiveParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=1 / 3, theta=0.7),
    iwan.Jenkins(k_t=1e-300, f_s=5e-301),
    iwan.Uniform(k_t=1e16, f_s=5.0, width=0.1),
    iwan.Tabulated(strength=[0.0, 0.1, 0.3], density=[1 / 3, 2.0, 0.0], dirac=0.1),
    iwan.Haversine(amplitude=-1e3, duration=1.6e-3),
    iwan.HalfSine(amplitude=1.0, duration=2.0),
    iwan.Step(amplitude=1.0),
    iwan.Sine(amplitude=1.0, frequency=3.0, duration=4.0),
    iwan.Sampled(samples=[0.0, 0.1, 0.2], dt=0.1),
    iwan.PowerDamping(c=0.1, n=2.0),
    iwan.Coulomb(force=1 / 3),
    iwan.Spring(k=-1e9, exponent=3.0),
    iwan.Pinning(k=1e4, gap=1e-3),
    iwan.ModeCurves([1e-4, 1e-2], [124.0, 122.0], [0.001, 0.005]),
    iwan.ModeCurves([1e-4, 1e-2], [124.0, 122.0], [0.001, 0.005], extrapolate=True),
    iwan.Mode(frequency=124.0, joint=JOINT, parts=[iwan.Coulomb(force=2.0), iwan.Spring(k=-1.0, exponent=3.0)]),
    iwan.Mode(curves=iwan.ModeCurves([1e-4, 1e-2], [124.0, 122.0], [0.001, 0.005]), name="by curves"),
    iwan.Mode(frequency=124.0),
    iwan.Mode(
        frequency=1.0, joint=JOINT, name="it's \\ \n \x07 é", outputs={"tip": 0.1, "'": -2.0}, allow_negative_residual=True
    ),
    iwan.Record([[1.0, 2.0], [0.1, 0.2]], dt=0.1, names=["a", "b"], quantity="velocity", unit="m/s", start=-1.0),
]


@pytest.mark.parametrize("value", [v for v in VALUES if not isinstance(v, iwan.Record)], ids=lambda v: type(v).__name__)
def test_repr_reads_back(value):
    back = eval(repr(value), {"iwan": iwan})
    assert back == value and repr(back) == repr(value) and hash(back) == hash(value)


@pytest.mark.parametrize("value", VALUES, ids=lambda v: type(v).__name__)
@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_pickles_come_back(value, protocol):
    back = pickle.loads(pickle.dumps(value, protocol))
    assert type(back) is type(value) and back == value and repr(back) == repr(value)
    assert copy.deepcopy(value) == value


def test_values_differ_where_they_should():
    for i, a in enumerate(VALUES):
        for j, b in enumerate(VALUES):
            assert (a == b) == (i == j)
    assert JOINT != 1 and JOINT != None and not JOINT == "x"  # noqa: E711
    assert len({v for v in VALUES if not isinstance(v, iwan.Record)}) == len(VALUES) - 1


def test_zero_and_minus_zero_are_one():
    a, b = (iwan.FourParameter(k_t=1.0, f_s=1.0, chi=chi, beta=0.0) for chi in (0.0, -0.0))
    assert a == b and hash(a) == hash(b)


def test_a_response_pickles(mode, blow):
    response = iwan.simulate(mode, force=blow, dt=1e-4, duration=0.05)
    back = pickle.loads(pickle.dumps(response))
    for name in ["t", "displacement", "velocity", "acceleration", "joint_force"]:
        np.testing.assert_array_equal(getattr(back, name), getattr(response, name))
    assert back.statistics == response.statistics and back.energy == response.energy and back.dt == response.dt


def test_a_record_with_warnings_pickles(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time [ms],a [m/s^2]\n0,1\n1,2\n2,4\n")
    record = iwan.read_record(path)
    assert record.warnings and pickle.loads(pickle.dumps(record)).warnings == record.warnings
