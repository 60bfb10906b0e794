"""The lowest modes of a solid block: `iwan modes` beside SciPy's eigsh with several factorisations, on the same matrices.

    python scripts/peers/scipy_modes.py [--iwan PROGRAM] [--cells N] [--count N] [--factor superlu] [--factor cholmod] [--factor pardiso]

32 cells along each side are 107,811 unknowns. SciPy gets the matrices that `iwan modes --write-matrices=npz` wrote and a shift below the first elastic
eigenvalue. Factors: SuperLU in its symmetric mode, which is what `pip install scipy` has; CHOLMOD, supernodal, ordered by METIS (`pip install scikit-sparse`, built
on `apt install libsuitesparse-dev libopenblas-dev`); MKL PARDISO (`pip install pypardiso`), symmetric positive definite. Without --factor all that are installed. iwan
searches twice as much: with all joints stuck and with all slipping, which are the same here.
"""

import argparse
import json
import pathlib
import shutil
import resource
import subprocess
import tempfile
import time

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu


def superlu(matrix):
    factor = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return factor.solve


def cholmod(matrix):
    from sksparse.cholmod import cholesky
    return cholesky(matrix.tocsc(), mode="supernodal", ordering_method="metis")


def pardiso(matrix):
    from pypardiso import PyPardisoSolver
    solver = PyPardisoSolver(mtype=2)
    upper = sparse.triu(matrix, format="csr")
    upper.sort_indices()
    solver.factorize(upper)
    solver.set_phase(33)
    return lambda b: solver._call_pardiso(upper, b)


FACTORS = {"superlu": superlu, "cholmod": cholmod, "pardiso": pardiso}


def search(name, stiffness, mass, shift, count):
    """Seconds of the factor and of all, elastic frequencies."""
    start = time.perf_counter()
    solve = FACTORS[name]((stiffness - shift * mass).tocsc())
    factored = time.perf_counter() - start
    inverse = LinearOperator(stiffness.shape, matvec=solve, dtype=float)
    values = eigsh(stiffness, k=count + 6, M=mass, sigma=shift, OPinv=inverse, which="LM", return_eigenvectors=True)[0]
    seconds = time.perf_counter() - start
    return factored, seconds, np.sqrt(np.sort(values)[6:]) / (2.0 * np.pi)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--iwan", default="iwan")
    arguments.add_argument("--cells", type=int, default=32)
    arguments.add_argument("--count", type=int, default=44)
    arguments.add_argument("--factor", action="append", choices=list(FACTORS))
    given = arguments.parse_args()
    given.iwan = str(pathlib.Path(shutil.which(given.iwan) or given.iwan).resolve())
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        n = given.cells
        (folder / "block.toml").write_text(
            f'[mesh]\nkind = "block"\nsize = [1.0, 1.1, 1.2]\ncells = [{n}, {n}, {n}]\n'
            "[[material]]\nyoung = 2.1e11\npoisson = 0.3\ndensity = 7850.0\n")
        command = [given.iwan, "modes", "block.toml", "--count", str(given.count), "--json", "--quiet"]
        start = time.perf_counter()
        done = subprocess.run([*command, "--write-matrices=npz", "--out", "out"], cwd=folder, capture_output=True, text=True, check=True)
        whole = time.perf_counter() - start
        found = json.loads(done.stdout)
        memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
        stiffness, mass = (sparse.load_npz(folder / "out" / f"{name}.npz") for name in ("stuck_stiffness", "mass"))
    own = np.array(found["stuck"])
    print(f"{stiffness.shape[0]} unknowns, {given.count} elastic modes")
    print(f"iwan: {found['seconds']:.2f} s for two searches ({whole:.2f} s with start and all files, the matrices among them), {memory:.1f} GB at most")
    shift = -0.5 * (2.0 * np.pi * own[0]) ** 2
    for name in given.factor or FACTORS:
        try:
            factored, seconds, elastic = search(name, stiffness, mass, shift, given.count)
        except ImportError as error:
            print(f"SciPy with {name}: not installed ({error})")
            continue
        print(f"SciPy with {name}: {seconds:.2f} s for one search ({factored:.2f} s of it the factor), "
              f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.1f} GB at most so far; "
              f"largest difference of frequencies {np.abs(own[: len(elastic)] / elastic - 1.0).max():.1e}")


if __name__ == "__main__":
    main()
