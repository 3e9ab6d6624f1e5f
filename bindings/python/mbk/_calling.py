"""Converts arguments of a function to a command of the core, and its answer to a document."""

from __future__ import annotations

import functools
import json
import os
import pathlib
import re
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Protocol, Union

import numpy as np

from mbk import _documents, _errors, _mbk
from mbk._recording import Recording


class Table(Protocol):
    """A pandas DataFrame: a channel in each column."""

    @property
    def columns(self) -> Any: ...

    @property
    def index(self) -> Any: ...

    def to_numpy(self) -> Any: ...


class DataSet(Protocol):
    """An xarray Dataset: a channel in each variable."""

    @property
    def data_vars(self) -> Any: ...

    @property
    def coords(self) -> Any: ...


# What a function accepts instead of a file name.
Source = Union[str, "os.PathLike[str]", Recording, _documents.Document, Mapping[str, Any], Sequence[Any], Table, DataSet]


def _plain(value: Any) -> Any:
    """A NumPy scalar as a Python scalar."""
    return value.item() if isinstance(value, np.generic) or isinstance(value, np.ndarray) and value.ndim == 0 else value


class _Given:
    """The words of a call, and the recordings and documents in memory that they stand for."""

    __slots__ = ("documents", "recordings", "words")

    def __init__(self) -> None:
        self.words: list[str] = []
        self.recordings: list[_mbk.Recording] = []
        self.documents: list[str] = []

    def word(self, value: Any) -> str:
        """The word that stands for a file, recording or document."""
        if isinstance(value, str):
            return value
        if isinstance(value, os.PathLike):
            return os.fsdecode(value)
        if isinstance(value, _documents.Document):
            self.documents.append(value.json)
            return _mbk.document_word(len(self.documents) - 1)
        if not isinstance(value, (Recording, Mapping)) and not hasattr(value, "columns") and not hasattr(value, "data_vars"):
            raise _errors.wrong_type(value, "is neither a file name nor a recording",
                                     "give a file name, a Recording (arrays by keyword, as in mbk.Recording(time=t, x=x, "
                                     "F=F)), a mapping of arrays, a pandas DataFrame or an xarray Dataset")
        recording = value if isinstance(value, Recording) else Recording(value)
        self.recordings.append(recording._core)
        return _mbk.recording_word(len(self.recordings) - 1)

    def add(self, source: Any) -> None:
        if source is None:
            return
        if isinstance(source, (list, tuple)):
            for one in source:
                self.add(one)
        else:
            self.words.append(self.word(source))

    def value(self, value: Any, separator: str) -> Any:
        """The value of an option as on the command line."""
        value = _plain(value)
        if isinstance(value, (str, int, float)):
            return value
        if isinstance(value, (os.PathLike, _documents.Document, Recording)):
            return self.word(value)
        if isinstance(value, Mapping):
            return ",".join(f"{name}={self.value(one, ':')}" for name, one in value.items())
        if isinstance(value, (Sequence, np.ndarray)):
            if not len(value):
                raise _errors.usage("an option is an empty list", "omit the option")
            return separator.join(str(self.value(one, ":")) for one in value)
        raise _errors.usage(f"an option has the type {type(value).__name__}", "give a number, a text or a list of them")

    def options(self, options: Mapping[str, Any], several: Mapping[str, str]) -> dict[str, Any]:
        given: dict[str, Any] = {}
        for name, value in options.items():
            value = _plain(value)
            if value is None or value is False:
                continue
            if isinstance(value, (str, int, float)):
                given[name] = value
            elif several.get(name) == "" and not isinstance(value, (Mapping, os.PathLike)):
                given[name] = [self.value(one, ",") for one in value]
            else:
                given[name] = self.value(value, several.get(name, ","))
        return given


def _answer(command: str, given: _Given, options: dict[str, Any], level: int) -> _mbk.Answer:
    """Calls the core. Issues warnings of the result as Python warnings of the caller, `level` frames up."""
    try:
        answer = _mbk.call(command, options, given.recordings, given.words, given.documents)
    except _mbk.Error as error:
        raise _errors.of(error) from None
    for code, text in answer.warnings:
        warnings.warn(_errors.MbkWarning(code, text), stacklevel=level)
    for failed in answer.errors:
        warnings.warn(_errors.MbkWarning("failed", str(failed)), stacklevel=level)
    return answer


def run(command: str, sources: Sequence[Any], options: Mapping[str, Any], several: Mapping[str, str]) -> Any:
    """Runs a command.

    Parameters
    ----------
    command : str
        As on the command line: "robot identify".
    sources : sequence
        Arguments other than options: file names, recordings, documents, words.
    options : mapping
        By their long names; None and False mean that an option is not given.
    several : mapping
        Separator between values of options with several values; empty: the option is repeated.

    Returns
    -------
    Document or str
        A document if the command has one, otherwise the text that it prints.
    """
    given = _Given()
    for source in sources:
        given.add(source)
    answer = _answer(command, given, given.options(options, several), 4)
    text = answer.json or answer.text
    if not text.startswith("{"):
        return text
    document = _documents.of(text, answer.exit_code)
    if command in ("measure", "identify") and isinstance(document, _documents.Result):
        document._again = functools.partial(_report, given, given.options(options, several))
    return document


def _report(given: _Given, options: dict[str, Any]) -> Any:
    """The data of a report page."""
    with tempfile.TemporaryDirectory(prefix="mbk-") as folder:
        page = pathlib.Path(folder, "report.html")
        with _errors.translated():
            _mbk.call("measure", {**options, "report": str(page)}, given.recordings, given.words, given.documents)
        text = page.read_text(encoding="utf-8")
    match = re.search(r'<script type="application/json" id="report-data">(.*?)</script>', text, re.DOTALL)
    if match is None:
        raise _errors.Error("this build of mbk has no report page; build mbk with MBK_WEB=ON")
    return json.loads(match[1])


def convert(command: str, sources: Sequence[Any], options: Mapping[str, Any], several: Mapping[str, str]) -> Any:
    """Like `run`. Writes the last source and returns its path. Data that its format cannot hold cause a warning."""
    given = _Given()
    for source in sources:
        given.add(source)
    answer = _answer(command, given, {**given.options(options, several), "quiet": True}, 4)
    for message in answer.messages:
        warnings.warn(_errors.MbkWarning("conversion", message.removeprefix("mbk: ").strip()), stacklevel=3)
    return pathlib.Path(given.words[-1])


def simulate(command: str, sources: Sequence[Any], options: Mapping[str, Any], several: Mapping[str, str]) -> Any:
    """Like `run`. Without `out` it returns the recordings and leaves no file."""
    given = _Given()
    for source in sources:
        given.add(source)
    asked = given.options(options, several)
    if "out" in asked or any(name in asked for name in ("list", "facts", "show")):
        answer = _answer(command, given, {**asked, "quiet": True}, 4)
        return answer.text if "out" not in asked else pathlib.Path(asked["out"])
    with tempfile.TemporaryDirectory(prefix="mbk-") as folder:
        _answer(command, given, {**asked, "quiet": True, "out": os.path.join(folder, "simulated.h5")}, 4)
        files = sorted(pathlib.Path(folder).iterdir(), key=_natural)
        with _errors.translated():
            cores = [_mbk.read_all([file], {})[0] for file in files]
    recordings = [Recording(Recording._of(core), metadata=core.metadata, events=core.events) for core in cores]
    return recordings[0] if len(recordings) == 1 else recordings


def _natural(path: pathlib.Path) -> list[Any]:
    """seed2 before seed10."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", path.name)]


def read(command: str, sources: Sequence[Any], options: Mapping[str, Any], several: Mapping[str, str]) -> Any:
    """Every recording in the files: one, or a list if there are several."""
    given = _Given()
    for source in sources:
        given.add(source)
    with _errors.translated():
        cores = _mbk.read_all(given.words, given.options(options, several))
    recordings = [Recording._of(core) for core in cores]
    return recordings[0] if len(recordings) == 1 else recordings
