"""Ensembles of the Python package: two threads beside one, and a ring-down beside OpenSeesPy's where that is installed.

usage: ensemble.py [MEMBERS]

A ring-down: mode 1 of the paper's Table 2 released at 1e-3, 0.2 s. Fastest of three runs each, interleaved. OpenSeesPy takes
20,000 steps with 100 sliders, as in python_peers.py; its time is that of one ring-down.
"""

import sys
import time

import numpy as np

import iwan
import python_peers

JOINT = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)


def ensemble(members, threads):
    """Seconds per ring-down."""
    f_s = np.random.default_rng(1).uniform(100.0, 400.0, members)
    start = time.perf_counter()
    iwan.ensemble.simulate(
        frequency=124.0, damping_ratio=2.5e-4, k_t=4.45e4, f_s=f_s, chi=-0.183, beta=0.3, displacement=1e-3,
        dt=1e-2, duration=0.2, threads=threads, progress=False,
    )
    return (time.perf_counter() - start) / members


def main():
    members = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    runs = [(ensemble(members, 1), ensemble(members, 2)) for _ in range(3)]
    one, two = (min(times) for times in zip(*runs))
    print(f"{members} ring-downs: {one * 1e6:.2f} us each on one thread, {two * 1e6:.2f} us on two: {one / two:.2f} times")
    try:
        strength, stiffness = JOINT.discretise(100)
        times = []
        for _ in range(3):
            start = time.perf_counter()
            python_peers.opensees(strength, stiffness, 1000.0)
            times.append(time.perf_counter() - start)
    except ImportError as error:
        print(f"OpenSeesPy left out: {error}", file=sys.stderr)
        return
    print(f"OpenSeesPy: {min(times) * 1e3:.0f} ms each: {min(times) / two:.0f} times as long as the ensemble on two threads")


if __name__ == "__main__":
    main()
