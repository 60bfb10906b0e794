"""Modes from hits and from free decays."""

import pickle

import numpy as np
import pytest

import iwan

RATE = 2048
N = 8192


def _hit(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Two modes of mass 1 at three points, the first struck by an impulse of 2 N s at sample 30."""
    t = np.maximum(np.arange(N) - 30, 0) / RATE
    random = np.random.default_rng(seed)
    force = np.zeros(N)
    force[30] = 2 * RATE
    shapes = np.array([[1.0, 0.5, -0.7], [0.8, -1.1, 0.6]])
    motion = np.zeros((3, N))
    for (frequency, damping), shape in zip([(90.0, 2e-3), (170.0, 5e-4)], shapes, strict=True):
        omega = 2 * np.pi * frequency
        damped = omega * np.sqrt(1 - damping**2)
        motion += 2 * shape[0] * shape[:, None] * np.exp(-damping * omega * t) * np.sin(damped * t) / damped
    scale = np.sqrt(np.mean(motion**2))
    return force, motion + 3e-3 * scale * random.standard_normal(motion.shape)


def test_hits_give_modes_with_scale_and_standard_deviations():
    force, motion = (np.array(x) for x in zip(*[_hit(seed) for seed in range(3)], strict=True))
    fit = iwan.modal_fit(force, motion, 1 / RATE, names=["tip", "b", "c"], force_at="tip", quantity="displacement", band=(50, 250), order=20)
    assert fit.mass_normalised and fit.remarks == [] and len(fit.modes) == 2
    for mode, (frequency, damping) in zip(fit.modes, [(90.0, 2e-3), (170.0, 5e-4)], strict=True):
        assert mode.frequency == pytest.approx(frequency, rel=1e-5)
        assert mode.damping_ratio == pytest.approx(damping, rel=1e-2)
        assert abs(mode.frequency - frequency) < 4 * mode.frequency_sd
    assert np.abs(fit.modes[0].shape) == pytest.approx([1.0, 0.5, 0.7], rel=5e-3)
    assert fit.responses.shape == fit.fitted.shape == (3, len(fit.frequency))
    assert fit.misfit < 0.1
    again = pickle.loads(pickle.dumps(fit))
    assert again.modes[1].frequency == fit.modes[1].frequency


def test_modes_are_added_and_left_out_one_by_one():
    force, motion = _hit(1)
    options = {"quantity": "displacement", "band": (50, 250), "order": 20}
    left = iwan.modal_fit(force, motion, 1 / RATE, drop_poles=[90.0], **options)
    assert [mode.frequency for mode in left.modes] == pytest.approx([170.0], rel=1e-5)
    again = iwan.modal_fit(force, motion, 1 / RATE, drop_poles=[90.0], add_poles=[90.1], **options)
    assert [mode.frequency for mode in again.modes] == pytest.approx([90.0, 170.0], rel=1e-5)
    with pytest.raises(iwan.InvalidValueError, match="frequency of a mode to leave out = 120"):
        iwan.modal_fit(force, motion, 1 / RATE, drop_poles=[120.0], **options)
    with pytest.raises(iwan.InvalidValueError, match="poles gives all modes"):
        iwan.modal_fit(force, motion, 1 / RATE, poles=[90.0], add_poles=[170.0], **options)


def test_a_force_without_a_pulse_is_refused_unless_it_is_taken_whole():
    force, motion = _hit(1)
    shaker = np.random.default_rng(3).standard_normal(N)
    options = {"quantity": "displacement", "band": (50, 250), "order": 20}
    with pytest.raises(iwan.IdentificationError, match=r"hit 1 \(counted from 0\): no pulse stands out .* whole_force=True") as refused:
        iwan.modal_fit([force, shaker], [motion, motion], 1 / RATE, **options)
    assert refused.value.kind == "refused"
    assert iwan.modal_fit(force, motion, 1 / RATE, whole_force=True, **options).remarks == []


def test_free_decays_need_no_force():
    motion = _hit(1)[1][:, 31:]
    fit = iwan.modal_fit(None, motion, 1 / RATE, quantity="displacement", band=(50, 250), order=20)
    assert not fit.mass_normalised
    assert [mode.frequency for mode in fit.modes] == pytest.approx([90.0, 170.0], rel=1e-5)
    other = iwan.modal_fit(None, motion, 1 / RATE, quantity="displacement", band=(50, 250), order=20, method="subspace")
    assert [mode.frequency for mode in other.modes] == pytest.approx([mode.frequency for mode in fit.modes], rel=1e-9)


def test_what_does_not_go_together_is_refused():
    force, motion = _hit(2)
    with pytest.raises(iwan.InvalidValueError, match="one force for each hit"):
        iwan.modal_fit([force, force], motion, 1 / RATE)
    with pytest.raises(iwan.InvalidValueError, match="3 channels"):
        iwan.modal_fit(force, motion, 1 / RATE, names=["a"])
    with pytest.raises(iwan.InvalidValueError, match="free decays"):
        iwan.modal_fit(force, motion, 1 / RATE, method="subspace")
    with pytest.raises(iwan.InvalidValueError, match="quantity"):
        iwan.modal_fit(force, motion, 1 / RATE, quantity="force")
    with pytest.raises(iwan.InvalidValueError, match="method"):
        iwan.modal_fit(force, motion, 1 / RATE, method="fourier")
    with pytest.raises(iwan.IdentificationError, match="no mode"):
        iwan.modal_fit(force, motion, 1 / RATE, quantity="displacement", band=(300, 500), order=20)


def test_what_is_no_channel_and_no_real_number_is_refused():
    force, motion = _hit(1)
    options = {"names": ["tip", "b", "c"], "quantity": "displacement", "band": [50, 250], "order": 20}
    assert iwan.modal_fit(force, motion, 1 / RATE, force_at="tip", **options).mass_normalised
    with pytest.raises(iwan.InvalidValueError, match="force_at = \"top\" is no channel: the names are tip, b, c"):
        iwan.modal_fit(force, motion, 1 / RATE, force_at="top", **options)
    with pytest.raises(iwan.InvalidValueError, match=r"responses hides \d+ numbers under a mask"):
        iwan.modal_fit(force, np.ma.masked_greater(motion, 1e-4), 1 / RATE, **options)
    for wrong in (motion * 1j, [iwan.Record(motion, dt=1 / RATE)], iwan.Record(motion, dt=1 / RATE)):
        with pytest.raises(iwan.InvalidTypeError, match="responses"):
            iwan.modal_fit(force, wrong, 1 / RATE, **options)


def test_poles_that_move_away_from_where_they_were_given_are_named():
    force, motion = _hit(1)
    options = {"quantity": "displacement", "band": (50, 250), "order": 20}
    assert iwan.modal_fit(force, motion, 1 / RATE, poles=[90.2, 169.0], **options).remarks == []
    [remark] = iwan.modal_fit(force, motion, 1 / RATE, poles=[75.0, 170.0], **options).remarks
    assert "at 75.00 Hz (the nearest at 90.00 Hz)" in remark
