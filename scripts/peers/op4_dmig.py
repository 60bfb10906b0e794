"""Every OP4, DMIG and punch file below some folders: read by iwan-exchange beside pyyeti and pyNastran.

    python scripts/peers/op4_dmig.py --read target/release/examples/read_matrix FOLDER ...

FOLDERs are checkouts of github.com/twmacro/pyyeti and github.com/SteveDoyle2/pyNastran; their files never enter the project. `read_matrix` is the example of
iwan-exchange. A file counts as *equal* when all its matrices have the names, sizes and values of those that pyyeti (OP4, DMIG) or, where that fails, pyNastran (OP4) reads
(complex ones: their real parts; square DMIG by grid and component of their rows and columns, as programs order these as they like), *refused* when ours refuses it, *different* otherwise. The reason of each refusal is printed.
"""

import argparse
import io
import contextlib
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np
import scipy.sparse as sparse

# Values in text have as many digits as the file, so that both parsers end at the same double; one unit in the last place is allowed for decimal conversions.
TOLERANCE = 4e-16


def ours(program, path):
    done = subprocess.run([program, "--entries", str(path)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None, done.stderr.strip()
    matrices, current = [], None
    for line in done.stdout.splitlines():
        words = line.split()
        if words and words[0] == "matrix":
            name = " ".join(words[1:-3])
            current = (name, (int(words[-3]), int(words[-2])), {}, [])
            matrices.append(current)
        elif current is not None and len(words) == 4 and words[0] == "label":
            current[2][int(words[1])] = (int(words[2]), int(words[3]))
        elif current is not None and len(words) == 3 and not line.startswith("/"):
            current[3].append((int(words[0]), int(words[1]), float(words[2])))
    found = []
    for name, shape, labels, entries in matrices:
        rows, columns, values = zip(*entries) if entries else ((), (), ())
        found.append((name, sparse.coo_matrix((np.array(values, float), (rows, columns)), shape=shape).tocsr(), labels))
    return found, None


def op4(path):
    """Names and matrices by pyyeti, or by pyNastran where pyyeti cannot; with who it was."""
    try:
        from pyyeti.nastran import op4 as reader
        names, matrices, _, _ = reader.read(str(path), into="list", sparse=True)
        return [(n, sparse.csr_matrix(m)) for n, m in zip(names, matrices)], "pyyeti"
    except Exception as error:  # whatever a peer stumbles over is its own finding
        first = str(error)
    try:
        from pyNastran.op4.op4 import read_op4
        with contextlib.redirect_stdout(io.StringIO()):
            found = read_op4(str(path))
        return [(n, sparse.csr_matrix(m.data if hasattr(m, "data") and not isinstance(m, np.ndarray) else m)) for n, m in found.items()], "pyNastran"
    except Exception as error:
        return None, f"pyyeti: {first[:80]}; pyNastran: {str(error)[:80]}"


def dmig(path):
    try:
        from pyyeti.nastran import bulk
        found = bulk.rddmig(str(path))
        return [(n.upper(), Labelled(frame.values, list(frame.index), list(frame.columns))) for n, frame in found.items()], "pyyeti"
    except Exception as error:
        first = str(error)
    try:
        from pyNastran.bdf.bdf import BDF
        model = BDF(debug=None)
        with contextlib.redirect_stdout(io.StringIO()):
            model.read_bdf(str(path), xref=False, validate=False, punch=path.suffix.lower() == ".pch")
        found = []
        for name, card in model.dmig.items():
            if name.upper() != "UACCEL":
                values, rows, columns = card.get_matrix(is_sparse=False)
                found.append((name.upper(), Labelled(values, list(rows.values()), list(columns.values()))))
        return found, "pyNastran"
    except Exception as error:
        return None, f"pyyeti: {first[:80]}; pyNastran: {str(error)[:80]}"


class Labelled:
    """A matrix of a peer with the grid and component of its rows and columns."""

    def __init__(self, values, rows, columns):
        self.matrix = sparse.csr_matrix(values)
        self.shape, self.nnz = self.matrix.shape, self.matrix.nnz
        self.rows, self.columns = ([self.key(label) for label in labels] for labels in (rows, columns))

    @staticmethod
    def key(label):
        # A column of a rectangular matrix has a number alone.
        return tuple(int(part) for part in label) if isinstance(label, tuple) else (int(label), 0)

    def entries(self):
        found = self.matrix.tocoo()
        return {(self.rows[i], self.columns[j]): v.real for i, j, v in zip(found.row, found.col, found.data) if v.real != 0.0}


def near(x, y, scale):
    return abs(x - y) <= TOLERANCE * scale


def same(a, labels, b):
    """Same values at the same places; by the labels of rows and columns where both have them."""
    scale = abs(b.matrix if isinstance(b, Labelled) else b).max() if b.nnz else 0.0
    if isinstance(b, Labelled):
        if labels and sorted(b.rows) == sorted(b.columns):
            found = a.tocoo()
            own = {(labels[i], labels[j]): v for i, j, v in zip(found.row, found.col, found.data) if v != 0.0}
            other = b.entries()
            return own.keys() == other.keys() and all(near(own[place], other[place], scale) for place in own)
        # A rectangular one: its rows by their labels in ascending order, as ours has them; its columns as they stand.
        order = np.argsort([row[0] * 10 + row[1] for row in b.rows], kind="stable")
        b = b.matrix[order]
    if a.shape != b.shape:
        return False
    difference = abs(a - b.real)
    return difference.nnz == 0 or difference.max() <= TOLERANCE * scale


def compare(path, program):
    with tempfile.TemporaryDirectory() as folder:
        # Ours tells OP4 by its extension.
        read = path if path.suffix.lower() != ".other" else pathlib.Path(shutil.copy(path, pathlib.Path(folder) / path.stem))
        found, refusal = ours(program, read)
    is_op4 = ".op4" in path.name.lower()
    expected, who = (op4 if is_op4 else dmig)(path)
    if found is None:
        return "refused", refusal.splitlines()[0] if refusal else ""
    if expected is None:
        return "read by us only", who
    if len(found) != len(expected):
        return "different", f"{len(found)} matrices, {who} has {len(expected)}"
    by_name = {n.strip().upper(): m for n, m in expected}
    for index, (name, matrix, labels) in enumerate(found):
        # Several matrices of a file may have one name: then the place tells.
        own = expected[index][0].strip().upper() == name.strip().upper()
        other = expected[index][1] if own else by_name.get(name.strip().upper(), expected[index][1])
        if not same(matrix, labels, other):
            return "different", f"{name}: {matrix.shape} with {matrix.nnz} entries, {who} {other.shape} with {other.nnz}"
    return "equal", who


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--read", required=True)
    arguments.add_argument("folders", nargs="+")
    given = arguments.parse_args()
    paths = []
    for folder in given.folders:
        for path in sorted(pathlib.Path(folder).rglob("*")):
            kind = path.suffix.lower()
            wanted = ".op4" in path.name.lower() or kind == ".pch"
            if kind in (".bdf", ".dat", ".nas") and path.is_file():
                wanted = any(line.upper().startswith(b"DMIG") for line in path.read_bytes().splitlines())
            if wanted and path.is_file():
                paths.append(path)
    counts = {}
    for path in paths:
        outcome, words = compare(path, given.read)
        counts[outcome] = counts.get(outcome, 0) + 1
        if outcome != "equal":
            print(f"{outcome}: {path}: {words}")
    print(f"{len(paths)} files: " + ", ".join(f"{count} {outcome}" for outcome, count in sorted(counts.items())))
    if counts.get("different"):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
