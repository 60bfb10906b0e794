"""Modes that share joints."""

import json
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

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


def blows(levels):
    """Motions of two modes that share a joint, and the forces of blows on them, sampled coarsely so that a fit takes a moment."""
    law = iwan.FourParameter(k_t=1500.0, f_s=20.0, chi=-0.3, beta=0.05)
    stuck = [
        iwan.Mode(frequency=20.0, damping_ratio=5e-4, name="one"),
        iwan.Mode(frequency=52.0, damping_ratio=5e-4, shape_at_force=-0.7, name="two"),
    ]
    truth = iwan.CoupledModes(stuck, [iwan.SharedJoint(joint=law, participation=[1.0, -2.5], compliance=1e-4)])
    motions, forces = [], []
    for level in levels:
        blow = iwan.Haversine(amplitude=level, duration=0.01)
        rung = truth.simulate(force=blow, dt=2.5e-4, duration=1.5)
        motions.append(np.array([mode.acceleration[::4] for mode in rung.modes]))
        forces.append(np.array([blow.at(1e-3 * n) for n in range(1501)]))
    return motions, forces


ASKED = {"dt": 1e-3, "shapes": np.eye(2), "frequencies": [20.0, 52.0]}


@pytest.fixture(scope="module")
def fitted():
    motions, forces = blows([60.0, 600.0, 6000.0, 2000.0])
    told = []
    found = iwan.fit_coupled(
        motions[:3], forces=forces[:3], predict=motions[3:], predict_forces=forces[3:],
        progress=lambda done, total: told.append(done / total), **ASKED,
    )
    assert told == sorted(told) and told[-1] == 1.0 and any(0.0 < share < 1.0 for share in told)
    return found, motions, forces


def test_a_coupled_fit_finds_the_shared_joint_and_predicts_a_blow_kept_out(fitted) -> None:
    found, motions, _ = fitted
    assert found.chosen == "shared 1" and found.in_words[0] == "all modes share one joint"
    told = found.estimates["participation of mode 2 in joint"]
    assert told.low < told.value < told.high and told.value == found.joints[0].participation[1] == pytest.approx(-2.5, rel=2e-3)
    assert found.estimates["k_t of joint"].value == found.joints[0].joint.k_t == pytest.approx(1500.0, rel=0.05)
    misfit = {model["name"]: model["held_out_misfit"] for model in found.models}
    assert misfit["shared 1"] < 0.02 and misfit["uncoupled"] > 3.0 * misfit["shared 1"]
    # Records are cut where the modes have rung down, and the model with them.
    for own, model, motion in zip(found.measured, found.motions, motions, strict=True):
        assert own.shape == model.shape and 700 < own.shape[1] <= 1501
        assert np.abs(own - motion[:, : own.shape[1]]).max() < 1e-12 * np.abs(motion).max()
        assert np.sqrt(np.mean((own - model) ** 2) / np.mean(own**2)) < 0.02
    # The model goes on: it is what `simulate` takes.
    rung = found.model.simulate(force=iwan.Haversine(amplitude=2000.0, duration=0.01), dt=2.5e-4, duration=1.5)
    left = rung.modes[0].acceleration[::4] - motions[3][0]
    assert np.sqrt(np.mean(left**2) / np.mean(motions[3][0] ** 2)) < 0.05


def test_a_coupled_fit_is_that_of_the_command_line(fitted, tmp_path) -> None:
    found, motions, forces = fitted
    (tmp_path / "shapes.csv").write_text("frequency,a,b\n20,1,0\n52,0,1\n")
    names = []
    for n, (motion, force) in enumerate(zip(motions, forces, strict=True)):
        names.append(f"hit-{n}.csv")
        rows = [f"{k * 1e-3!r},{a!r},{b!r},{f!r}" for k, (a, b, f) in enumerate(zip(*motion.tolist(), force.tolist(), strict=True))]
        (tmp_path / names[-1]).write_text("\n".join(["t [s],a [m/s^2],b [m/s^2],hammer [N]", *rows]))
    told = json.loads(
        subprocess.run(
            [sys.executable, "-m", "iwan", "fit", *names[:3], "--coupled", "--shapes", "shapes.csv", "--load", "hammer",
             "--held-out", names[3], "--json", "--quiet", "--out", "f"],
            cwd=tmp_path, check=True, capture_output=True,
        ).stdout
    )
    joint = told["joints"][0]
    for what in ("k_t", "f_s", "chi", "beta", "compliance_k_t", "slip_at_force"):
        assert vars(found.estimates[f"{what} of joint"]) == joint[what]
    assert vars(found.estimates["participation of mode 2 in joint"]) == joint["participation"]["mode 2"]
    for mode in told["modes"]:
        for what in ("frequency", "damping_ratio", "shape_at_force"):
            assert vars(found.estimates[f"{what} of {mode['name']}"]) == mode[what]
    for own, other in zip(found.models, told["models"], strict=True):
        assert {**own, "misfits": 0, "held_out": 0} == {**other, "misfits": 0, "held_out": 0}
        assert [m["relative"] for m in own["misfits"]] == [m["relative"] for m in other["misfits"]]
    assert list(found.in_words) == told["in_words"]


def test_a_coupled_fit_out_of_a_pickle_writes_the_same_report(fitted, tmp_path) -> None:
    found = fitted[0]
    again = pickle.loads(pickle.dumps(found))
    assert repr(again) == repr(found) and vars(again)["estimates"] == found.estimates
    found.report(tmp_path / "one.html")
    again.report(tmp_path / "two.html")
    told = json.loads(found.to_json(tmp_path / "fit.json"))
    assert told["chosen"] == found.chosen and "files" not in told and again.to_json() == (tmp_path / "fit.json").read_text()
    page = (tmp_path / "one.html").read_bytes()
    assert page == (tmp_path / "two.html").read_bytes() and b"Models side by side" in page
    with pytest.raises(iwan.ExistingFileError):
        found.report(tmp_path / "one.html")


def has_workers(process: int) -> bool:
    def name(task: Path) -> str:
        try:
            return (task / "comm").read_text()
        except OSError:
            return "ended"

    return any(name(task).startswith("iwan") for task in Path(f"/proc/{process}/task").iterdir())


def test_a_coupled_fit_hears_an_interrupt_and_its_work_ends() -> None:
    program = """
        import os, time, iwan, numpy as np
        from pathlib import Path

        t = 1e-4 * np.arange(20_000)
        decays = [np.exp(-2.0 * t) * np.cos(2.0 * np.pi * f * t + 0.3 * np.exp(-2.0 * t)) for f in (20.0, 52.0)]

        def name(task):
            try:
                return (task / "comm").read_text()
            except OSError:
                return "ended"

        def workers():
            return [task for task in Path("/proc/self/task").iterdir() if name(task).startswith("iwan")]

        print("ready", flush=True)
        try:
            iwan.fit_coupled(np.array(decays), dt=1e-4, shapes=np.eye(2), frequencies=[20.0, 52.0], hits="first")
            print("finished", flush=True)
        except KeyboardInterrupt:
            until = time.monotonic() + 10.0
            while workers() and time.monotonic() < until:
                time.sleep(0.02)
            print("interrupted", len(workers()), flush=True)
    """
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(program)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    # A busy machine takes its time until the work is on threads.
    until = time.monotonic() + 60.0
    while not has_workers(process.pid) and time.monotonic() < until:
        time.sleep(0.01)
    assert has_workers(process.pid)
    os.kill(process.pid, signal.SIGINT)
    assert process.communicate(timeout=120)[0] == "interrupted 0\n"


def test_what_does_not_fit_a_coupled_fit_is_named() -> None:
    motions, forces = blows([60.0])
    one, force = motions[0], forces[0]
    for records, options, said in [
        (one, {"shapes": [[1.0, 0.0]], "frequencies": [20.0]}, "at least two"),
        (one, {"bands": [(15.0, 25.0), (45.0, 60.0)]}, "(?s)2 channels, and no mode shapes.*shapes=, or give one channel"),
        (one, {"shapes": np.eye(3), "frequencies": [20.0, 52.0, 90.0]}, "3 values for 2 channels"),
        (one, {"shapes": np.eye(2), "frequencies": [20.0]}, "1 frequencies for 2 shapes"),
        (one, {"shapes": np.eye(2), "near": [20.0, 52.0]}, "near goes without shapes"),
        (one, {**ASKED, "forces": force[:10]}, "give 1 x 1501"),
        (one, {**ASKED, "forces": [force, force]}, "one array for each of 1 records"),
        (one, {**ASKED, "forces": force, "shape_at_force": [1.0]}, "shape_at_force"),
        (one, {**ASKED, "forces": force, "quantity": "warmth"}, "quantity"),
        (one, {**ASKED, "forces": force, "threads": 0}, "threads"),
        ([one, one], {**ASKED, "forces": [force, force]}, "it is the same record"),
        (one, {**ASKED, "forces": force, "predict": 2.0 * one}, "differ in whether the force is known"),
    ]:
        with pytest.raises(iwan.InvalidValueError, match=said):
            iwan.fit_coupled(records, **{"dt": 1e-3, **options})


def test_a_window_that_the_header_names_leaves_no_shared_joint_told(with_window) -> None:
    t = 5e-4 * np.arange(3000)
    samples = sum(np.exp(-3.0 * t) * np.cos(2.0 * np.pi * f * t) for f in (100.0, 240.0))
    asked = {"bands": [(90.0, 110.0), (230.0, 250.0)]}
    plain, windowed = (iwan.fit_coupled([with_window(samples, 5e-4, kind)], **asked) for kind in (0, 4))
    assert plain.estimates["frequency of mode 1"].low is not None
    assert windowed.models == plain.models and any("windowed or filtered" in words for words in windowed.warnings)
    assert all(one.low is None and one.high is None for one in windowed.estimates.values())
