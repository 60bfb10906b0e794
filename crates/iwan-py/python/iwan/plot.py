"""Figures with matplotlib (extra `iwan-ringdown[plot]`): the paper's, and those that show what a record tells.

Each function draws into `ax`, or into axes of its own when there are none, and returns them; title, limits and the rest are
yours. Frequencies are in Hz, damping ratios in per cent on the axis, everything else in your own consistent set of units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from iwan._arguments import by_name, chosen, instance, items
from iwan._axes import axes
from iwan._native import Envelope, FourParameter, Joint, Mode, Record, Response, _numbers
from iwan._shapes import mode_shape, mode_shapes
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.steady import Backbone, SteadyResponse
from iwan.types import Array, History

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from iwan.identification import Fit
    from iwan.updating import StructureUpdate

__all__ = [
    "backbone",
    "damping",
    "density",
    "dissipation",
    "fitted",
    "frequency",
    "frf",
    "hysteresis",
    "mode_shape",
    "mode_shapes",
    "profile",
    "ring_down",
    "updated",
]

_MEASURED: dict[str, Any] = {"marker": ".", "markersize": 4, "linestyle": "none"}
_MODEL: dict[str, Any] = {"color": "black", "linewidth": 1.0}
# Standard deviations on each side of a value within which 95 % of a normal distribution lie.
_WITHIN = 1.96
_POWERS = {"acceleration": 2, "velocity": 1, "displacement": 0}

Envelopes: TypeAlias = Envelope | Mapping[str, Envelope] | None


def _readable(ax: Axes) -> None:
    """Plain ticks on logarithmic axes that cover about a decade: powers of ten would label one of them, or overlap."""
    from matplotlib.ticker import MaxNLocator, NullFormatter, ScalarFormatter

    for axis, scale, (low, high) in [(ax.xaxis, ax.get_xscale(), ax.get_xlim()), (ax.yaxis, ax.get_yscale(), ax.get_ylim())]:
        if scale == "log" and high < 30 * low:
            axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
            axis.set_major_formatter(ScalarFormatter())
            axis.set_minor_formatter(NullFormatter())


def ring_down(
    response: Response | Record,
    *,
    quantity: History = "displacement",
    channel: str | int | None = None,
    envelope: Envelope | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a ring-down against time, with its envelope.

    `response`: a `Response`, of which `quantity` is drawn, or a `Record`, of which `channel` is; `envelope`: drawn as a line
    above and below, where it can be trusted.

    >>> response = iwan.simulate(iwan.Mode(frequency=10.0, damping_ratio=0.01), dt=1e-3, duration=2.0, initial=(1.0, 0.0))
    >>> iwan.plot.ring_down(response).get_xlabel()
    'time (s)'
    """
    ax = axes(ax)
    if isinstance(response, Record):
        label = response.quantity if response.quantity != "unknown" else "record"
        if response.unit:
            label += f" ({response.unit})"
        values = response.channel(channel)
    elif isinstance(response, Response):
        name = chosen("quantity", quantity, ("displacement", "velocity", "acceleration", "joint_force"))
        label, values = name.replace("_", " "), getattr(response, name)
    else:
        raise InvalidTypeError(f"response must be an iwan.Response or an iwan.Record, not {type(response).__name__}")
    ax.plot(response.t, values, linewidth=0.6)
    if envelope is not None:
        instance("envelope", envelope, Envelope)
        for sign in (1, -1):
            ax.plot(envelope.t, sign * envelope.amplitude, color="C1", linewidth=1.2)
    ax.set(xlabel="time (s)", ylabel=label)
    return ax


def hysteresis(
    response: Response | tuple[ArrayLike, ArrayLike], *, joint: Joint | None = None, ax: Axes | None = None
) -> Axes:
    """Draw joint force against displacement: hysteresis loops.

    `response`: a `Response`, or displacements and forces (`Joint.force_history`) of equal length; `joint`: its virgin curve is
    drawn too, in both directions.

    >>> import numpy as np
    >>> joint = iwan.FourParameter(k_t=2.75e5, f_s=300.0, chi=-0.3, beta=0.02)
    >>> u = joint.phi_max * np.sin(np.linspace(0.0, 15.0, 1000))
    >>> iwan.plot.hysteresis((u, joint.force_history(u)), joint=joint).get_ylabel()
    'joint force'
    """
    ax = axes(ax)
    if isinstance(response, Response):
        u, force = response.displacement, response.joint_force
    else:
        pair = items("response", response)
        if len(pair) != 2:
            raise InvalidValueError(f"response has {len(pair)} parts: give an iwan.Response, or displacements and forces")
        u, force = (_numbers(name, values) for name, values in zip(("displacements", "forces"), pair, strict=True))
        if u.shape != force.shape:
            raise InvalidValueError(f"displacements have the shape {u.shape}, forces {force.shape}: they must agree")
    ax.plot(u, force, linewidth=0.7)
    if joint is not None:
        instance("joint", joint, Joint)
        most = float(np.abs(u).max(initial=0.0))
        virgin = np.linspace(-most, most, 401)
        ax.plot(virgin, joint.force(virgin), linestyle="--", label="virgin curve", **_MODEL)
        ax.legend()
    ax.set(xlabel="displacement", ylabel="joint force")
    return ax


def _named(envelopes: Envelopes) -> list[tuple[str, Envelope]]:
    return [] if envelopes is None else list(by_name("envelopes", envelopes, Envelope, "measured").items())


def _displacement(envelope: Envelope, quantity: str | None) -> Array:
    """Amplitude of displacement: A, A/omega or A/omega^2 (Sec. 2.3)."""
    quantity = chosen("quantity", envelope.quantity if quantity is None else quantity, list(_POWERS))
    return np.asarray(envelope.amplitude / (2 * np.pi * envelope.frequency) ** _POWERS[quantity])


def _amplitudes(envelopes: Sequence[tuple[str, Envelope]], quantity: str | None, modes: Sequence[Mode]) -> Array:
    """Where to draw the modes: over the measured range, or four decades about the onset of macro-slip."""
    seen = [_displacement(envelope, quantity) for _, envelope in envelopes]
    if seen:
        return np.geomspace(min(a.min() for a in seen), max(a.max() for a in seen), 201)
    ends = [mode.joint.phi_max for mode in modes if mode.joint is not None]
    if not ends:
        raise InvalidValueError("there is nothing to draw: give envelopes, or a mode with a joint")
    return np.geomspace(1e-3 * min(ends), 10 * max(ends), 201)


def _band(ax: Axes, x: Array, values: Array, half_width: Array, color: Any) -> None:
    """Shade a band about values. Axes are not widened for it: where an envelope has sunk into noise the band is wider than all that it tells."""
    from matplotlib.collections import PolyCollection

    outline = np.concatenate([np.column_stack([x, values + half_width]), np.column_stack([x, values - half_width])[::-1]])
    ax.add_collection(PolyCollection([outline], facecolor=color, edgecolor="none", alpha=0.25), autolim=False)


def _against_amplitude(
    envelopes: Envelopes, mode: Mode | Mapping[str, Mode] | None, quantity: str | None, name: str, scale: float, ax: Axes
) -> Axes:
    named = _named(envelopes)
    modes = {} if mode is None else by_name("mode", mode, Mode, "model")
    for label, envelope in named:
        amplitude, values = _displacement(envelope, quantity), scale * getattr(envelope, name)
        (line,) = ax.plot(amplitude, values, label=label, **_MEASURED)
        _band(ax, amplitude, values, _WITHIN * scale * getattr(envelope, f"{name}_sd"), line.get_color())
    amplitude = _amplitudes(named, quantity, list(modes.values()))
    for style, (label, one) in zip(("-", "--", ":", "-.") * len(modes), modes.items(), strict=False):
        values = scale * (one.frequency_at(amplitude) if name == "frequency" else one.damping_ratio_at(amplitude))
        ax.plot(amplitude, values, label=label, linestyle=style, **_MODEL)
    ax.set(xscale="log", xlabel="displacement amplitude")
    if len(named) + len(modes) > 1:
        ax.legend()
    return ax


def frequency(
    envelopes: Envelopes = None,
    *,
    mode: Mode | Mapping[str, Mode] | None = None,
    quantity: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw frequency against the amplitude of displacement.

    `envelopes`: one `Envelope` or several by name, each with a 95 % band by its standard deviations; `quantity`: what their
    amplitudes are of ("acceleration", "velocity", "displacement"), None: what each says itself; `mode`: one `Mode` or several by
    name, drawn by first-harmonic balance. One of the two is enough.

    >>> mode = iwan.Mode(frequency=124.0, joint=iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3))
    >>> iwan.plot.frequency(mode=mode).get_ylabel()
    'frequency (Hz)'
    """
    ax = _against_amplitude(envelopes, mode, quantity, "frequency", 1.0, axes(ax))
    ax.set(ylabel="frequency (Hz)")
    _readable(ax)
    return ax


def damping(
    envelopes: Envelopes = None,
    *,
    mode: Mode | Mapping[str, Mode] | None = None,
    quantity: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the damping ratio, in per cent, against the amplitude of displacement; arguments as in `frequency`.

    >>> mode = iwan.Mode(frequency=124.0, joint=iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3))
    >>> iwan.plot.damping(mode=mode).get_yscale()
    'log'
    """
    ax = _against_amplitude(envelopes, mode, quantity, "damping_ratio", 100.0, axes(ax))
    ax.set(yscale="log", ylabel="damping ratio (%)")
    _readable(ax)
    return ax


def dissipation(
    joint: Joint | Mapping[str, Joint],
    *,
    against: Literal["force", "displacement"] = "force",
    printed: bool = False,
    ax: Axes | None = None,
) -> Axes:
    """Draw the energy dissipated per cycle against the amplitude of the joint's force or displacement.

    `joint`: one `Joint` or several by name, from a thousandth of phi_max to ten times phi_max; dots mark the onset of
    macro-slip, where the force stands still. `printed`: also Eq. 17 as printed, 4 q F_S, for four-parameter joints (dashed).

    >>> joint = iwan.FourParameter(k_t=2.75e5, f_s=300.0, chi=-0.3, beta=0.02)
    >>> iwan.plot.dissipation(joint).get_xlabel()
    'joint force'
    """
    ax = axes(ax)
    joints = by_name("joint", joint, Joint, "")
    for i, (label, one) in enumerate(joints.items()):
        u = np.geomspace(max(1e-3 * one.phi_max, 1.001 * one.phi_min), 10 * one.phi_max, 401)
        x = one.force if chosen("against", against, ("force", "displacement")) == "force" else np.asarray
        ax.plot(x(u), one.dissipation(u), color=f"C{i}", label=label)
        ax.plot(x(one.phi_max), one.dissipation(one.phi_max), marker="o", markersize=4, color=f"C{i}")
        if printed and isinstance(one, FourParameter):
            slipping = u[u >= one.phi_max]
            ax.plot(x(slipping), one.dissipation_printed_eq17(slipping), color=f"C{i}", linestyle="--")
    label = "joint force" if against == "force" else "displacement amplitude"
    ax.set(xscale="log", yscale="log", xlabel=label, ylabel="dissipation per cycle")
    if any(joints):
        ax.legend()
    return ax


def fitted(
    fit: Fit, *, show: Literal["dissipation", "frequency", "damping_ratio"] = "dissipation", ax: Axes | None = None
) -> Axes:
    """Draw what a fit compares: measured curves with their 95 % band against the fit's force, and the model's through them.

    `show`: dissipation per cycle (the paper's Fig. 6 and 7), frequency, or damping ratio. One colour for each record.

    Example: that of `examples/2_fit_of_a_record.py`.
    """
    chosen("show", show, ("dissipation", "frequency", "damping_ratio"))
    ax = axes(ax)
    scale = 100.0 if show == "damping_ratio" else 1.0
    for number in np.unique(fit.curves["record"]):
        mine = {key: values[fit.curves["record"] == number] for key, values in fit.curves.items()}
        model = {key: values[fit.model_curves["record"] == number] for key, values in fit.model_curves.items()}
        color, label = f"C{int(number)}", f"record {int(number)}"
        force, values = mine["force"], scale * mine[show]
        if show == "frequency":
            low, high = values - _WITHIN * mine["frequency_sd"], values + _WITHIN * mine["frequency_sd"]
        else:
            low, high = (values * np.exp(sign * _WITHIN * mine["log_dissipation_sd"]) for sign in (-1, 1))
        ax.fill_between(force, low, high, color=color, alpha=0.25, linewidth=0.0)
        ax.plot(force, values, color=color, label=label, **_MEASURED)
        ax.plot(model["force"], scale * model[show], **_MODEL)
    names = {"dissipation": "dissipation per cycle", "frequency": "frequency (Hz)", "damping_ratio": "damping ratio (%)"}
    ax.set(xscale="log", xlabel=f"{fit.force_axis} force", ylabel=names[show])
    if show != "frequency":
        ax.set(yscale="log")
    if len(fit.envelopes) > 1:
        ax.legend()
    _readable(ax)
    return ax


def updated(
    found: StructureUpdate, *, show: Literal["frequency", "damping_ratio"] = "damping_ratio", ax: Axes | None = None
) -> Axes:
    """Draw what `iwan.update` compares: measured curves (dots), the structure as given (dashed) and with the joints found (line, with the 95 %
    band of what the curves leave open). One colour for each curve; curves that were kept out are labelled as predicted.

    `show`: damping ratio or frequency. Frequencies are drawn over the first measured one, because modes lie far apart.

    >>> beam = iwan.Structure.built_in("paper-a")
    >>> found = iwan.update(beam, {"bending 1": beam.quasi_static("bending 1", points=12)}, undamped=True)
    >>> iwan.plot.updated(found).get_ylabel()
    'damping ratio (%)'
    """
    chosen("show", show, ("frequency", "damping_ratio"))
    ax = axes(ax)
    for i, curve in enumerate(found.curves):
        color, q = f"C{i}", curve.displacement
        label = f"{curve.mode} (predicted)" if curve.held_out else curve.mode
        if show == "damping_ratio":
            scale, after, half = 100.0, curve.damping_ratio_after, np.exp(_WITHIN * curve.log_damping_sd)
            low, high = after / half, after * half
            measured, before = curve.damping_ratio, curve.damping_ratio_before
        else:
            scale, after, half = 1.0 / float(np.max(curve.frequency)), curve.frequency_after, _WITHIN * curve.frequency_sd
            low, high = after - half, after + half
            measured, before = curve.frequency, curve.frequency_before
        ax.fill_between(q, scale * low, scale * high, color=color, alpha=0.25, linewidth=0.0)
        ax.plot(q, scale * measured, color=color, label=label, **_MEASURED)
        if before.size:
            ax.plot(q, scale * before, color=color, linestyle="--", linewidth=1.0)
        ax.plot(q, scale * after, color=color, linewidth=1.0)
    label = "damping ratio (%)" if show == "damping_ratio" else "frequency over the highest measured"
    ax.set(xscale="log", xlabel="modal displacement", ylabel=label)
    if show == "damping_ratio":
        ax.set(yscale="log")
    ax.legend()
    _readable(ax)
    return ax


def profile(fit: Fit, parameter: str, *, ax: Axes | None = None) -> Axes:
    """Draw the profile likelihood of a parameter of a fit: the deviance against its values, the 95 % limit, and the ends of
    the interval. Where the curve never crosses the limit, the records do not bound the parameter on that side.

    Example: that of `examples/3_uncertainty.py`.
    """
    chosen("parameter", parameter, list(fit.profiles))
    ax = axes(ax)
    values, deviance = fit.profiles[parameter]
    ax.plot(values, deviance, marker=".", markersize=4, linewidth=1.0)
    ax.axhline(fit.limit, linestyle="--", label="95 %", **_MODEL)
    ax.plot(fit.parameters[parameter], 0.0, marker="o", color="black", markersize=4)
    for end in fit.intervals[parameter]:
        if end is not None:
            ax.axvline(end, color="grey", linewidth=0.8, linestyle=":")
    if len(values) > 0 and values.min() > 0 and values.max() > 20 * values.min():
        ax.set(xscale="log")
    ax.set(xlabel=parameter, ylabel="deviance", ylim=(-0.15 * fit.limit, 3 * fit.limit))
    ax.legend()
    return ax


def density(joint: Joint | Mapping[str, Joint], *, ax: Axes | None = None) -> Axes:
    """Draw the density of slider strengths; the sliders at the largest strength stand at its end as a line with their
    stiffness beside it.

    `joint`: one `Joint` or several by name.

    >>> iwan.plot.density(iwan.Uniform(k_t=1000.0, f_s=5.0, width=0.5)).get_xlabel()
    'slider strength'
    """
    ax = axes(ax)
    joints = by_name("joint", joint, Joint, "")
    for i, (label, one) in enumerate(joints.items()):
        phi = np.geomspace(max(one.phi_min, 1e-4 * one.phi_max), one.phi_max, 401)
        values = one.density(phi)
        drawn = values > 0
        ax.plot(phi[drawn], values[drawn], color=f"C{i}", label=label)
        if one.dirac > 0:
            foot = values[drawn].min() if drawn.any() else one.dirac / one.phi_max
            ax.plot([one.phi_max] * 2, [foot, 30 * foot], color=f"C{i}", marker="^", markevery=[1], linewidth=1.5)
            text = f"{one.dirac:.3g}"
            ax.annotate(text, (one.phi_max, 30 * foot), (-4, 4), textcoords="offset points", ha="right", color=f"C{i}")
    ax.margins(y=0.12)
    ax.set(xscale="log", yscale="log", xlabel="slider strength", ylabel="density (stiffness/length)")
    if any(joints):
        ax.legend()
    return ax


def frf(
    curves: SteadyResponse | Sequence[SteadyResponse],
    *,
    show: Literal["amplitude", "phase", "excitation", "receptance", "harmonics"] = "amplitude",
    backbone: Backbone | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw steady forced responses over frequency, one line for each level.

    `show`: amplitude of the response; its phase in degrees; the excitation that holds it; amplitude over excitation ("receptance");
    or the higher harmonics. Circles: frequencies at which a measured response jumps, on harmonics their own resonances. `backbone`: drawn
    through the amplitudes (dashed).

    >>> mode = iwan.Mode(frequency=124.0, joint=iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3))
    >>> iwan.plot.frf(iwan.frf(mode, band=(112.0, 128.0), force=[1.0, 100.0])).get_ylabel()
    'amplitude'
    """
    chosen("show", show, ("amplitude", "phase", "excitation", "receptance", "harmonics"))
    several = [curves] if isinstance(curves, SteadyResponse) else items("curves", curves)
    for i, curve in enumerate(several):
        instance(f"curves[{i}]", curve, SteadyResponse)
    ax = axes(ax)
    for i, curve in enumerate(several):
        label, color = f"{curve.control.replace('_', ' ')} {curve.level:.4g}", f"C{i % 10}"
        marked: list[tuple[float, float]] = []
        if show == "harmonics":
            for n, (amplitude, _) in curve.harmonics.items():
                ax.plot(curve.frequency, amplitude, color=color, alpha=3 / n, label=f"{label}, harmonic {n}", linewidth=1.0)
            marked = [(frequency, amplitude) for _, frequency, amplitude in curve.superharmonics]
        else:
            of = {
                "amplitude": curve.amplitude,
                "phase": np.degrees(curve.phase),
                "excitation": curve.excitation,
                "receptance": curve.amplitude / curve.excitation,
            }
            ax.plot(curve.frequency, of[show], color=color, label=label, linewidth=1.0)
            marked = list(curve.jumps) if show == "amplitude" else []
        if marked:
            ax.plot(*zip(*marked, strict=True), linestyle="none", marker="o", markersize=4, fillstyle="none", color=color)
    if backbone is not None:
        instance("backbone", backbone, Backbone)
    if backbone is not None and show == "amplitude":
        ax.plot(backbone.frequency, backbone.response, linestyle="--", label="backbone", **_MODEL)
    ax.set(xlabel="frequency (Hz)", ylabel="phase (deg)" if show == "phase" else show)
    if show != "phase":
        ax.set(yscale="log")
    ax.legend()
    return ax


def backbone(
    curves: Backbone | Mapping[str, Backbone],
    *,
    show: Literal["frequency", "damping_ratio", "harmonics", "slips"] = "frequency",
    ax: Axes | None = None,
) -> Axes:
    """Draw nonlinear modes against the modal amplitude: frequency, damping ratio in per cent, the higher harmonics over the response's first, or
    the slips of the joints over the amplitude, which stay level where the mode does not change its shape.

    `curves`: one `Backbone` or several by name.

    >>> mode = iwan.Mode(frequency=124.0, joint=iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3))
    >>> iwan.plot.backbone(iwan.backbone(mode, amplitude=[1e-4, 1e-3, 1e-2]), show="damping_ratio").get_ylabel()
    'damping ratio (%)'
    """
    chosen("show", show, ("frequency", "damping_ratio", "harmonics", "slips"))
    named = by_name("curves", curves, Backbone, "")
    ax = axes(ax)
    for label, curve in named.items():
        of: Mapping[str, Array] = {
            "frequency": {label: curve.frequency},
            "damping_ratio": {label: 100.0 * curve.damping_ratio},
            "harmonics": {f"{label} {n}".strip(): a / curve.response for n, a in curve.harmonics.items()},
            "slips": {f"{label} {name}".strip(): slip / curve.amplitude for name, slip in curve.slips.items()},
        }[show]
        for name, values in of.items():
            ax.plot(curve.amplitude, values, label=name, linewidth=1.0)
    words = {
        "frequency": "frequency (Hz)",
        "damping_ratio": "damping ratio (%)",
        "harmonics": "harmonic / first harmonic",
        "slips": "slip / amplitude",
    }
    ax.set(xscale="log", xlabel="modal amplitude", ylabel=words[show])
    if show != "frequency":
        ax.set(yscale="log")
    if any(ax.get_legend_handles_labels()[1]):
        ax.legend()
    _readable(ax)
    return ax
