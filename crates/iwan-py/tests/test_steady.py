"""Forced responses and backbones: the balance itself, options, errors."""

import json
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


@pytest.fixture(scope="module")
def beam():
    return iwan.Structure.built_in("paper-a")


def test_a_structure_is_driven_and_freely_vibrating(beam):
    weak, strong = beam.frf(band=(125.0, 140.0), force=[0.01, 30.0], damping_ratio=1e-3, basis=20, harmonics=3)
    assert weak.peak[0] == pytest.approx(132.35, abs=0.2) and strong.peak[0] < weak.peak[0] - 0.5
    assert not weak.remarks and sorted(weak.harmonics) == [3]
    free = beam.backbone("bending 1", amplitude=[1e-5, 1e-2], harmonics=3, basis=20)
    assert free.frequency[0] == pytest.approx(132.34, abs=0.02) and free.frequency[1] < 131
    assert set(free.slips) >= {"left link x", "right washer y"} and free.response[0] == pytest.approx(1e-5 * 23.5, rel=1e-2)
    # By the other door, and with default amplitudes.
    again = iwan.backbone(beam, of="bending 1", amplitude=[1e-5, 1e-2], harmonics=3, basis=20)
    np.testing.assert_array_equal(again.frequency, free.frequency)
    assert beam.backbone(points=3, basis=12).amplitude.size == 3
    [held] = iwan.frf(beam, band=(131.0, 133.0), acceleration=[50.0], damping_ratio=1e-3, basis=20)
    np.testing.assert_allclose((2 * np.pi * held.frequency) ** 2 * held.amplitude, 50.0, rtol=1e-8)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"base_acceleration": [1.0]}, "needs the direction"),
        ({"base_acceleration": [1.0], "direction": (0, 0, 1)}, "nothing holds the structure"),
        ({"force": [1.0], "direction": (0, 0, 1)}, "leave it out"),
        ({"force": [1.0], "at": "moon"}, "moon"),
        ({"force": [1.0], "damping_ratio": 1.0}, "damping_ratio = 1"),
        ({"force": [1.0], "basis": 0}, "basis = 0"),
        ({"force": [1.0], "basis": 10**6}, r"basis = 1000000 is out of range: 1 to \d+, as many as the structure has unknowns"),
    ],
)
def test_bad_values_of_structures_are_named(beam, options, message):
    with pytest.raises(iwan.IwanError, match=message) as caught:
        beam.frf(band=(125.0, 140.0), **options)
    assert isinstance(caught.value, ValueError)


def test_coupled_modes_vibrate_together():
    modes = [iwan.Mode(frequency=132.35, name="bending 1", outputs={"tip": 20.0}), iwan.Mode(frequency=719.6, name="bending 3")]
    law = iwan.FourParameter(k_t=3.16e4, f_s=143.8, chi=-0.3, beta=0.02)
    coupled = iwan.CoupledModes(modes, [iwan.SharedJoint(joint=law, participation=[1.0, -4.905], compliance=9.1e-6, name="link")])
    [curve] = iwan.frf(coupled, band=(125.0, 135.0), force=[20.0], harmonics=3)
    free = coupled.backbone("bending 1", amplitude=[1e-5, curve.peak[1]], harmonics=3)
    assert free.frequency[1] == pytest.approx(curve.peak[0], rel=1e-4) and list(free.slips) == ["link"]
    with pytest.raises(iwan.InvalidValueError, match="no point"):
        coupled.frf(band=(125.0, 135.0), force=[20.0], at="tip")  # mode 2 has none
    with pytest.raises(iwan.InvalidValueError, match="no mode has its resonance"):
        coupled.frf(band=(200.0, 250.0), force=[20.0])
    with pytest.raises(iwan.InvalidValueError, match="not known"):
        coupled.backbone("moon", amplitude=[1e-5])


def test_levels_on_threads_are_the_same_bits(mode):
    options = {"band": BAND, "force": [5.0, 50.0, 100.0], "harmonics": 3}
    one, three = (iwan.frf(mode, threads=threads, **options) for threads in (1, 3))
    assert [curve.level for curve in three] == [5.0, 50.0, 100.0]
    for a, b in zip(one, three, strict=True):
        np.testing.assert_array_equal(a.amplitude, b.amplitude)


def measured(mode):
    """A shaker's test of two levels, as a table."""
    curves = iwan.frf(mode, band=BAND, force=[2.0, 100.0], points=60)
    columns = ("frequency", "amplitude", "phase", "excitation")
    return curves, {name: np.concatenate([getattr(curve, name) for curve in curves]) for name in columns}


def test_sweeps_of_any_origin_are_one_fit(mode, joint, tmp_path):
    import scipy.io

    curves, table = measured(mode)
    names = list(table)
    np.savetxt(tmp_path / "test.csv", np.column_stack(list(table.values())), delimiter=",", header=",".join(names), comments="")
    scipy.io.savemat(tmp_path / "test.mat", {"sweep": table})
    np.savez(tmp_path / "test.npz", **table)
    free = iwan.backbone(mode, amplitude=np.geomspace(1e-5, 1e-3, 20))
    found = [
        iwan.fit(sweeps=[curves]),
        iwan.fit(sweeps=table),
        *(iwan.fit(sweeps=tmp_path / f"test.{ending}") for ending in ("csv", "mat", "npz")),
        iwan.fit(sweeps=[curves], backbones=free),
    ]
    for fit in found:
        assert fit.joint.f_s == pytest.approx(joint.f_s, rel=1e-3) and fit.joint.chi == pytest.approx(joint.chi, rel=1e-3)
        assert fit.identifiable["k_t"] and fit.slips and fit.grade == "matches"
    assert "f_s" in str(found[0]) and pickle.loads(pickle.dumps(found[0])).mode == found[0].mode
    held = iwan.fit(sweeps=[curves], hold={"damping_ratio": 2.5e-4})
    assert held.damping_ratio == 2.5e-4 and not held.identifiable["damping_ratio"]


def test_a_fit_of_sweeps_writes_the_page_of_the_command(mode, joint, tmp_path):
    curves = iwan.frf(mode, band=BAND, force=[2.0, 20.0], points=60)
    response = iwan.simulate(mode, dt=2e-4, duration=0.4, initial=(2.0 * joint.phi_max, 0.0), method="half-cycle")
    fit = iwan.fit(response.acceleration, dt=2e-4, sweeps=[curves], mass=1.0)
    # The ring-down goes beyond what the shaker reached.
    assert fit.informed[1] > 1.5 * max(curve.amplitude.max() for curve in curves)
    fit.report(tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text()
    assert page.count("<svg") >= 5 and "record" in page and "Measured and predicted: sweeps[0]" in page
    pickle.loads(pickle.dumps(fit)).report(tmp_path / "again.html")
    assert (tmp_path / "again.html").read_text() == page
    with pytest.raises(iwan.ExistingFileError):
        fit.report(tmp_path / "page.html")
    fit.report(tmp_path / "page.html", force=True)
    told = json.loads(fit.to_json(tmp_path / "fit.json"))
    assert told["modes"][0]["k_t"]["value"] == fit.joint.k_t and "files" not in told
    assert json.loads((tmp_path / "fit.json").read_text()) == told


def universal(path, frequency, responses):
    """Frequency responses of acceleration over force as another program writes them (dataset 58 of type 4)."""
    import pyuff

    sets = [
        pyuff.prepare_58(
            func_type=4,
            rsp_node=2,
            rsp_dir=3,
            ref_node=1,
            ref_dir=3,
            data=values,
            x=frequency,
            id1="H",
            ord_data_type=6,
            abscissa_spacing=1,
            abscissa_min=frequency[0],
            abscissa_inc=frequency[1] - frequency[0],
            num_pts=frequency.size,
            abscissa_spec_data_type=18,
            ordinate_spec_data_type=12,
            orddenom_spec_data_type=13,
        )
        for values in responses
    ]
    pyuff.UFF(str(path)).write_sets(sets, "overwrite")


def test_functions_of_universal_files_are_sweeps(mode, joint, tmp_path):
    frequency = np.linspace(*BAND, 321)
    responses = []
    for level in (2.0, 20.0):
        [curve] = iwan.frf(mode, band=BAND, force=[level], points=4000)
        order = np.argsort(curve.frequency)  # at these levels nothing turns back
        assert not curve.jumps
        amplitude = np.interp(frequency, curve.frequency[order], curve.amplitude[order])
        phase = np.interp(frequency, curve.frequency[order], curve.phase[order])
        responses.append(-((2 * np.pi * frequency) ** 2) * amplitude / level * np.exp(1j * phase))
    universal(tmp_path / "test.uff", frequency, responses)
    found = iwan.fit(sweeps=tmp_path / "test.uff", levels=[2.0, 20.0])
    assert found.joint.chi == pytest.approx(joint.chi, rel=0.02) and found.frequency == pytest.approx(124.0, rel=1e-4)
    with pytest.raises(iwan.RecordError, match="2 frequency responses, but 0 levels"):
        iwan.fit(sweeps=tmp_path / "test.uff")


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({}, iwan.InvalidTypeError, "record is missing"),
        ({"sweeps": "none.csv"}, iwan.MissingFileError, "none.csv"),
        ({"sweeps": {"frequency": [1.0, 2.0]}}, iwan.RecordError, "no column"),
        ({"sweeps": {"frequency": [1.0], "amplitude": [1.0, 2.0], "phase": [0.0], "force": [1.0]}}, iwan.InvalidValueError, "must agree"),
        ({"sweeps": [3]}, iwan.InvalidTypeError, "must be a path"),
        ({"sweeps": {"frequency": [1.0]}, "mass": 0.0}, iwan.InvalidValueError, "mass = 0"),
        ({"sweeps": {"frequency": [1.0]}, "law": "linear"}, iwan.InvalidValueError, "ring-downs alone"),
    ],
)
def test_bad_sweeps_are_named(options, error, message):
    with pytest.raises(error, match=message):
        iwan.fit(**options)
