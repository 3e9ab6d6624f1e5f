"""Recordings in memory."""

from __future__ import annotations

import datetime
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from mbk import _errors, _mbk, _tables

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import numpy.typing as npt
    import pandas
    import xarray

    from mbk._documents import Information

    Array = npt.NDArray[np.float64]

_TIMES = frozenset(("time", "t"))
_ALIAS = re.compile(r"t|x|y|a|F|xr|yr|Fx|Fy|ax|ay|Vx|Vy|(?:q|tau|qr)[1-8]")  # names that carry no unit


class Recording:
    """Signals of one trial in memory. Immutable; threads may share it.

    Parameters
    ----------
    channels : mapping of str to array_like, pandas.DataFrame or xarray.Dataset, optional
        One-dimensional arrays of equal length, by name. Names have the same meaning as in a file: ``time``, ``x``,
        ``y``, ``Fx``, ``Fy``, ``xr``, ``yr``, ``ax``, …, also ``hand_x_mm``. Contiguous float64 arrays are not copied:
        do not change them while the recording exists. Other arrays are converted.
    time : array_like, optional
        Time of each sample, if it is not one of the channels: seconds, or dates, which are converted to seconds from
        the first.
    rate_hz : float, optional
        Sample rate [Hz], if there is no time.
    units : mapping of str to str, optional
        Units of channels that are not in SI: ``{"x": "mm"}``.
    metadata : mapping of str to str, optional
        Other properties of the recording, such as ``{"handle_mass_kg": "0.194"}``.
    events : iterable of (float, str) or (float, str, float), optional
        Time [s], name and value of each event.
    **named : array_like
        Further channels.

    Raises
    ------
    UsageError
        The arguments do not form a recording: values are not real numbers, a name is given twice, a unit is not a text.
    DataError
        The signals have different lengths or are empty.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(5000) / 1000
    >>> recording = mbk.Recording(time=t, x=0.01 * np.sin(6 * t), F=-np.cos(6 * t))
    >>> recording.rate_hz
    1000.0
    >>> recording["x"].shape
    (5000,)
    >>> mbk.Recording({"t": t, "x": 5 * np.sin(t), "F": t}, units={"x": "mm"}).units["position"]
    'm'
    """

    def __init__(
        self,
        channels: Mapping[str, npt.ArrayLike] | pandas.DataFrame | xarray.Dataset | None = None,
        *,
        time: npt.ArrayLike | None = None,
        rate_hz: float | None = None,
        units: Mapping[str, str] | None = None,
        metadata: Mapping[str, object] | None = None,
        events: Iterable[tuple[Any, ...]] = (),
        **named: npt.ArrayLike,
    ) -> None:
        signals, known_units, known_metadata = _signals_of(channels)
        for name in ("time", *named) if time is not None else named:
            if name in signals:
                raise _errors.usage(f"'{name}' is given twice", "omit one of them")
        signals = {**({} if time is None else {"time": time}), **signals, **named}
        known_units.update(_mapping("units", units))
        known_metadata.update(_mapping("metadata", metadata))
        for name in _TIMES & signals.keys():
            if rate_hz is not None:
                raise _errors.usage(f"both '{name}' and rate_hz are given", "omit one of them")
            signals[name] = _time(name, signals[name], known_units)
        signals = {name: _numbers(name, values) for name, values in signals.items()}
        self._rate_hz = 0.0 if rate_hz is None else _rate(rate_hz)
        with _errors.translated():
            self._core: _mbk.Recording = _mbk.Recording(signals, self._rate_hz, _texts(known_units), known_metadata,
                                                        _events(events))

    def __reduce__(self) -> tuple[Any, ...]:
        """For pickle, multiprocessing and joblib: signals, rate, units, metadata and events."""
        given = self._given()
        with _errors.translated():
            known = dict(self._core.metadata), list(self._core.events)
        return _rebuilt, ({name: self._core.channel(name) for name in given}, self._rate_hz,
                          {name: unit for name, unit in given.items() if unit}, *known)

    def __copy__(self) -> Recording:
        return self  # immutable

    def __deepcopy__(self, memo: dict[int, Any]) -> Recording:
        return self

    @classmethod
    def _of(cls, core: _mbk.Recording) -> Recording:
        made = cls.__new__(cls)
        made._core, made._rate_hz = core, 0.0
        return made

    # Contents

    def _given(self) -> dict[str, str]:
        """Names and units as given; cached."""
        found: dict[str, str] | None = self.__dict__.get("_signals")
        if found is None:
            found = self.__dict__["_signals"] = dict(self._core.signals)
        return found

    def _meaning(self) -> list[tuple[str, str, str]]:
        """Names, SI units and frames of the recognised channels; cached."""
        found: list[tuple[str, str, str]] | None = self.__dict__.get("_recognised")
        if found is None:
            with _errors.translated():
                found = self.__dict__["_recognised"] = list(self._core.channels)
        return found

    def _si(self) -> _mbk.Recording:
        """The recording with every channel in SI units: itself if all signals are in SI."""
        found: _mbk.Recording | None = self.__dict__.get("_converted")
        if found is None:
            found = self.__dict__["_converted"] = self._core if self._is_si() else self._by_way_of_a_file()
        return found

    def _is_si(self) -> bool:
        given = self._given()
        places = {self._core.channel(name).__array_interface__["data"][0]: name for name in given}
        for name, unit, _ in self._meaning():
            signal = places.get(self._core.channel(name).__array_interface__["data"][0])
            if signal is None or given[signal] not in ("", unit) or not (signal == name or _ALIAS.fullmatch(signal)):
                return False
        return given.get("time", "s") in ("", "s")

    def _by_way_of_a_file(self) -> _mbk.Recording:
        with tempfile.TemporaryDirectory(prefix="mbk-") as folder, _errors.translated():
            file = f"{folder}/recording.h5"
            _mbk.call("convert", {"quiet": True}, [self._core], [_mbk.recording_word(0), file])
            return _mbk.read_all([file], {})[0]

    def __getitem__(self, name: str) -> Array:
        """A channel, or a signal as given.

        Parameters
        ----------
        name : str
            Name of a channel, such as ``hand_x``: values in SI units. Name of any other signal: values as given.

        Returns
        -------
        numpy.ndarray
            Shape (samples,), float64, read-only. Not a copy, except for channels that were given in other units than SI.
        """
        given = self._given()
        if given.get(name) == "":
            return self._core.channel(name)
        try:
            channels = [one for one, _, _ in self._meaning()]
        except _errors.Error:
            channels = []
        if name in given and name not in channels:
            return self._core.channel(name)
        return self._si().channel(name) if channels else self._core.channel(name)

    def __contains__(self, name: object) -> bool:
        try:
            self._core.channel(str(name))
        except KeyError:
            return False
        return True

    def __iter__(self) -> Iterator[str]:
        return iter(self.channels)

    def __len__(self) -> int:
        """Number of samples."""
        return int(self._core.channel(next(iter(self._given()))).size)

    @property
    def signals(self) -> dict[str, str]:
        """Names and units of the signals, as given."""
        return dict(self._given())

    @property
    def channels(self) -> list[str]:
        """Names of the recognised channels, without the time."""
        return [name for name, _, _ in self._meaning()]

    @property
    def units(self) -> dict[str, str]:
        """SI units of the channels."""
        return {name: unit for name, unit, _ in self._meaning()}

    @property
    def frames(self) -> dict[str, str]:
        """Coordinate frames of the channels."""
        return {name: frame for name, _, frame in self._meaning()}

    @property
    def time(self) -> Array:
        """Time of each sample [s]; shape (samples,)."""
        try:
            return self._si().channel("time")
        except KeyError:  # no time, only a rate
            return np.arange(len(self)) / self._rate_hz

    @property
    def rate_hz(self) -> float:
        """Sample rate [Hz]: reciprocal of the median interval."""
        if self._rate_hz:
            return self._rate_hz
        time = self.time
        return round(1.0 / float(np.median(np.diff(time))), 6) if time.size > 1 else float("nan")

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample [s]."""
        time = self.time
        return float(time[-1] - time[0])

    @property
    def metadata(self) -> dict[str, str]:
        """Other properties, by name."""
        with _errors.translated():
            return dict(self._core.metadata)

    @property
    def events(self) -> list[tuple[float, str, float]]:
        """Time [s], name and value of each event."""
        with _errors.translated():
            return list(self._core.events)

    @property
    def notes(self) -> list[str]:
        """Notes about how the recording was read."""
        with _errors.translated():
            return list(self._core.notes)

    @property
    def sources(self) -> list[dict[str, str]]:
        """Files that the recording was read from: path, format, sha256, trial."""
        with _errors.translated():
            return [dict(one) for one in self._core.sources]

    # Conversions

    def to_dict(self) -> dict[str, Array]:
        """The time and every channel by name, without a copy."""
        return {"time": self.time, **{name: self[name] for name in self.channels}}

    def to_dataframe(self) -> pandas.DataFrame:
        """A table with the time [s] as its index and a column for each channel; units are in ``.attrs["units"]``."""
        import pandas

        table = pandas.DataFrame({name: self[name] for name in self.channels},
                                 index=pandas.Index(self.time, name="time"))
        table.attrs["units"] = self.units
        return table

    def to_xarray(self) -> xarray.Dataset:
        """A data set over the coordinate ``time`` [s]; each variable has its unit and frame as attributes."""
        import xarray

        units, frames = self.units, self.frames
        variables = {name: ("time", self[name], {"units": units[name], "frame": frames[name]}) for name in self.channels}
        return xarray.Dataset(variables, coords={"time": ("time", self.time, {"units": "s"})}, attrs=self.metadata)

    def save(self, file: str | PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the recording to a file. The extension selects the format: .h5, .mat or .csv."""
        import mbk

        mbk.convert(self, file, overwrite=overwrite)

    def info(self) -> Information:
        """Contents of the recording, and problems found in it."""
        import mbk

        found: Information = mbk.info(self)
        return found

    def plot(self, channels: Iterable[str] | None = None,
             axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """Plots each kind of channel over time, with its unit.

        Parameters
        ----------
        channels : iterable of str, optional
            Channels to plot (default: all).
        axes : sequence of matplotlib.axes.Axes, optional
            One for each panel, to draw into.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from mbk import _plots

        return _plots.recording(self, list(channels) if channels is not None else self.channels, axes)

    def __repr__(self) -> str:
        try:
            names = ", ".join(self.channels)
            return f"<mbk.Recording {self.duration_s:.6g} s at {self.rate_hz:.6g} Hz: {names}>"
        except (_errors.Error, KeyError):
            return f"<mbk.Recording with the signals {', '.join(self.signals)}>"

    def _repr_html_(self) -> str:
        try:
            rows = [(name, unit, self[name]) for name, unit in self.units.items()]
            head = f"{self.duration_s:.6g} s at {self.rate_hz:.6g} Hz"
        except (_errors.Error, KeyError):
            rows = [(name, unit, self[name]) for name, unit in self.signals.items()]
            head = "Signals that need channels=… to be measured"
        body = [[name, *(_tables.significant(float(one), 6) for one in (np.fmin.reduce(values), np.fmax.reduce(values))),
                 _tables.unit_as_read(unit)] for name, unit, values in rows]
        return (f"<p><strong>Recording</strong>: {_tables.escaped(head)}</p>"
                + _tables.table("", ["channel", "minimum", "maximum", "unit"], body))


def _signals_of(given: Any) -> tuple[dict[str, Any], dict[str, Any], dict[str, str]]:
    """Signals, units and metadata of an object with named arrays."""
    if given is None:
        return {}, {}, {}
    if isinstance(given, Recording):
        return dict(given.to_dict()), dict(given.units), given.metadata
    if hasattr(given, "data_vars"):  # an xarray Dataset
        signals = {str(name): variable.values for name, variable in given.data_vars.items()}
        units = {str(name): str(variable.attrs["units"]) for name, variable in given.data_vars.items()
                 if "units" in variable.attrs}
        if "time" not in signals and "time" in given.coords:
            signals = {"time": given.coords["time"].values, **signals}
        return signals, units, {str(name): str(value) for name, value in given.attrs.items()}
    if hasattr(given, "columns") and hasattr(given, "index"):  # a pandas DataFrame
        for name in given.columns[given.columns.duplicated()]:
            raise _errors.usage(f"two columns have the name '{name}'", "omit one of them")
        signals = {str(name): values for name, values in given.items()}
        units = {str(name): unit for name, unit in dict(given.attrs.get("units", {})).items() if name in signals}
        if "time" not in signals and (given.index.name in _TIMES or given.index.dtype.kind in "mM"):
            signals = {"time": given.index, **signals}
        return signals, units, {}
    if isinstance(given, Mapping):
        return {str(name): value for name, value in given.items()}, {}, {}
    raise _errors.wrong_type(given, "does not form a recording",
                             "give arrays by keyword, as in mbk.Recording(time=t, x=x, F=F), a mapping of arrays or a "
                             "DataFrame; mbk.read(\"log.mat\") reads a file")


def _numbers(name: str, given: Any) -> Any:
    """Nullable numbers of pandas as float64 with NaN; anything else unchanged, because the core checks it."""
    plain = name.isascii()
    if plain and type(given) is np.ndarray:
        return given
    if not plain and any("\ud800" <= letter <= "\udfff" for letter in name):
        raise _errors.usage(f"the name {ascii(name)} is not valid text", "rename the signal")
    dtype = getattr(given, "dtype", None)
    if isinstance(dtype, np.dtype) or getattr(dtype, "kind", "O") not in "fiub" or not hasattr(given, "to_numpy"):
        return given
    return given.to_numpy(dtype=np.float64, na_value=np.nan)


def _time(name: str, given: Any, units: dict[str, Any]) -> Any:
    """Dates and time differences of NumPy, pandas and Python as seconds from the first; numbers unchanged."""
    try:
        times = _dates(given)
    except (TypeError, ValueError, AttributeError):
        raise _errors.usage(f"'{name}' is neither numbers nor dates", "give seconds") from None
    if times is None:
        return given
    units.pop(name, None)  # dates have their own unit
    since = times - times[:1]
    return np.where(np.isnat(since), np.nan, since.astype(np.float64) * 1e-9)


def _dates(given: Any) -> npt.NDArray[Any] | None:
    """Dates as NumPy dates, to the nanosecond; None if they are not dates."""
    kind = getattr(getattr(given, "dtype", None), "kind", "O")
    if kind == "O" and isinstance(given, (Sequence, np.ndarray)) and len(given):
        if isinstance(given[0], datetime.datetime):
            zone = datetime.timezone.utc
            given = [one.astimezone(zone).replace(tzinfo=None) if one.tzinfo else one for one in given]
            kind = "M"
        elif isinstance(given[0], datetime.timedelta):
            kind = "m"
    return np.asarray(given, dtype={"M": "datetime64[ns]", "m": "timedelta64[ns]"}[kind]) if kind in "Mm" else None


def _rate(given: Any) -> float:
    try:
        rate = float(given)
    except (TypeError, ValueError):
        rate = float("nan")
    if not 0.0 < rate < float("inf"):
        raise _errors.usage(f"rate {given!r} Hz is not a positive number", "give the sample rate in Hz")
    return rate


def _mapping(what: str, given: Any) -> dict[str, Any]:
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise _errors.usage(f"{what} has the type {type(given).__name__}", f"give a mapping: {what}={{…}}")
    return {str(name): value if what == "units" else str(value) for name, value in given.items()}


def _texts(units: dict[str, Any]) -> dict[str, str]:
    for name, unit in units.items():
        if not isinstance(unit, str):
            raise _errors.usage(f"the unit of '{name}' is {unit!r}, not a text", "give a text, such as 'mm'")
    return units


def _events(given: Iterable[tuple[Any, ...]]) -> list[tuple[float, str, float]]:
    try:
        return [(float(one[0]), str(one[1]), float(one[2]) if len(one) > 2 else float("nan")) for one in given]
    except (TypeError, ValueError, LookupError):
        raise _errors.usage("an event is not (time in seconds, name) or (time, name, value)",
                            "give a list of such tuples") from None


def _rebuilt(signals: dict[str, Any], rate_hz: float, units: dict[str, str], metadata: dict[str, str],
             events: list[tuple[float, str, float]]) -> Recording:
    """The inverse of `Recording.__reduce__`."""
    made = Recording.__new__(Recording)
    made._rate_hz = rate_hz
    with _errors.translated():
        made._core = _mbk.Recording(signals, rate_hz, units, metadata, events)
    return made
