"""Figures, compared with images that were looked at by eye.

New images after a change: IWAN_NEW_BASELINE=1 python -m pytest crates/iwan-py/tests/test_plot.py, then look at each.
"""

import os
from pathlib import Path

import matplotlib
import numpy as np
import pytest

import iwan

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.testing.compare import compare_images

BASELINE = Path(__file__).parent / "baseline"
TOLERANCE = 3.0
"""Root mean square of the grey levels: another version of the font engine stays below, a line out of place does not."""

JOINT = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
MODE = iwan.Mode(frequency=124.0, joint=JOINT, damping_ratio=2.5e-4)
BLOW = iwan.Haversine(amplitude=5000.0, duration=1.6e-3)
RESPONSE = iwan.simulate(MODE, force=BLOW, dt=1e-4, duration=0.4)
ENVELOPE = iwan.envelope(RESPONSE.acceleration[20:], dt=1e-4, filter_order=0)


@pytest.fixture(autouse=True)
def style():
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update({"figure.figsize": (5.0, 3.5), "savefig.dpi": 80, "svg.hashsalt": "iwan"})
        yield
    pyplot.close("all")


def ring_down(ax):
    record = iwan.Record(RESPONSE.acceleration[20:], dt=1e-4, quantity="acceleration", unit="m/s^2")
    return iwan.plot.ring_down(record, envelope=ENVELOPE, ax=ax)


def ring_down_of_a_response(ax):
    return iwan.plot.ring_down(RESPONSE, quantity="joint_force", ax=ax)


def hysteresis(ax):
    return iwan.plot.hysteresis(RESPONSE, joint=JOINT, ax=ax)


def frequency(ax):
    return iwan.plot.frequency(ENVELOPE, mode=MODE, ax=ax)


def damping(ax):
    stiffer = iwan.Mode(frequency=124.0, joint=iwan.FourParameter(k_t=4.45e4, f_s=400.0, chi=-0.183, beta=0.3))
    return iwan.plot.damping({"hilbert": ENVELOPE}, mode={"truth": MODE, "stronger": stiffer}, ax=ax)


def dissipation(ax):
    table_1 = iwan.FourParameter(k_t=2.75e5, f_s=300.0, chi=-0.3, beta=0.02)
    return iwan.plot.dissipation({"mode 1": JOINT, "Table 1": table_1}, ax=ax)


def dissipation_against_displacement(ax):
    return iwan.plot.dissipation(JOINT, against="displacement", printed=True, ax=ax)


def density(ax):
    table = iwan.Tabulated(strength=[1e-4, 1e-3, 5e-3], density=[1e6, 5e6, 2e6])
    return iwan.plot.density({"four-parameter": JOINT, "tabulated": table}, ax=ax)


def mode_shapes(ax):
    x = np.linspace(-10.0, 10.0, 21)
    rng = np.random.default_rng(0)
    order = rng.permutation(21)
    return iwan.plot.mode_shapes(x[order], [((x / 10) ** 2 - 0.3)[order], ((x / 10) ** 3 - 0.6 * x / 10)[order]], ax=ax)


def bent_beam(ax):
    return iwan.plot.mode_shape(iwan.Structure.built_in("paper-a").modes(4), "bending 1", ax=ax)


def twisted_beam(ax):
    modes = iwan.Structure.built_in("paper-a").modes(4)
    return iwan.plot.mode_shape(modes, "torsion-1", slipping=True, view=(20.0, 50.0), ax=ax)


def made_fit():
    """A fit made by hand: figures do not change when the identification gets better."""
    rng, joint = np.random.default_rng(7), JOINT
    q = np.geomspace(0.4, 0.04, 60) * joint.phi_max
    f, zeta = MODE.frequency_at(q), MODE.damping_ratio_at(q)
    omega = 2 * np.pi * f
    model = {"record": np.repeat([0.0, 1.0], 30), "force": omega**2 * q, "frequency": f, "damping_ratio": zeta}
    model["dissipation"] = 2 * np.pi * zeta * omega**2 * q**2
    curves = model | {"frequency_sd": np.full(60, 0.01), "log_dissipation_sd": np.linspace(0.02, 0.2, 60)}
    noise = rng.standard_normal(60)
    curves["dissipation"] = model["dissipation"] * np.exp(noise * curves["log_dissipation_sd"])
    curves["frequency"] = f + noise * curves["frequency_sd"]
    chi, f_s = np.linspace(-0.25, -0.1, 16), np.geomspace(90.0, 3e4, 40)
    profiles = {"chi": (chi, ((chi + 0.183) / 0.02) ** 2), "f_s": (f_s, 3.0 * (1 - (239.4 / f_s).clip(0, 3)) ** 2)}
    intervals = {"chi": (-0.222, -0.144), "f_s": (111.0, None)}
    return iwan.Fit(
        mode=MODE, intervals=intervals, identifiable={"chi": True, "f_s": False}, adequate=True, grade="matches", misfit="", joint_needed=True,
        words=[], notes=[], curves=curves, model_curves=model, force_axis="modal", envelopes=[ENVELOPE, ENVELOPE],
        profiles=profiles, limit=3.9, relative_residual=1e-3, law=None, law_words="", laws=[], backbone={},
        _records=[], _request={},
    )


FIT = made_fit()


def fitted(ax):
    return iwan.plot.fitted(FIT, ax=ax)


def fitted_frequency(ax):
    return iwan.plot.fitted(FIT, show="frequency", ax=ax)


def profile(ax):
    return iwan.plot.profile(FIT, "chi", ax=ax)


def profile_that_is_open(ax):
    return iwan.plot.profile(FIT, "f_s", ax=ax)


STEADY = iwan.frf(MODE, band=(112.0, 128.0), force=[5.0, 100.0], harmonics=3, points=60)
FREE = iwan.backbone(MODE, amplitude=np.geomspace(1e-5, 1e-2, 31), harmonics=3)


def responses(ax):
    return iwan.plot.frf(STEADY, backbone=FREE, ax=ax)


def nonlinear_mode(ax):
    return iwan.plot.backbone({"mode 1": FREE}, show="damping_ratio", ax=ax)


FIGURES = [
    responses,
    nonlinear_mode,
    fitted,
    fitted_frequency,
    profile,
    profile_that_is_open,
    ring_down,
    ring_down_of_a_response,
    hysteresis,
    frequency,
    damping,
    dissipation,
    dissipation_against_displacement,
    density,
    mode_shapes,
    bent_beam,
    twisted_beam,
]


@pytest.mark.parametrize("draw", FIGURES, ids=lambda f: f.__name__)
def test_figures_look_as_they_did(draw, tmp_path):
    figure, ax = pyplot.subplots(layout="constrained")
    assert draw(ax) is ax
    name = f"{draw.__name__}.png"
    if os.environ.get("IWAN_NEW_BASELINE"):
        BASELINE.mkdir(exist_ok=True)
        figure.savefig(BASELINE / name, metadata={"Software": None})
        return
    figure.savefig(tmp_path / name)
    expected = tmp_path / f"expected-{name}"
    expected.write_bytes((BASELINE / name).read_bytes())
    difference = compare_images(str(expected), str(tmp_path / name), tol=TOLERANCE)
    assert difference is None, difference


def test_every_function_is_drawn():
    import inspect

    used = "".join(inspect.getsource(figure) for figure in FIGURES)
    # An update takes seconds to compute: test_structure draws the one that it has.
    elsewhere = {"updated"}
    assert all(f"iwan.plot.{name}(" in used for name in set(iwan.plot.__all__) - elsewhere)


def test_axes_are_made_where_there_are_none():
    before = len(pyplot.get_fignums())
    ax = iwan.plot.density(JOINT)
    assert len(pyplot.get_fignums()) == before + 1 and ax.figure is pyplot.gcf()


def test_a_shifted_line_is_seen(tmp_path):
    """The comparison can fail: the same figure of another joint is told apart."""
    figure, ax = pyplot.subplots(layout="constrained")
    other = iwan.FourParameter(k_t=4.45e4, f_s=300.0, chi=-0.183, beta=0.3)
    iwan.plot.hysteresis(RESPONSE, joint=other, ax=ax)
    figure.savefig(tmp_path / "other.png")
    expected = tmp_path / "expected.png"
    expected.write_bytes((BASELINE / "hysteresis.png").read_bytes())
    assert compare_images(str(expected), str(tmp_path / "other.png"), tol=TOLERANCE) is not None


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(iwan.InvalidTypeError, match="iwan.Response or an iwan.Record"):
        iwan.plot.ring_down(np.zeros(3))
    with pytest.raises(iwan.InvalidValueError, match="nothing to draw"):
        iwan.plot.frequency()
    with pytest.raises(iwan.InvalidValueError, match="quantity = 'strain'"):
        iwan.plot.damping(ENVELOPE, quantity="strain")
    with pytest.raises(iwan.InvalidValueError, match="they must agree"):
        iwan.plot.hysteresis(([0.0, 1.0], [0.0]))
    with pytest.raises(iwan.InvalidValueError, match="one each"):
        iwan.plot.mode_shapes([0.0, 1.0], {"first": [1.0]})
    record = iwan.Record(np.zeros((2, 4)), dt=0.1)
    with pytest.raises(iwan.InvalidValueError, match="choose one with channel"):
        iwan.plot.ring_down(record)


def test_all_that_a_steady_vibration_has_is_drawn():
    for show in ("amplitude", "phase", "excitation", "receptance", "harmonics"):
        assert len(iwan.plot.frf(STEADY, show=show).lines) >= 2
    for show, lines in (("frequency", 1), ("damping_ratio", 1), ("harmonics", 1), ("slips", 0)):
        assert len(iwan.plot.backbone(FREE, show=show).lines) == lines


def test_envelopes_say_what_they_are_of():
    envelope = iwan.envelope(iwan.Record(RESPONSE.velocity[20:], dt=1e-4, quantity="velocity"))
    drawn = [iwan.plot.frequency(envelope, quantity=quantity).lines[0].get_xdata() for quantity in (None, "velocity")]
    np.testing.assert_array_equal(*drawn)
    assert drawn[0].max() > 10 * iwan.plot.frequency(envelope, quantity="acceleration").lines[0].get_xdata().max()


def test_envelopes_have_their_band_and_axes_are_those_of_the_points():
    envelope = iwan.envelope(iwan.Record(RESPONSE.acceleration[20:], dt=1e-4, quantity="acceleration"))
    _, ax = pyplot.subplots()
    iwan.plot.damping(envelope, ax=ax)
    (band,) = ax.collections
    outline = band.get_paths()[0].vertices[: 2 * len(envelope)]
    upper, lower = outline[: len(envelope), 1], outline[len(envelope) :, 1][::-1]
    np.testing.assert_allclose(upper, 100 * (envelope.damping_ratio + 1.96 * envelope.damping_ratio_sd), rtol=1e-12)
    np.testing.assert_allclose(lower, 100 * (envelope.damping_ratio - 1.96 * envelope.damping_ratio_sd), rtol=1e-12)
    points = ax.lines[0].get_ydata()
    low, high = ax.get_ylim()
    assert low < points.min() and high > points.max() and high / low < 2 * points.max() / points.min()
