"""What the tests share. They run on the installed wheel, never on the source folder."""

import signal
from pathlib import Path

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


def pytest_sessionstart() -> None:
    source = Path(__file__).parent.parent / "python"
    if Path(iwan.__file__).is_relative_to(source):
        pytest.exit("the tests ran on the source folder: install the wheel", returncode=4)
