"""Results of commands: documents with attributes, units, tables and plots."""

from __future__ import annotations

import functools
import html
import json
import os
import pathlib
import re
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mbk import _errors, _mbk, _tables

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import pandas

SCHEMAS = pathlib.Path(__file__).resolve().parent / "schemas"
_ATTRIBUTE = {"from": "from_", "import": "import_", "class": "class_"}  # reserved words of Python


# ---- schemas: fields, their meaning and their units


@functools.lru_cache(maxsize=None)
def _schema(name: str) -> _Field | None:
    file = SCHEMAS / f"{name}.schema.json"
    if not file.exists():
        return None
    schema = json.loads(file.read_text(encoding="utf-8"))
    return _Field(schema, schema["definitions"])


class _Field:
    """A place in a schema: its description and the fields below it."""

    def __init__(self, node: dict[str, Any], types: dict[str, Any], description: str = "", within: str = "") -> None:
        self.types = types
        self.type, self.within = "", within  # names of its type and of the type that contains it
        while "$ref" in node:
            description = description or node.get("description", "")
            self.type = node["$ref"].rpartition("/")[2]
            node = types[self.type]
        self.node = node
        self.description: str = description or node.get("description", "")

    def _options(self) -> Iterator[_Field]:
        yield self
        for key in ("anyOf", "oneOf"):
            for one in self.node.get(key, ()):
                yield from _Field(one, self.types, self.description, self.within)._options()

    def below(self, name: str) -> _Field | None:
        for option in self._options():
            node = option.node.get("properties", {}).get(name)
            if node is not None:
                return _Field(node, self.types, within=option.type)
            if name.isdecimal() and isinstance(option.node.get("items"), dict):
                return _Field(option.node["items"], self.types, option.description)
        return None

    @property
    def names(self) -> list[str]:
        return [name for option in self._options() for name in option.node.get("properties", {})]


_UNIT = re.compile(r"\[([^\[\]]+)\]")


# ---- parts


class Part:
    """A part of a document. Its fields are attributes: numbers, texts, NumPy arrays or further parts."""

    def __init__(self, values: dict[str, Any], field: _Field | None, units: dict[str, str]) -> None:
        self._values, self._field, self._units = values, field, units
        self._made: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        key = name[:-1] if name.endswith("_") and name not in self._values else name
        made = self._made
        if key in made:
            return made[key]
        if key not in self._values:
            known = self._field.names if self._field else []
            why = "is not in this result" if key in known else f"is not one of {', '.join(sorted(self._values))}"
            raise AttributeError(f"'{name}' {why}")
        field = self._field.below(key) if self._field else None
        made[key] = _made(self._values[key], field, self._units)
        return made[key]

    def __getitem__(self, name: str) -> Any:
        if name not in self._values:
            raise KeyError(name)
        return getattr(self, name)

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(_ATTRIBUTE.get(name, name) for name in self._values)]

    def to_dict(self) -> dict[str, Any]:
        """A copy of this part of the JSON document."""
        copied: dict[str, Any] = json.loads(json.dumps(self._values))
        return copied

    def unit(self, path: str) -> str:
        """The unit of a field in this part.

        Parameters
        ----------
        path : str
            Names separated by dots: ``"model.K"``, ``"fit.RMSE"``.

        Returns
        -------
        str
            Such as ``"N/m"``; empty if it has no unit.
        """
        field, name, value = self._field, "", self._values
        for name in path.split("."):
            field = field.below(name) if field else None
            if field is None:
                raise KeyError(path)
            if isinstance(value, dict):
                value = value.get(name, {})
        del value
        assert field is not None
        if self._units and name in self._units and field.within == "Model":
            return self._units[name]
        described = _UNIT.findall(field.description)
        unit: str = described[-1] if described else ""
        match = re.fullmatch(r"unit of (?:the )?(inertia|damping|stiffness|position|force)", unit)
        if match:
            key = {"inertia": "M", "damping": "B", "stiffness": "K", "position": "x0", "force": "force"}[match[1]]
            return self._units.get(key, unit)
        if not unit:
            end = re.search(r"_(s|hz|m|deg|J|kg|us|percent)$", name)
            unit = {"hz": "Hz", "deg": "°", "us": "µs", "percent": "%"}.get(end[1], end[1]) if end else ""
        return unit

    def describe(self, path: str) -> str:
        """The description of a field."""
        field = self._field
        for name in path.split("."):
            field = field.below(name) if field else None
            if field is None:
                raise KeyError(path)
        assert field is not None
        return _mbk.in_python(field.description)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {', '.join(self._values)}>"

    def _repr_html_(self) -> str:
        return _tables.fields(self)


def _is_numeric(value: Any) -> bool:
    if isinstance(value, list):
        return all(map(_is_numeric, value))
    return value is None or isinstance(value, (int, float)) and not isinstance(value, bool)


def _made(value: Any, field: _Field | None, units: dict[str, str]) -> Any:
    if isinstance(value, dict):
        return Part(value, field, units)
    if isinstance(value, list):
        if value and _is_numeric(value):
            try:
                array = np.array(value, dtype=np.float64)  # null is an undefined number: NaN
                array.setflags(write=False)
                return array
            except ValueError:  # rows of different lengths
                pass
        item = field.below("0") if field else None
        return [_made(one, item, units) for one in value]
    return value


# ---- documents


class Document(Part):
    """The result of a command. Its fields are attributes (``.model.K``). Lists of numbers are NumPy arrays. Units are SI.

    Attributes
    ----------
    json : str
        The exact JSON text of the command.
    exit_code : int
        Exit code of the command: 0, or 4 if the result is not usable.
    """

    def __init__(self, text: str, exit_code: int = 0) -> None:
        self.json, self.exit_code = text, exit_code
        self._again: Callable[[], dict[str, Any]] | None = None  # makes the report of the same measurement

    def __getattr__(self, name: str) -> Any:
        if name in ("_values", "_field", "_units", "_made"):  # made on first access
            self._read()
            return self.__dict__[name]
        return super().__getattr__(name)

    def _read(self) -> None:
        values = json.loads(self.json)
        match = re.fullmatch(r"mbk\.(\w+)/\d+", values.get("schema", ""))
        Part.__init__(self, values, _schema(match[1]) if match else None, values.get("units") or {})

    def to_dict(self) -> dict[str, Any]:
        """The JSON document as dictionaries and lists; a new copy each time."""
        found: dict[str, Any] = json.loads(self.json)
        return found

    def save(self, file: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the JSON document to a file.

        Parameters
        ----------
        file : str or path
            File to write.
        overwrite : bool
            Replace an existing file.
        """
        try:
            with open(file, "w" if overwrite else "x", encoding="utf-8") as out:
                out.write(self.json)
        except FileExistsError:
            raise _errors.UsageError(f"{os.fspath(file)}: the file exists; replace it with overwrite=True",
                                     file=str(os.fspath(file)), what="the file exists",
                                     hint="replace it with overwrite=True") from None

    def to_dataframe(self) -> pandas.DataFrame:
        """A table of the numbers in the document; each class documents its own."""
        import pandas

        return pandas.DataFrame(_tables.flat(self._values))

    def plot(self, *args: Any, **kwargs: Any) -> matplotlib.figure.Figure:
        """A figure, if this kind of document has one."""
        raise NotImplementedError(f"{self._values.get('schema', 'this document')} has no plot")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Document) and self.json == other.json

    def __hash__(self) -> int:
        return hash(self.json)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.json, self.exit_code)

    def __repr__(self) -> str:
        return f"<mbk.{type(self).__name__}: {', '.join(self._values)}>"

    def _repr_html_(self) -> str:
        return _tables.of(self)


def load(file: str | os.PathLike[str]) -> Any:
    """Reads a document that `.save` or `mbk … --json` wrote.

    Parameters
    ----------
    file : str or path
        A JSON file.

    Returns
    -------
    Document
        Its schema determines the class.
    """
    text = pathlib.Path(file).read_text(encoding="utf-8")
    try:
        schema = json.loads(text)["schema"]
    except (ValueError, KeyError, TypeError):
        schema = ""
    if not re.fullmatch(r"mbk\.\w+/\d+", str(schema)):
        raise _errors.DataError(f"{os.fspath(file)}: the file is not a document of mbk; give a file that save() wrote",
                                file=str(os.fspath(file)), what="the file is not a document of mbk",
                                hint="give a file that save() wrote")
    return of(text)


class _Measured(Document):
    """Base of one result and of several results."""

    def plot(self, axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """Ellipses of inertia, damping and stiffness at the hand with the 95 % interval of their orientation; for one
        axis, the parameters with their 95 % intervals. Draws into `axes`, row by row and without titles, if given."""
        from mbk import _plots

        return _plots.ellipses(self, axes)


class Result(_Measured):
    """M, B, K and x₀ of one recording or of pooled recordings: ``M ẍ + B ẋ + K (x − x₀) = −F``. ``print`` shows them as
    a table with their 95 % intervals, the fit and the warnings.

    `model.M` [kg], `model.B` [N·s/m], `model.K` [N/m] have shape (axes, axes), `model.x0` [m] has shape (axes,);
    `standard_error` likewise. For a joint, `units` contains the units of rotation.
    """

    def __str__(self) -> str:
        return _tables.result_text(self._values)

    def __repr__(self) -> str:
        return f"<mbk.Result {_tables.result_line(self._values)}>"

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each parameter: value, standard_error, low95, high95, unit."""
        import pandas

        return pandas.DataFrame(_tables.parameters(self._values)).set_index("parameter")

    def plot_energy(self, axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """Passivity index (minimum damping in any direction) over frequency with its 95 % band; for results of
        `mbk.measure`. Draws into `axes`, row by row and without titles, if given."""
        if "passivity" not in self._values:
            raise _errors.usage("this result has no passivity index", "measure the recording with mbk.measure()")
        from mbk import _plots

        return _plots.passivity(self, axes)

    def report(self) -> dict[str, Any]:
        """The data of the HTML report (schema mbk.report). Measures the recording again.

        Returns
        -------
        dict
            `trials` contains predicted force, residual, spectra and energy.
        """
        if self._again is None:
            raise _errors.usage("this result was loaded, not measured in this process", "measure the recording again")
        found: dict[str, Any] = self._again()
        return found

    def plot_fit(self, axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """Measured force, predicted force and residual, on held-out data if there are any, as in the report. Draws into
        `axes`, row by row and without titles, if given."""
        from mbk import _plots

        return _plots.fit(self.report(), self._units.get("force", "N"), axes)


class Results(_Measured):
    """Results of several recordings, and their mean. Supports ``len()``, iteration and indexing over the results."""

    def __str__(self) -> str:
        return _tables.results_text(self._values)

    def __repr__(self) -> str:
        return f"<mbk.Results: {len(self)} recordings, {sum(one.usable for one in self)} usable>"

    @property
    def results(self) -> list[Result]:
        """One result for each recording that could be measured."""
        made: dict[str, Any] = self._made
        if "results" not in made:
            made["results"] = [_inner(Result, one) for one in self._values["results"]]
        found: list[Result] = made["results"]
        return found

    def __iter__(self) -> Iterator[Any]:
        return iter(self.results)

    def __len__(self) -> int:
        return len(self.results)

    def __getitem__(self, which: Any) -> Any:
        return self.results[which] if isinstance(which, (int, slice)) else super().__getitem__(which)

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each recording: file, usable, every parameter with its standard error, fit and ellipses."""
        import pandas

        return pandas.DataFrame([_tables.one_row(one) for one in self._values["results"]])


def _inner(kind: type[Document], values: dict[str, Any]) -> Any:
    """A document within a document."""
    return kind(json.dumps(values, ensure_ascii=False, separators=(",", ":")))


class Passivity(Document):
    """Energy that the limb absorbed in the trial, and the prediction of its model."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each recording: absorbed energy [J] with its 95 % interval and verdict, prediction of the model,
        minimum passivity index and excess of passivity [unit of the damping]."""
        import pandas

        return pandas.DataFrame(_tables.passivity_rows(self._values))

    def plot(self, axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """Absorbed energy over the trial, and passivity index over frequency with its 95 % band. Draws into `axes`,
        row by row and without titles, if given."""
        from mbk import _plots

        return _plots.passivity(self, axes)


class Exploration(Document):
    """Results that do not use the model M, B, K: frequency responses, impulse response, reflexes."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each combination of frequency, input and output of the frequency response."""
        import pandas

        return pandas.DataFrame(_tables.frequency_rows(self._values))

    def plot(self, axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """Bode plot with 95 % intervals, and coherence. Draws into `axes`, row by row and without titles,
        if given."""
        from mbk import _plots

        return _plots.exploration(self, axes)


class TransferFunction(Document):
    """Transfer function from one signal to another."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each coefficient: value, standard_error, low95, high95."""
        import pandas

        return pandas.DataFrame(_tables.coefficients(self._values)).set_index("parameter")

    def plot(self, axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """Bode plot with 95 % intervals. Draws into `axes`, row by row and without titles,
        if given."""
        from mbk import _plots

        return _plots.transfer_function(self, axes)


class Teleoperation(Document):
    """Absolute stability of a teleoperation system."""

    def to_dataframe(self) -> pandas.DataFrame:
        """The curves: a row for each curve and frequency."""
        import pandas

        return pandas.DataFrame([
            {"curve": curve["name"], "frequency_rad_s": frequency, "value": value}
            for curve in self._values["curves"] for frequency, value in zip(curve["frequency"], curve["value"])])

    def plot(self, axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """The conditions of absolute stability over frequency. Draws into `axes`, row by row and without titles,
        if given."""
        from mbk import _plots

        return _plots.teleoperation(self, axes)


class Comparison(Document):
    """Difference between two results."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each matrix: distance, low95, high95, distinguishable."""
        import pandas

        return pandas.DataFrame(_tables.widths(self._values)).set_index("matrix")


class Ellipses(_Measured):
    """Area, shape and orientation of the ellipses of a result."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each matrix: area, shape and orientation with their intervals."""
        import pandas

        return pandas.DataFrame(_tables.ellipse_rows(self._values)).set_index("matrix")


class Validation(Document):
    """Test of a method against known truth."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each row of the table."""
        import pandas

        return pandas.DataFrame(_tables.validation_rows(self._values))

    def plot(self, ax: matplotlib.axes.Axes | None = None) -> matplotlib.figure.Figure:
        """The judged rows with their intervals and the expected ranges. Draws into `ax`, without a title, if given."""
        from mbk import _plots

        return _plots.validation(self, ax)


class Information(Document):
    """Contents of a recording."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each channel."""
        import pandas

        return pandas.DataFrame(_tables.channel_rows(self._values))


class Movement(Document):
    """Quality of reaches."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each reach."""
        import pandas

        return pandas.DataFrame([{"file": recording["file"], **reach}
                                 for recording in self._values["recordings"] for reach in recording["reaches"]])


class Springs(Document):
    """A rig of springs: its force field, its design, or calibrated spring constants."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each spring."""
        import pandas

        rows = self._values.get("springs", self._values.get("constants", []))
        return pandas.DataFrame([dict(_tables.leaves(one)) for one in rows])

    def plot(self, ax: matplotlib.axes.Axes | None = None) -> matplotlib.figure.Figure:
        """The stiffness ellipse at the equilibrium and the springs on their anchors. Draws into `ax`, without a
        title, if given."""
        from mbk import _plots

        return _plots.springs(self, ax)


class RobotDynamics(Document):
    """Inertia, weight and friction of a robot."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each coefficient: value, standard_error, unit."""
        import pandas

        return pandas.DataFrame(self._values["parameters"]).set_index("name")


class VirtualForce(Document):
    """Summary of a force at the hand that was computed without a force sensor."""


class StudyList(Document):
    """The recordings of a study."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each recording."""
        import pandas

        return pandas.DataFrame(_tables.study_rows(self._values))


class StudySummary(Document):
    """Each outcome of a study by condition, over participants."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each condition and outcome."""
        import pandas

        return pandas.DataFrame(self._values["outcomes"])

    def reliability_table(self) -> pandas.DataFrame:
        """A row for each condition and outcome with repeated sessions: ICC(A,1) between sessions with its 95 % interval,
        standard error of measurement and minimal detectable change in the unit of the outcome. `support` says whether
        the data support them."""
        import pandas

        return pandas.DataFrame(_tables.reliability_rows(self._values))

    def plot(self, ax: matplotlib.axes.Axes | None = None) -> matplotlib.figure.Figure:
        """ICC(A,1) between sessions of each outcome with its 95 % interval. Draws into `ax`, without a title,
        if given."""
        from mbk import _plots

        return _plots.reliability(self, ax)


CLASSES: dict[str, Callable[[str, int], Document]] = {
    "result": Result, "results": Results, "passivity": Passivity, "passivities": Passivity, "explore": Exploration,
    "tf": TransferFunction, "teleop": Teleoperation, "compare": Comparison, "ellipse": Ellipses, "ellipses": Ellipses,
    "validation": Validation, "info": Information, "infos": Information, "contents": Information, "movement": Movement,
    "springs": Springs, "robot": RobotDynamics, "force": VirtualForce, "study_list": StudyList,
    "study_summary": StudySummary,
}
_SCHEMA = re.compile(r'"schema"\s*:\s*"mbk\.(\w+)/\d+"')


def of(text: str, exit_code: int = 0) -> Document:
    """The document as an object of the class for its schema."""
    match = _SCHEMA.search(text, 0, 200)
    return CLASSES.get(match[1] if match else "", Document)(text, exit_code)


def escaped(text: object) -> str:
    """Escaped for HTML."""
    return html.escape(str(text))
