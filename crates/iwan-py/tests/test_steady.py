"""Forced responses and backbones: the balance itself, options, errors."""

import pickle

import numpy as np
import pytest

import iwan

BAND = (112.0, 128.0)


def balance(mode, joint, curve):
    """Force and phase that harmonic balance asks for, from the joint's closed forms."""
    a, w = curve.amplitude, 2 * np.pi * curve.frequency
    w0 = 2 * np.pi * mode.frequency
    re = w0**2 - joint.k_t + joint.harmonic_stiffness(a) - w**2
    im = 2 * mode.damping_ratio * w0 * w + joint.dissipation(a) / (np.pi * a**2)
    return a * np.hypot(re, im), -np.arctan2(im, re)


@pytest.mark.parametrize("held", ["force", "displacement", "velocity", "acceleration"])
def test_every_point_is_balanced(mode, joint, held):
    level = {"force": 50.0, "displacement": 2e-3, "velocity": 1.5, "acceleration": 1200.0}[held]
    [curve] = iwan.frf(mode, band=BAND, **{held: [level]})
    force, phase = balance(mode, joint, curve)
    np.testing.assert_allclose(curve.excitation, force, rtol=1e-8)
    np.testing.assert_allclose(curve.phase, phase, atol=1e-7)
    w = 2 * np.pi * curve.frequency
    size = {"force": curve.excitation, "displacement": curve.amplitude, "velocity": w * curve.amplitude}
    np.testing.assert_allclose(size.get(held, w**2 * curve.amplitude), level, rtol=1e-12)
    assert curve.control == held and curve.level == level and not curve.remarks


def test_harmonics_leave_the_fundamental_nearly_alone(mode):
    [one] = iwan.frf(mode, band=BAND, force=[100.0])
    [seven] = iwan.frf(mode, band=BAND, force=[100.0], harmonics=7)
    assert seven.peak == pytest.approx(one.peak, rel=1e-4)
    assert sorted(seven.harmonics) == [3, 5, 7] and not one.harmonics
    amplitude, phase = seven.harmonics[3]
    assert amplitude.shape == phase.shape == seven.frequency.shape
    assert 0 < amplitude.max() < 0.02 * seven.amplitude.max()


def test_several_modes_on_threads_are_the_same_bits(joint):
    modes = [iwan.Mode(frequency=f, joint=joint, damping_ratio=1e-3) for f in (118.0, 121.0, 124.0)]
    options = {"band": (105.0, 130.0), "force": [5.0, 50.0], "harmonics": 3}
    alone = [iwan.frf(mode, **options) for mode in modes]
    for threads in (1, 3):
        for a, b in zip(iwan.frf(modes, threads=threads, **options), alone, strict=True):
            for x, y in zip(a, b, strict=True):
                np.testing.assert_array_equal(x.amplitude, y.amplitude)
                np.testing.assert_array_equal(x.frequency, y.frequency)


def test_the_backbone_is_the_closed_form_and_harmonics_change_little(mode, joint):
    amplitude = joint.phi_max * np.geomspace(1e-3, 10, 30)
    one = iwan.backbone(mode, amplitude=amplitude)
    np.testing.assert_array_equal(one.frequency, [mode.frequency_at(a) for a in amplitude])
    np.testing.assert_array_equal(one.damping_ratio, [mode.damping_ratio_at(a) for a in amplitude])
    seven = iwan.backbone([mode], amplitude=amplitude, harmonics=7)[0]
    np.testing.assert_allclose(seven.frequency, one.frequency, rtol=1e-5)
    np.testing.assert_allclose(seven.damping_ratio, one.damping_ratio, rtol=1e-2)
    assert sorted(seven.harmonics) == [3, 5, 7] and not seven.remarks


def test_results_pickle_and_show_themselves(mode, joint):
    [curve] = iwan.frf(mode, band=BAND, force=[10.0])
    again = pickle.loads(pickle.dumps(curve))
    np.testing.assert_array_equal(again.phase, curve.phase)
    assert "peak" in repr(curve)
    backbone = iwan.backbone(mode, amplitude=[joint.phi_max])
    assert pickle.loads(pickle.dumps(backbone)).frequency == backbone.frequency
    assert "1 amplitudes" in repr(backbone)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"force": [0.0]}, "level = 0"),
        ({"force": [np.nan]}, "force"),
        ({}, "exactly one"),
        ({"force": [1.0], "velocity": [1.0]}, "exactly one"),
        ({"force": [1.0], "harmonics": 4}, "harmonics = 4"),
        ({"force": [1.0], "band": (10.0, 5.0)}, "to = 5"),
        ({"force": [1.0], "at": "moon"}, "moon"),
        ({"force": [1.0], "points": 3}, "points = 3"),
    ],
)
def test_bad_values_are_named(mode, options, message):
    with pytest.raises(iwan.InvalidValueError, match=message):
        iwan.frf(mode, **{"band": BAND} | options)


def test_bad_modes_and_amplitudes_are_named(mode):
    with pytest.raises(iwan.InvalidTypeError, match="iwan.Mode"):
        iwan.frf(3, band=BAND, force=[1.0])
    with pytest.raises(iwan.InvalidValueError, match="empty"):
        iwan.backbone([], amplitude=[1.0])
    with pytest.raises(iwan.InvalidValueError, match="amplitudes"):
        iwan.backbone(mode, amplitude=[2.0, 1.0])


def test_a_force_that_friction_cannot_hold_is_said(joint):
    mode = iwan.Mode(frequency=124.0, joint=joint)
    [curve] = iwan.frf(mode, band=BAND, force=[400.0])
    assert any("without bound" in remark for remark in curve.remarks)
    assert curve.frequency.min() < 113 and curve.frequency.max() > 127
