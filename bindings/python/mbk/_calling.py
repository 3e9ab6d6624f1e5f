"""From a function's arguments to a command of the core, and from its answer to a document."""

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


# What a function takes in place of the name of a file.
Source = Union[str, "os.PathLike[str]", Recording, _documents.Document, Mapping[str, Any], Sequence[Any], Table, DataSet]


def _plain(value: Any) -> Any:
    """A scalar of NumPy as one of Python."""
    return value.item() if isinstance(value, np.generic) or isinstance(value, np.ndarray) and value.ndim == 0 else value


class _Given:
    """The words of a call, with what stands for them in memory."""

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
        recording = value if isinstance(value, Recording) else Recording(value)
        self.recordings.append(recording._core)
        return _mbk.recording_word(len(self.recordings) - 1)

    def add(self, source: Any) -> None:
        if source is None:
            return
        if isinstance(source, (list, tuple)):
            for one in source:
                self.add(one)
        elif isinstance(source, (int, np.integer)):
            self.words.append(str(source))
        else:
            self.words.append(self.word(source))

    def value(self, value: Any, separator: str) -> Any:
        """An option's value as it would be typed."""
        value = _plain(value)
        if isinstance(value, (str, int, float)):
            return value
        if isinstance(value, (os.PathLike, _documents.Document, Recording)):
            return self.word(value)
        if isinstance(value, Mapping):
            return ",".join(f"{name}={self.value(one, ':')}" for name, one in value.items())
        if isinstance(value, (Sequence, np.ndarray)):
            if not len(value):
                raise _errors.usage("an option cannot be an empty list", "leave it out")
            return separator.join(str(self.value(one, ":")) for one in value)
        raise _errors.usage(f"an option cannot be {type(value).__name__}", "give a number, a word, or several")

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
    """Calls; what needs care becomes Python warnings of whoever called the function, `level` frames up."""
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
        As it is typed: "robot identify".
    sources : sequence
        What stands beside the options: names of files, recordings, documents, words.
    options : mapping
        By their long names; None and False are not given.
    several : mapping
        For options that take more than one value, what stands between them; empty: each is given by itself.

    Returns
    -------
    Document or str
        A document where the command has one, else what it prints.
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
    """What the page of a report shows."""
    with tempfile.TemporaryDirectory(prefix="mbk-") as folder:
        page = pathlib.Path(folder, "report.html")
        with _errors.translated():
            _mbk.call("measure", {**options, "report": str(page)}, given.recordings, given.words, given.documents)
        text = page.read_text(encoding="utf-8")
    match = re.search(r'<script type="application/json" id="report-data">(.*?)</script>', text, re.DOTALL)
    if match is None:
        raise _errors.Error("this build of mbk has no page for reports; build it with npm")
    return json.loads(match[1])


def convert(command: str, sources: Sequence[Any], options: Mapping[str, Any], several: Mapping[str, str]) -> Any:
    """As `run`; the last source is the file to write, whose path comes back. What has no place in it is a warning."""
    given = _Given()
    for source in sources:
        given.add(source)
    answer = _answer(command, given, {**given.options(options, several), "quiet": True}, 4)
    for message in answer.messages:
        warnings.warn(_errors.MbkWarning("conversion", message.removeprefix("mbk: ").strip()), stacklevel=3)
    return pathlib.Path(given.words[-1])


def simulate(command: str, sources: Sequence[Any], options: Mapping[str, Any], several: Mapping[str, str]) -> Any:
    """As `run`; without `out` the recordings come back and no file stays."""
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
    """Every recording that the files hold: one, or a list of them."""
    given = _Given()
    for source in sources:
        given.add(source)
    with _errors.translated():
        cores = _mbk.read_all(given.words, given.options(options, several))
    recordings = [Recording._of(core) for core in cores]
    return recordings[0] if len(recordings) == 1 else recordings
