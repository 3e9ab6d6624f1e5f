"""Figures, in matplotlib. Axis labels contain units; colour-blind readers can distinguish the colours."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from mbk import _errors, _tables

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure

BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#009E73", "#8E5A9B", "#666666"
COLOURS = (BLUE, ORANGE, GREEN, PURPLE)
MATRIX_COLOURS = {"inertia": PURPLE, "damping": GREEN, "stiffness": BLUE}


def figure(rows: int, columns: int = 1, *, into: Any = None, width: float = 7.0, height: float = 2.4,
           **more: Any) -> Any:
    """A new figure and its axes, or the given axes, row by row, and the figure that they are in."""
    if into is not None:
        given = list(np.atleast_1d(np.asarray(into, dtype=object)).flat)
        if len(given) != rows * columns:
            raise _errors.usage(f"this plot needs {rows * columns} axes, not {len(given)}",
                                f"give axes of plt.subplots({rows}, {columns})")
        axes = np.empty((rows, columns), dtype=object)
        axes.flat[:] = given
        return given[0].figure, axes
    import matplotlib.pyplot as plt

    made, axes = plt.subplots(rows, columns, figsize=(width, height * rows), squeeze=False, layout="constrained", **more)
    for one in axes.flat:
        one.spines[["top", "right"]].set_visible(False)
    return made, axes


def shaded(axes: matplotlib.axes.Axes, x: Any, low: Any, high: Any, colour: str, label: str | None = None) -> None:
    axes.fill_between(x, numbers(low), numbers(high), color=colour, alpha=0.2, linewidth=0, label=label)


def title(panel: matplotlib.axes.Axes, text: str, into: Any, **more: Any) -> None:
    """Axes that the caller made have captions of the caller's."""
    if into is None:
        panel.set_title(text, **more)


def numbers(values: Any) -> Any:
    return np.array([math.nan if value is None else value for value in values], dtype=float)


def logarithmic(axis: Any) -> None:
    """A logarithmic axis with plain numbers, so that a range below a decade has labels too."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    decades = math.log10(high / low) if low > 0 else 9.0
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if decades < 2.5 else (1.0,)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def unit_text(unit: str) -> str:
    return f" [{_tables.unit_as_read(unit)}]" if unit else ""


# ---- recordings


# Channels that share a panel: prefix of their names, and title of the panel. Motion has one panel for each axis, with
# its reference, because the positions of the axes differ by more than the motion.
KINDS = (("force_", "force of the hand"), ("reaction", "reaction"), ("acceleration", "acceleration"),
         ("torque_", "torque"), ("voltage", "voltage"), ("velocity", "velocity"))


def panel_of(name: str, unit: str, units: dict[str, str]) -> tuple[str, str]:
    end = name.rsplit("_", 1)[-1]
    if name.startswith("reference"):
        motion = next((one for one in (f"hand_{end}", "position") if units.get(one) == unit), None)
        return (motion.replace("_", " "), unit) if motion else ("reference", unit)
    kind = next((title for start, title in KINDS if name.startswith(start)), name.replace("_", " "))
    return kind, unit


def recording(what: Any, channels: list[str], into: Any = None) -> matplotlib.figure.Figure:
    units = what.units
    groups: dict[tuple[str, str], list[str]] = {}
    for name in sorted(channels, key=lambda one: one.startswith("reference")):  # behind what they are drawn upon
        groups.setdefault(panel_of(name, units.get(name, ""), units), []).append(name)
    made, axes = figure(len(groups), height=1.9, sharex=True, into=into)
    time = what.time
    for panel, ((kind, unit), names) in zip(axes[:, 0], sorted(groups.items())):
        for name, colour in zip(names, COLOURS * 4):
            dashed = name.startswith("reference") and len(names) > 1
            panel.plot(time, what[name], color=colour, linewidth=0.8, linestyle="--" if dashed else "-", label=name)
        panel.set_ylabel(f"{kind}{unit_text(unit)}")
        if len(names) > 1:
            panel.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), frameon=False, ncols=len(names), borderaxespad=0.0)
    axes[-1, 0].set_xlabel("time [s]")
    return made


# ---- results


def outline(ellipse: dict[str, Any]) -> tuple[Any, Any] | None:
    small, large = (math.nan if value is None else value for value in ellipse["eigenvalues"])
    if not (small > 0 and large > 0) or ellipse["orientation_deg"] is None:
        return None
    angle, turn = np.linspace(0.0, 2.0 * np.pi, 181), math.radians(ellipse["orientation_deg"])
    along, across = large * np.cos(angle), small * np.sin(angle)
    return along * math.cos(turn) - across * math.sin(turn), along * math.sin(turn) + across * math.cos(turn)


def shadow(ellipsoid: dict[str, Any], first: int, second: int) -> tuple[Any, Any] | None:
    """Outline of an ellipsoid's projection onto the plane of two axes; nothing if it is not closed."""
    if not ellipsoid["closed"]:
        return None
    symmetric = np.array(ellipsoid["symmetric_part"], float)
    plane = (symmetric @ symmetric)[np.ix_([first, second], [first, second])]
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    points = np.linalg.cholesky(plane) @ np.vstack([np.cos(angle), np.sin(angle)])
    return points[0], points[1]


def ellipsoids(results: list[dict[str, Any]], into: Any = None) -> matplotlib.figure.Figure:
    """Projections of the ellipsoids of M, B and K onto the planes xy, xz and yz, a row for each plane."""
    units = results[0].get("units", _tables.UNITS)
    made, axes = figure(3, 3, width=9.0, height=3.0, into=into)
    for row, (first, second) in enumerate([(0, 1), (0, 2), (1, 2)]):
        for panel, (symbol, name) in zip(axes[row], _tables.MATRICES):
            outlines = [shadow(one["ellipsoids"][name], first, second) for one in results]
            drawn = [points for points in outlines if points is not None]
            for points in drawn:
                panel.plot(*points, color=MATRIX_COLOURS[name], linewidth=1.8 if len(results) == 1 else 1.0)
            if not drawn:
                panel.text(0.5, 0.5, "no ellipsoid:\nnot positive beyond\nits interval", ha="center", va="center",
                           transform=panel.transAxes)
            panel.set_aspect("equal", adjustable="datalim")
            if row == 0:
                title(panel, f"{name} {symbol}", into)
            panel.set_xlabel(f"along {'xyz'[first]}{unit_text(units[symbol])}")
            panel.set_ylabel(f"along {'xyz'[second]}{unit_text(units[symbol])}")
            panel.axhline(0.0, color=GREY, linewidth=0.5)
            panel.axvline(0.0, color=GREY, linewidth=0.5)
    return made


def ellipses(document: Any, into: Any = None) -> matplotlib.figure.Figure:
    values = document._values
    results = [one for one in values.get("results", [values]) if one.get("usable", True)]
    in_space = [one for one in results if "ellipsoids" in one]
    if in_space:
        return ellipsoids(in_space, into)
    with_ellipses = [one for one in results if "ellipses" in one]
    if not with_ellipses:
        return parameters(results or values.get("results", [values]), into)
    units = with_ellipses[0].get("units", _tables.UNITS)
    made, axes = figure(1, 3, width=9.0, height=3.4, into=into)
    for panel, (symbol, name) in zip(axes[0], _tables.MATRICES):
        colour = MATRIX_COLOURS[name]
        largest = 0.0
        for result in with_ellipses:
            one = result["ellipses"][name]
            points = outline(one)
            if points is None:
                continue
            panel.plot(*points, color=colour, linewidth=1.8 if len(with_ellipses) == 1 else 1.0)
            large = one["eigenvalues"][1]
            largest = max(largest, large)
            turn = math.radians(one["orientation_deg"])
            panel.plot([-large * math.cos(turn), large * math.cos(turn)], [-large * math.sin(turn), large * math.sin(turn)],
                       color=colour, linewidth=0.8, linestyle=(0, (4, 3)))
            low, high = one["interval95"]["orientation_deg"]
            if low is not None and high is not None and high - low < 180:  # where the major axis may point
                for half in (0.0, math.pi):
                    arc = np.radians(np.linspace(low, high, 31)) + half
                    panel.fill(np.concatenate([[0.0], large * np.cos(arc)]), np.concatenate([[0.0], large * np.sin(arc)]),
                               color=colour, alpha=0.18, linewidth=0)
        if largest:
            panel.set_xlim(-1.12 * largest, 1.12 * largest)
            panel.set_ylim(-1.12 * largest, 1.12 * largest)
        else:
            panel.text(0.5, 0.5, "no ellipse:\nnot positive definite", ha="center", va="center", transform=panel.transAxes)
        panel.set_aspect("equal")
        title(panel, f"{name} {symbol}", into)
        panel.set_xlabel(f"along x{unit_text(units[symbol])}")
        panel.set_ylabel(f"along y{unit_text(units[symbol])}")
        panel.axhline(0.0, color=GREY, linewidth=0.5)
        panel.axvline(0.0, color=GREY, linewidth=0.5)
    return made


def parameters(results: list[dict[str, Any]], into: Any = None) -> matplotlib.figure.Figure:
    """M, B and K of each recording, entry by entry, with their 95 % intervals."""
    units = results[0].get("units", _tables.UNITS)
    entries = [(result, i, k) for result in results for i in range(result["axes"]) for k in range(result["axes"])]
    names = ["".join(_tables.axis_names(result["axes"])[one] for one in (i, k)) for result, i, k in entries]
    places = np.arange(1, len(entries) + 1)
    made, axes = figure(1, 3, width=8.0, height=2.6, into=into)
    for panel, (symbol, name) in zip(axes[0], _tables.MATRICES):
        values = numbers([result["model"][symbol][i][k] for result, i, k in entries])
        halves = _tables.NORMAL95 * numbers([result["standard_error"][symbol][i][k] for result, i, k in entries])
        panel.errorbar(places, values, yerr=halves, fmt="o", capsize=4, color=MATRIX_COLOURS[name])
        panel.set_xticks(places, names if any(names) else None)
        panel.set_xlim(0.3, len(entries) + 0.7)
        panel.set_xlabel("entry" if any(names) else "recording")
        panel.set_ylabel(f"{name} {symbol}{unit_text(units[symbol])}")
        panel.ticklabel_format(axis="y", useOffset=False)
    usable = all(result.get("usable", True) for result in results)
    if into is None:
        made.suptitle("95 % intervals" if usable else "not usable: do not report these numbers", fontsize="medium")
    elif not usable:
        axes[0, 0].text(0.02, 0.98, "not usable", va="top", transform=axes[0, 0].transAxes)
    return made


def fit(report: dict[str, Any], unit: str, into: Any = None) -> matplotlib.figure.Figure:
    found = report["trials"][0]["diagnostics"]["prediction"]
    count = len(found["measured"])
    made, axes = figure(2 * count, height=1.7, sharex=True, into=into)
    time = numbers(found["time_s"])
    for k in range(count):
        name = " xy"[k + 1] if count > 1 else ""
        above, below = axes[2 * k, 0], axes[2 * k + 1, 0]
        above.plot(time, numbers(found["measured"][k]), color=GREY, linewidth=1.6, label="measured")
        above.plot(time, numbers(found["predicted"][k]), color=ORANGE, linewidth=0.9, label="predicted")
        above.set_ylabel(f"force {name}{unit_text(unit)}".replace("  ", " "))
        below.plot(time, numbers(found["residual"][k]), color=BLUE, linewidth=0.8)
        below.axhline(0.0, color=GREY, linewidth=0.5)
        below.set_ylabel(f"residual {name}{unit_text(unit)}".replace("  ", " "))
        if k == 0:
            above.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), frameon=False, ncols=2, borderaxespad=0.0)
            title(above, "held-out data" if found["held_out"] else "the data to which the model was fitted", into,
                  fontsize="medium", loc="left")
    axes[-1, 0].set_xlabel("time [s]")
    return made


def passivity(document: Any, into: Any = None) -> matplotlib.figure.Figure:
    results = document._values.get("results", [document._values])
    models = [(one, result) for result in results for one in result["passivity"].get("models", []) if "index" in one]
    if len(results) == 1:
        curves = [(one["index"], _tables.METHODS.get(one["method"], one["method"])) for one, _ in models]
    else:  # of each recording the model that it is judged by
        first = {id(result): one for one, result in reversed(models)}
        curves = [(first[id(result)]["index"], _tables.names_of(result)) for result in results if id(result) in first]
    recordings = [(one, _tables.names_of(result)) for result in results for one in result.get("recordings", [])]
    units = results[0].get("units", {})
    made, axes = figure(1 + (1 if recordings else 0), height=2.7, into=into)
    panel = axes[-1, 0]
    for (index, label), colour in zip(curves, itertools.cycle(COLOURS)):
        frequency = numbers(index["frequency_hz"])
        shaded(panel, frequency, index["lower95"], index["upper95"], colour)
        panel.plot(frequency, numbers(index["value"]), color=colour, label=label)
    panel.axhline(0.0, color=GREY, linewidth=0.8)
    panel.set_xscale("log")
    logarithmic(panel.xaxis)
    panel.set_xlabel("frequency [Hz]")
    panel.set_ylabel(f"passivity index{unit_text(units.get('B', 'N·s/m'))}")
    title(panel, "below zero the model can generate energy; bands are 95 % intervals", into, fontsize="medium")
    if curves:
        panel.legend(loc="best", frameon=False)
    if recordings:
        above = axes[0, 0]
        for (one, label), colour in zip(recordings, itertools.cycle(COLOURS)):
            above.plot(numbers(one["time_s"]), numbers(one["absorbed_J"]), color=colour, linewidth=1.2, label=label)
        if len(recordings) > 1:
            above.legend(loc="best", frameon=False)
        above.axhline(0.0, color=GREY, linewidth=0.8)
        above.set_xlabel("time [s]")
        above.set_ylabel("absorbed energy [J]")
    return made


# ---- frequency responses


def decibels(values: Any) -> Any:
    with np.errstate(divide="ignore", invalid="ignore"):
        return 20.0 * np.log10(numbers(values))


def bode(pairs: list[tuple[str, str, dict[str, Any]]], frequency: Any, *, coherence: bool, into: Any = None) -> Any:
    """Magnitude, phase and, if known, coherence: one column per response. Returns figure and axes."""
    made, axes = figure(3 if coherence else 2, len(pairs), width=max(6.0, 3.6 * len(pairs)), height=2.1, sharex=True,
                        into=into)
    for column, (name, unit, one) in enumerate(pairs):
        magnitude, phase = axes[0, column], axes[1, column]
        shaded(magnitude, frequency, one["magnitude_interval95"][0], one["magnitude_interval95"][1], BLUE, "95 %")
        magnitude.plot(frequency, numbers(one["magnitude"]), color=BLUE)
        magnitude.set_xscale("log")
        positive = numbers(one["magnitude"])
        if np.nanmin(positive) > 0:
            magnitude.set_yscale("log")
            lowest, highest = np.nanmin(positive), np.nanmax(positive)
            magnitude.set_ylim(lowest / 3.0, highest * 3.0)
        title(magnitude, name, into, fontsize="medium")
        if "phase_interval95_deg" in one:
            shaded(phase, frequency, one["phase_interval95_deg"][0], one["phase_interval95_deg"][1], BLUE)
        phase.plot(frequency, numbers(one["phase_deg"]), color=BLUE)
        magnitude.set_ylabel(f"magnitude{unit_text(unit)}")
        phase.set_ylabel("phase [°]")
        if coherence:
            below = axes[2, column]
            if "partial_coherence" in one:
                below.plot(frequency, numbers(one["partial_coherence"]), color=ORANGE)
            below.set_ylim(0.0, 1.05)
            below.set_ylabel("partial coherence")
        axes[-1, column].set_xlabel("frequency [Hz]")
        logarithmic(axes[-1, column].xaxis)
    return made, axes


def exploration(document: Any, into: Any = None) -> matplotlib.figure.Figure:
    values = document._values
    response = values.get("frequency_response")
    if not response:
        raise NotImplementedError("this exploration holds no frequency response; plot its parts yourself")
    units = {one["name"]: one["unit"] for one in [*response["inputs"], *response["outputs"]]}
    pairs = [(f"{one['input']} → {one['output']}", f"{units[one['output']]}/{units[one['input']]}", one)
             for one in response["responses"]]
    made, _ = bode(pairs, numbers(response["frequency_hz"]), coherence=True, into=into)
    return made


def transfer_function(document: Any, into: Any = None) -> matplotlib.figure.Figure:
    values = document._values
    response = values["frequency_response"]
    unit = f"{values['output']['unit']}/{values['input']['unit']}" if values["input"]["unit"] else ""
    name = f"{values['input']['name']} → {values['output']['name']}"
    made, axes = bode([(name, unit, response)], numbers(response["frequency_hz"]), coherence=False, into=into)
    low, high = values["excited_band_hz"]
    if low is not None and high is not None:
        for panel in axes.flat:
            panel.axvspan(low, high, color=GREY, alpha=0.12, linewidth=0)
        title(axes[0, 0], f"{name}; grey: excited band", into, fontsize="medium")
    return made


# ---- other documents


CURVES = {"r11": "Re z₁₁ [N·s/m]", "r22": "Re z₂₂ [N·s/m]", "third": "third condition, normalised"}


def teleoperation(document: Any, into: Any = None) -> matplotlib.figure.Figure:
    curves = document._values["curves"]
    made, axes = figure(len(curves), height=2.0, sharex=True, into=into)
    for panel, curve in zip(axes[:, 0], curves):
        panel.plot(numbers(curve["frequency"]), numbers(curve["value"]), color=BLUE)
        panel.axhline(0.0, color=ORANGE, linewidth=1.0, linestyle="--")
        panel.set_xscale("log")
        panel.set_ylabel(CURVES.get(curve["name"], curve["name"]))
        low, high = panel.get_ylim()
        panel.set_ylim(min(low, -0.05 * high), high)
    title(axes[0, 0], "Llewellyn's conditions: none may be negative", into, fontsize="medium")
    axes[-1, 0].set_xlabel("frequency [rad/s]")
    logarithmic(axes[-1, 0].xaxis)
    return made


def validation(document: Any, into: Any = None) -> matplotlib.figure.Figure:
    rows = [one for one in _tables.validation_rows(document._values) if not math.isnan(one["value"])]
    made, axes = figure(1, width=8.0, height=max(2.0, 0.32 * len(rows) + 0.8), into=into)
    panel = axes[0, 0]
    for k, one in enumerate(rows):
        for low, high, colour, width in ((one["expected_low"], one["expected_high"], "#CCCCCC", 8.0),):
            if math.isfinite(low) and math.isfinite(high):
                panel.plot([low, high], [k, k], color=colour, linewidth=width, solid_capstyle="butt", zorder=1)
        colour = GREY if one["met"] is None else GREEN if one["met"] else ORANGE
        panel.plot(one["value"], k, "o", color=colour, markersize=4, zorder=3)
        if math.isfinite(one["low95"]) and math.isfinite(one["high95"]):
            panel.plot([one["low95"], one["high95"]], [k, k], color=colour, linewidth=1.5, zorder=2)
    panel.set_yticks(range(len(rows)), [one["what"] for one in rows], fontsize="small")
    panel.invert_yaxis()
    panel.set_xlabel(f"value{unit_text(document._values['unit'])}; bars: 95 % interval, grey: expected")
    return made


def springs(document: Any, into: Any = None) -> matplotlib.figure.Figure:
    values = document._values
    if "K" not in values:
        raise NotImplementedError("spring constants have no plot")
    made, axes = figure(1, width=5.0, height=4.6, into=into)
    panel = axes[0, 0]
    centre = numbers(values["equilibrium"])
    for one in values["springs"]:
        hole = numbers(one["hole"]) if one.get("hole") else np.zeros(2)
        ends = np.array([centre + hole, numbers(one["anchor"])]) * 1000.0
        panel.plot(ends[:, 0], ends[:, 1], color=GREY, linewidth=1.2)
        panel.plot(*ends[1], "s", color=GREY, markersize=5)
    stiffness = np.array([numbers(row) for row in values["K"]])
    symmetric = 0.5 * (stiffness + stiffness.T)
    eigenvalues, vectors = np.linalg.eigh(symmetric)
    if eigenvalues[0] > 0:
        size = 0.3 * max(np.ptp(panel.get_xlim()), np.ptp(panel.get_ylim())) / eigenvalues[1]
        angle = np.linspace(0, 2 * np.pi, 181)
        points = vectors @ (eigenvalues[:, None] * np.array([np.cos(angle), np.sin(angle)])) * size
        panel.plot(centre[0] * 1000.0 + points[0], centre[1] * 1000.0 + points[1], color=BLUE)
        title(panel, f"stiffness {_tables.significant(eigenvalues[1])} and {_tables.significant(eigenvalues[0])} N/m",
              into, fontsize="medium")
    panel.plot(*(centre * 1000.0), "+", color=ORANGE, markersize=10)
    panel.set_aspect("equal", adjustable="datalim")
    panel.set_xlabel("x [mm]")
    panel.set_ylabel("y [mm]")
    return made


def live(samples: dict[str, Any], reference_unit: str, into: Any = None) -> matplotlib.figure.Figure:
    made, axes = figure(2, height=2.2, sharex=True, into=into)
    position, force = axes[0, 0], axes[1, 0]
    references = position if reference_unit == "m" else force
    for axis, colour in zip("xy", COLOURS):
        position.plot(samples["time"], samples[f"hand_{axis}"], color=colour, linewidth=1.0, label=axis)
        force.plot(samples["time"], samples[f"force_{axis}"], color=colour, linewidth=1.0, label=axis)
        references.plot(samples["time"], samples[f"reference_{axis}"], color=colour, linewidth=0.8, linestyle="--")
    position.set_ylabel("hand position [m]")
    force.set_ylabel("force of the hand [N]")
    force.set_xlabel("time [s]")
    position.legend(loc="upper right", frameon=False, ncols=2, title=None)
    return made


def reliability(document: Any, into: Any = None) -> matplotlib.figure.Figure:
    rows = [one for one in _tables.reliability_rows(document._values) if math.isfinite(one["ICC"])]
    if not rows:
        raise NotImplementedError("no outcome of this study was repeated often enough to have an ICC")
    made, axes = figure(1, width=6.5, height=max(2.0, 0.3 * len(rows) + 0.9), into=into)
    panel = axes[0, 0]
    several = len({one["condition"] for one in rows}) > 1
    for k, one in enumerate(rows):
        panel.plot([one["ICC_low95"], one["ICC_high95"]], [k, k], color=BLUE, linewidth=1.5)
        panel.plot(one["ICC"], k, "o", color=BLUE, markersize=5)
    panel.set_yticks(range(len(rows)), [f"{one['condition']}: {one['outcome']}" if several else one["outcome"]
                                        for one in rows], fontsize="small")
    panel.invert_yaxis()
    panel.set_xlim(min(0.0, min(one["ICC_low95"] for one in rows)) - 0.02, 1.02)
    panel.set_xlabel("ICC(A,1) between sessions; bars: 95 % interval")
    return made
