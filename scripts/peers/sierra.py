"""Sierra/SD matrices through iwan against the frequencies of Sierra's own Exodus file.

    python scripts/peers/sierra.py [--iwan PROGRAM] [--reduced FOLDER/block_1] FOLDER/block_a [FOLDER/block_a2 ...]

Fetches nothing: each argument is what NAME_Kaa.m, NAME_Maa.m, NAME_ASetMap.m, NAME_gid.m and NAME-eig.exo begin with, such as those in docs/book/assets
of github.com/sandialabs/sdynpy. The Exodus file (netCDF classic) has the frequencies as its times. Where NAME.inp is there, too, with one material, iwan's own hexahedra are
put on the mesh of the Exodus file, by incompatible modes and as plain ones. --reduced names a Craig-Bampton model: NAME-cbr.nc4 with matrices and
nodes, NAME-cbr.exo whose first times are the frequencies with the boundary held; free frequencies are compared with LAPACK's of the same two matrices.
"""

import argparse
import json
import pathlib
import re
import shutil
import subprocess
import tempfile

import numpy as np
from scipy.io import netcdf_file

TOLERANCE = 1e-8


def modes(program, text, count, mesh=None):
    """What `iwan modes` says about a structure file, and a mesh beside it."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        if mesh:
            (folder / "mesh.inp").write_text(mesh)
        (folder / "s.toml").write_text(text)
        command = [program, "modes", "s.toml", "--count", str(count), "--json", "--quiet", "--out", "out"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    return json.loads(done.stdout)


def meshed(program, name, expected):
    """The largest difference of iwan's own elements on the same mesh by incompatible modes, which Sierra's are as well; that of plain ones is printed."""
    deck = pathlib.Path(f"{name}.inp").read_text()
    young, poisson, density = (float(re.search(rf"\b{key}\s*=?\s*([-+.0-9eE]+)", deck).group(1)) for key in ("E", "nu", "density"))
    with netcdf_file(f"{name}-eig.exo", mmap=False) as exodus:
        nodes = np.column_stack([exodus.variables[f"coord{axis}"][:] for axis in "xyz"]).tolist()
        elements = np.vstack([array[:] for key, array in exodus.variables.items() if key.startswith("connect")]).tolist()
    lines = ["*NODE", *(f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in enumerate(nodes, 1)), "*ELEMENT, TYPE=C3D8, ELSET=ALL"]
    lines += [f"{n}, " + ", ".join(map(str, element)) for n, element in enumerate(elements, 1)]
    off = {}
    for formulation in ("incompatible-modes", "displacement"):
        text = f'[mesh]\npath = "mesh.inp"\n[elements]\nformulation = "{formulation}"\n[[material]]\nyoung = {young!r}\npoisson = {poisson!r}\ndensity = {density!r}\n'
        own = np.array(modes(program, text, len(expected), "\n".join(lines) + "\n")["stuck"])[: len(expected)]
        off[formulation] = np.abs(own / expected - 1.0).max()
    print(f"{pathlib.Path(name).name}, {len(elements)} own elements on its mesh: largest difference {off['incompatible-modes']:.1e} by incompatible modes, "
          f"{off['displacement']:.1e} by plain elements")
    return off["incompatible-modes"]


def reduced(program, name):
    """The largest differences of a Craig-Bampton model: boundary held, and free."""
    from scipy.linalg import eigh
    path = f"{pathlib.Path(name).resolve()}-cbr.nc4"
    with netcdf_file(path, mmap=False) as model:
        stiffness, mass = (np.array(model.variables[key][:], dtype=float) for key in ("Kr", "Mr"))
        held = int(np.sum(np.array(model.variables["cbmap"][:])[:, 0] == 0))
    with netcdf_file(f"{name}-cbr.exo", mmap=False) as exodus:
        fixed = np.sort(np.array(exodus.variables["time_whole"][:held], dtype=float))
    base = f"[matrices]\nstiffness = {json.dumps(path)}\nmass = {json.dumps(path)}\ncoordinates = {json.dumps(path)}\n"
    support = '[[set]]\nkind = "box"\nname = "boundary"\nlow = [-1e9, -1e9, -1e9]\nhigh = [1e9, 1e9, 1e9]\n' \
              '[[support]]\nname = "held"\nnodes = "boundary"\nfixed = ["x", "y", "z"]\n'
    own = np.array(modes(program, base + support, held)["stuck"])[:held]
    off = np.abs(own / fixed - 1.0).max()
    free = np.sqrt(np.abs(eigh(stiffness, mass, eigvals_only=True))) / (2.0 * np.pi)
    found = modes(program, base, 20)
    elastic = np.array(found["stuck"])[:20]
    free_off = np.abs(elastic / free[6:26] - 1.0).max()
    print(f"{pathlib.Path(name).name}-cbr: {held} frequencies with the boundary held from {fixed[0]:.3f} to {fixed[-1]:.3f} Hz, largest difference {off:.1e}; "
          f"20 free ones from {elastic[0]:.3f} Hz on, against LAPACK {free_off:.1e}; zero modes {found['zero_modes']['stuck']}")
    return max(off, free_off)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--iwan", default="iwan")
    arguments.add_argument("--reduced", action="append", default=[])
    arguments.add_argument("names", nargs="*")
    given = arguments.parse_args()
    given.iwan = str(pathlib.Path(shutil.which(given.iwan) or given.iwan).resolve())
    worst = 0.0
    for name in given.names:
        with netcdf_file(f"{name}-eig.exo", mmap=False) as exodus:
            expected = np.array(exodus.variables["time_whole"][:], dtype=float)
        expected = np.sort(expected[expected > 1.0])
        base = str(pathlib.Path(name).resolve())
        lines = [f"{key} = {json.dumps(base + tail)}" for key, tail in
                 [("stiffness", "_Kaa.m"), ("mass", "_Maa.m"), ("rows", "_ASetMap.m"), ("numbers", "_gid.m")]]
        found = modes(given.iwan, "[matrices]\n" + "\n".join(lines) + "\n", len(expected))
        own = np.array(found["stuck"])[: len(expected)]
        off = np.abs(own / expected - 1.0)
        worst = max(worst, off.max())
        print(f"{pathlib.Path(name).name}: {len(expected)} elastic frequencies from {expected[0]:.3f} to {expected[-1]:.3f} Hz, "
              f"largest difference {off.max():.1e}; zero modes {found['zero_modes']['stuck']}; mass {found['size']['total_mass']:.9g}")
        if pathlib.Path(f"{name}.inp").exists():
            worst = max(worst, meshed(given.iwan, name, expected))
    for name in given.reduced:
        worst = max(worst, reduced(given.iwan, name))
    if worst > TOLERANCE:
        raise SystemExit(f"larger than {TOLERANCE}")


if __name__ == "__main__":
    main()
