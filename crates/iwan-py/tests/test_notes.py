"""What disturbs records is said by fits of several modes and by fits beside a shaker's test, too."""

import numpy as np

import iwan


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
