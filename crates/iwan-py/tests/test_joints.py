"""Joint laws: golden numbers, laws of the model, and every kind of array at the door."""

import numpy as np
import pytest

import iwan

# 40-digit arithmetic, rounded: K_T, F_S, chi, beta, phi_max, R, S, D(phi_max).
GOLDEN = [
    (2.75e5, 300, -0.3, 0.02, 0.002577161258360168, 12247048.73944549, 5392.156862745098, 1.092348096186569),
    (4.45e4, 239.4, -0.183, 0.3, 0.009329393723670242, 1274290.571068603, 10269.23076923077, 1.902233281315488),
    (2.0e4, 1.0e5, -0.999, 3.0, 6.664447403462051, 4.990525053618572, 15000.0, 443.4831454753349),
    (8.73e5, 534.6, -0.048, 0.38, 0.0009739165324363437, 443301714.5175033, 240391.3043478261, 0.3965330649073753),
]

LAWS = [
    iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3),
    iwan.Jenkins(k_t=1000.0, f_s=5.0),
    iwan.Uniform(k_t=1000.0, f_s=5.0, width=0.4),
    iwan.Tabulated(strength=[0.0, 0.002, 0.01], density=[1e5, 3e5, 2e5], dirac=70.0),
]


@pytest.mark.parametrize(("k_t", "f_s", "chi", "beta", "phi_max", "r", "s", "lost"), GOLDEN)
def test_golden_numbers(k_t, f_s, chi, beta, phi_max, r, s, lost):
    joint = iwan.FourParameter(k_t=k_t, f_s=f_s, chi=chi, beta=beta)
    found = [joint.phi_max, joint.r, joint.s, joint.dissipation(joint.phi_max)]
    np.testing.assert_allclose(found, [phi_max, r, s, lost], rtol=2e-13)
    back = iwan.FourParameter.from_density(r=joint.r, chi=joint.chi, phi_max=joint.phi_max, s=joint.s)
    np.testing.assert_allclose([back.k_t, back.f_s, back.beta], [k_t, f_s, beta], rtol=1e-11)


@pytest.mark.parametrize("joint", LAWS)
def test_the_density_is_what_the_stiffness_loses(joint):
    """rho = -dK/du between the weakest and the strongest slider, and the Dirac is what is left at the end."""
    edges = np.linspace(joint.phi_min + 1e-3 * joint.phi_max, (1 - 1e-9) * joint.phi_max, 20_001)
    if joint.phi_min < joint.phi_max:
        lost = -np.diff(joint.tangent(edges))
        middle = (edges[1:] + edges[:-1]) / 2
        np.testing.assert_allclose(joint.density(middle) * np.diff(edges), lost, rtol=1e-3, atol=1e-9 * joint.k_t)
    assert joint.dirac == pytest.approx(joint.tangent((1 - 1e-9) * joint.phi_max), abs=1e-6 * joint.k_t)
    assert joint.density(1.01 * joint.phi_max) == 0.0


@pytest.mark.parametrize("joint", LAWS)
def test_force_is_odd_and_the_rest_is_even(joint):
    u = np.linspace(0.0, 1.5 * joint.phi_max, 37)[1:]
    np.testing.assert_array_equal(joint.force(-u), -joint.force(u))
    for name in ["tangent", "secant", "harmonic_stiffness", "dissipation", "energy"]:
        np.testing.assert_array_equal(getattr(joint, name)(-u), getattr(joint, name)(u), err_msg=name)
    np.testing.assert_allclose(joint.secant(u) * u, joint.force(u), rtol=1e-15)


@pytest.mark.parametrize("joint", LAWS)
def test_masing_holds_for_the_history(joint):
    top = 0.8 * joint.phi_max
    u = np.concatenate([np.linspace(0, top, 50), np.linspace(top, -top, 99)[1:]])
    force = joint.force_history(u)
    np.testing.assert_allclose(force[:50], joint.force(u[:50]), rtol=1e-13)
    unloading = joint.force(top) - 2 * joint.force((top - u[50:]) / 2)
    np.testing.assert_allclose(force[50:], unloading, rtol=1e-11, atol=1e-11 * joint.f_s)


@pytest.mark.parametrize("joint", LAWS)
def test_sliders_are_the_plain_loop_over_their_elements(joint):
    strength, stiffness = joint.discretise(50)
    rng = np.random.default_rng(5)
    u = np.cumsum(rng.normal(scale=0.3 * joint.phi_max, size=400))
    extension, expected = np.zeros_like(strength), []
    for du in np.diff(u, prepend=0.0):
        extension = np.clip(extension + du, -strength, strength)
        expected.append(stiffness @ extension)
    np.testing.assert_allclose(joint.force_history(u, sliders=50), expected, rtol=0, atol=1e-12 * joint.f_s)


def test_grids_are_what_they_say(joint):
    strength, _ = joint.discretise(10, grid="uniform")
    assert np.all(np.diff(strength[:-1]) < 0.2 * joint.phi_max)
    strength, _ = joint.discretise(100, grid=1.08)
    np.testing.assert_allclose(strength[60:99] / strength[59:98], 1.08, rtol=1e-9)
    for grid in ["coarse", 1.0, np.nan, None.__class__]:
        with pytest.raises(iwan.IwanError):
            joint.discretise(10, grid=grid)
    with pytest.raises(iwan.InvalidValueError, match="sliders = 0"):
        joint.force_history([0.0], sliders=0)


def test_every_layout_and_dtype_gives_the_same(joint):
    u = np.linspace(-0.01, 0.01, 24).reshape(4, 6)
    expected = joint.force(u)
    assert expected.shape == (4, 6) and expected.dtype == np.float64
    read_only = u.copy()
    read_only.setflags(write=False)
    swapped = u.astype(">f8")
    wide = np.zeros((8, 12))
    wide[::2, ::-2] = u
    packed = np.zeros((4, 6), dtype=[("flag", "u1"), ("u", "f8")])
    packed["u"] = u
    received = np.frombuffer(b"x" + u.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(4, 6)
    assert not packed["u"].flags.aligned and not received.flags.aligned
    layouts = [packed["u"], received, np.broadcast_to(u, (4, 6)), np.asfortranarray(u), read_only, swapped, wide[::2, ::-2], u.tolist(), u.astype(np.longdouble)]
    for same in layouts:
        np.testing.assert_array_equal(joint.force(same), expected)
    np.testing.assert_array_equal(joint.force(u.T), expected.T)
    single = u.astype(np.float32)
    np.testing.assert_array_equal(joint.force(single), joint.force(single.astype(np.float64)))
    np.testing.assert_array_equal(iwan.Jenkins(k_t=2.0, f_s=9.0).force(np.arange(3)), [0.0, 2.0, 4.0])
    np.testing.assert_array_equal(u, np.linspace(-0.01, 0.01, 24).reshape(4, 6))


def test_scalars_and_empty_arrays(joint):
    for scalar in [0.001, np.float64(0.001), np.array(0.001), 1, np.int32(1)]:
        assert type(joint.force(scalar)) is float
    for shape in [(0,), (3, 0), (0, 2)]:
        assert joint.force(np.empty(shape)).shape == shape
    assert joint.force([]).shape == (0,)
    assert joint.force_history([]).shape == (0,)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_refused_with_its_place(joint, bad):
    u = np.zeros((2, 3))
    u[1, 2] = bad
    with pytest.raises(iwan.InvalidValueError, match=r"u\[1, 2\]"):
        joint.force(u)
    with pytest.raises(ValueError, match=r"u\[3\]"):
        joint.force_history([0.0, 1.0, 2.0, bad])
    with pytest.raises(iwan.IwanError):
        joint.dissipation(bad)


@pytest.mark.parametrize("bad", [1j, np.array([1j]), "text", object(), [[1.0], [1.0, 2.0]], np.array(["1"]), {"u": 1}])
def test_what_holds_no_real_numbers_is_refused(joint, bad):
    with pytest.raises(iwan.InvalidTypeError, match="u must hold real numbers") as caught:
        joint.force(bad)
    assert isinstance(caught.value, TypeError)


@pytest.mark.parametrize(
    ("make", "names"),
    [
        (lambda: iwan.FourParameter(k_t=-1.0, f_s=1.0, chi=0.0, beta=0.0), "k_t = -1"),
        (lambda: iwan.FourParameter(k_t=1.0, f_s=np.nan, chi=0.0, beta=0.0), "f_s = NaN"),
        (lambda: iwan.FourParameter(k_t=1.0, f_s=1.0, chi=-1.0, beta=0.0), "-1 < chi <= 1"),
        (lambda: iwan.FourParameter.from_density(r=1.0, chi=0.0, phi_max=0.0, s=0.0), "phi_max = 0"),
        (lambda: iwan.FiveParameter(k_t=1.0, f_s=1.0, chi=0.0, beta=0.0, theta=1.1), "0 < theta <= 1"),
        (lambda: iwan.Jenkins(k_t=1.0, f_s=np.inf), "f_s = inf"),
        (lambda: iwan.Uniform(k_t=1.0, f_s=1.0, width=1.5), "0 < width <= 1"),
        (lambda: iwan.Tabulated(strength=[0.0, 0.0], density=[1.0, 1.0]), r"strength\[1\] = 0"),
        (lambda: iwan.Tabulated(strength=[0.0, 1.0], density=[1.0]), "density has 1 entries"),
        (lambda: iwan.FourParameter(k_t=1.0, f_s=1.0, chi=0.0, beta=0.0).density(-1.0), "phi = -1"),
    ],
)
def test_bad_values_are_named(make, names):
    with pytest.raises(iwan.InvalidValueError, match=names) as caught:
        make()
    assert isinstance(caught.value, iwan.IwanError) and isinstance(caught.value, ValueError)


def test_joints_are_frozen_and_keyword_only(joint):
    with pytest.raises(AttributeError):
        joint.k_t = 1.0
    with pytest.raises(AttributeError):
        joint.other = 1.0
    with pytest.raises(TypeError):
        iwan.FourParameter(4.45e4, 239.4, -0.183, 0.3)
    with pytest.raises(TypeError):
        iwan.Joint()


def test_a_joint_whose_friction_drops():
    four = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    same, drops = (iwan.FiveParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3, theta=theta) for theta in (1.0, 0.6))
    u = np.linspace(0.05, 2.0, 9) * four.phi_max
    for name in ["force", "tangent", "energy", "dissipation", "harmonic_stiffness"]:
        np.testing.assert_allclose(getattr(same, name)(u), getattr(four, name)(u), rtol=1e-11, atol=1e-9, err_msg=name)
    # Loops of sliders: driven from rest up to an amplitude, and down to it from twice that.
    top = 0.4 * four.phi_max
    turn = np.linspace(0.0, 2 * np.pi, 4001)
    rise, decay = np.linspace(0.0, top, 500), np.linspace(2.0, 1.0, 60)
    loud = np.concatenate([a * top * np.cos(turn) for a in decay])
    for before, lost, stiffness in [
        (rise, drops.dissipation(top), drops.harmonic_stiffness(top)),
        (loud, drops.dissipation_in_decay(top), drops.harmonic_stiffness_in_decay(top)),
    ]:
        history = np.concatenate([before, *(top * np.cos(turn[1:]) for _ in range(2))])
        force = drops.force_history(history, sliders=2000)[-4001:]
        path = top * np.cos(turn)
        assert np.trapezoid(force, path) == pytest.approx(lost, rel=0.01)
        assert 2 * np.mean(force[1:] * np.cos(turn[1:])) / top == pytest.approx(stiffness, rel=1e-3)
    with pytest.raises(iwan.IwanError, match="Masing"):
        drops.force_history(u)
    with pytest.raises(iwan.InvalidValueError, match="largest = -1"):
        drops.dissipation_in_decay(u, largest=-1.0)


def test_a_mode_whose_friction_drops_is_stepped_and_averaged():
    joint = iwan.FiveParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3, theta=0.7)
    mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=2.5e-4)
    blow = iwan.Haversine(amplitude=300.0, duration=1.6e-3)
    stepped, averaged = (iwan.simulate(mode, force=blow, dt=2e-5, duration=0.3, method=m) for m in ("newmark", "averaging"))
    assert stepped.energy_error < 1e-10
    peak = np.abs(stepped.displacement).max()
    assert np.abs(stepped.displacement - averaged.displacement).max() < 0.05 * peak
    for method in ("half-cycle", "event"):
        with pytest.raises(iwan.IwanError, match="theta < 1"):
            iwan.simulate(mode, force=blow, dt=2e-5, duration=0.3, method=method)
