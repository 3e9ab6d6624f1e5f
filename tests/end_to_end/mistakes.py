"""Typical mistakes in reading a recording, as maps of channels, and the recordings on which they are made.

A mistake changes the map that reads a recording rightly. What is expected of mbk: the result is not usable or the
recording is refused, and the hint is right. Where the hint holds options, following them is what shows that."""

import dataclasses
import re
import shlex

ENTRIES = ("x", "y", "Fx", "Fy", "xr", "yr")
NAMES = ("hand_x", "hand_y", "force_x", "force_y", "reference_x", "reference_y")
ONE_AXIS = {"x": "position", "F": "reaction", "xr": "reference"}


COLUMNS = ("time", *NAMES, "joint_1", "joint_2", "torque_1", "torque_2", "acceleration_x", "acceleration_y")
COLUMNS_OF_ONE_AXIS = ("time", "position", "reaction", "reference")


def numbered(entries, axes=2):
    """The same map by the numbers of columns that have no names."""
    columns = COLUMNS_OF_ONE_AXIS if axes == 1 else COLUMNS
    position_unit = ":rad" if axes == 1 else ":m"
    by_number = {}
    for channel, source in {"time": "time", **entries}.items():
        name = source.lstrip("-")
        by_number[channel] = ("-" if source != name else "") + str(columns.index(name) + 1)
        if channel in ("xr", "yr"):
            by_number[channel] += position_unit
    return by_number


def right_map(axes=2):
    """The map that reads a recording of `mbk simulate` as it is."""
    return dict(ONE_AXIS) if axes == 1 else dict(zip(ENTRIES, NAMES))


def as_option(entries):
    return ("--channels", ",".join(f"{channel}={source}" for channel, source in entries.items()))


def scaled(*channels, by):
    return lambda entries: {c: f"{s}*{by:g}" if c in channels else s for c, s in entries.items()}


def flipped(*channels):
    return lambda entries: {c: f"-{s}" if c in channels else s for c, s in entries.items()}


def read_from(**sources):
    return lambda entries: {**entries, **sources}


def exchanged(a, b):
    return lambda entries: {**entries, a: entries[b], b: entries[a]}


def after(first, second):
    return lambda entries: second(first(entries))


@dataclasses.dataclass(frozen=True)
class Mistake:
    """`change` of the right map, or `options` beside it; `code` of the first warning, a word of which the hint must
    hold each of `says`; `cured`: the first option in the hint gives the model that the right map gives."""
    name: str
    code: str
    change: callable = staticmethod(lambda entries: entries)
    options: tuple = ()
    says: tuple = ()
    cured: bool = True
    axes: int = 2
    drives: str = ""  # the recordings that it is made on: those whose name holds this
    unnamed: bool = False  # in a file without names and units, which would refuse it


MISTAKES = (
    # units
    Mistake("mm as m", "implausible-scale", scaled("x", "y", by=1e3), says=(":mm",)),
    Mistake("mm as m, reference too", "implausible-scale", scaled("x", "y", "xr", "yr", by=1e3), says=(":mm",)),
    Mistake("cm as m", "implausible-scale", scaled("x", "y", by=1e2), says=(":cm",)),
    Mistake("inches as m", "implausible-scale", scaled("x", "y", by=1 / 0.0254), says=(":in",)),
    Mistake("m declared as mm", "implausible-scale",
            lambda entries: {**entries, "x": "hand_x:mm", "y": "hand_y:mm"}, says=(":m",)),
    Mistake("x in mm, y in m", "implausible-scale", scaled("x", by=1e3), says=(":mm",)),
    Mistake("y in cm, x in m", "implausible-scale|axes-scaled-differently", scaled("y", by=1e2), says=(":cm",)),
    Mistake("kN as N", "implausible-scale", scaled("Fx", "Fy", by=1e-3), says=(":kN",)),
    Mistake("mN as N", "implausible-scale", scaled("Fx", "Fy", by=1e3), says=(":mN",)),
    Mistake("Fy in kN, Fx in N", "implausible-scale|axes-scaled-differently", scaled("Fy", by=1e-3),
            says=(":kN",), drives="relaxed"),
    Mistake("Fx in mN, Fy in N", "implausible-scale|axes-scaled-differently", scaled("Fx", by=1e3),
            says=(":mN",), drives="relaxed"),
    # gain
    Mistake("force gain 100", "implausible-scale", scaled("Fx", "Fy", by=100), says=("Fx",), cured=False),
    Mistake("force gain 1/100", "implausible-scale", scaled("Fx", "Fy", by=0.01), says=("Fx",), cured=False),
    Mistake("gain 10 of Fx alone", "implausible-scale|axes-scaled-differently", scaled("Fx", by=10), says=("Fx",),
            drives="relaxed", cured=False),
    # signs and order
    Mistake("Fx flipped", "axes-mismatched", flipped("Fx"), says=("sign", "Fx")),
    Mistake("Fy flipped", "axes-mismatched", flipped("Fy"), says=("sign", "Fy")),
    Mistake("both forces flipped", "force-sign-reversed", flipped("Fx", "Fy"), says=("sign", "Fx", "Fy")),
    Mistake("x flipped", "axes-mismatched", flipped("x"), says=("sign", "x=hand_x")),
    Mistake("y flipped", "axes-mismatched", flipped("y"), says=("sign", "y=hand_y")),
    Mistake("Fx and Fy exchanged", "axes-mismatched", exchanged("Fx", "Fy"), says=("Fx", "Fy")),
    Mistake("x and y exchanged", "axes-mismatched", exchanged("x", "y"), says=("x=", "y=")),
    Mistake("forces turned by 90°", "axes-mismatched", after(exchanged("Fx", "Fy"), flipped("Fx")),
            says=("Fx", "Fy")),
    Mistake("exchanged and both flipped", "axes-mismatched", after(exchanged("Fx", "Fy"), flipped("Fx", "Fy")),
            says=("Fx", "Fy")),
    # columns
    Mistake("Fx twice", "same-column", read_from(Fy="force_x"), says=("Fx", "Fy"), cured=False),
    Mistake("x twice", "same-column", read_from(y="hand_x"), says=("x", "y"), cured=False),
    Mistake("position as force", "same-column", read_from(Fx="hand_x"), says=("Fx",), cured=False, unnamed=True),
    Mistake("time as x", "same-column", read_from(x="time"), says=("x", "time"), cured=False, unnamed=True),
    Mistake("reference as position", "same-column", read_from(x="reference_x", y="reference_y"), says=("x", "xr"),
            cured=False, unnamed=True),
    Mistake("reference as force", "same-column", read_from(Fx="reference_x", Fy="reference_y"), says=("Fx", "xr"),
            cured=False, unnamed=True),
    Mistake("joint angles as position", "axes-mismatched", read_from(x="joint_1", y="joint_2"), says=("mbk info",),
            cured=False, unnamed=True),
    Mistake("motor torques as force", "axes-mismatched", read_from(Fx="torque_1", Fy="torque_2"), says=("mbk info",),
            cured=False, unnamed=True),
    Mistake("acceleration as force", "implausible-scale", read_from(Fx="acceleration_x", Fy="acceleration_y"),
            says=("stiffness", "mbk info"), cured=False, unnamed=True),
    Mistake("acceleration as force, flipped", "implausible-scale",
            read_from(Fx="-acceleration_x", Fy="-acceleration_y"), says=("stiffness", "mbk info"), cured=False,
            unnamed=True),
    Mistake("acceleration as position", "implausible-scale", read_from(x="acceleration_x", y="acceleration_y"),
            says=("mbk info",), cured=False, unnamed=True),
    Mistake("position and force exchanged", "implausible-scale",
            read_from(x="force_x", y="force_y", Fx="hand_x", Fy="hand_y"), says=("mbk info",), cured=False,
            unnamed=True),
    # handle
    Mistake("5 kg of handle too many", "handle-mass-too-large", options=("--handle-mass", "5.194"),
            says=("--handle-mass",), cured=False),
    # one axis
    Mistake("deg as rad", "implausible-scale", scaled("x", by=57.29577951308232), says=(":deg",), axes=1),
    Mistake("N·mm as N·m", "implausible-scale", scaled("F", by=1e3), says=("mm",), axes=1),
    Mistake("torque flipped", "force-sign-reversed", flipped("F"), says=("sign", "F=reaction"), axes=1),
    Mistake("angle as torque", "same-column", read_from(F="position"), says=("F",), axes=1, cured=False, unnamed=True),
)


def first_options(hint):
    """The first options that a hint holds, as they are typed: "…: --channels x=2:mm,y=3; or …"."""
    match = re.search(r"(--(?:channels|rate|method|handle-mass|axes|cutoff|structure|split|to|from|resample|terms|"
                      r"force-rotation-deg) "
                      r"(?:'[^']*'|[^\s;']+)(?: --channels (?:'[^']*'|[^\s;']+))?)", hint)
    return tuple(shlex.split(match.group(1))) if match else ()
