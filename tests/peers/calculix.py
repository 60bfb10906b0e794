#!/usr/bin/env python3
"""Eigenfrequencies of blocks of hexahedra, tetrahedra and wedges by CalculiX, for the tests of crates/iwan-fem.

    apt-get install calculix-ccx
    python3 tests/peers/calculix.py        # rewrites tests/peers/calculix.csv and calculix_solids.csv

Needs ccx and the standard library. Elements: C3D8 (8 nodes, displacements alone, 2 x 2 x 2 points) and C3D20 (20 nodes,
3 x 3 x 3 points), consistent mass. Bodies, in lbf, in, s:

beam       the paper's beam alone, 20 x 2 x 0.25 in as 80 x 8 x 1 elements, free in space
cantilever the same, clamped at x = -10
skewed     6 x 3 x 2 in as 6 x 3 x 2 elements, inner mesh lines moved by `skew`, clamped at x = 0
curved     the same, with the middles of the edges moved by `skew` too, so that edges and faces are curved

In calculix_solids.csv every brick of skewed and curved is cut into six tetrahedra or two wedges: C3D4 (one point), C3D10 (four),
C3D6 (two) and C3D15 (nine), for stiffness and mass alike.
"""

import datetime
import math
import pathlib
import re
import subprocess
import tempfile

STEEL = (28.0e6, 0.29, 7.48e-4)
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]


def skew(x, y, z):
    """Moves points inside the block by up to a fifth of an element; its faces stay where they are."""
    bump = math.sin(math.pi * x / 6) * math.sin(math.pi * y / 3) * math.sin(math.pi * z / 2)
    return x + 0.2 * bump, y - 0.15 * bump, z + 0.1 * bump


def block(low, high, cells, move=None):
    """Nodes and 8-node elements of a block; node numbers from 1, x fastest."""
    counts = [c + 1 for c in cells]
    line = [[a + (b - a) * i / c for i in range(c + 1)] for a, b, c in zip(low, high, cells)]
    number = lambda i, j, k: 1 + i + counts[0] * (j + counts[1] * k)
    nodes = {}
    for k in range(counts[2]):
        for j in range(counts[1]):
            for i in range(counts[0]):
                point = (line[0][i], line[1][j], line[2][k])
                nodes[number(i, j, k)] = move(*point) if move else point
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    elements = [
        [number(i + a, j + b, k + c) for a, b, c in corners]
        for k in range(cells[2])
        for j in range(cells[1])
        for i in range(cells[0])
    ]
    return nodes, elements


def with_middles(nodes, elements, edges=EDGES, move=None):
    """The same with edges of three nodes: straight ones, or those of `nodes` before they are moved, all nodes moved then."""
    nodes, middles, larger = dict(nodes), {}, []
    for element in elements:
        extra = []
        for a, b in edges:
            pair = tuple(sorted((element[a], element[b])))
            if pair not in middles:
                middles[pair] = len(nodes) + 1
                nodes[middles[pair]] = tuple(0.5 * (p + q) for p, q in zip(nodes[pair[0]], nodes[pair[1]]))
            extra.append(middles[pair])
        larger.append(element + extra)
    if move:
        nodes = {number: move(*point) for number, point in nodes.items()}
    return nodes, larger


# Corners of the six tetrahedra around the diagonal 0-6 of a brick, and of its two wedges.
TETRAHEDRA = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
WEDGES = [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)]
TETRAHEDRON_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
WEDGE_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]


def cut(elements, pieces):
    """Every brick cut into pieces that fit those of its neighbours."""
    return [[brick[corner] for corner in piece] for brick in elements for piece in pieces]


def solids():
    """Body, element and mesh of each case of calculix_solids.csv."""
    plain, bricks = block((0.0, 0.0, 0.0), (6.0, 3.0, 2.0), (6, 3, 2))
    moved = {number: skew(*point) for number, point in plain.items()}
    for pieces, edges, small, large in [
        (TETRAHEDRA, TETRAHEDRON_EDGES, "C3D4", "C3D10"),
        (WEDGES, WEDGE_EDGES, "C3D6", "C3D15"),
    ]:
        elements = cut(bricks, pieces)
        yield "skewed", small, (moved, elements)
        yield "skewed", large, with_middles(moved, elements, edges)
        yield "curved", large, with_middles(plain, elements, edges, skew)


def deck(nodes, elements, kind, clamped, count):
    """A CalculiX input of a frequency step."""
    lines = ["*NODE"]
    lines += [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in nodes.items()]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=ALL")
    for number, element in enumerate(elements, 1):
        numbers = [str(number), *map(str, element)]
        rows = [numbers[i : i + 15] for i in range(0, len(numbers), 15)]
        lines.append(",\n".join(", ".join(row) for row in rows))
    young, poisson, density = STEEL
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{young}, {poisson}", "*DENSITY", f"{density}"]
    lines += ["*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL"]
    if clamped:
        lines += ["*NSET, NSET=CLAMP", *(f"{n}," for n in clamped), "*BOUNDARY", "CLAMP, 1, 3"]
    lines += ["*STEP", "*FREQUENCY", f"{count}", "*END STEP"]
    return "\n".join(lines) + "\n"


def frequencies(text, folder):
    """Runs ccx and reads the frequencies in Hz."""
    (folder / "job.inp").write_text(text)
    run = subprocess.run(["ccx", "job"], cwd=folder, capture_output=True, text=True, check=False)
    table = (folder / "job.dat").read_text() if (folder / "job.dat").exists() else ""
    rows = re.findall(r"^\s+\d+\s+(\S+)\s+(\S+)\s+(\S+)\s+(\S+)\s*$", table.split("P A R T I C I P A T I O N")[0], re.M)
    if not rows:
        raise SystemExit(f"ccx gave no frequencies:\n{run.stdout[-2000:]}")
    return [float(row[2]) for row in rows]


def main():
    beam = block((-10.0, -1.0, 0.0), (10.0, 1.0, 0.25), (80, 8, 1))
    skewed = block((0.0, 0.0, 0.0), (6.0, 3.0, 2.0), (6, 3, 2), skew)
    cases = [("beam", beam, None, 12), ("cantilever", beam, -10.0, 6), ("skewed", skewed, 0.0, 6)]
    version = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout.strip()
    rows = []
    for name, mesh, wall, count in cases:
        for kind, (nodes, elements) in [("C3D8", mesh), ("C3D20", with_middles(*mesh))]:
            rows += computed(name, kind, nodes, elements, wall, count)
    write("calculix.csv", "Plain hexahedra, consistent mass", version, rows)
    rows = []
    for name, kind, (nodes, elements) in solids():
        rows += computed(name, kind, nodes, elements, 0.0, 6)
    write("calculix_solids.csv", "Tetrahedra and wedges, mass by the points of the stiffness", version, rows)


def computed(name, kind, nodes, elements, wall, count):
    """Lines of one case."""
    clamped = [n for n, p in nodes.items() if wall is not None and p[0] == wall]
    with tempfile.TemporaryDirectory() as folder:
        found = frequencies(deck(nodes, elements, kind, clamped, count), pathlib.Path(folder))
    elastic = [f for f in found if f > 1.0]
    print(name, kind, elastic)
    return [f"{name},{kind},{mode},{f!r}" for mode, f in enumerate(elastic, 1)]


def write(file, what, version, rows):
    """One table beside this script."""
    head = [
        f"# Eigenfrequencies in Hz by CalculiX ({version}), written by tests/peers/calculix.py on {datetime.date.today()}.",
        f"# {what}; bodies and units are described there. Printed by ccx with seven digits.",
        "body,element,mode,frequency",
    ]
    pathlib.Path(__file__).with_name(file).write_text("\n".join(head + rows) + "\n")


if __name__ == "__main__":
    main()
