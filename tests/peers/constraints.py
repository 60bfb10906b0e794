#!/usr/bin/env python3
"""Small decks with constraints, and their eigenfrequencies by CalculiX, for the tests of crates/iwan-fem.

    apt-get install calculix-ccx
    python3 tests/peers/constraints.py     # rewrites tests/peers/decks and tests/peers/calculix_constraints.csv

tied.inp        two blocks of C3D8, 4 x 3 elements on 3 x 2, tied by *TIE, clamped below
tied_tet.inp    the same cut into C3D10: leading faces of six nodes
rigid.inp       a clamped block whose end face is a *RIGID BODY with a mass away from it
mean.bdf        the same block; three corners of a brick beyond its end follow the end face by RBE3. CalculiX gets the three linear equations
                of each corner that this script writes out: weights 1 of the end face's nodes, least-squares rigid motion
                (not a mass at a node: with *EQUATION on its node CalculiX 2.20 makes its mass matrix indefinite)
"""

import datetime
import pathlib
import tempfile

from calculix import TETRAHEDRA, TETRAHEDRON_EDGES, block, cut, frequencies, with_middles

STEEL = (28.0e6, 0.29, 7.48e-4)
HERE = pathlib.Path(__file__).parent
MASS = 2.0e-3


def rows(numbers, width=12):
    """Numbers in lines that end in commas but for the last."""
    numbers = list(map(str, numbers))
    return ",\n".join(", ".join(numbers[i : i + width]) for i in range(0, len(numbers), width))


def head(nodes, elements, kind):
    """Nodes, elements and material."""
    lines = ["*NODE", *(f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in nodes.items())]
    lines += [f"*ELEMENT, TYPE={kind}, ELSET=ALL", *(rows([e, *of]) for e, of in elements.items())]
    young, poisson, density = STEEL
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{young}, {poisson}", "*DENSITY", f"{density}"]
    return lines + ["*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL"]


def tail(clamped, count=8):
    """Support and step."""
    lines = ["*NSET, NSET=CLAMP", rows(clamped), "*BOUNDARY", "CLAMP, 1, 3"]
    return lines + ["*STEP", "*FREQUENCY", f"{count}", "*END STEP", ""]


def tied(quadratic):
    """Two blocks with meshes that do not match."""
    nodes, elements, sides = {}, {}, {}
    for name, low, high, cells in [
        ("LEAD", (0.0, 0.0, 0.0), (3.0, 2.0, 1.0), (3, 2, 1)),
        ("FOLLOW", (0.25, 0.25, 1.0), (2.75, 1.5, 2.0), (4, 3, 1)),
    ]:
        own, bricks = block(low, high, cells)
        pieces = [list(b) for b in bricks]
        if quadratic:
            own, pieces = with_middles(own, cut(bricks, TETRAHEDRA), TETRAHEDRON_EDGES)
        shift, first = len(nodes), len(elements)
        nodes |= {shift + n: p for n, p in own.items()}
        elements |= {first + e: [shift + n for n in of] for e, of in enumerate(pieces, 1)}
        corners, table = (4, [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)]) if quadratic else (
            8,
            [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
        )
        faces = [
            (first + e, side)
            for e, of in enumerate(pieces, 1)
            for side, face in enumerate(table, 1)
            if all(own[of[c]][2] == 1.0 for c in face)
        ]
        assert all(len(of) >= corners for of in pieces)
        sides[name] = faces
    lines = head(nodes, elements, "C3D10" if quadratic else "C3D8")
    for name, faces in sides.items():
        lines += [f"*SURFACE, NAME={name}, TYPE=ELEMENT", *(f"{e}, S{side}" for e, side in faces)]
    lines += ["*TIE, NAME=GLUE, POSITION TOLERANCE=0.01", "FOLLOW, LEAD"]
    lines += tail([n for n, p in nodes.items() if p[2] == 0.0])
    return "\n".join(lines)


def beam():
    """A block, its clamped nodes, those of its end, and the place of a mass."""
    nodes, bricks = block((0.0, 0.0, 0.0), (4.0, 1.0, 1.0), (4, 2, 2))
    elements = dict(enumerate(bricks, 1))
    clamped = [n for n, p in nodes.items() if p[0] == 0.0]
    end = [n for n, p in nodes.items() if p[0] == 4.0]
    return nodes, elements, clamped, end, (5.0, 0.75, 0.625)


def with_mass(extra):
    """The block with a mass at node 1000, and further lines."""
    nodes, elements, clamped, end, place = beam()
    lines = head(nodes | {1000: place}, elements, "C3D8")
    lines += ["*NSET, NSET=END", rows(end)]
    lines += ["*ELEMENT, TYPE=MASS, ELSET=POINT", "2000, 1000", "*MASS, ELSET=POINT", f"{MASS!r}"]
    return "\n".join(lines + extra(nodes, end, place) + tail(clamped))


def rigid(_nodes, _end, _place):
    """The end face as a rigid body."""
    return ["*RIGID BODY, NSET=END, REF NODE=1000"]


def solve(matrix, right):
    """Gauss' elimination with pivots."""
    n = len(right)
    rows_ = [list(row) + [r] for row, r in zip(matrix, right)]
    for i in range(n):
        p = max(range(i, n), key=lambda k: abs(rows_[k][i]))
        rows_[i], rows_[p] = rows_[p], rows_[i]
        for k in range(n):
            if k != i:
                f = rows_[k][i] / rows_[i][i]
                rows_[k] = [a - f * b for a, b in zip(rows_[k], rows_[i])]
    return [rows_[i][n] / rows_[i][i] for i in range(n)]


def strain_free(arm):
    """Displacements along x, y, z at an arm of the six rigid motions of the reference."""
    x, y, z = arm
    return [[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]]


def brick():
    """A brick beyond the end of the beam, its corners from 1001, and those that follow."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    nodes = {1001 + i: (4.5 + a, 0.25 + 0.75 * b, 0.125 + 0.5 * c) for i, (a, b, c) in enumerate(corners)}
    return nodes, (1001, 1004, 1005)


def mean():
    """The beam and the brick with equations: the normal equations of the least-squares rigid motion, solved here."""
    nodes, elements, clamped, end, _ = beam()
    extra, following = brick()
    lines = head(nodes | extra, elements | {500: list(extra)}, "C3D8")
    for node in following:
        parts = {n: strain_free([p - q for p, q in zip(nodes[n], extra[node])]) for n in end}
        normal = [[sum(s[a][i] * s[a][j] for s in parts.values() for a in range(3)) for j in range(6)] for i in range(6)]
        for axis in range(3):
            # Row `axis` of the inverse: weights of the six sums S^T u.
            weights = solve(normal, [1.0 if i == axis else 0.0 for i in range(6)])
            terms = [(node, axis + 1, 1.0)]
            for n, s in parts.items():
                terms += [(n, a + 1, -sum(weights[i] * s[a][i] for i in range(6))) for a in range(3)]
            terms = [t for t in terms if abs(t[2]) > 1e-14]
            lines += ["*EQUATION", f"{len(terms)}", *(f"{n}, {a}, {c!r}" for n, a, c in terms)]
    return "\n".join(lines + tail(clamped))


def bulk_data():
    """The same as Nastran bulk data."""
    nodes, elements, clamped, end, _ = beam()
    extra, following = brick()
    young, poisson, density = STEEL
    lines = ["SOL 103", "CEND", "SPC = 7", "BEGIN BULK", f"MAT1,3,{young},,{poisson},{density}", "PSOLID,5,3"]
    lines += [f"GRID,{n},,{x!r},{y!r},{z!r}" for n, (x, y, z) in (nodes | extra).items()]
    for e, of in (elements | {500: list(extra)}).items():
        lines += [f"CHEXA,{e},5," + ",".join(map(str, of[:6])), "," + ",".join(map(str, of[6:]))]
    for node in following:
        lines += [f"RBE3,{node},,{node},123,1.0,123,{end[0]},{end[1]}"]
        lines += ["," + ",".join(map(str, end[i : i + 8])) for i in range(2, len(end), 8)]
    lines += ["SPC1,7,123," + ",".join(map(str, clamped[i : i + 6])) for i in range(0, len(clamped), 6)]
    return "\n".join(lines + ["ENDDATA", ""])


def main():
    decks = {"tied.inp": tied(False), "tied_tet.inp": tied(True), "rigid.inp": with_mass(rigid), "mean.bdf": bulk_data()}
    (HERE / "decks").mkdir(exist_ok=True)
    lines = []
    for name, text in decks.items():
        (HERE / "decks" / name).write_text(text)
        run = mean() if name == "mean.bdf" else text
        with tempfile.TemporaryDirectory() as folder:
            found = frequencies(run, pathlib.Path(folder))
        print(name, found)
        lines += [f"{name},{mode},{f!r}" for mode, f in enumerate(found, 1)]
    note = f"# Eigenfrequencies in Hz by CalculiX of tests/peers/decks, written by tests/peers/constraints.py on {datetime.date.today()}."
    (HERE / "calculix_constraints.csv").write_text("\n".join([note, "deck,mode,frequency", *lines]) + "\n")


if __name__ == "__main__":
    main()
