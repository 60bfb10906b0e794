"""Identification beside the same steps written with SciPy, on one record: 65,536 samples at 10 kHz in three channels.

usage: identification.py [ROUNDS]

Envelope: band-pass, analytic signal, polynomials through its logarithm and phase, frequency and damping. SciPy's version takes the
band and the order that ours found, so that it has less to do. Curves: SciPy fits K_T, F_S, chi, beta, frequency and viscous damping to
the dissipation and frequency of one channel. Ours, `iwan.fit`, goes on from there to the record itself and to intervals. Interleaved
rounds, medians; before that both must agree.
"""

import sys
import time

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import butter, hilbert, sosfiltfilt

import iwan

DT, SAMPLES = 1e-4, 65_536
JOINT = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)


def record():
    """Acceleration of three channels after release at 1.5 phi_max, noise 40 dB below."""
    mode = iwan.Mode(frequency=124.0, joint=JOINT, damping_ratio=2.5e-4)
    start = (1.5 * JOINT.phi_max, 0.0)
    clean = iwan.simulate(
        mode, force=np.zeros(2), dt=DT, duration=(SAMPLES - 1) * DT, initial=start, method="half-cycle"
    ).acceleration
    noise = np.random.default_rng(1).normal(size=(3, SAMPLES))
    return clean + 0.01 * np.sqrt(np.mean(clean**2)) * noise


def ours(x):
    return [iwan.envelope(channel, dt=DT) for channel in x]


def with_scipy(channel, band, order, window):
    """Time, amplitude, frequency in Hz and damping ratio."""
    sos = butter(3, np.array(band) * 2 * DT, "bandpass", output="sos")
    analytic = hilbert(sosfiltfilt(sos, channel))
    t = np.arange(len(channel)) * DT
    inside = (t >= window[0]) & (t <= window[1])
    t, analytic = t[inside], analytic[inside]
    log, phase = np.log(np.abs(analytic)), np.unwrap(np.angle(analytic))
    smooth = [np.polynomial.Polynomial.fit(t, y, order) for y in (log, phase)]
    decay, omega = -smooth[0].deriv()(t), smooth[1].deriv()(t)
    return t, np.exp(smooth[0](t)), omega / (2 * np.pi), decay / np.hypot(decay, omega)


def curve_fit(amplitude, frequency, damping_ratio):
    """Least squares on ln D and frequency at 200 amplitudes, by the closed forms."""
    pick = np.linspace(0, len(amplitude) - 1, 200).astype(int)
    omega = 2 * np.pi * frequency[pick]
    q = amplitude[pick] / omega**2
    log_d = np.log(2 * np.pi * damping_ratio[pick] * omega**2 * q**2)

    def residuals(x):
        k_t, f_s, ratio, omega_0, zeta, chi = *np.exp(x[:5]), np.tanh(x[5])
        try:
            joint = iwan.FourParameter(k_t=k_t, f_s=f_s, chi=chi, beta=ratio)
        except iwan.IwanError:
            return np.full(2 * len(q), 1e3)
        stiffness = omega_0**2 - k_t + joint.harmonic_stiffness(q)
        found = np.sqrt(np.maximum(stiffness, 1.0))
        d = joint.dissipation(q) + 2 * np.pi * zeta * omega_0 * found * q**2
        return np.concatenate(((np.log(d) - log_d) / 0.02, (found - omega) / (1e-4 * omega)))

    start = np.append(np.log([3e4, 200.0, 0.5, omega.max(), 1e-4]), -0.3)
    return least_squares(residuals, start)


def timed(run):
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    x = record()
    found = ours(x)[0]
    band = (100.0, 150.0)
    theirs = with_scipy(x[0], band, found.order, (found.t[0], found.t[-1]))
    middle = len(found.t) // 2
    for name, a, b in (("frequency", found.frequency, theirs[2]), ("damping ratio", found.damping_ratio, theirs[3])):
        other = np.interp(found.t[middle], theirs[0], b)
        if abs(a[middle] / other - 1) > 0.05:
            sys.exit(f"{name} in the middle: {a[middle]} here, {other} with SciPy")
    rows = {"envelopes, iwan": lambda: ours(x)}
    rows["envelopes, SciPy"] = lambda: [
        with_scipy(c, band, found.order, (found.t[0], found.t[-1])) for c in x
    ]
    rows["curves to parameters, SciPy"] = lambda: curve_fit(*theirs[1:])
    rows["record to parameters with intervals, iwan.fit"] = lambda: iwan.fit(x[0], dt=DT, quantity="acceleration")
    times = {name: [] for name in rows}
    for _ in range(rounds):
        for name, run in rows.items():
            times[name].append(timed(run))
    for name, values in times.items():
        print(f"{name:<48} {np.median(values) * 1e3:10.1f} ms")
    ratio = np.median(np.array(times["envelopes, SciPy"]) / np.array(times["envelopes, iwan"]))
    print(f"envelopes: SciPy takes {ratio:.2f} times as long")


if __name__ == "__main__":
    main()
