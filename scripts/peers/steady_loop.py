#!/usr/bin/env python3
"""How long tmdsimpy's VectorIwan4 takes for the harmonics of a joint's force and their derivatives, for `cargo bench --bench steady` beside it.

Mode 1 of Table 2, chi = -0.183, 100 sliders, 128 samples, harmonics 0 to 3 as in its examples; and with harmonics 0 to 7. The median of
51 rounds. Its law has no Dirac of its own (beta is a share of stiffness as ours).

usage: steady_loop.py FOLDER    a checkout of github.com/tmd-lab/tmdsimpy
Needs numpy and scipy.
"""

import sys
import time

import numpy as np


def main():
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return 0 if len(sys.argv) == 2 else 2
    sys.path.insert(0, sys.argv[1])
    from tmdsimpy.nlforces.vector_iwan4 import VectorIwan4

    joint = VectorIwan4(np.eye(1), np.eye(1), 4.45e4, 239.4, -0.183, 0.3, Nsliders=100, alphasliders=1.0)
    phi_max = 239.4 * 1.3 / (4.45e4 * (0.3 + (1 - 0.183) / (2 - 0.183)))
    for highest in (3, 7):
        h = np.arange(highest + 1)
        u = np.zeros(2 * highest + 1)
        u[1], u[5] = 0.5 * phi_max, 0.0025 * phi_max
        times = []
        for _ in range(51):
            begin = time.perf_counter()
            force = joint.aft(u, 1.0, h, Nt=128)[0]
            times.append(time.perf_counter() - begin)
        print(f"harmonics 0 to {highest}: {1e6 * np.median(times):.0f} us, first harmonic {force[1]:.6f} cos, {force[2]:.6f} sin")
    return 0


if __name__ == "__main__":
    sys.exit(main())
