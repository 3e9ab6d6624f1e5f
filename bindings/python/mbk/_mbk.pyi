"""The core of mbk, in C++."""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

__version__: str

class Error(ValueError):
    file: str
    what: str
    hint: str
    exit_code: int

class Recording:
    def __init__(
        self,
        channels: dict[str, Any],
        rate_hz: float = 0.0,
        units: dict[str, str] = ...,
        metadata: dict[str, str] = ...,
        events: list[tuple[float, str, float]] = ...,
    ) -> None: ...
    def channel(self, name: str) -> npt.NDArray[np.float64]: ...
    @property
    def signals(self) -> list[tuple[str, str]]: ...
    @property
    def channels(self) -> list[tuple[str, str, str]]: ...
    @property
    def samples(self) -> int: ...
    @property
    def metadata(self) -> dict[str, str]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def events(self) -> list[tuple[float, str, float]]: ...
    @property
    def sources(self) -> list[dict[str, str]]: ...

class Answer:
    @property
    def json(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def exit_code(self) -> int: ...
    @property
    def warnings(self) -> list[tuple[str, str]]: ...
    @property
    def messages(self) -> list[str]: ...
    @property
    def errors(self) -> list[Error]: ...

def call(
    command: str,
    options: dict[str, Any] = ...,
    recordings: list[Recording] = ...,
    files: list[str] = ...,
    documents: list[str] = ...,
    progress: Callable[[str, float], object] | None = None,
) -> Answer: ...
def read_all(files: list[Any], options: dict[str, Any] = ...) -> list[Recording]: ...
def describe() -> str: ...
def recording_word(k: int) -> str: ...
def document_word(k: int) -> str: ...
