"""What the tests share. They run on the installed wheel, never on the source folder."""

import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import iwan

# What a shell starts in the background ignores Ctrl-C, and hands that on: the tests of Ctrl-C want it as at a terminal.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def joint() -> iwan.FourParameter:
    """Mode 1 of the paper's Table 2."""
    return iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)


@pytest.fixture
def mode(joint: iwan.FourParameter) -> iwan.Mode:
    return iwan.Mode(frequency=124.0, joint=joint, damping_ratio=2.5e-4, name="bending 1")


@pytest.fixture
def blow() -> iwan.Haversine:
    return iwan.Haversine(amplitude=1000.0, duration=1.6e-3)


@pytest.fixture
def with_window(tmp_path: Path) -> Callable[[np.ndarray, float, int], iwan.Record]:
    """Writes one channel to a UFF file whose header names a window (type 1858: 0 none, 4 exponential), and reads it."""

    def read(samples: np.ndarray, dt: float, window: int) -> iwan.Record:
        rows = "\n".join(f"{a:20.11e}" for a in samples)
        axes = "".join(f"{code:>10}    0    0    0 {label:<20} {unit:<20}\n" for code, label, unit in [
            (17, "Time", "s"), (12, "Acceleration", "m/s2"), (0, "NONE", "NONE"), (0, "NONE", "NONE"),
        ])  # fmt: skip
        head = "    -1\n    58\ntip\nNONE\n01-Jan-26 00:00:00\nNONE\nNONE\n    1         0    0         0 NONE               1   3 NONE               0   0\n"
        clock = f"{2:>10}{len(samples):>10}{1:>10}{0:>13.5e}{dt:>13.5e}{0:>13.5e}\n"
        zeros = [f"{0:>15.7e}" * n for n in (5, 4, 5)]
        qualifiers = f"    -1\n  1858\n{f'{0:>12}' * 6}\n     0{window:>6}{f'{0:>6}' * 10}\n{zeros[0]}\n{zeros[1]}{2.5:>15.7e}\n{zeros[2]}\nNONE  NONE\nNONE\n    -1\n"
        path = tmp_path / f"{window}.uff"
        path.write_text(f"{head}{clock}{axes}{rows}\n    -1\n{qualifiers}")
        return iwan.read_record(path)

    return read


def pytest_sessionstart() -> None:
    source = Path(__file__).parent.parent / "python"
    if Path(iwan.__file__).is_relative_to(source):
        pytest.exit("the tests ran on the source folder: install the wheel", returncode=4)
