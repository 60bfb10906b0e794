"""Writes matrices like large ones: an OP4 of 311,244 rows, and a million entries in each text format.

    python scripts/peers/large_matrices.py FOLDER
    cargo run --release --workspace --example read_matrix -- FOLDER/large.op4

The OP4 is binary, sparse, double precision, one triangle's worth of a grid of 47 x 47 x 47 nodes with three displacements each, 311,469 rows cut to 311,244:
as many as the file that SteveDoyle2/pyNastran issue 695 is about.
"""

import pathlib
import struct
import sys

import numpy as np

ROWS = 311_244
GRID = 47


def columns(rows, grid):
    """For each column its rows (from 0): the neighbours of a node of a grid, all three displacements, both triangles."""
    steps = [(i, j, k) for k in (-1, 0, 1) for j in (-1, 0, 1) for i in (-1, 0, 1)]
    for column in range(rows):
        node = column // 3
        i, j, k = node % grid, node // grid % grid, node // grid**2
        nodes = [(k + c) * grid**2 + (j + b) * grid + i + a for a, b, c in steps
                 if 0 <= i + a < grid and 0 <= j + b < grid and 0 <= k + c < grid]
        found = [3 * n + d for n in nodes for d in range(3)]
        yield column, [row for row in found if row < rows]


def strings(rows):
    """Runs of consecutive rows."""
    start = 0
    for at in range(1, len(rows) + 1):
        if at == len(rows) or rows[at] != rows[at - 1] + 1:
            yield rows[start], at - start
            start = at


def write_op4(path, rows):
    entries = 0
    with open(path, "wb") as out:
        def record(content):
            out.write(struct.pack("<i", len(content)) + content + struct.pack("<i", len(content)))
        # Negative rows: BIGMAT strings, whose heads are two words.
        record(struct.pack("<4i8s", rows, -rows, 6, 2, b"KAA     "))
        for column, found in columns(rows, GRID):
            body = b""
            for first, length in strings(found):
                body += struct.pack("<2i", 2 * length + 1, first + 1)
                values = np.full(length, -1.0)
                values[[n for n in range(length) if first + n == column]] = 100.0 + column
                body += values.tobytes()
                entries += length
            record(struct.pack("<3i", column + 1, 0, len(body) // 4) + body)
        record(struct.pack("<3i", rows + 1, 1, 2) + struct.pack("<d", 1.0))
    return entries


def write_texts(folder, count):
    """A million entries: Matrix Market, CalculiX and Abaqus."""
    n = count // 5
    triplets = [(min(n, r + o), r, -1.0 / o if o else 4.0) for r in range(1, n + 1) for o in (0, 1, 2, 40, 41)]
    triplets = sorted(set((i, j, v) for i, j, v in triplets if i <= n))
    (folder / "million.mtx").write_text(
        f"%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {len(triplets)}\n"
        + "".join(f"{i} {j} {v:.16e}\n" for i, j, v in triplets))
    (folder / "million.sti").write_text("".join(f"{j} {i} {v:.16e}\n" for i, j, v in triplets))
    label = lambda row: f"{(row - 1) // 3 + 1},{(row - 1) % 3 + 1}"
    (folder / "million_abaqus.mtx").write_text("".join(f"{label(i)}, {label(j)}, {v:.16e}\n" for i, j, v in triplets))


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    write_texts(folder, 1_000_000)
    print(f"{write_op4(folder / 'large.op4', ROWS)} entries in {folder / 'large.op4'}")


if __name__ == "__main__":
    main()
