"""One jointed structure by three ways: its mesh; matrices from CalculiX (MATRIXSTORAGE); matrices that `iwan modes --write-matrices` wrote.

    python scripts/peers/three_ways.py [--iwan PROGRAM] [--ccx PROGRAM]

Two cantilevers of wedges lie on each other and are bolted node to node along their tips. Compared are the frequencies with all joints stuck and
slipping (1e-8) and a ring-down of all unknowns with the joints in macro-slip (1e-9 of the peak acceleration).
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np

# Short: CalculiX writes 14 digits, and rounding of the largest entries disturbs the lowest frequency by the square of their ratio; 0.4 long in 16 cells
# differs by 7e-9 in frequency and 3e-8 in the ring-down, although every entry agrees to 5e-14.
LENGTH, WIDTH, HEIGHT = 0.12, 0.04, 0.02
CELLS = (6, 3, 2)
MATERIAL = (2.1e11, 0.3, 7850.0)
JOINTS = """
[[joint]]
name = "bolt"
face = "upper"
patch = "lower"
motion = "node-to-node"
slip = [{ direction = "x", law = { k_t = 2e6, f_s = 4.0, chi = -0.3, beta = 0.1 } }]
[[load]]
name = "tip"
nodes = "tip"
direction = "z"
[[output]]
name = "tip"
nodes = "tip"
direction = "z"
"""
SCENARIO = """
[structure]
path = "{name}.toml"
model = "full"
[force]
kind = "haversine"
amplitude = 2e4
duration = 2e-4
[time]
step = 2e-6
duration = 4e-3
"""


def deck(parts=(0, 1)):
    """An Abaqus deck of two blocks of wedges, one on the other, with nodes of their own, clamped at x = 0; or of one of them."""
    nx, ny, nz = CELLS
    text = ["*NODE"]
    elements, sets = [], {"upper": [], "lower": [], "tip": [], "clamped": []}
    number, label = {}, 0
    for part in parts:
        label = part * (nx + 1) * (ny + 1) * (nz + 1)
        for k in range(nz + 1):
            for j in range(ny + 1):
                for i in range(nx + 1):
                    label += 1
                    number[part, i, j, k] = label
                    place = (i * LENGTH / nx, j * WIDTH / ny, part * HEIGHT + k * HEIGHT / nz)
                    text.append(f"{label}, " + ", ".join(f"{x:.12e}" for x in place))
                    if i == 0:
                        sets["clamped"].append(label)
                    elif i >= nx - 2 and (part, k) in ((0, nz), (1, 0)):
                        sets["lower" if part == 0 else "upper"].append(label)
                    if i == nx and (part, k) == (1, nz):
                        sets["tip"].append(label)
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    low = [number[part, i + a, j + b, k] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                    high = [number[part, i + a, j + b, k + 1] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                    for corners in ((0, 1, 2), (0, 2, 3)):
                        elements.append([low[c] for c in corners] + [high[c] for c in corners])
    text.append("*ELEMENT, TYPE=C3D6, ELSET=all")
    text += [f"{n + 1}, " + ", ".join(map(str, e)) for n, e in enumerate(elements)]
    for name, members in ((name, members) for name, members in sets.items() if members):
        text.append(f"*NSET, NSET={name}")
        text += [f"{member}," for member in members]
    young, poisson, density = MATERIAL
    text += ["*MATERIAL, NAME=steel", "*ELASTIC", f"{young:e}, {poisson}", "*DENSITY", f"{density}",
             "*SOLID SECTION, ELSET=all, MATERIAL=steel"]
    return "\n".join(text) + "\n"


def run(program, folder, *arguments):
    done = subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(arguments)}: {done.stderr}{done.stdout}")
    return done.stdout


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--iwan", default="iwan")
    arguments.add_argument("--ccx", default="ccx")
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        held = '[[support]]\nname = "wall"\nnodes = "clamped"\nfixed = ["x", "y", "z"]\n'
        (folder / "model.inp").write_text(deck())
        (folder / "job.inp").write_text(deck() + "*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n1\n*END STEP\n")
        run(given.ccx, folder, "job")
        (folder / "bare").mkdir()
        merged = {"stiffness": [], "mass": []}
        rows = []
        for part in (0, 1):
            (folder / f"part{part}.inp").write_text(deck((part,)))
            (folder / f"part{part}.toml").write_text(f'[mesh]\npath = "part{part}.inp"\n')
            run(given.iwan, folder, "modes", f"part{part}.toml", "--count", "1", "--write-matrices", "--quiet", "--out", f"part{part}")
            for name, lines in merged.items():
                body = [line for line in (folder / f"part{part}" / f"{name}.mtx").read_text().splitlines() if line[0] != "%"][1:]
                for i, j, value in (line.split() for line in body):
                    lines.append(f"{int(i) + len(rows)} {int(j) + len(rows)} {value}\n")
            rows += (folder / f"part{part}" / "rows.csv").read_text().splitlines()[1:]
        for name, lines in merged.items():
            head = f"%%MatrixMarket matrix coordinate real symmetric\n{len(rows)} {len(rows)} {len(lines)}\n"
            (folder / "bare" / f"{name}.mtx").write_text(head + "".join(lines))
        (folder / "bare" / "rows.csv").write_text("\n".join(rows) + "\n")
        ways = {
            "mesh": '[mesh]\npath = "model.inp"\n',
            "calculix": '[matrices]\nstiffness = "job.sti"\nmass = "job.mas"\nrows = "job.dof"\ncoordinates = "model.inp"\n',
            "market": '[matrices]\nstiffness = "bare/stiffness.mtx"\nmass = "bare/mass.mtx"\nrows = "bare/rows.csv"\n'
                      'coordinates = "model.inp"\n',
        }
        frequencies, accelerations = {}, {}
        for name, start in ways.items():
            (folder / f"{name}.toml").write_text(start + held + JOINTS)
            (folder / f"{name}-run.toml").write_text(SCENARIO.format(name=name))
            found = json.loads(run(given.iwan, folder, "modes", f"{name}.toml", "--json", "--quiet", "--out", f"{name}-modes"))
            frequencies[name] = np.array(found["stuck"] + found["slipping"])
            run(given.iwan, folder, "simulate", f"{name}-run.toml", "--quiet", "--out", f"{name}-run")
            table = np.genfromtxt(folder / f"{name}-run" / "response.csv", delimiter=",", names=True, deletechars="")
            accelerations[name] = np.array(table["tip.acceleration"])
            slips = [table[column] for column in table.dtype.names if column.endswith(".slip")]
            print(f"{name}: {found['size']['unknowns']} unknowns, {frequencies[name][0]:.6f} Hz stuck, "
                  f"{len(slips)} slips, largest {max(np.abs(s).max() for s in slips):.3e}")
        peak = np.abs(accelerations["mesh"]).max()
        for name in ("calculix", "market"):
            off = np.abs(frequencies[name] / frequencies["mesh"] - 1.0).max()
            ring = np.abs(accelerations[name] - accelerations["mesh"]).max() / peak
            print(f"{name} against mesh: frequencies {off:.1e}, ring-down {ring:.1e} of the peak acceleration")
            if off > 1e-8 or ring > 1e-9:
                raise SystemExit("larger than 1e-8 or 1e-9")


if __name__ == "__main__":
    main()
