"""Structures: the numbers of the paper's beam, the same bits as the command, records that go on to the identification."""

import json
import os
import pickle
import signal
import subprocess
import sys
import sysconfig
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest

import iwan

COMMAND = str(Path(sysconfig.get_path("scripts")) / "iwan")
BLOW = iwan.Haversine(amplitude=10.0, duration=1.6e-3)


@pytest.fixture(scope="module")
def beam():
    return iwan.Structure.built_in("paper-a")


def command(arguments, folder):
    done = subprocess.run([COMMAND, *arguments, "--json", "--quiet"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_modes_of_the_papers_beam(beam, tmp_path):
    modes = beam.modes(5)
    assert modes.names == ["bending 1", "bending 2", "bending 3", "torsion 1", "lateral 1"]
    np.testing.assert_allclose(modes.frequency, [132.3509, 344.2292, 696.2418, 779.8392, 945.9998], rtol=1e-5)
    np.testing.assert_allclose(modes.frequency_slipping[:3], [127.7660, 344.3195, 676.3752], rtol=1e-5)
    np.testing.assert_allclose(modes.k_t[[0, 2]], [4.708e4, 1.0765e6], rtol=5e-3)
    np.testing.assert_allclose(np.abs(modes.outputs["tip"][:3]), [23.4987, 23.1862, 23.2410], rtol=1e-4)
    np.testing.assert_array_equal(modes.shape_at_force, modes.outputs["tip"])
    assert modes.zero_modes == (6, 12) and modes.total_mass == pytest.approx(7.737125e-3, rel=1e-6)
    told = command(["modes", "--count", "5"], tmp_path)
    assert [m["name"] for m in told["modes"]] == modes.names
    for key, values in {"frequency_stuck": modes.frequency, "frequency_slipping": modes.frequency_slipping, "k_t": modes.k_t, "mac": modes.mac}.items():
        assert [m[key] for m in told["modes"]] == values.tolist(), key


def test_shapes_are_arrays_over_nodes(beam):
    modes = beam.modes(4)
    for shapes in (modes.shapes, modes.shapes_slipping):
        assert shapes.shape == (4, 1554, 3) and shapes.dtype == np.float64 and not shapes.flags.writeable
    tip = beam.node_sets["tip"]
    np.testing.assert_allclose(modes.shapes[:, tip, 2].mean(axis=1), modes.outputs["tip"], rtol=1e-9, atol=1e-9)
    assert modes.nodes.shape == (1554, 3) and beam.faces.shape[1] == 4 and beam.faces.max() < 1554
    assert len(modes) == 4 and "4 elastic modes" in repr(modes)


def test_quasi_static_curves(beam, tmp_path):
    q = np.array([1.989e-4, 1.983e-3, 9.949e-3, 4.981e-2])
    curves = beam.quasi_static("bending-1", displacement=q)
    np.testing.assert_allclose(curves.frequency, [132.2419, 131.7560, 129.8896, 128.2020], atol=0.01)
    np.testing.assert_allclose(curves.dissipation, [4.722e-5, 2.690e-2, 3.2325, 37.31], rtol=0.01)
    assert curves.name == "bending 1" and curves.whole and len(curves.slips) == 8
    told = command(["quasi-static", "--mode", "bending 1"], tmp_path)["modes"][0]
    whole = beam.quasi_static("bending 1")
    for key in ["displacement", "frequency", "dissipation", "joint_force"]:
        assert told[key] == getattr(whole, key).tolist(), key
    assert {key: told[key] for key in ["k_t", "f_s", "chi", "beta"]} == {
        key: getattr(whole.joint, key) for key in ["k_t", "f_s", "chi", "beta"]
    }
    assert whole.mode.frequency == whole.frequency_stuck and whole.joint.k_t == pytest.approx(whole.k_t, rel=1e-12)
    second = beam.quasi_static("bending 2", points=8)
    assert second.joint is None and "not positive" in second.remark and second.mode.joint is None


def test_the_command_and_the_library_agree_to_the_last_bit(beam, tmp_path):
    scenario = """
        [structure]
        name = "paper-a"
        basis = 30
        [force]
        kind = "haversine"
        amplitude = 1000.0
        duration = 1.6e-3
        [time]
        step = 1e-5
        duration = 0.02
    """
    (tmp_path / "s.toml").write_text(textwrap.dedent(scenario))
    told = command(["simulate", "s.toml", "--out", "out", "--format", "npz"], tmp_path)
    blow = iwan.Haversine(amplitude=1000.0, duration=1.6e-3)
    response = beam.simulate(force=blow, dt=1e-5, duration=0.02, basis=30)
    table = np.load(tmp_path / "out" / "response.npz")
    np.testing.assert_array_equal(table["t"], response.t)
    for name in [*response.modes, *response.outputs]:
        for quantity in ["displacement", "velocity", "acceleration"]:
            np.testing.assert_array_equal(table[f"{name}.{quantity}"], getattr(response, quantity)[name])
    for name in response.modes:
        np.testing.assert_array_equal(table[f"{name}.joint_force"], response.joint_force[name])
    for figures in told["modes"]:
        assert figures["time_step_error"] == response.time_step_error[figures["name"]]
        assert figures["discretisation_error"] == response.discretisation_error[figures["name"]]
    assert response.basis == 30 and response.basis_error is None and response.energy_error < 1e-11


def test_models_agree_and_say_what_they_cost(beam):
    options = {"force": BLOW, "dt": 1e-5, "duration": 0.004, "modes": ["bending 1", "bending-3"]}
    full = beam.simulate(model="full", **options)
    assert full.basis is None and full.time_step_error is None and full.modes == ["bending 1", "bending 3"]
    told = []
    found = beam.simulate(tolerance=0.05, progress=lambda done, total: told.append((done, total)), **options)
    assert found.basis >= 50 and found.basis_error is not None and found.converged == (found.basis_error <= 0.05)
    assert told[-1] == (1000, 1000)
    for name in full.modes:
        a, b = full.displacement[name], found.displacement[name]
        assert np.sqrt(np.mean((a - b) ** 2) / np.mean(a**2)) < 1e-3
    exact = beam.simulate(sliders=None, basis=50, **options)
    assert exact.discretisation_error is None and exact.time_step_error["bending 1"] < 0.01
    quick = beam.simulate(basis=50, quality=False, **options)
    assert quick.time_step_error is None
    assert max(quick.slip_ratio.values()) > 0 and set(quick.slip) == set(quick.slip_force) == set(quick.slip_ratio)


def test_a_ring_down_in_one_mode_is_the_quasi_static_one(beam):
    """From a modal velocity, through envelope and fit, back to what static loads promise."""
    curves = beam.quasi_static("bending 1", displacement=np.geomspace(2e-4, 2e-3, 9))
    speed = 2 * np.pi * 132.0 * 2e-3
    response = beam.simulate(velocity={"bending 1": speed}, dt=2e-5, duration=0.3, modes=["bending 1"], basis=25, quality=False)
    record = response.record("bending 1")
    assert record.quantity == "acceleration" and record.names == ["bending 1"] and record.dt == 2e-5
    envelope = iwan.envelope(record, filter_order=0)
    q = envelope.amplitude / (2 * np.pi * envelope.frequency) ** 2
    promised = np.interp(np.log(q), np.log(curves.displacement), np.log(curves.dissipation))
    seen = np.log(2 * np.pi * envelope.damping_ratio * (2 * np.pi * envelope.frequency) ** 2 * q**2)
    inside = (q > 3e-4) & (q < 1.8e-3)
    assert inside.sum() > 10 and np.median(np.abs(seen - promised)[inside]) < 0.03
    late = response.record("bending 1", quantity="displacement", since=0.1)
    np.testing.assert_array_equal(late.channel(), response.displacement["bending 1"][5000:])
    assert late.start == pytest.approx(0.1)


def test_records_go_straight_into_the_fit(beam):
    speed = 2 * np.pi * 132.0 * 3e-3
    response = beam.simulate(velocity={"bending 1": speed}, dt=5e-5, duration=0.25, modes=["bending 1"], basis=25, quality=False)
    fit = iwan.fit(response.record("bending 1"), hold={"damping_ratio": 0.0})
    assert fit.frequency == pytest.approx(132.35, abs=0.1)
    curves = beam.quasi_static("bending 1", displacement=np.geomspace(8e-4, 2.5e-3, 5))
    np.testing.assert_allclose(fit.joint.dissipation(curves.displacement), curves.dissipation, rtol=0.1)


def test_values_read_back(beam, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = beam.text
    Path("my beam.toml").write_text(text.replace('title = "Beam', 'title = "My beam'))
    mine = iwan.Structure.load("my beam.toml")
    assert mine.title.startswith("My beam") and mine.joints == beam.joints and mine.loads == ["blow"]
    for structure in (beam, mine):
        assert eval(repr(structure)).name == structure.name
        again = pickle.loads(pickle.dumps(structure))
        assert repr(again) == repr(structure)
        np.testing.assert_array_equal(again.modes(2).frequency, structure.modes(2).frequency)
    assert iwan.Structure.load(tmp_path / "my beam.toml").title == mine.title
    modes = pickle.loads(pickle.dumps(mine.modes(2)))
    np.testing.assert_array_equal(modes.shapes, beam.modes(2).shapes)
    curves = pickle.loads(pickle.dumps(mine.quasi_static("bending 1", displacement=[1e-3])))
    assert curves.joint is None and "bending 1" in repr(curves)


def test_errors_name_file_line_and_key(beam, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = beam.text
    with pytest.raises(iwan.MissingFileError, match="none.toml") as missing:
        iwan.Structure.load("none.toml")
    assert str(missing.value.filename) == "none.toml" and isinstance(missing.value, FileNotFoundError)
    for change, message in [
        (("young = 28.0e6", "young = -1.0"), r"bad.toml:\d+:\d+: material 1: young = -1"),
        (("[[load]]", "[[lod]]"), r"bad.toml:\d+:\d+: unknown key `lod`.*did you mean `load`"),
        (('nodes = "tip"', 'nodes = "tp"'), 'did you mean "tip"'),
    ]:
        Path("bad.toml").write_text(text.replace(*change, 1))
        with pytest.raises(iwan.StructureError, match=message):
            iwan.Structure.load("bad.toml")
    with pytest.raises(iwan.StructureError, match="choose from paper-a, paper-b"):
        iwan.Structure.built_in("paper-c")
    with pytest.raises(ValueError, match="n = 0"):
        beam.modes(0)
    with pytest.raises(iwan.InvalidValueError, match='paper-a: there is no mode "bending 99"; choose from bending 1'):
        beam.quasi_static("bending 99")
    with pytest.raises(iwan.InvalidValueError, match="modal displacement = -1"):
        beam.quasi_static("bending 1", displacement=[-1.0])
    with pytest.raises(iwan.InvalidValueError, match=r"displacement\[0\] = NaN"):
        beam.quasi_static("bending 1", displacement=[np.nan])
    Path("loose.toml").write_text(text.split("[[load]]")[0])
    loose = iwan.Structure.load("loose.toml")
    with pytest.raises(iwan.StructureError, match=r"loose.toml: the structure has no \[\[load\]\]"):
        loose.simulate(force=BLOW, dt=1e-5, duration=1e-3)
    run = {"force": BLOW, "dt": 1e-5, "duration": 1e-3}
    for options, message in [
        ({"force": None}, "nothing moves the structure"),
        ({"dt": 0.0}, "dt = 0"),
        ({"duration": -1.0}, "duration = -1"),
        ({"duration": 1e9}, "8 GB"),
        ({"model": "half"}, "model = 'half'"),
        ({"model": "full", "basis": 10}, "do not apply"),
        ({"basis": 10, "tolerance": 0.1}, "exclude each other"),
        ({"basis": 0}, "basis = 0"),
        ({"basis": 10**6}, r"basis = 1000000 is out of range: 1 to \d+, as many as the structure has unknowns"),
        ({"tolerance": -0.1}, "tolerance = -0.1"),
        ({"modes": ["bending 77"]}, 'no mode "bending 77"'),
        ({"velocity": {"sideways": 1.0}}, 'no mode "sideways"'),
        ({"velocity": {"bending 1": np.inf}}, "must be finite"),
        ({"sliders": 0}, "sliders = 0"),
    ]:
        with pytest.raises(iwan.InvalidValueError, match=message):
            beam.simulate(**(run | options))
    with pytest.raises(iwan.InvalidValueError, match="modes = 1000000 is out of range: 1 to"):
        beam.write_reduced("reduced", modes=10**6)
    assert not Path("reduced").exists()
    response = beam.simulate(basis=25, quality=False, **run)
    for arguments, message in [
        ({"name": "root"}, "choose from bending 1"),
        ({"name": "tip", "since": 1.0}, "leaves no record"),
        ({"name": "tip", "quantity": "strain"}, "quantity = 'strain'"),
    ]:
        with pytest.raises(iwan.InvalidValueError, match=message):
            response.record(**arguments)


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to a process of one's own")
def test_ctrl_c_ends_a_transient():
    program = """
        import iwan, time
        beam = iwan.Structure.built_in("paper-a")
        beam.modes(40)
        print("ready", flush=True)
        try:
            beam.simulate(force=iwan.Haversine(amplitude=10.0, duration=1.6e-3), dt=1e-6, duration=1.0, model="full")
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(program)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(1.5)
    os.kill(process.pid, signal.SIGINT)
    assert process.communicate(timeout=60)[0] == "interrupted\n"


def test_a_reduced_model_opens_again_with_the_same_bits(beam, tmp_path):
    beam.write_reduced(tmp_path / "r", modes=30)
    again = iwan.Structure.load(tmp_path / "r")
    once = beam.simulate(force=BLOW, dt=1e-5, duration=0.005, basis=30, quality=False)
    for structure in (again, pickle.loads(pickle.dumps(again))):
        response = structure.simulate(force=BLOW, dt=1e-5, duration=0.005, quality=False)
        assert response.basis == 30
        np.testing.assert_array_equal(response.acceleration["bending 1"], once.acceleration["bending 1"])
        np.testing.assert_array_equal(response.acceleration["tip"], once.acceleration["tip"])
    with pytest.raises(OSError, match="force"):
        beam.write_reduced(tmp_path / "r", modes=30)


def test_matrices_are_those_of_the_modes(beam, tmp_path):
    sparse = pytest.importorskip("scipy.sparse")
    names = beam.write_matrices(tmp_path / "m", format="npz")
    assert "mass.npz" in names
    stiffness, mass, displacements = (
        sparse.load_npz(tmp_path / "m" / f"{name}.npz") for name in ("stuck_stiffness", "mass", "displacements")
    )
    assert stiffness.shape == mass.shape == (displacements.shape[1],) * 2
    assert displacements.shape[0] == beam.nodes.size
    # A rigid displacement along x, in the unknowns, by least squares: its mass is that of the structure.
    rigid = sparse.linalg.lsqr(displacements.tocsr(), np.tile([1.0, 0.0, 0.0], len(beam.nodes)), atol=1e-14, btol=1e-14)[0]
    assert rigid @ (mass @ rigid) == pytest.approx(beam.modes(1).total_mass, rel=1e-6)
    with pytest.raises(iwan.InvalidValueError, match="format"):
        beam.write_matrices(tmp_path / "n", format="csv")


@pytest.fixture(scope="module")
def updated(beam):
    measured = {mode: beam.quasi_static(mode, points=24) for mode in ("bending 1", "bending 3")}
    return iwan.update(beam, {"bending 1": measured["bending 1"]}, predict={"bending-3": measured["bending 3"]}, undamped=True)


def test_joints_of_a_structure_come_back_from_curves(beam, updated, tmp_path):
    links, washers = updated.groups
    assert updated.adequate and links.joints == ["left link", "right link"]
    assert links.joint.k_t == pytest.approx(2.75e5, rel=0.02) and not washers.f_s.identifiable
    predicted = updated.curves[1]
    assert predicted.held_out and predicted.damping_ratio_after == pytest.approx(predicted.damping_ratio, rel=0.03)
    assert repr(pickle.loads(pickle.dumps(updated))) == repr(updated)
    updated.write(tmp_path / "updated.toml")
    assert iwan.Structure.load(tmp_path / "updated.toml").joints == beam.joints
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = iwan.plot.updated(updated, show="frequency")
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["bending 1", "bending 3 (predicted)"]


def test_curves_that_do_not_fit_are_named(beam):
    curve = {"displacement": [1e-4, 2e-4, 3e-4, 4e-4], "frequency": [132.3, 132.2, 132.1, 132.0], "damping_ratio": [1e-4] * 4}
    with pytest.raises(iwan.InvalidValueError, match="has no 'frequency'"):
        iwan.update(beam, {"bending 1": {"displacement": [1.0]}})
    with pytest.raises(iwan.InvalidValueError, match="no joint 'nowhere'.*left link"):
        iwan.update(beam, {"bending 1": curve}, groups={"all": ["nowhere"]})
    with pytest.raises(iwan.InvalidValueError, match="no part 'air'.*material"):
        iwan.update(beam, {"bending 1": curve}, correct=["air"])
    with pytest.raises(iwan.InvalidTypeError, match="must be an iwan.Fit"):
        iwan.update(beam, {"bending 1": 3.0})


def test_joints_of_a_structure_come_back_from_blows(beam):
    def hit(amplitude):
        blow = iwan.Haversine(amplitude=amplitude, duration=1.6e-3)
        told = beam.simulate(force=blow, dt=5e-6, duration=0.13, modes=["bending 1", "bending 3"], basis=50, quality=False)
        motions = {name: told.acceleration[name][::4] for name in ("tip", "bending 3")}
        return {"dt": 2e-5, "force": [blow.at(2e-5 * n) for n in range(motions["tip"].size)], **motions}

    told = []
    found = iwan.update(
        beam, records=[hit(1000.0)], predict_records=[hit(100.0)], modes=["bending 1", "bending 3"], undamped=True,
        progress=lambda done, total: told.append(done / total),
    )
    assert found.groups[0].k_t.value == pytest.approx(2.75e5, rel=0.02) and found.adequate
    assert {blow.point for blow in found.blows} == {"tip", "bending 3"} and not found.curves
    # One hard blow tells the joints to a per cent, and the end of a blow a tenth as hard to two.
    assert all(blow.after < 0.025 for blow in found.blows) and {blow.held_out for blow in found.blows} == {False, True}
    assert told == sorted(told) and told[-1] <= 1.0 and len(set(told)) > 3
    assert repr(pickle.loads(pickle.dumps(found))) == repr(found)


def test_blows_that_do_not_fit_are_named(beam):
    samples = [0.0, 1.0] * 50
    for records, modes, said in [
        ([{"dt": 1e-4, "tip": samples}], ["bending 1"], "has no 'force'"),
        ([{"dt": 1e-4, "force": samples, "nose": samples}], ["bending 1"], "no mode or output 'nose'.*tip"),
        ([{"dt": 1e-4, "force": samples, "tip": samples[:80]}], ["bending 1"], "tip has 80 samples"),
        ([{"dt": 1e-4, "force": samples, "tip": samples}], None, "modes is missing"),
        ([{"dt": -1.0, "force": samples, "tip": samples}], ["bending 1"], "sampling interval"),
    ]:
        with pytest.raises(iwan.InvalidValueError, match=said):
            iwan.update(beam, records=records, modes=modes)
    with pytest.raises(iwan.InvalidTypeError, match="curves and records are missing"):
        iwan.update(beam)
    with pytest.raises(iwan.InvalidTypeError, match=r"records\[0\] must be a mapping"):
        iwan.update(beam, records=[3.0], modes=["bending 1"])
