"""Reference numbers of `crates/iwan-modal/tests/decays.rs` and `crates/iwan-ident/tests/freevib.rs`, by NumPy and SciPy and with
nothing of this project.

Zeroed early-time spectra (Allen, Mayes 2010) of a mode whose frequency falls with its amplitude until 0.4 s, and
FREEVIB (Feldman 1994) on a hardening spring. Prints the numbers that the tests quote.

    python tests/peers/decays.py
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares
from scipy.signal import hilbert

DT = 1 / 2048
SAMPLES, TIMES = 4096, 30
OMEGA, ZETA, UNTIL = 2 * np.pi * 80.0, 4e-3, 0.4


def decay():
    t = np.arange(SAMPLES) * DT
    phase = OMEGA * t + np.where(t < UNTIL, 9 * (1 - t / UNTIL) ** 2, 0)
    return t, np.exp(-ZETA * OMEGA * t) * np.cos(phase)


def zeroed():
    """Spectra of the record with its begin zero, the late half's linear model, and how far it is off them."""
    t, x = decay()
    start = SAMPLES // 2

    def model(p, t):
        return np.exp(p[0] * t) * (p[2] * np.cos(p[1] * t) + p[3] * np.sin(p[1] * t))

    late = t[start:] - t[start]
    fit = least_squares(lambda p: model(p, late) - x[start:], [-2.0, OMEGA, 0.1, 0.1], x_scale=[1, 10, 0.1, 0.1], xtol=1e-15, ftol=1e-15, gtol=1e-15)
    print(f"late pole {fit.x[0]:.6f} + {fit.x[1]:.6f}i")
    width = 4 * -fit.x[0] / (2 * np.pi)
    for k in (0, 3, 6, 12):
        begin = k * start // TIMES
        step = 1 / ((SAMPLES - begin) * DT)
        measured = np.fft.rfft(x[begin:]) * DT
        extrapolated = np.fft.rfft(model(fit.x, t[begin:] - t[start])) * DT
        half = max(width, 3 * step)
        # A line at the very end of the range counts, whatever rounding says.
        centre, beyond = fit.x[1] / (2 * np.pi), 1e-6
        lines = np.arange(int(np.ceil((centre - half) / step - beyond)), int((centre + half) / step + beyond) + 1)
        off = np.linalg.norm((measured - extrapolated)[lines]) / np.linalg.norm(measured[lines])
        print(f"zeroed until {t[begin]:.6f} s: largest line {np.abs(measured).max():.9e}, distance {off:.6e}")


def freevib():
    """Backbone and damping coefficient of x'' + 2 h x' + k x + c x^3 = 0 by Feldman's equations, derivatives by central differences."""
    k, h = (2 * np.pi * 40.0) ** 2, 4.0
    c, dt = 0.4 * k, 1 / 4096
    run = solve_ivp(lambda _, y: [y[1], -2 * h * y[1] - k * y[0] - c * y[0] ** 3], (0, 1), [1.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-14, t_eval=np.arange(4096) * dt)
    signal = hilbert(run.y[0])
    # Two cycles of the mean frequency, twice: what is left of the third harmonic goes, and the slow parts stay.
    window = np.ones(205) / 205
    smooth = lambda v: np.convolve(np.convolve(v, window, "same"), window, "same")
    amplitude = np.exp(smooth(np.log(np.abs(signal))))
    omega = np.gradient(smooth(np.unwrap(np.angle(signal))), dt)
    rate, second = np.gradient(amplitude, dt), np.gradient(np.gradient(amplitude, dt), dt)
    slope = np.gradient(omega, dt)
    damping = -rate / amplitude - slope / (2 * omega)
    natural = omega**2 - second / amplitude + 2 * (rate / amplitude) ** 2 + rate * slope / (amplitude * omega)
    for t in (0.2, 0.3, 0.4):
        n = round(t / dt)
        print(f"{t} s: amplitude {amplitude[n]:.5f}, natural frequency {np.sqrt(natural[n]) / (2 * np.pi):.5f} Hz, damping coefficient {damping[n]:.4f} 1/s")


if __name__ == "__main__":
    zeroed()
    freevib()
