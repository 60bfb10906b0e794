"""The lowest modes of a solid block: `iwan modes` beside SciPy's eigsh with SuperLU, on the same matrices.

    python scripts/peers/scipy_modes.py [--iwan PROGRAM] [--cells N] [--count N]

32 cells along each side are 107,811 unknowns. SciPy gets the matrices that `iwan modes --write-matrices=npz` wrote, a shift below the first elastic
eigenvalue, and SuperLU in its symmetric mode, which is what `pip install scipy` offers. iwan searches twice as much: with all joints stuck
and with all slipping, which are the same here.
"""

import argparse
import json
import pathlib
import resource
import subprocess
import tempfile
import time

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--iwan", default="iwan")
    arguments.add_argument("--cells", type=int, default=32)
    arguments.add_argument("--count", type=int, default=44)
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        n = given.cells
        (folder / "block.toml").write_text(
            f'[mesh]\nkind = "block"\nsize = [1.0, 1.1, 1.2]\ncells = [{n}, {n}, {n}]\n'
            "[[material]]\nyoung = 2.1e11\npoisson = 0.3\ndensity = 7850.0\n")
        command = [given.iwan, "modes", "block.toml", "--count", str(given.count), "--json", "--quiet"]
        start = time.perf_counter()
        done = subprocess.run([*command, "--out", "timed"], cwd=folder, capture_output=True, text=True, check=True)
        whole = time.perf_counter() - start
        found = json.loads(done.stdout)
        subprocess.run([*command, "--write-matrices=npz", "--out", "out"], cwd=folder, capture_output=True, check=True)
        memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
        stiffness, mass = (sparse.load_npz(folder / "out" / f"{name}.npz") for name in ("stuck_stiffness", "mass"))
    own = np.array(found["stuck"])
    print(f"{stiffness.shape[0]} unknowns, {given.count} elastic modes")
    print(f"iwan: {found['seconds']:.2f} s for two searches ({whole:.2f} s with start and files), {memory:.1f} GB at most")
    start = time.perf_counter()
    shift = -0.5 * (2.0 * np.pi * own[0]) ** 2
    factor = splu((stiffness - shift * mass).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    factored = time.perf_counter() - start
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve)
    values = eigsh(stiffness, k=given.count + 6, M=mass, sigma=shift, OPinv=inverse, which="LM", return_eigenvectors=False)
    seconds = time.perf_counter() - start
    elastic = np.sqrt(np.sort(values)[6:]) / (2.0 * np.pi)
    print(f"SciPy: {seconds:.2f} s for one search ({factored:.2f} s of it the factor), "
          f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.1f} GB at most")
    print(f"largest difference of frequencies {np.abs(own[: len(elastic)] / elastic - 1.0).max():.1e}")


if __name__ == "__main__":
    main()
