"""Peers in Python: the same mode, pulse and sliders as plain_loop.c, 20,000 steps of average acceleration.

usage: python_peers.py FILE P

FILE holds one slider a line: strength stiffness. Prints a line per peer: time of a step in ns (median of three),
displacement at the end, the relative tolerance to which it may differ, and the peer's name. A library that is not
installed is left out.
"""

import sys
import time

import numpy as np

STEPS, DT = 20_000, 1e-5
OMEGA = 2 * np.pi * 124.0
DAMPING = 2 * 2.5e-4 * OMEGA
DURATION = 1.6e-3


def pulse(t, amplitude):
    return np.where(t < DURATION, 0.5 * amplitude * (1 - np.cos(2 * np.pi * t / DURATION)), 0.0)


def vectorised(strength, stiffness, amplitude):
    """NumPy: all sliders in one expression, Newton's method capped at two evaluations."""
    load = pulse(np.arange(STEPS + 1) * DT, amplitude)
    k = OMEGA**2 - stiffness.sum()
    inertia = 4 / DT**2 + 2 * DAMPING / DT + k
    position = np.zeros_like(strength)
    q = v = force = 0.0
    slope, a = stiffness.sum(), load[0]
    for p in load[1:]:
        rhs = p - k * q - force + 4 / DT * v + a + DAMPING * v
        dq = rhs / (inertia + slope)
        for _ in range(2):
            x = q + dq - position
            held = np.clip(x, -strength, strength)
            now, slope = stiffness @ held, stiffness @ (held == x)
            change = (rhs - inertia * dq - (now - force)) / (inertia + slope)
            if abs(change) <= 1e-12 * abs(dq):
                break
            dq, now = dq + change, now + slope * change
        position += x - held
        q, v, force = q + dq, 2 / DT * dq - v, now
        a = p - DAMPING * v - k * q - force
    return q


def solve_ivp(strength, stiffness, amplitude):
    """SciPy: RK45 on displacement, velocity and the sliders' extensions, steps of ten dt at most (its time is the run's over 20,000)."""
    from scipy.integrate import solve_ivp as integrate

    k = OMEGA**2 - stiffness.sum()

    def rates(t, y):
        q, v, x = y[0], y[1], y[2:]
        stuck = (np.abs(x) < strength) | (x * v < 0)
        a = pulse(t, amplitude) - DAMPING * v - k * q - stiffness @ np.clip(x, -strength, strength)
        return np.concatenate(([v, a], np.where(stuck, v, 0.0)))

    start = np.zeros(2 + len(strength))
    return integrate(rates, (0, STEPS * DT), start, max_step=DT * 10, rtol=1e-6, atol=1e-12).y[0, -1]


def opensees(strength, stiffness, amplitude):
    """OpenSeesPy: zeroLength with a Parallel of ElasticPP, Newmark, Newton."""
    try:
        import openseespy.opensees as ops
    except RuntimeError as error:  # what it raises when a system library is missing
        raise ImportError(str(error)) from error

    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    ops.mass(2, 1.0)
    n = len(strength)
    for i, (phi, k) in enumerate(zip(strength, stiffness), 1):
        ops.uniaxialMaterial("ElasticPP", i, float(k), float(phi))
    ops.uniaxialMaterial("Elastic", n + 1, float(OMEGA**2 - stiffness.sum()))
    ops.uniaxialMaterial("Viscous", n + 2, float(DAMPING), 1.0)
    ops.uniaxialMaterial("Parallel", n + 3, *range(1, n + 3))
    ops.element("zeroLength", 1, 1, 2, "-mat", n + 3, "-dir", 1, "-doRayleigh", 0)
    load = pulse(np.arange(STEPS + 1) * DT, amplitude)
    ops.timeSeries("Path", 1, "-dt", DT, "-values", *load.tolist())
    ops.pattern("Plain", 1, 1)
    ops.load(2, 1.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-14, 10)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    if ops.analyze(STEPS, DT) != 0:
        raise RuntimeError("OpenSees did not converge")
    return ops.nodeDisp(2, 1)


def main():
    strength, stiffness = np.loadtxt(sys.argv[1], unpack=True)
    amplitude = float(sys.argv[2])
    peers = [
        (vectorised, 1e-6, "NumPy vectorised"),
        (solve_ivp, 1e-2, "SciPy RK45"),
        (opensees, 1e-3, "OpenSeesPy"),
    ]
    for run, tolerance, name in peers:
        try:
            times = []
            for _ in range(3):
                start = time.perf_counter()
                end = run(strength, stiffness, amplitude)
                times.append((time.perf_counter() - start) / STEPS * 1e9)
        except ImportError as error:
            print(f"{name} left out: {error}", file=sys.stderr)
            continue
        print(f"{sorted(times)[1]:.1f} {end:.12e} {tolerance} {name}")


if __name__ == "__main__":
    main()
