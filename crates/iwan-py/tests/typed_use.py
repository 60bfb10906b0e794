"""Checked by mypy --strict, never run: what the types promise to callers."""

import pathlib

import numpy as np
from numpy.typing import NDArray
from typing_extensions import assert_type

import iwan

joint = iwan.FourParameter(k_t=1.0, f_s=1.0, chi=0.0, beta=0.0)
assert_type(joint.force(0.1), float)
assert_type(joint.force([0.1]), NDArray[np.float64])
assert_type(joint.force(np.zeros((2, 2), dtype=np.float32)), NDArray[np.float64])
mode = iwan.Mode(frequency=124.0, joint=joint, outputs={"tip": 1.0})
assert_type(iwan.simulate(mode, dt=1e-5, duration=0.1), iwan.Response)
assert_type(iwan.simulate([mode], dt=1e-5, duration=0.1), list[iwan.Response])
assert_type(iwan.simulate(mode, dt=1e-5, duration=0.1).statistics["time_step_error"], float | None)
iwan.simulate(mode, dt=1e-5, duration=0.1, method="euler")  # type: ignore[call-overload]
iwan.FourParameter(1.0, 1.0, 0.0, 0.0)  # type: ignore[call-arg]
record = iwan.read_record(pathlib.Path("a.csv"), channels=["a"])
assert_type(iwan.envelope(record, band=(1.0, 2.0)).t, NDArray[np.float64])
beam = iwan.Structure.load(pathlib.Path("beam.toml"))
assert_type(beam.modes(4).shapes, NDArray[np.float64])
assert_type(beam.quasi_static("bending 1").joint, iwan.FourParameter | None)
truth = beam.simulate(force=iwan.Haversine(amplitude=1.0, duration=1e-3), dt=1e-5, duration=0.1, model="full")
assert_type(truth.record("bending 1"), iwan.Record)
beam.simulate(dt=1e-5, duration=0.1, model="half")  # type: ignore[arg-type]
fits = iwan.ensemble.fit([record, [record, record]], hold={"damping_ratio": 0.0})
assert_type(fits.parameters["chi"], NDArray[np.float64])
assert_type(iwan.fit(record, band=[1.0, 2.0], window=(0.0, 1.0)), iwan.Fit)
assert_type(iwan.ensemble.envelope([record], band=[1.0, 2.0], window=[0.0, 1.0]), list[iwan.Envelope])
beam.frf(band=[125.0, 140.0], force=[1.0])
iwan.fit_coupled(record, bands=[[100.0, 120.0], (200.0, 220.0)])
