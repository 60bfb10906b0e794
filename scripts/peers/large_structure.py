"""A bolted structure of some 300,000 unknowns through `iwan modes` and `iwan simulate`: seconds, peak memory, and how soon Ctrl-C ends a factorisation.

    python scripts/peers/large_structure.py [--iwan PROGRAM] [--cells 120 24 16] [--folder FOLDER]

Two bars of 120 x 24 x 16 hexahedra each, 308,550 displacements, are bolted in a lap joint at two places that slip along both axes of the interface. The mesh is written as
Abaqus input.
"""

import argparse
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time

import numpy as np

SIZE = np.array([0.4, 0.04, 0.02])  # of one bar, m
LAP = 0.08  # length of the lap, m
WASHER = 0.008  # radius around the bolts, m

STRUCTURE = """[mesh]
path = "bars.inp"
[[material]]
young = 2.1e11
poisson = 0.3
density = 7850.0
{joints}[[load]]
name = "hammer"
nodes = "tip"
direction = "z"
[[output]]
name = "tip"
nodes = "tip"
direction = "z"
"""
JOINT = """[[joint]]
name = "bolt {n}"
face = "FACE{n}"
patch = "PATCH{n}"
motion = "averaging"
slip = [
    {{ direction = "x", law = {{ k_t = 2.0e8, f_s = 4000.0, chi = -0.5, beta = 0.1 }} }},
    {{ direction = "y", law = {{ k_t = 2.0e8, f_s = 4000.0, chi = -0.5, beta = 0.1 }} }},
]
"""
SCENARIO = """[structure]
path = "s.toml"
basis = 20
[force]
kind = "haversine"
amplitude = 2000.0
duration = 1e-3
[time]
step = 2e-5
duration = 0.02
"""


def bar(cells, origin):
    """Nodes and elements (from 0) of a bar whose lowest corner is at `origin`."""
    axes = [np.linspace(o, o + s, c + 1) for o, s, c in zip(origin, SIZE, cells)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    nodes = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    n = np.array(cells) + 1
    k, j, i = np.meshgrid(*(np.arange(c) for c in cells[::-1]), indexing="ij")
    first = (i + n[0] * (j + n[1] * k)).ravel()
    steps = np.array([0, 1, 1 + n[0], n[0]])
    corners = np.concatenate([steps, steps + n[0] * n[1]])
    return nodes, first[:, None] + corners


def write(folder, cells):
    lower, below = bar(cells, [0.0, 0.0, 0.0])
    upper, above = bar(cells, [SIZE[0] - LAP, 0.0, SIZE[2]])
    nodes, elements = np.vstack([lower, upper]), np.vstack([below, above + len(lower)])
    lines = ["*NODE"] + [f"{n + 1}, {p[0]:.12g}, {p[1]:.12g}, {p[2]:.12g}" for n, p in enumerate(nodes)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=ALL"] + [f"{e + 1}, " + ", ".join(str(n + 1) for n in row) for e, row in enumerate(elements)]

    def put(name, found):
        lines.append(f"*NSET, NSET={name}")
        lines.extend(str(n + 1) for n in found)

    part = np.arange(len(nodes)) >= len(lower)
    touching = np.abs(nodes[:, 2] - SIZE[2]) < 1e-9
    for number, share in enumerate((0.25, 0.75), 1):
        bolt = np.array([SIZE[0] - LAP + share * LAP, 0.5 * SIZE[1]])
        near = touching & (np.linalg.norm(nodes[:, :2] - bolt, axis=1) < WASHER)
        put(f"FACE{number}", np.flatnonzero(near & part))
        put(f"PATCH{number}", np.flatnonzero(near & ~part))
    end = nodes[:, 0].max()
    put("tip", np.flatnonzero((nodes[:, 0] == end) & (nodes[:, 2] == nodes[:, 2].max()) & (np.abs(nodes[:, 1] - 0.5 * SIZE[1]) < 1e-9)))
    (folder / "bars.inp").write_text("\n".join(lines) + "\n")
    (folder / "s.toml").write_text(STRUCTURE.format(joints="".join(JOINT.format(n=n) for n in (1, 2))))
    (folder / "run.toml").write_text(SCENARIO)
    return 3 * len(nodes)


def run(command, folder):
    """Standard output, notes, seconds and peak memory in GB."""
    start = time.perf_counter()
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=open(folder / "notes", "w"), text=True)
    out = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    notes = (folder / "notes").read_text().strip()
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command)}: {notes}")
    notes = "; ".join(line for line in notes.splitlines() if "unknowns" in line)
    return json.loads(out), notes, time.perf_counter() - start, usage.ru_maxrss / 1e6


def interrupted(command, folder, after):
    """Seconds from Ctrl-C, `after` so many seconds, to the end of the process, and its exit code."""
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(after)
    start = time.perf_counter()
    process.send_signal(signal.SIGINT)
    return process.wait(), time.perf_counter() - start


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--iwan", default="iwan")
    arguments.add_argument("--cells", nargs=3, type=int, default=[120, 24, 16])
    arguments.add_argument("--folder", type=pathlib.Path)
    given = arguments.parse_args()
    given.iwan = str(pathlib.Path(shutil.which(given.iwan) or given.iwan).resolve())
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        print(f"{write(folder, given.cells)} displacements of nodes")
        modes = [given.iwan, "modes", "s.toml", "--count", "10", "--json", "--force", "--out", "modes"]
        found, notes, seconds, memory = run(modes, folder)
        print(f"iwan modes: {seconds:.1f} s, {memory:.1f} GB at most; {notes}")
        print("stuck", " ".join(f"{f:.3f}" for f in found["stuck"][:6]), "Hz; slipping", " ".join(f"{f:.3f}" for f in found["slipping"][:6]), "Hz")
        simulate = [given.iwan, "simulate", "run.toml", "--json", "--force", "--out", "run"]
        found, notes, seconds, memory = run(simulate, folder)
        print(f"iwan simulate, 20 modes and attachment vectors, 1000 steps: {seconds:.1f} s, {memory:.1f} GB at most; {notes}")
        for name, command, after in (("modes", modes, 0.25), ("simulate", simulate, 0.25), ("simulate, reducing", simulate, 0.85)):
            whole = seconds if "simulate" in name else 0.6 * seconds
            code, took = interrupted(command, folder, after * whole)
            print(f"Ctrl-C in {name} after {after * whole:.0f} s: ended within {took:.2f} s, exit code {code}")


if __name__ == "__main__":
    main()
