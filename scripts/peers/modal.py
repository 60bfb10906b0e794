"""Modes from frequency responses beside sdypy-EMA, and from free decays beside pyOMA2, on the same hits: ten modes, 54 points, five hits,
noise 40 dB.

usage: modal.py [ROUNDS]

What is timed is a call from samples in memory to frequencies, damping and shapes: no start of a process, no import, no file. All get the same arrays
and polynomials or realizations of all orders up to 60, and use the cores that their libraries use by themselves. Ours does more in its
time: it looks for faults of the hits, picks its modes, refines all poles by maximum likelihood, gives standard deviations, and computes the
responses a second time for the scale of the shapes. The others' poles are picked for them, those nearest to the truth. Rounds interleaved; medians, and the ratio
of medians to that of ours in the row before.
"""

import sys
import time

import numpy as np

import iwan

RATE, SAMPLES, STATIONS = 4096, 8192, 27
MODES = [
    (122.4, 1e-3, 2, 0), (243.1, 1e-4, 3, 0), (301.7, 3e-3, 1, 1), (402.3, 5e-4, 4, 0), (515.8, 1e-2, 2, 1),
    (601.5, 2e-4, 5, 0), (743.0, 4e-3, 6, 0), (751.916, 4e-3, 3, 1), (875.2, 2e-3, 7, 0), (958.4, 7e-4, 4, 1),
]
BAND = (60.0, 1100.0)


def shapes():
    x = np.arange(STATIONS) / (STATIONS - 1)
    rows = [np.concatenate([np.cos(n * np.pi * x), (-1) ** twist * np.cos(n * np.pi * x)]) for *_, n, twist in MODES]
    return np.array(rows)


def hits(count):
    """Forces and accelerances' responses: an impulse of one sample, so that nothing of the responses is aliased in the force."""
    random = np.random.default_rng(1)
    t = np.maximum(np.arange(SAMPLES) - 40, 0) / RATE
    after = np.arange(SAMPLES) >= 40
    motion = np.zeros((2 * STATIONS, SAMPLES))
    for (frequency, damping, *_), shape in zip(MODES, shapes(), strict=True):
        omega = 2 * np.pi * frequency
        pole = -damping * omega + 1j * omega * np.sqrt(1 - damping**2)
        motion += shape[0] * np.outer(shape, after * np.real(np.exp(pole * t) / (1j * pole.imag)))
    rms = np.sqrt(np.mean(motion**2, axis=1, keepdims=True))
    forces = np.zeros((count, SAMPLES))
    forces[:, 40] = RATE
    return forces, np.array([motion + 0.01 * rms * random.standard_normal(motion.shape) for _ in range(count)])


def ours(forces, motions):
    names = [str(n) for n in range(2 * STATIONS)]
    fit = iwan.modal_fit(forces, motions, 1 / RATE, names=names, force_at="0", quantity="displacement", band=BAND)
    return np.array([[m.frequency, m.damping_ratio] for m in fit.modes]), np.array([m.shape for m in fit.modes])


def with_sdypy(forces, motions):
    from sdypy import EMA

    spectra = np.fft.rfft(motions, axis=2)
    force = np.fft.rfft(forces, axis=1)[:, None]
    h1 = (force.conj() * spectra).sum(0) / (np.abs(force) ** 2).sum(0)
    model = EMA.Model(h1[:, 1:], np.fft.rfftfreq(SAMPLES, 1 / RATE)[1:], lower=BAND[0], upper=BAND[1], pol_order_high=60, driving_point=0)
    model.get_poles(method="lscf", show_progress=False)
    model.select_closest_poles([m[0] for m in MODES])
    model.get_constants()
    found = np.column_stack([model.nat_freq, model.nat_xi])
    return found, np.real(np.asarray(model.A)).T


def decays_of(motions):
    """The mean of the hits from the first sample after the blow on."""
    return np.ascontiguousarray(motions.mean(0)[:, 41:])


def ours_free(_, decays):
    names = [str(n) for n in range(2 * STATIONS)]
    fit = iwan.modal_fit(None, decays[None], 1 / RATE, names=names, quantity="displacement", band=BAND)
    return np.array([[m.frequency, m.damping_ratio] for m in fit.modes]), np.array([m.shape for m in fit.modes])


def with_pyoma2(_, decays):
    from pyoma2.algorithms import SSI
    from pyoma2.setup import SingleSetup

    setup = SingleSetup(decays.T, fs=RATE)
    # Covariance-driven subspaces of order 60; five reference channels and 20 block rows were the best of a few.
    setup.add_algorithms(SSI(name="ssi", method="cov", br=20, ordmax=60, ref_ind=[0, 5, 13, 30, 40]))
    setup.run_by_name("ssi")
    setup.mpe("ssi", sel_freq=[m[0] for m in MODES], order_in=60, rtol=5e-2)
    result = setup.algorithms["ssi"].result
    return np.column_stack([result.Fn, result.Xi]), np.real(np.asarray(result.Phi)).T


def report(name, found, modes, seconds, ratio):
    if len(found) != len(MODES):
        print(f"{name:12} {len(found)} modes of {len(MODES)}, {seconds:.3f} s{ratio}")
        return
    truth = np.array([m[:2] for m in MODES])
    off = np.abs(found / truth - 1).max(0)
    exact = shapes()
    unlike = max(1 - np.dot(a, b) ** 2 / (np.dot(a, a) * np.dot(b, b)) for a, b in zip(modes, exact, strict=True))
    print(f"{name:12} frequency {off[0]:.1e}, damping {off[1]:.1e}, 1-MAC {unlike:.1e}, {seconds:.3f} s{ratio}")


def main(rounds):
    forces, motions = hits(5)
    decays = decays_of(motions)
    ways = {"iwan": ours}
    try:
        import sdypy.EMA  # noqa: F401

        ways["sdypy-EMA"] = with_sdypy
    except ImportError:
        print("sdypy-EMA is not installed: left out")
    ways["iwan, decays"] = ours_free
    try:
        import logging

        import pyoma2.setup  # noqa: F401

        logging.disable(logging.INFO)
        ways["pyOMA2"] = with_pyoma2
    except ImportError:
        print("pyOMA2 is not installed: left out")
    seconds = {name: [] for name in ways}
    found = {}
    for _ in range(rounds):
        for name, way in ways.items():
            start = time.perf_counter()
            found[name] = way(forces, decays if way in (ours_free, with_pyoma2) else motions)
            seconds[name].append(time.perf_counter() - start)
    print("modes of 54 responses, largest errors of ten modes")
    own = 0.0
    for name in ways:
        median = float(np.median(seconds[name]))
        is_own = name.startswith("iwan")
        own = median if is_own else own
        report(name, *found[name], median, "" if is_own else f", {median / own:.1f} times ours")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3)
