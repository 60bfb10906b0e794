"""Modes that share joints."""

import numpy as np
import pytest

import iwan

LAW = iwan.FourParameter(k_t=3.16e4, f_s=143.8, chi=-0.3, beta=0.02)
BLOW = iwan.Haversine(amplitude=7000.0, duration=1.6e-3)
MODES = [iwan.Mode(frequency=132.35, name="bending 1"), iwan.Mode(frequency=719.6, name="bending 3")]


def test_one_mode_that_alone_moves_its_joint_is_the_single_mode() -> None:
    own = iwan.Mode(frequency=132.35, joint=LAW)
    single = iwan.simulate(own, force=BLOW, dt=1e-5, duration=0.05, sliders=None)
    shared = iwan.CoupledModes(MODES[:1], [iwan.SharedJoint(joint=LAW, participation=[1.0])])
    coupled = shared.simulate(force=BLOW, dt=1e-5, duration=0.05)
    for name in ("displacement", "velocity", "acceleration", "joint_force"):
        one, other = getattr(single, name), getattr(coupled.modes[0], name)
        assert np.abs(one - other).max() < 1e-9 * np.abs(one).max(), name
    assert np.allclose(coupled.joints[0].slip, single.displacement, rtol=0.0, atol=1e-11)


def test_energy_closes_and_modes_couple() -> None:
    joint = iwan.SharedJoint(joint=LAW, participation=[1.0, -4.905], compliance=9.1e-6)
    model = iwan.CoupledModes(MODES, [joint])
    response = model.simulate(force=BLOW, dt=1e-5, duration=0.1)
    assert response.energy_error < 1e-13
    assert response.joints[0].friction == pytest.approx(response.energy["friction"], rel=1e-9)
    on_sliders = model.simulate(force=BLOW, dt=1e-5, duration=0.1, sliders=100)
    difference = np.abs(on_sliders.joints[0].slip - response.joints[0].slip).max()
    assert 0.0 < difference < 0.02 * np.abs(response.joints[0].slip).max()


def test_what_does_not_fit_is_named() -> None:
    def refused(**changes: object) -> str:
        given = {"joint": LAW, "participation": [1.0, -4.905], "name": "link"} | changes
        with pytest.raises(iwan.InvalidValueError) as caught:
            iwan.CoupledModes(MODES, [iwan.SharedJoint(**given)]).simulate(dt=1e-5, duration=0.01)
        return str(caught.value)

    assert "more modes" in refused(compliance=1e-4)
    assert "participation" in refused(participation=[1.0])
    assert "link" in refused(participation=[float("nan"), 1.0])
    with pytest.raises(iwan.InvalidValueError, match="joints is empty"):
        iwan.CoupledModes(MODES, [])
    with pytest.raises(iwan.InvalidTypeError, match="SharedJoint"):
        iwan.CoupledModes(MODES, [LAW])
