"""What disturbs records is said by fits of several modes and by fits beside a shaker's test, too."""

import numpy as np
import pandas
import pytest

import iwan
from iwan._stretches import several


def test_coupled_fits_say_where_samples_are_lost() -> None:
    modes = [iwan.Mode(frequency=f, damping_ratio=5e-4, name=name) for name, f in (("one", 20.0), ("two", 52.0))]
    law = iwan.FourParameter(k_t=1500.0, f_s=20.0, chi=-0.3, beta=0.05)
    truth = iwan.CoupledModes(modes, [iwan.SharedJoint(joint=law, participation=[1.0, -2.5], compliance=1e-4)])
    blow = iwan.Haversine(amplitude=600.0, duration=0.01)
    whole = np.array([mode.acceleration for mode in truth.simulate(force=blow, dt=1e-3, duration=1.5).modes])
    lost = np.concatenate([whole[:, :1200], whole[:, 1207:], np.zeros((2, 7))], axis=1)
    force = np.array([blow.at(1e-3 * n) for n in range(whole.shape[1])])

    def words(record: np.ndarray) -> str:
        found = iwan.fit_coupled(record, dt=1e-3, forces=force, shapes=np.eye(2), frequencies=[20.0, 52.0])
        return "\n".join(found.warnings)

    assert "lost" not in words(whole)
    assert "records[0]: the vibration breaks off, as where samples are lost, at 1.200000 s" in words(lost)


def test_fits_beside_sweeps_say_where_a_structure_is_let_go() -> None:
    joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=1e-3)
    decay = iwan.simulate(mode, dt=2e-4, duration=0.4, initial=(0.2 * joint.phi_max, 0.0), method="half-cycle").acceleration
    shaker = iwan.frf(mode, band=(112.0, 128.0), force=[1.0, 100.0], points=60)
    rung = np.ravel(decay)
    assert list(iwan.fit(rung, dt=2e-4, sweeps=[shaker]).notes) == []
    notes = iwan.fit(np.concatenate([rung, rung]), dt=2e-4, sweeps=[shaker]).notes
    assert any("before 0.400000 s" in note and "the record begins there" in note for note in notes), notes


def _decays() -> tuple[np.ndarray, np.ndarray]:
    t = np.arange(8192) / 2048
    one = np.exp(-1.5 * t) * np.sin(2 * np.pi * 60.0 * t)
    return t, np.concatenate([one, 0.8 * one])


def test_an_envelope_through_two_hits_says_so() -> None:
    _, x = _decays()
    record = iwan.Record(x, dt=1 / 2048, quantity="velocity")
    envelope = iwan.envelope(record)
    assert any(note.startswith("2 hits, at ") and "Record.hits" in note for note in envelope.notes), envelope.notes
    assert envelope.notes == iwan.ensemble.envelope([record])[0].notes
    one = iwan.envelope(record.hits()[0])
    assert not any("hits" in note for note in one.notes)
    # It knows what it is of, which figures ask it for.
    assert envelope.quantity == "velocity" and iwan.envelope(x[:8192], dt=1 / 2048).quantity == "acceleration"


def test_lists_of_tables_are_records_and_not_channels() -> None:
    t, x = _decays()
    one, other = x[:8192], x[8192:]
    tables = [pandas.Series(x, index=pandas.Index(t, name="time [s]"), name="acc") for x in (one, other)]
    assert len(several(tables)) == len(several([one, other])) == 2
    assert len(several([pandas.Series(one), other])) == 2
    assert len(several([{"time": t, "acc": one}, {"time": t, "acc": other}])) == 2
    assert len(several([list(one), list(other)])) == 1


def test_records_in_different_units_are_not_fitted_together() -> None:
    _, x = _decays()
    records = [iwan.Record(x[:8192], dt=1 / 2048, quantity="acceleration", unit=unit) for unit in ("g", "m/s^2")]
    with pytest.raises(iwan.InvalidValueError, match='acceleration in "g" and acceleration in "m/s\\^2"'):
        iwan.fit(records)


def test_what_a_shakers_test_has_no_use_for_is_refused(mode: iwan.Mode) -> None:
    shaker = iwan.frf(mode, band=(112.0, 128.0), force=[1.0], points=20)
    for given, said in [({"band": (900.0, 10.0)}, "band"), ({"method": "typo"}, "method"), ({"force_axis": "joint"}, "force_axis")]:
        with pytest.raises(iwan.InvalidValueError, match=said):
            iwan.fit(sweeps=[shaker], **given)  # type: ignore[call-overload]
