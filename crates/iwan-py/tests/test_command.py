"""The command `iwan` of the package is the program built by cargo, and both agree with the library to the last bit."""

import json
import os
import re
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import numpy as np
import pytest

import iwan

COMMAND = str(Path(sysconfig.get_path("scripts")) / "iwan")
PROGRAM = os.environ.get("IWAN_PROGRAM")
"""Where scripts/test built the program; without it the two cannot be compared."""


def run(arguments, folder, program=COMMAND):
    environment = os.environ | {"COLUMNS": "100"}
    return subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True, env=environment)


@pytest.mark.parametrize("method", ["newmark", "half-cycle", "averaging", "event"])
def test_the_command_and_the_library_agree_to_the_last_bit(tmp_path, method):
    arguments = ["simulate", "--out", "out", "--format", "npz", "--json", "--quiet", "--step", "1e-4", "--duration", "0.1"]
    done = run([*arguments, "--method", method], tmp_path)
    assert done.returncode == 0, done.stderr
    summary, scenario = json.loads(done.stdout), (tmp_path / "out" / "scenario.toml").read_text()
    import tomllib

    parsed = tomllib.loads(scenario)
    force = iwan.Haversine(amplitude=parsed["force"]["amplitude"], duration=parsed["force"]["duration"])
    modes = [
        iwan.Mode(
            name=m["name"],
            frequency=m["frequency"],
            damping_ratio=m["damping_ratio"],
            joint=iwan.FourParameter(**{key: m["joint"][key] for key in ["k_t", "f_s", "chi", "beta"]}),
            shape_at_force=m["shape_at_force"],
            outputs=m["outputs"],
        )
        for m in parsed["mode"]
    ]
    responses = iwan.simulate(modes, force=force, dt=1e-4, duration=0.1, method=method)
    table = np.load(tmp_path / "out" / "response.npz")
    np.testing.assert_array_equal(table["t"], responses[0].t)
    for mode, response, figures in zip(modes, responses, summary["modes"], strict=True):
        for name in ["displacement", "velocity", "acceleration", "joint_force"]:
            np.testing.assert_array_equal(table[f"{mode.name}.{name}"], getattr(response, name), err_msg=name)
        for name, value in response.statistics.items():
            assert name == "seconds" or figures[name] == value, name
    for point, motion in iwan.superpose(modes, responses).items():
        for name, values in motion.items():
            np.testing.assert_array_equal(table[f"{point}.{name}"], values)


def without_times(text):
    return re.sub(r'"seconds": [^,\n]+|seconds .*', "", text)


@pytest.mark.skipif(PROGRAM is None, reason="IWAN_PROGRAM does not name the program built by cargo")
@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["--help"],
        ["--version"],
        ["simulate", "--help"],
        ["scenario", "paper-modal"],
        ["simulate", "none.toml"],
        ["simulate", "--step", "-1"],
        ["simulate", "--json", "--duration", "0.05"],
        ["fit", "none.csv"],
        ["dance"],
    ],
    ids=" ".join,
)
def test_the_command_is_the_program(arguments, tmp_path):
    (tmp_path / "ours").mkdir()
    (tmp_path / "theirs").mkdir()
    ours, theirs = run(arguments, tmp_path / "ours"), run(arguments, tmp_path / "theirs", PROGRAM)
    assert ours.returncode == theirs.returncode
    assert without_times(ours.stdout) == without_times(theirs.stdout)
    assert without_times(ours.stderr) == without_times(theirs.stderr)
    for path in (tmp_path / "theirs").rglob("*.csv"):
        same = tmp_path / "ours" / path.relative_to(tmp_path / "theirs")
        assert same.read_bytes() == path.read_bytes()


def test_exit_codes(tmp_path):
    assert run(["--version"], tmp_path).returncode == 0
    assert run(["dance"], tmp_path).returncode == 2
    assert run(["simulate", "none.toml"], tmp_path).returncode == 2
    overflow = "[[mode]]\nname='a'\nfrequency=10.0\n[mode.initial]\ndisplacement=1e300\n[force]\nkind='none'\n"
    (tmp_path / "a.toml").write_text(overflow + "[time]\nstep=1e-3\nduration=1.0\n[method]\nkind='newmark'\n")
    failed = run(["simulate", "a.toml"], tmp_path)
    assert failed.returncode == 1 and failed.stdout == "", failed.stderr
    module = subprocess.run([sys.executable, "-m", "iwan", "--version"], capture_output=True, text=True)
    assert module.stdout == run(["--version"], tmp_path).stdout == f"iwan {iwan.__version__}\n"


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to a process of one's own")
def test_ctrl_c_ends_the_command_with_130_and_leaves_nothing(tmp_path):
    arguments = [COMMAND, "simulate", "--step", "2e-6", "--duration", "20", "--joint", "continuum", "--threads", "1", "--out", "out"]
    process = subprocess.Popen(arguments, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    time.sleep(1.0)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130 and "interrupted" in errors
    assert list(tmp_path.iterdir()) == []
