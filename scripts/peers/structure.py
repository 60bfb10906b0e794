"""A beam with four bolted interfaces: the full model step by step beside OpenSeesPy on the same mesh, and the reduced one.

usage: structure.py [STEPS]

The paper's beam (configuration A: 1,554 nodes, 1,008 eight-node elements of plain displacements), bolted node to node: at each of
the 24 pairs of nodes a joint of 100 sliders acts along x, the other directions are tied. OpenSees has the same nodes and
elements (stdBrick), equalDOF, and a Parallel of ElasticPP per pair; Newmark, modified Newton, SparseSYM. The blow is a
haversine of 1.6 ms and 1000 lbf at the tip, dt = 1e-5 s, 100 steps unless told otherwise. Fails when the tips move differently.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import iwan

DT, BLOW, AMPLITUDE = 1e-5, 1.6e-3, 1000.0
YOUNG, POISSON, DENSITY = 28.0e6, 0.29, 7.48e-4
PAIRS = 6
JOINT = iwan.FourParameter(k_t=2.75e5 / PAIRS, f_s=300.0 / PAIRS, chi=-0.3, beta=0.02)
SLIDERS = 100
REDUCED_STEPS = 20_000
AGREEMENT = 1e-9
"""Largest difference of the tips' displacements, over the largest displacement."""

INTERFACES = {
    # name: centre along x, and level z of the surface of the beam that the washer is on
    "left link": (-1.25, 0.25),
    "right link": (1.25, 0.25),
    "left washer": (-1.25, 0.0),
    "right washer": (1.25, 0.0),
}


class Mesh:
    """Nodes from 1, elements of eight nodes, named sets of nodes."""

    def __init__(self):
        self.nodes, self.elements, self.sets = [], [], {}
        x, y = np.arange(-10, 10.01, 0.25), np.arange(-1, 1.01, 0.25)
        beam = self.block(x, y, [0.0, 0.25], {})
        self.sets["tip"] = [node for (px, _, pz), node in beam.items() if px == 10 and pz == 0.25]
        link = self.block(np.arange(-1.75, 1.76, 0.25), [-0.25, 0.25], [0.375, 0.5], {})
        for name, (centre, level) in INTERFACES.items():
            footprint = [centre - 0.25, centre, centre + 0.25]
            upper = level > 0
            # Washers above share their upper nodes with the link.
            washer = self.block(footprint, [-0.25, 0.25], [0.25, 0.375] if upper else [-0.125, 0.0], link if upper else {})
            here = sorted(at for at in washer if at[2] == level)
            self.sets[name + " face"] = [washer[at] for at in here]
            self.sets[name + " patch"] = [beam[at] for at in here]

    def block(self, x, y, z, known):
        """Elements of a block between lines; nodes in `known` are shared."""
        at = {}
        for point in ((float(a), float(b), float(c)) for a in x for b in y for c in z):
            at[point] = known.get(point)
            if at[point] is None:
                self.nodes.append(point)
                at[point] = len(self.nodes)
        for a, b in zip(x[:-1], x[1:]):
            for c, d in zip(y[:-1], y[1:]):
                for e, f in zip(z[:-1], z[1:]):
                    face = [(a, c), (b, c), (b, d), (a, d)]
                    self.elements.append([at[float(p), float(q), float(level)] for level in (e, f) for p, q in face])
        return at

    def abaqus(self):
        lines = ["*NODE"]
        lines += [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in enumerate(self.nodes, 1)]
        lines += ["*ELEMENT, TYPE=C3D8"]
        lines += [", ".join(map(str, [n, *nodes])) for n, nodes in enumerate(self.elements, 1)]
        for name, nodes in self.sets.items():
            lines += [f"*NSET, NSET={name}", *(f"{node}," for node in nodes)]
        return "\n".join(lines) + "\n"


def structure_file(mesh):
    law = f"{{ k_t = {JOINT.k_t!r}, f_s = {JOINT.f_s!r}, chi = {JOINT.chi!r}, beta = {JOINT.beta!r} }}"
    joints = "".join(
        f'[[joint]]\nname = "{name}"\nface = "{name} face"\npatch = "{name} patch"\nmotion = "node-to-node"\n'
        f'slip = [{{ direction = "x", law = {law} }}]\n'
        for name in INTERFACES
    )
    return (
        f'[mesh]\npath = "{mesh}"\n[elements]\nformulation = "displacement"\n'
        f"[[material]]\nyoung = {YOUNG}\npoisson = {POISSON}\ndensity = {DENSITY}\n{joints}"
        '[[load]]\nname = "blow"\nnodes = "tip"\ndirection = "z"\n'
        '[[output]]\nname = "tip"\nnodes = "tip"\ndirection = "z"\n'
    )


def iwan_response(structure, steps, model):
    """Displacements of the tip, and seconds of the stepping."""
    response = structure.simulate(
        force=iwan.Haversine(amplitude=AMPLITUDE, duration=BLOW),
        dt=DT,
        duration=steps * DT,
        model=model,
        basis=50 if model == "reduced" else None,
        sliders=SLIDERS,
        grid="uniform",
        quality=False,
    )
    return response.displacement["tip"], response.seconds


def opensees_response(mesh, steps):
    """Displacements of the tip, and seconds of the stepping."""
    try:
        import openseespy.opensees as ops
    except RuntimeError as error:  # what it raises when a system library is missing
        raise ImportError(str(error)) from error
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    for n, point in enumerate(mesh.nodes, 1):
        ops.node(n, *point)
    ops.nDMaterial("ElasticIsotropic", 1, YOUNG, POISSON, DENSITY)
    for n, nodes in enumerate(mesh.elements, 1):
        ops.element("stdBrick", n, *nodes, 1)
    strength, stiffness = JOINT.discretise(SLIDERS, grid="uniform")
    for i, (phi, k) in enumerate(zip(strength, stiffness), 1):
        ops.uniaxialMaterial("ElasticPP", i, float(k), float(phi))
    parallel = len(strength) + 1
    ops.uniaxialMaterial("Parallel", parallel, *range(1, parallel))
    tag = len(mesh.elements)
    for name in INTERFACES:
        for face, patch in zip(mesh.sets[name + " face"], mesh.sets[name + " patch"]):
            tag += 1
            ops.equalDOF(patch, face, 2, 3)
            ops.element("zeroLength", tag, patch, face, "-mat", parallel, "-dir", 1, "-doRayleigh", 0)
    # One value more than steps: OpenSees takes a time that rounds past the last value for one without force.
    t = np.arange(steps + 2) * DT
    blow = np.where(t < BLOW, 0.5 * AMPLITUDE * (1 - np.cos(2 * np.pi * t / BLOW)), 0.0)
    ops.timeSeries("Path", 1, "-dt", DT, "-values", *blow.tolist())
    ops.pattern("Plain", 1, 1)
    for node in mesh.sets["tip"]:
        ops.load(node, 0.0, 0.0, 1.0 / len(mesh.sets["tip"]))
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("SparseSYM")
    ops.test("NormDispIncr", 1e-14, 50)
    ops.algorithm("ModifiedNewton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    tip = [0.0]
    start = time.perf_counter()
    for _ in range(steps):
        if ops.analyze(1, DT) != 0:
            raise SystemExit("OpenSees did not converge")
        tip.append(np.mean([ops.nodeDisp(node, 3) for node in mesh.sets["tip"]]))
    return np.array(tip), time.perf_counter() - start


def main():
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    mesh = Mesh()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "beam.inp").write_text(mesh.abaqus(), encoding="ascii")
        (Path(folder) / "beam.toml").write_text(structure_file("beam.inp"), encoding="ascii")
        structure = iwan.Structure.load(Path(folder) / "beam.toml")
    full = [iwan_response(structure, steps, "full") for _ in range(3)]
    ours = min(seconds for _, seconds in full) / steps
    reduced = min(iwan_response(structure, REDUCED_STEPS, "reduced")[1] for _ in range(3)) / REDUCED_STEPS
    print(f"{len(mesh.nodes)} nodes: full {ours * 1e3:.3f} ms a step, reduced {reduced * 1e6:.2f} us a step")
    try:
        theirs, seconds = opensees_response(mesh, steps)
    except ImportError as error:
        print(f"OpenSeesPy left out: {error}", file=sys.stderr)
        return
    tip = full[0][0]
    difference = np.abs(tip - theirs).max() / np.abs(theirs).max()
    theirs = seconds / steps
    print(
        f"OpenSeesPy {theirs * 1e3:.1f} ms a step: {theirs / ours:.0f} times the full model, {theirs / reduced:.0f} times "
        f"the reduced one; tips differ by {difference:.1e}"
    )
    if difference > AGREEMENT:
        raise SystemExit(f"the tips differ by {difference:.1e}, allowed {AGREEMENT:.0e}")


if __name__ == "__main__":
    main()
