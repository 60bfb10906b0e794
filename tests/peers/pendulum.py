"""Reference numbers of `crates/iwan-core/tests/parts_in_time.rs`, by SciPy and with nothing of this project.

A mode of 0.5 Hz with viscous, dry and quadratic damping and a cubic spring that softens, as a pendulum has them,
released at 0.8; and the slopes of a monotone cubic. Prints the numbers that the tests quote.

    python tests/peers/pendulum.py
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

OMEGA0 = 2 * np.pi * 0.5
VISCOUS = 2 * 0.002 * OMEGA0
FRICTION, QUADRATIC, CUBIC = 0.004, 0.03, -1.64


def half_cycle(t, q, direction, until):
    """From rest at `q` in `direction` to the next rest; its dense solution and end."""

    def rate(_, y):
        u, v = y
        forces = VISCOUS * v + OMEGA0**2 * u + CUBIC * u**3 + QUADRATIC * v * abs(v) + FRICTION * direction
        return [v, -forces]

    def rest(s, y):
        return y[1] if s > t + 1e-3 else direction

    rest.terminal = True
    return solve_ivp(rate, (t, until), [q, 0.0], method="DOP853", rtol=1e-13, atol=1e-15, events=rest, dense_output=True)


def pendulum(times):
    """Displacements at `times` of the mode released at 0.8, one half cycle after the other until it sticks."""
    out = np.empty(len(times))
    t, q, until = 0.0, 0.8, times[-1] + 2.0
    while t < times[-1]:
        restoring = OMEGA0**2 * q + CUBIC * q**3
        if abs(restoring) <= FRICTION:
            out[times >= t] = q
            break
        run = half_cycle(t, q, -np.sign(restoring), until)
        inside = (times >= t) & (times <= run.t[-1])
        if inside.any():
            out[inside] = run.sol(times[inside])[0]
        t, q = run.t[-1], run.y[0, -1]
    return out


if __name__ == "__main__":
    times = np.array([5.0, 20.0, 60.0, 200.0])
    for t, q in zip(times, pendulum(times)):
        print(f"q({t}) = {q:.12e}")
    curve = PchipInterpolator(np.log([1e-4, 3e-4, 1e-3, 5e-3, 1e-2]), [124.0, 123.9, 123.2, 122.9, 121.0])
    print([f"{value:.12f}" for value in curve(np.log([1.5e-4, 5e-4, 2e-3, 7e-3]))])
