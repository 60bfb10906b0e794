"""Modes with parts beside the joint, and modes by their curves."""

import numpy as np
import pytest

import iwan

JOINT = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)


def test_dry_friction_takes_four_f_over_k_in_a_cycle():
    """Den Hartog: exactly, whatever the step."""
    omega = 2 * np.pi * 3.0
    mode = iwan.Mode(frequency=3.0, parts=[iwan.Coulomb(force=0.01 * omega**2)])
    response = iwan.simulate(mode, dt=1 / 300, duration=2.0, initial=(1.0, 0.0))
    np.testing.assert_allclose(response.displacement[::100], 1.0 - 0.04 * np.arange(7), atol=1e-11)
    assert response.energy_error < 1e-12 and response.statistics["discretisation_error"] == 0.0


def test_parts_add_up_in_frequency_and_damping():
    parts = [iwan.Spring(k=-3e8, exponent=3), iwan.PowerDamping(c=0.05, n=2), iwan.Coulomb(force=0.3)]
    mode = iwan.Mode(frequency=124.0, joint=JOINT, damping_ratio=1e-3, parts=parts)
    assert mode.parts == tuple(parts) and mode.curves is None
    a = np.array([1e-4, 1e-3])
    stiffness = mode.k_inf + JOINT.harmonic_stiffness(a) + sum(p.harmonic_stiffness(a, frequency=1.0) for p in parts)
    frequency = mode.frequency_at(a)
    np.testing.assert_allclose(frequency, np.sqrt(stiffness) / (2 * np.pi), rtol=1e-13)
    for i in range(2):
        lost = JOINT.dissipation(a[i]) + sum(p.dissipation(a[i], frequency=frequency[i]) for p in parts)
        ratio = 1e-3 * 124.0 / frequency[i] + lost / (2 * np.pi * (2 * np.pi * frequency[i] * a[i]) ** 2)
        assert mode.damping_ratio_at(a[i]) == pytest.approx(ratio, rel=1e-13)


def test_averaging_follows_the_stepper():
    parts = [iwan.PowerDamping(c=0.05, n=2), iwan.Coulomb(force=0.4)]
    mode = iwan.Mode(frequency=10.0, parts=parts)
    options = dict(dt=1e-3, duration=1.0, initial=(0.5, 0.0))
    slow, steps = (iwan.simulate(mode, method=method, **options) for method in ("averaging", "newmark"))
    assert np.abs(slow.displacement - steps.displacement).max() < 0.01
    assert 0 < slow.statistics["time_step_error"] < 0.02
    for method in ("half-cycle", "event"):
        with pytest.raises(iwan.InvalidValueError, match="newmark or averaging"):
            iwan.simulate(mode, method=method, **options)


def of_an_iwan_mode(**options):
    mode = iwan.Mode(frequency=124.0, joint=JOINT, damping_ratio=2.5e-4)
    a = JOINT.phi_max * np.geomspace(1e-4, 1.0, 40)
    return mode, iwan.Mode(curves=iwan.ModeCurves(a, mode.frequency_at(a), [mode.damping_ratio_at(x) for x in a], **options))


@pytest.mark.parametrize("method", ["newmark", "averaging"])
def test_curves_of_an_iwan_mode_reproduce_its_ring_down(method):
    mode, by_curves = of_an_iwan_mode()
    options = dict(dt=1e-5, duration=0.2, initial=(0.3 * JOINT.phi_max, 0.0))
    truth = iwan.simulate(mode, sliders=None, **options)
    found = iwan.simulate(by_curves, method=method, **options)
    assert np.abs(found.displacement - truth.displacement).max() < 5e-3 * truth.displacement[0]
    assert "below_curves_from" not in found.statistics


def test_leaving_the_curves_is_never_silent():
    _, by_curves = of_an_iwan_mode()
    options = dict(dt=1e-5, duration=0.05)
    with pytest.raises(iwan.ComputationError, match="extrapolate"):
        iwan.simulate(by_curves, initial=(1.2 * JOINT.phi_max, 0.0), **options)
    _, allowed = of_an_iwan_mode(extrapolate=True)
    with pytest.warns(UserWarning, match="exceeds the largest"):
        above = iwan.simulate(allowed, initial=(1.2 * JOINT.phi_max, 0.0), **options)
    assert above.statistics["above_curves_from"] == 0.0
    with pytest.warns(UserWarning, match="below the smallest"):
        below = iwan.simulate(by_curves, initial=(1.005e-4 * JOINT.phi_max, 0.0), **options)
    assert 0 < below.statistics["below_curves_from"] < 0.05


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: iwan.PowerDamping(c=-1.0, n=1.0), "c = -1"),
        (lambda: iwan.Spring(k=1.0, exponent=1.0), "exponent = 1"),
        (lambda: iwan.Pinning(k=1.0, gap=0.0), "gap = 0"),
        (lambda: iwan.Coulomb(force=np.nan), "force = NaN"),
        (lambda: iwan.ModeCurves([2.0, 1.0], [1.0, 1.0], [0.0, 0.0]), r"amplitude\[1\] = 1"),
        (lambda: iwan.ModeCurves([1.0], [1.0], [0.0]), "2 are needed"),
        (lambda: iwan.Mode(), "frequency is missing"),
        (lambda: iwan.Mode(frequency=1.0, curves=iwan.ModeCurves([1.0, 2.0], [1.0, 1.0], [0.0, 0.0])), "exclude each other"),
        (lambda: iwan.Mode(joint=JOINT, curves=iwan.ModeCurves([1.0, 2.0], [1.0, 1.0], [0.0, 0.0])), "in place of joint"),
    ],
)
def test_bad_values_are_named(make, message):
    with pytest.raises(iwan.InvalidValueError, match=message):
        make()
