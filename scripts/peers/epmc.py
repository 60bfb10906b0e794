#!/usr/bin/env python3
"""Nonlinear modes of two freedoms beside tmdsimpy and juliajim: the limit of their curves as samples are refined.

Models: `tests/test_epmc.py` of tmdsimpy (github.com/tmd-lab/tmdsimpy, commit 17d5fc3), M = I, K = [[2, -1], [-1, 2]], C = 0.01 M, a Jenkins
element of k_t = 0.25, F_s = 0.2 at the second freedom; `examples/c4_mdofgen_epmc.jl` of juliajim (github.com/Nidish96/juliajim, commit 55465ef),
the same K and M, C = 0.01 M + 0.001 K, k_t = F_s = 1. Parameters are theirs, the equations are written anew: harmonics of M u'' + (C - xi M) u' + K u
+ f = 0, f sampled over a period that a slider runs through as theirs does, and transformed. The amplitude is held in the mode with the joint
stuck, as ours is. The samples' last two doublings are extrapolated (their error goes with the square of the step); the numbers stand in
crates/iwan-sim/tests/steady_peers.rs.

usage: epmc.py [--tmdsimpy FOLDER]
    --tmdsimpy FOLDER   a checkout: its own residual is evaluated at our limit, with 2^10 samples as in its tests
Needs numpy and scipy.
"""

import argparse
import sys

import numpy as np
from scipy.optimize import fsolve

M = np.eye(2)
K = np.array([[2.0, -1.0], [-1.0, 2.0]])
ORDERS = np.array([1, 3, 5])


def jenkins(u, k_t, f_s):
    """Force of a slider at the samples of a period with one top and one bottom, once history is forgotten."""
    n, top, bottom = u.size, int(np.argmax(u)), int(np.argmin(u))
    if 2.0 * f_s >= k_t * (u[top] - u[bottom]):
        return k_t * u
    down = (np.arange(n) - top) % n <= (bottom - top) % n
    falling = np.maximum(-f_s, f_s - k_t * (u[top] - u))
    rising = np.minimum(f_s, -f_s + k_t * (u - u[bottom]))
    return np.where(down, falling, rising)


def falls(u):
    """Whether the samples only fall from their top to their bottom: what `jenkins` takes for granted."""
    top, bottom = int(np.argmax(u)), int(np.argmin(u))
    return bool(np.all(np.diff(u[(top + np.arange((bottom - top) % u.size + 1)) % u.size]) <= 0.0))


def slip(x, samples):
    """Displacement of the second freedom at the samples of a period."""
    u = (x[:6] - 1j * x[6:12]).reshape(3, 2)
    theta = 2.0 * np.pi * np.arange(samples) / samples
    return sum((u[h, 1] * np.exp(1j * n * theta)).real for h, n in enumerate(ORDERS))


def residual(x, q, shape, damping, k_t, f_s, samples):
    """Harmonic balance of both freedoms, and the modal amplitude in phase."""
    u = (x[:6] - 1j * x[6:12]).reshape(3, 2)
    omega, xi = x[12:]
    force = jenkins(slip(x, samples), k_t, f_s)
    spectrum = 2.0 * np.fft.rfft(force)[ORDERS] / samples
    left = []
    for h, n in enumerate(ORDERS):
        z = K - (n * omega) ** 2 * M + 1j * n * omega * (damping - xi * M)
        left.append(z @ u[h] + np.array([0.0, spectrum[h]]))
    modal = shape @ M @ u[0]
    left = np.concatenate(left)
    return np.concatenate([left.real, left.imag, [modal.real - q, modal.imag]])


def limit(q, shape, damping, k_t, f_s, start):
    """Solutions at 2^14 to 2^18 samples and their limit, for a start that is near."""
    found = []
    for power in (10, 14, 16, 18):
        start, _, flag, message = fsolve(
            residual, start, (q, shape, damping, k_t, f_s, 2**power), xtol=1e-13, full_output=True
        )
        assert flag == 1 or np.abs(residual(start, q, shape, damping, k_t, f_s, 2**power)).max() < 1e-11 * q, message
        found.append(start)
    assert falls(slip(start, 2**12)), "more than two turning points"
    return found, found[-1] + (found[-1] - found[-2]) / 15.0


def theirs(folder, x, k_t, f_s, damping_ab):
    """tmdsimpy's own residual at our limit, over its size for the linear force."""
    sys.path.insert(0, folder)
    from tmdsimpy.nlforces.vector_jenkins import VectorJenkins
    from tmdsimpy.vibration_system import VibrationSystem

    system = VibrationSystem(M, K, ab=damping_ab)
    system.add_nl_force(VectorJenkins(np.array([[0.0, 1.0]]), np.array([[0.0], [1.0]]), k_t, f_s))
    a = np.linalg.norm(x[:2]) if not x[6:8].any() else np.sqrt(np.sum(x[:2] ** 2) + np.sum(x[6:8] ** 2))
    parts = [np.concatenate([x[2 * h : 2 * h + 2], x[6 + 2 * h : 8 + 2 * h]]) / a for h in range(3)]
    full = np.concatenate([*parts, [x[12], x[13], np.log10(a)]])
    h = ORDERS
    phase = np.zeros(12)
    phase[2:4] = 1.0
    r = system.epmc_res(full, phase, h, Nt=1 << 10, aft_tol=1e-7)[0]
    return np.abs(r[:12]).max() / np.abs(K @ x[:2]).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tmdsimpy")
    arguments = parser.parse_args()
    for name, k_t, f_s, alpha, beta, amplitudes in (
        ("tmdsimpy", 0.25, 0.2, 0.01, 0.0, (1.5, 4.0, 20.0)),
        ("juliajim", 1.0, 1.0, 0.01, 0.001, (2.0, 5.0, 30.0)),
    ):
        values, shapes = np.linalg.eigh(K + k_t * np.diag([0.0, 1.0]))
        shape = shapes[:, 0] * np.sign(shapes[:, 0].sum())
        full = alpha * M + beta * K
        # Ours is diagonal in the modes with the joint stuck.
        diagonal = shapes @ np.diag(np.diag(shapes.T @ full @ shapes)) @ shapes.T
        for words, damping in (("diagonal", diagonal), ("as given", full)):
            if words == "as given" and np.allclose(full, diagonal):
                continue
            start = np.concatenate([shape * amplitudes[0], np.zeros(10), [np.sqrt(values[0]), 0.01]])
            q0 = amplitudes[0]
            print(f"{name}, damping {words}: q, omega, xi, then |u_1|, |u_2| of harmonics 1, 3, 5; what its own samples change in omega")
            for q in amplitudes:
                for step in np.geomspace(q0, q, 30):
                    start[:12] *= step / q0
                    q0 = step
                    start = fsolve(residual, start, (step, shape, damping, k_t, f_s, 2**10), xtol=1e-12)
                found, best = limit(q, shape, damping, k_t, f_s, start)
                sizes = np.hypot(best[:6], best[6:12])
                own = found[0][12] / best[12] - 1.0
                print(f"  ({q}, {best[12]:.12f}, {best[13]:.12f}, [{', '.join(f'{s:.12f}' for s in sizes)}]) {own:.1e}")
                if arguments.tmdsimpy and name == "tmdsimpy":
                    print(f"    tmdsimpy's residual there: {theirs(arguments.tmdsimpy, best, k_t, f_s, [alpha, beta]):.1e}")


if __name__ == "__main__":
    main()
