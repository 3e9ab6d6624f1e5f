"""What commands give: documents with attributes, units, tables and plots."""

from __future__ import annotations

import functools
import html
import json
import os
import pathlib
import re
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from mbk import _errors, _tables

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

SCHEMAS = pathlib.Path(__file__).resolve().parent / "schemas"
_ATTRIBUTE = {"from": "from_", "import": "import_", "class": "class_"}  # names that Python keeps to itself


# ---- schemas: which fields there are, what they mean, in which unit


@functools.lru_cache(maxsize=None)
def _schema(name: str) -> _Field | None:
    file = SCHEMAS / f"{name}.schema.json"
    if not file.exists():
        return None
    schema = json.loads(file.read_text(encoding="utf-8"))
    return _Field(schema, schema["definitions"])


class _Field:
    """A place in a schema: what a description says of it, and what is below it."""

    def __init__(self, node: dict[str, Any], types: dict[str, Any], description: str = "", within: str = "") -> None:
        self.types = types
        self.type, self.within = "", within  # the names of its type and of the type that it is a field of
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
    """A part of a document. Its fields are attributes: numbers, words, NumPy arrays, further parts."""

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
            why = "is not in this result" if key in known else f"is none of {', '.join(sorted(self._values))}"
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
        """A copy of what the JSON holds here."""
        copied: dict[str, Any] = json.loads(json.dumps(self._values))
        return copied

    def unit(self, path: str) -> str:
        """The unit of a field below this one.

        Parameters
        ----------
        path : str
            Names with dots: ``"model.K"``, ``"fit.RMSE"``.

        Returns
        -------
        str
            ``"N/m"``; empty where it has none.
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
        """What a field is, in a sentence."""
        field = self._field
        for name in path.split("."):
            field = field.below(name) if field else None
            if field is None:
                raise KeyError(path)
        assert field is not None
        return field.description

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
                array = np.array(value, dtype=np.float64)  # null is a number that is not defined: NaN
                array.setflags(write=False)
                return array
            except ValueError:  # rows of different lengths
                pass
        item = field.below("0") if field else None
        return [_made(one, item, units) for one in value]
    return value


# ---- documents


class Document(Part):
    """What a command gives. Its fields are attributes (``.model.K``), numbers are NumPy arrays in SI units.

    Attributes
    ----------
    json : str
        The document as the command prints it with ``--json``, to the bit.
    exit_code : int
        With which the command would have ended: 0, or 4 where the result is not usable.
    """

    def __init__(self, text: str, exit_code: int = 0) -> None:
        self.json, self.exit_code = text, exit_code
        self._again: Callable[[], dict[str, Any]] | None = None  # the report of the same measurement

    def __getattr__(self, name: str) -> Any:
        if name in ("_values", "_field", "_units", "_made"):  # made when something is asked for
            self._read()
            return self.__dict__[name]
        return super().__getattr__(name)

    def _read(self) -> None:
        values = json.loads(self.json)
        match = re.fullmatch(r"mbk\.(\w+)/\d+", values.get("schema", ""))
        Part.__init__(self, values, _schema(match[1]) if match else None, values.get("units") or {})

    def to_dict(self) -> dict[str, Any]:
        """What ``--json`` prints, as dictionaries and lists; a copy of its own each time."""
        found: dict[str, Any] = json.loads(self.json)
        return found

    def save(self, file: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the JSON document, as ``--json --out`` does.

        Parameters
        ----------
        file : str or path
            Where to.
        overwrite : bool
            Replace a file that is there.
        """
        try:
            with open(file, "w" if overwrite else "x", encoding="utf-8") as out:
                out.write(self.json)
        except FileExistsError:
            raise _errors.UsageError(f"{os.fspath(file)}: there is such a file; replace it with overwrite=True",
                                     file=str(os.fspath(file)), what="there is such a file",
                                     hint="replace it with overwrite=True") from None

    def to_dataframe(self) -> pandas.DataFrame:
        """The document's numbers as a table; which, its class says."""
        import pandas

        return pandas.DataFrame(_tables.flat(self._values))

    def plot(self) -> matplotlib.figure.Figure:
        """A figure, where there is one for this kind of document."""
        raise NotImplementedError(f"there is no plot of {self._values.get('schema', 'this document')}")

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
    """A document that `--json` or `.save` wrote.

    Parameters
    ----------
    file : str or path
        A JSON file.

    Returns
    -------
    Document
        Of the class that its schema names.
    """
    text = pathlib.Path(file).read_text(encoding="utf-8")
    try:
        schema = json.loads(text)["schema"]
    except (ValueError, KeyError, TypeError):
        schema = ""
    if not re.fullmatch(r"mbk\.\w+/\d+", str(schema)):
        raise _errors.DataError(f"{os.fspath(file)}: no document of mbk; give a file that --json or save() wrote",
                                file=str(os.fspath(file)), what="no document of mbk",
                                hint="give a file that --json or save() wrote")
    return of(text)


class _Measured(Document):
    """What a result and several have in common."""

    def plot(self) -> matplotlib.figure.Figure:
        """Ellipses of inertia, damping and stiffness at the hand with the 95 % interval of their orientation; with one
        axis the parameters with their 95 % intervals."""
        from mbk import _plots

        return _plots.ellipses(self)


class Result(_Measured):
    """M, B, K and x₀ of one recording, or of several that are pooled: ``M ẍ + B ẋ + K (x − x₀) = −F``.

    `model.M` [kg], `model.B` [N·s/m], `model.K` [N/m] have shape (axes, axes), `model.x0` [m] has shape (axes,);
    `standard_error` likewise. `units` says the units of rotation where a joint moves.
    """

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each parameter: value, standard_error, low95, high95, unit."""
        import pandas

        return pandas.DataFrame(_tables.parameters(self._values)).set_index("parameter")

    def plot_energy(self) -> matplotlib.figure.Figure:
        """The least damping in any direction over frequency with its 95 % band, of what `mbk.measure` found."""
        if "passivity" not in self._values:
            raise _errors.usage("this result says nothing of energy", "measure the recording with mbk.measure")
        from mbk import _plots

        return _plots.passivity(self)

    def report(self) -> dict[str, Any]:
        """What the page of `mbk measure --report` shows: schema mbk.report, measured again.

        Returns
        -------
        dict
            `trials` with predicted force, residual, spectra and energy.
        """
        if self._again is None:
            raise _errors.usage("this result was not measured here", "measure the recording again")
        found: dict[str, Any] = self._again()
        return found

    def plot_fit(self) -> matplotlib.figure.Figure:
        """Measured and predicted force, and the residual, on held-out data where there are any, as in the report."""
        from mbk import _plots

        return _plots.fit(self.report(), self._units.get("force", "N"))


class Results(_Measured):
    """Results of several recordings, and their mean. ``len()`` of it is the number of results, which it iterates."""

    @property
    def results(self) -> list[Result]:
        """One for each recording that could be measured."""
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
    """What energy the limb absorbed in the trial, and what its model predicts."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each recording: the energy that was absorbed [J] with its 95 % interval and verdict, what the model
        predicts, the least passivity index and the excess of passivity [unit of the damping]."""
        import pandas

        return pandas.DataFrame(_tables.passivity_rows(self._values))

    def plot(self) -> matplotlib.figure.Figure:
        """Absorbed energy of the trial, and the least damping in any direction over frequency with its 95 % band."""
        from mbk import _plots

        return _plots.passivity(self)


class Exploration(Document):
    """What a recording says without M, B and K: frequency responses, impulse response, reflexes."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each frequency, input and output of the frequency response."""
        import pandas

        return pandas.DataFrame(_tables.frequency_rows(self._values))

    def plot(self) -> matplotlib.figure.Figure:
        """Bode plot with 95 % intervals, and the coherence."""
        from mbk import _plots

        return _plots.exploration(self)


class TransferFunction(Document):
    """A transfer function from one signal to another."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each coefficient: value, standard_error, low95, high95."""
        import pandas

        return pandas.DataFrame(_tables.coefficients(self._values)).set_index("parameter")

    def plot(self) -> matplotlib.figure.Figure:
        """Bode plot with 95 % intervals."""
        from mbk import _plots

        return _plots.transfer_function(self)


class Teleoperation(Document):
    """Whether a teleoperation system is absolutely stable."""

    def to_dataframe(self) -> pandas.DataFrame:
        """The curves: a row for each frequency."""
        import pandas

        return pandas.DataFrame([
            {"curve": curve["name"], "frequency_rad_s": frequency, "value": value}
            for curve in self._values["curves"] for frequency, value in zip(curve["frequency"], curve["value"])])

    def plot(self) -> matplotlib.figure.Figure:
        """The conditions of absolute stability over frequency."""
        from mbk import _plots

        return _plots.teleoperation(self)


class Comparison(Document):
    """How far two results are apart."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each matrix: distance, low95, high95, distinguishable."""
        import pandas

        return pandas.DataFrame(_tables.widths(self._values)).set_index("matrix")


class Ellipses(_Measured):
    """Area, shape and orientation of the ellipses of a result."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each matrix: area, shape, orientation with their intervals."""
        import pandas

        return pandas.DataFrame(_tables.ellipse_rows(self._values)).set_index("matrix")


class Validation(Document):
    """A method against known truth."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each row of the table."""
        import pandas

        return pandas.DataFrame(_tables.validation_rows(self._values))

    def plot(self) -> matplotlib.figure.Figure:
        """The judged rows with their intervals against what is expected."""
        from mbk import _plots

        return _plots.validation(self)


class Information(Document):
    """What is in a recording."""

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
    """A rig of springs: its field, its design, or the constants of springs."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each spring."""
        import pandas

        rows = self._values.get("springs", self._values.get("constants", []))
        return pandas.DataFrame([dict(_tables.leaves(one)) for one in rows])

    def plot(self) -> matplotlib.figure.Figure:
        """The stiffness ellipse at the equilibrium and the springs on their anchors."""
        from mbk import _plots

        return _plots.springs(self)


class RobotDynamics(Document):
    """Inertia, weight and friction of a robot."""

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each coefficient: value, standard_error, unit."""
        import pandas

        return pandas.DataFrame(self._values["parameters"]).set_index("name")


class VirtualForce(Document):
    """A force at the hand without a force sensor, in short."""


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
        """A row for each condition and outcome that was repeated: ICC(A,1) between sessions with its 95 % interval,
        standard error of measurement and minimal detectable change in the outcome's unit; `support` says whether the
        data carry them."""
        import pandas

        return pandas.DataFrame(_tables.reliability_rows(self._values))

    def plot(self) -> matplotlib.figure.Figure:
        """ICC(A,1) between sessions of each outcome with its 95 % interval."""
        from mbk import _plots

        return _plots.reliability(self)


CLASSES: dict[str, Callable[[str, int], Document]] = {
    "result": Result, "results": Results, "passivity": Passivity, "passivities": Passivity, "explore": Exploration,
    "tf": TransferFunction, "teleop": Teleoperation, "compare": Comparison, "ellipse": Ellipses, "ellipses": Ellipses,
    "validation": Validation, "info": Information, "infos": Information, "contents": Information, "movement": Movement,
    "springs": Springs, "robot": RobotDynamics, "force": VirtualForce, "study_list": StudyList,
    "study_summary": StudySummary,
}
_SCHEMA = re.compile(r'"schema"\s*:\s*"mbk\.(\w+)/\d+"')


def of(text: str, exit_code: int = 0) -> Document:
    """The document, as the class that its schema names."""
    match = _SCHEMA.search(text, 0, 200)
    return CLASSES.get(match[1] if match else "", Document)(text, exit_code)


def escaped(text: object) -> str:
    """For HTML."""
    return html.escape(str(text))
