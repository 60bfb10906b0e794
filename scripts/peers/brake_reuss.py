"""The Brake-Reuss beam from the Abaqus decks that its authors publish, the interface stuck.

    python scripts/peers/brake_reuss.py [--iwan PROGRAM] Job.inp BRB_MATEX.inp

Fetches nothing: the decks are `assets/demo/Job.inp` of github.com/Nidish96/Abaqus4Joints and `MODELS/BRB/BRB_MATEX.inp` of
github.com/Nidish96/octave-jim. Each is read as it is; only its *BOUNDARY, which holds the interface in one of two steps, is passed over, and
the two halves are tied over the whole contact area. Bounding box and mass are compared with what this script finds in the deck by itself: the
mass as the volume of all hexahedra (2 x 2 x 2 Gauss points) times the density of the deck.

Literature: bending frequencies under preload, 168.5, 580.4 and 1177.7 Hz for a flat interface and 180.6, 595.3 and 1199.9 Hz with its
mesoscale topography, are those that github.com/tmd-lab/tmdsimpy, examples/structures/brb_epmc.py, quotes of its reference [1], J. H. Porter and M. R. W. Brake; they are the first,
third and fifth of all elastic modes, bending across the interface, which iwan may call lateral.
A beam that is stuck over its whole contact area is stiffer than one whose contact opens at the edges: ours must lie above.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np

INTERFACES = [("TOPBEAM_INSURF", "BOTBEAM_INSURF"), ("TOPS", "BOTS")]
LITERATURE = {"flat": (168.5026, 580.4082, 1177.6498), "with topography": (180.6293, 595.2815, 1199.9013)}


def rotated(system, points):
    """Global positions of points in the system of *SYSTEM."""
    if not system:
        return points
    a = np.array(system[:3])
    if len(system) < 6:
        return a + points
    b = np.array(system[3:6])
    x = (b - a) / np.linalg.norm(b - a)
    y = np.array(system[6:9]) - a if len(system) >= 9 else np.cross([0.0, 0.0, 1.0], x)
    y = y - (y @ x) * x
    y /= np.linalg.norm(y)
    return a + points @ np.array([x, y, np.cross(x, y)])


def deck(path):
    """Nodes, hexahedra and density of a deck, by counting lines."""
    nodes, elements, density, system, what, rows = {}, [], None, [], None, []

    def end():
        if what == "NODE" and rows:
            values = np.array(rows, dtype=float)
            places = rotated(system, values[:, 1:4])
            nodes.update(zip(values[:, 0].astype(int), places))

    for line in path.read_text().splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            end()
            rows = []
            word = line[1:].split(",")[0].strip().upper()
            what = word
            if word == "SYSTEM":
                system = []
            continue
        fields = [field for field in line.split(",") if field.strip()]
        if what == "NODE":
            rows.append([float(field) for field in fields[:4]])
        elif what == "SYSTEM":
            system += [float(field) for field in fields]
        elif what == "ELEMENT":
            elements.append([int(field) for field in fields[1:9]])
        elif what == "DENSITY":
            density = float(fields[0])
    end()
    return nodes, [e for e in elements if len(e) == 8], density


def volume(corners):
    """Volumes of hexahedra, elements x 8 x 3, by 2 x 2 x 2 Gauss points."""
    signs = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])
    total = 0.0
    for point in signs / np.sqrt(3.0):
        one = 1.0 + signs * point
        slopes = np.stack([signs[:, i] * one[:, (i + 1) % 3] * one[:, (i + 2) % 3] / 8.0 for i in range(3)])
        total = total + np.linalg.det(np.einsum("ik,ekj->eij", slopes, corners))
    return total


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--iwan", default="iwan")
    arguments.add_argument("decks", nargs="+", type=pathlib.Path)
    given = arguments.parse_args()
    for path in given.decks:
        text = path.read_text().upper()
        face, patch = next(pair for pair in INTERFACES if f"NAME={pair[0]}" in text)
        nodes, elements, density = deck(path)
        used = np.array([nodes[n] for e in elements for n in e]).reshape(-1, 8, 3)
        mass = density * volume(used).sum()
        box = used.reshape(-1, 3).max(axis=0) - used.reshape(-1, 3).min(axis=0)
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            (place / "s.toml").write_text(
                f'[mesh]\npath = {json.dumps(str(path.resolve()))}\nignore = ["BOUNDARY"]\n'
                f'[[tie]]\nname = "interface"\nface = "{face}"\npatch = "{patch}"\nmotion = "projection"\n'
            )
            command = [given.iwan, "modes", "s.toml", "--count", "8", "--json", "--write-matrices=npz", "--out", "out"]
            done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                print(f"{path.name}: refused\n{done.stderr}")
                continue
            found = json.loads(done.stdout)
            table = np.genfromtxt(place / "out" / "nodes.csv", delimiter=",", skip_header=1)
        corners = sorted({n for e in elements for n in e})
        own = {int(row[0]): row[1:] for row in table}
        points = np.array([own[n] for n in corners])
        moved = np.linalg.norm(points - np.array([nodes[n] for n in corners]), axis=1)
        ties = [line for line in done.stderr.splitlines() if "TIE" in line or "tie" in line]
        passed = sorted({line.split(" was passed over")[0].split(": ")[-1] for line in done.stderr.splitlines() if "passed over" in line})
        print(f"{path.name}: {found['size']['nodes']} nodes, {found['size']['elements']} elements, {found['size']['unknowns']} unknowns")
        print(f"  box   {box[0]:.6f} x {box[1]:.6f} x {box[2]:.6f} (deck)", end="")
        read = points.max(axis=0) - points.min(axis=0)
        print(f", {read[0]:.6f} x {read[1]:.6f} x {read[2]:.6f} (iwan)")
        print(f"  nodes {np.count_nonzero(moved > 1e-9)} of {len(corners)} were moved by ties, by {moved.max():.1e} at most")
        print(f"  mass  {mass:.9f} (deck), {found['size']['total_mass']:.9f} (iwan), {found['size']['total_mass'] / mass - 1:+.1e}")
        print(f"  zero modes {found['zero_modes']}; {len(ties)} remarks on ties; passed over: {', '.join(passed)}")
        for kind in ("bending", "lateral"):
            own = [m["frequency_stuck"] for m in found["modes"] if m["class"] == kind][:3]
            print(f"  {kind}: " + ", ".join(f"{f:.2f}" for f in own) + " Hz")
        for name, values in LITERATURE.items():
            print(f"  literature, {name}: " + ", ".join(f"{f:.2f}" for f in values) + " Hz")


if __name__ == "__main__":
    main()
