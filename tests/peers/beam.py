#!/usr/bin/env python3
"""The paper's beam with its four bolted interfaces, computed a second time: the numbers in the tests of crates/iwan-fem.

    pip install numpy scipy
    python3 tests/peers/beam.py            # prints them all, in a minute or two

Written in the plainest way and without a line of the library: strain matrices and dense element algebra, SciPy's sparse matrices
and its ARPACK, sliders in arrays. Deaner et al. (the paper), Sec. 3.1 and Table 1, in lbf, in, s. What the paper leaves open:

mesh       every 0.25 in along all three parts and across the beam; one element through each thickness; washers 0.5 x 0.5 in at
           x = -1.25 and 1.25, those above the beam merged with the link: 1,554 nodes. Configuration A: washers 0.125 thick.
           Configuration B: washers 0.09375 thick, lines across the beam at 0, +-0.25, +-0.6, +-0.9, +-1
elements   eight nodes with nine condensed incompatible modes (Taylor, Beresford and Wilson 1976), consistent mass
interfaces the washer's face follows a rigid motion of the nine nodes of the beam below it, but for slips along x and y; the nine
           move rigidly (A) or the motion fits theirs best (B)
blow       haversine of 1.6 ms along z, shared by the nine nodes of the upper edge at x = 10; dt = 1e-5 s, Newmark's average
           acceleration; 50 stuck modes and the static deflection under each slip's force; 100 sliders in geometric bins from
           1e-6 phi_max, each with the stiffness and the slip force of its bin
"""

import itertools

import numpy as np
import scipy.linalg as la
import scipy.optimize as opt
import scipy.sparse as sp
import scipy.sparse.linalg as spla

YOUNG, POISSON, DENSITY = 28.0e6, 0.29, 7.48e-4
K_T, F_S, CHI, BETA = 2.75e5, 300.0, -0.3, 0.02  # the paper's Table 1
C = (CHI + 1) / (CHI + 2)
PHI_MAX = F_S * (1 + BETA) / (K_T * (BETA + C))
R = F_S * (CHI + 1) / (PHI_MAX ** (CHI + 2) * (BETA + C))
S = F_S / PHI_MAX * BETA / (BETA + C)
CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float
)


def element(x):
    """Stiffness (24 x 24) and mass (24 x 24) of a hexahedron with corners x."""
    lame, shear = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
    elastic = np.diag([2 * shear] * 3 + [shear] * 3)
    elastic[:3, :3] += lame

    def slopes(at):
        f = 1 + CORNERS * at
        return np.stack([CORNERS[:, a] * f[:, a - 2] * f[:, a - 1] / 8 for a in range(3)], 1)

    def strain(g):
        b = np.zeros((6, 3 * len(g)))
        for a in range(3):
            b[a, a::3] = g[:, a]
        for row, (p, q) in enumerate([(0, 1), (1, 2), (0, 2)], 3):
            b[row, p::3], b[row, q::3] = g[:, q], g[:, p]
        return b

    centre = slopes(np.zeros(3)).T @ x
    k, m = np.zeros((33, 33)), np.zeros((24, 24))
    for at in itertools.product([-(3**-0.5), 3**-0.5], repeat=3):
        at = np.array(at)
        jacobian = slopes(at).T @ x
        volume = la.det(jacobian)
        outer = slopes(at) @ la.inv(jacobian).T
        # The incompatible modes 1 - xi^2, 1 - eta^2, 1 - zeta^2, with the Jacobian of the centre.
        inner = np.diag(-2 * at) @ la.inv(centre).T * la.det(centre) / volume
        b = strain(np.vstack([outer, inner]))
        k += b.T @ elastic @ b * volume
        n = np.prod(1 + CORNERS * at, 1) / 8
        m += np.kron(np.outer(n, n), np.eye(3)) * DENSITY * volume
    return k[:24, :24] - k[:24, 24:] @ la.solve(k[24:, 24:], k[24:, :24]), m


class Beam:
    """Stiffness, mass and slips in unknowns: free displacements, motions of the references of rigid patches, slips."""

    def __init__(self, configuration):
        rigid = configuration == "A"
        thick = 0.125 if rigid else 0.09375
        across = np.linspace(-1, 1, 9) if rigid else np.array([-1, -0.9, -0.6, -0.25, 0, 0.25, 0.6, 0.9, 1])
        self.nodes, self.elements = [], []
        beam = self.block({}, np.linspace(-10, 10, 81), across, [0, 0.25])
        link = self.block({}, np.linspace(-1.75, 1.75, 15), [-0.25, 0.25], [0.25 + thick, 0.375 + thick])
        pairs = []
        for x, above in [(-1.25, True), (1.25, True), (-1.25, False), (1.25, False)]:
            level = 0.25 if above else 0.0
            along = [x - 0.25, x, x + 0.25]
            z = [0.25, 0.25 + thick] if above else [-thick, 0]
            washer = self.block(link if above else {}, along, [-0.25, 0.25], z)
            face = [n for at, n in washer.items() if at[2] == level and n not in beam.values() and at[0] in along]
            patch = [n for at, n in beam.items() if at[0] in along and abs(at[1]) <= 0.25 and at[2] == level]
            pairs.append((face, patch))
        self.nodes = np.array(self.nodes)
        count = 3 * len(self.nodes)
        k, m = sp.lil_matrix((count, count)), sp.lil_matrix((count, count))
        for nodes in self.elements:
            dof = (3 * np.array(nodes)[:, None] + np.arange(3)).ravel()
            ke, me = element(self.nodes[nodes])
            k[np.ix_(dof, dof)] += ke
            m[np.ix_(dof, dof)] += me
        tied = {n for face, patch in pairs for n in face + (patch if rigid else [])}
        free = [3 * n + a for n in range(len(self.nodes)) if n not in tied for a in range(3)]
        number = {dof: j for j, dof in enumerate(free)}
        extra = len(free)
        t = sp.lil_matrix((count, extra + (6 * 4 if rigid else 0) + 8))
        for dof, j in number.items():
            t[dof, j] = 1
        self.slips = np.arange(t.shape[1] - 8, t.shape[1])
        for joint, (face, patch) in enumerate(pairs):
            centre = self.nodes[patch].mean(0)
            # The motion of the reference: unknowns of its own, or the rigid motion that fits the patch best.
            if rigid:
                motion = sp.lil_matrix((6, t.shape[1]))
                for c in range(6):
                    motion[c, extra + 6 * joint + c] = 1
            else:
                rows = np.vstack([rigid_rows(self.nodes[n] - centre) for n in patch])
                fit = la.lstsq(rows, np.eye(len(rows)))[0]
                motion = sp.csr_matrix(fit) @ t.tocsr()[[3 * n + a for n in patch for a in range(3)]]
            motion = motion.tocsr()
            for n in face + (patch if rigid else []):
                t[3 * n : 3 * n + 3] = sp.csr_matrix(rigid_rows(self.nodes[n] - centre)) @ motion
            for n in face:
                t[3 * n, self.slips[2 * joint]] = 1
                t[3 * n + 1, self.slips[2 * joint + 1]] = 1
        self.t = t.tocsr()
        along = np.tile([1.0, 0, 0], len(self.nodes))
        self.total_mass = along @ (m.tocsr() @ along)
        self.mass = (self.t.T @ m.tocsr() @ self.t).tocsc()
        self.slipping = (self.t.T @ k.tocsr() @ self.t).tocsc()
        joints = np.zeros(t.shape[1])
        joints[self.slips] = K_T
        self.stuck = (self.slipping + sp.diags(joints)).tocsc()
        tip = [n for at, n in beam.items() if at[0] == 10 and at[2] == 0.25]
        self.tip = np.asarray(self.t[[3 * n + 2 for n in tip]].mean(0)).ravel()
        self.top = [3 * n + 2 for n in beam.values() if self.nodes[n][2] == 0.25]

    def block(self, known, x, y, z):
        """Elements between mesh lines; nodes at the places in `known` are shared and added to."""
        for at in itertools.product(map(float, x), map(float, y), map(float, z)):
            if at not in known:
                self.nodes.append(at)
                known[at] = len(self.nodes) - 1
        lines = [[float(v) for v in line] for line in (x, y, z)]
        for i, j, k in itertools.product(*(range(len(line) - 1) for line in lines)):
            pick = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
            at = [(lines[0][i + a], lines[1][j + b], lines[2][k + c]) for a, b, c in pick]
            self.elements.append([known[point] for point in at])
        return known

    def modes(self, stiffness, count):
        """Lowest frequencies (Hz) and mass-normalised shapes; the shift lies below all of them."""
        values, shapes = spla.eigsh(stiffness, count, self.mass, sigma=-((2 * np.pi * 20) ** 2))
        order = np.argsort(values)
        return np.sqrt(np.maximum(values[order], 0)) / (2 * np.pi), shapes[:, order]


def rigid_rows(arm):
    """Displacement at `arm` from a reference, by the reference's three displacements and three small rotations."""
    x, y, z = arm
    return np.array([[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]], float)


def bending(beam, shapes):
    """Elastic modes whose motion is along z and of one sign across the beam: a torsion mode stands between them."""
    u = (beam.t @ shapes).reshape(-1, 3, shapes.shape[1])
    z = (u[:, 2] ** 2).sum(0) / (u**2).sum((0, 1))
    mean = np.array([np.mean([abs(u[m, 2, i].sum()) for m in columns(beam)]) for i in range(shapes.shape[1])])
    size = np.array([np.mean([np.abs(u[m, 2, i]).sum() for m in columns(beam)]) for i in range(shapes.shape[1])])
    return [i for i in range(6, shapes.shape[1]) if z[i] > 0.8 and mean[i] > 0.9 * size[i]]


def columns(beam):
    """Nodes of the beam's top, line by line across it."""
    top = [dof // 3 for dof in beam.top]
    x = beam.nodes[top][:, 0]
    return [np.array(top)[x == line] for line in np.unique(x)]


def modes(beam, name):
    """Prints frequencies, K_T and tip shapes; returns the stuck modes and the first bending modes."""
    f0, stuck = beam.modes(beam.stuck, 50)
    f1, slipping = beam.modes(beam.slipping, 24)
    a, b = beam.t @ stuck, beam.t @ slipping[:, 12:]
    mac = (a.T @ b) ** 2 / np.outer((a**2).sum(0), (b**2).sum(0))
    first = bending(beam, stuck)[:3]
    print(f"configuration {name}: {beam.mass.shape[0]} unknowns")
    print(f"  mass {beam.total_mass:.9g}")
    for i in first:
        j = mac[i].argmax()
        k_t = (2 * np.pi) ** 2 * (f0[i] ** 2 - f1[12 + j] ** 2)
        tip = abs(beam.tip @ stuck[:, i])
        print(f"  bending: stuck {f0[i]:.4f} Hz, slipping {f1[12 + j]:.4f} Hz, MAC {mac[i, j]:.5f}, K_T {k_t:.5g}, tip {tip:.4f}")
    print("  all stuck:", ", ".join(f"{f:.4f}" for f in f0[6:12]))
    return f0, stuck, first


def reduced_model(beam, stuck):
    """Basis of modes and static deflections, in which mass is 1 and stuck stiffness diagonal; its eigenvalues."""
    unit = np.zeros((beam.mass.shape[0], 8))
    unit[beam.slips, np.arange(8)] = 1
    shift = (2 * np.pi * 20) ** 2
    static = spla.splu((beam.stuck + shift * beam.mass).tocsc()).solve(unit)
    for _ in range(2):
        static -= stuck @ (stuck.T @ (beam.mass @ static))
    k, m = static.T @ (beam.stuck @ static), static.T @ (beam.mass @ static)
    values, shapes = la.eigh(k, m)
    own = np.einsum("ij,ij->j", stuck, beam.stuck @ stuck)
    own[:6] = 0
    return np.hstack([stuck, static @ shapes]), np.concatenate([own, values])


def sliders(bins=100, lowest=1e-6):
    """Stiffness and strength of each slider: those of its bin, and one for the sliders of strength phi_max."""
    edges = np.concatenate([[0], PHI_MAX * np.geomspace(lowest, 1, bins)])
    k = R * np.diff(edges ** (CHI + 1)) / (CHI + 1)
    f = R * np.diff(edges ** (CHI + 2)) / (CHI + 2)
    return np.append(k, S), np.append(f / k, PHI_MAX)


def blow(beam, basis, eigenvalues, amplitude, steps=20_000, dt=1e-5):
    """Accelerations of the coordinates, and the largest slip over phi_max."""
    shape = basis[beam.slips]
    load = basis.T @ beam.tip
    d = 1 / (1 + dt**2 / 4 * eigenvalues)
    flexibility = dt**2 / 4 * (shape * d) @ shape.T
    k, phi = sliders()
    spring = np.zeros((8, len(k)))  # extension of each slider's spring

    def joints(s, last):
        trial = spring + (s - last)[:, None]
        stuck = np.abs(trial) < phi
        held = np.clip(trial, -phi, phi)
        return held, held @ k, stuck @ k

    q, v = np.zeros(len(load)), np.zeros(len(load))
    force = lambda t: amplitude / 2 * (1 - np.cos(2 * np.pi * t / 1.6e-3)) if t < 1.6e-3 else 0.0
    a, s, largest, history = force(0) * load, np.zeros(8), 0.0, []
    for n in range(1, steps + 1):
        ahead, faster = q + dt * v + dt**2 / 4 * a, v + dt / 2 * a
        held = d * (force(n * dt) * load - eigenvalues * ahead)
        goal, new = shape @ (ahead + dt**2 / 4 * held), s
        for _ in range(100):
            springs, joint, tangent = joints(new, s)
            residual = new + flexibility @ (joint - K_T * new) - goal
            if np.abs(residual).max() < 1e-15 * max(1.0, np.abs(goal).max() / 1e-6):
                break
            new = new - la.solve(np.eye(8) + flexibility * (tangent - K_T), residual)
        springs, joint, _ = joints(new, s)
        spring, s = springs, new
        a = held - d * (shape.T @ (joint - K_T * s))
        q, v = ahead + dt**2 / 4 * a, faster + dt / 2 * a
        largest = max(largest, np.abs(s).max())
        history.append(a)
    return np.array(history), largest / PHI_MAX


def demodulate(x, dt, near, time):
    """Frequency and loss per cycle about a time: Fourier integrals over six cycles under a Hann window, a cycle apart."""
    half, lag, n = round(3 / near / dt), round(0.5 / near / dt), round(time / dt)
    omega = 2 * np.pi * near

    def at(centre):
        k = np.arange(centre - half, centre + half + 1)
        window = 0.5 * (1 + np.cos(np.pi * (k - centre) / half))
        return 2 / half * np.sum(window * x[k] * np.exp(-1j * omega * k * dt))

    before, after = at(n - lag), at(n + lag)
    span = 2 * lag * dt
    frequency = near + np.angle(after / before) / (2 * np.pi * span)
    energy = lambda z: 0.5 * (abs(z) / (2 * np.pi * frequency)) ** 2
    return frequency, (energy(before) - energy(after)) / (span * frequency)


def virgin(u):
    """Force and tangent of a joint on its virgin curve, and the loss in a closed cycle of amplitude u."""
    u = np.asarray(u, float)
    x = np.minimum(np.abs(u), PHI_MAX)
    slip = np.abs(u) >= PHI_MAX
    force = np.where(slip, F_S, x * (K_T - R * x ** (CHI + 1) / ((CHI + 1) * (CHI + 2))))
    tangent = np.where(slip, 0.0, K_T - R * x ** (CHI + 1) / (CHI + 1))
    micro = 4 * R * x ** (CHI + 3) / ((CHI + 2) * (CHI + 3))
    beyond = 4 * F_S * np.abs(u) - 4 * (R * PHI_MAX ** (CHI + 3) / (CHI + 3) + S * PHI_MAX**2)
    return np.sign(u) * force, tangent, np.where(slip, beyond, micro)


def quasi_static(beam, f0, stuck, mode, displacements):
    """Secant frequency and loss per cycle under static loads alpha M phi that bend the structure to each displacement."""
    rigid = beam.mass @ stuck[:, :6]
    system = sp.bmat([[beam.stuck, sp.csc_matrix(rigid)], [sp.csc_matrix(rigid).T, None]]).tocsc()
    unit = np.zeros((system.shape[0], 8))
    unit[beam.slips, np.arange(8)] = 1
    flexibility = spla.splu(system).solve(unit)[beam.slips]
    shape, eigenvalue = stuck[beam.slips, mode], (2 * np.pi * f0[mode]) ** 2
    stiffness = la.inv(flexibility)

    def slips(alpha):
        goal = stiffness @ shape * alpha / eigenvalue
        s = np.zeros(8)
        for share in np.linspace(0.02, 1, 50):
            for _ in range(200):
                force, tangent, _ = virgin(s)
                residual = stiffness @ s + force - K_T * s - share * goal
                if np.abs(residual).max() < 1e-9 * np.abs(goal).max():
                    break
                step = -la.solve(stiffness + np.diag(tangent - K_T), residual)
                length = 1.0
                while length > 1e-6:
                    there = s + length * step
                    if la.norm(stiffness @ there + virgin(there)[0] - K_T * there - share * goal) < la.norm(residual):
                        break
                    length /= 2
                s = s + length * step
        return s

    def displacement(alpha):
        s = slips(alpha)
        return (alpha - shape @ (virgin(s)[0] - K_T * s)) / eigenvalue

    for q in displacements:
        alpha = opt.brentq(lambda alpha: displacement(alpha) - q, 0.5 * eigenvalue * q, eigenvalue * q, rtol=1e-10)
        frequency = np.sqrt(alpha / q) / (2 * np.pi)
        print(f"  q {q:.3e}: {frequency:.4f} Hz, D {virgin(slips(alpha))[2].sum():.4g}")


def main():
    modes(Beam("B"), "B")
    beam = Beam("A")
    f0, stuck, first = modes(beam, "A")
    for name, dofs in [("all displacements", slice(None)), ("z of the top face", beam.top)]:
        singular = la.svdvals((beam.t @ stuck)[dofs])
        rank = (singular > 1e-9 * singular[0]).sum()
        print(f"50 stuck modes at {name}: rank {rank}, condition {singular[0] / singular[rank - 1]:.3g}")
    print("quasi-static, bending 1")
    quasi_static(beam, f0, stuck, first[0], [1.989e-4, 1.983e-3, 9.949e-3, 4.981e-2])
    basis, eigenvalues = reduced_model(beam, stuck)
    for amplitude, near in [
        (10.0, [132.192, 132.198, 132.201]),
        (100.0, [131.521, 131.653, 131.741]),
        (1000.0, [128.28, 129.25, 130.47]),
    ]:
        history, slip = blow(beam, basis, eigenvalues, amplitude)
        peaks = ", ".join(f"{np.abs(history[:, i]).max():.5g}" for i in first)
        print(f"blow of {amplitude:g} lbf: peaks of |q''| {peaks}; largest slip {slip:.3g} phi_max")
        x = np.concatenate([[0.0], history[:, first[0]]])
        for time, guess in zip([0.03, 0.1, 0.17], near):
            frequency, loss = demodulate(x, 1e-5, guess, time)
            print(f"  bending 1 at {time} s: {frequency:.3f} Hz, loss per cycle {loss:.3g}")


if __name__ == "__main__":
    main()
