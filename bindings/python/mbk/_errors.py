"""What goes wrong, and what needs care."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from mbk import _mbk


class Error(ValueError):
    """mbk gave no answer.

    Attributes
    ----------
    file : str
        Where it happened: a file, an option; empty where it is of no file.
    what : str
        What is wrong.
    hint : str
        What to do about it.
    exit_code : int
        With which the command would have ended.
    """

    file: str = ""
    what: str = ""
    hint: str = ""
    exit_code: int = 3

    def __init__(self, line: str, *, file: str = "", what: str = "", hint: str = "") -> None:
        super().__init__(line)
        self.file, self.what, self.hint = file, what or line, hint

    def __reduce__(self) -> tuple[object, ...]:
        return _made_again, (type(self), str(self), self.file, self.what, self.hint)


class UsageError(Error):
    """An option or an argument is wrong (exit code 2)."""

    exit_code = 2


class DataError(Error):
    """A file or a recording cannot be read or used (exit code 3)."""

    exit_code = 3


class NotUsableError(Error):
    """What was given is marked as not usable, such as a robot that could not be identified (exit code 4)."""

    exit_code = 4


class MbkWarning(UserWarning):
    """An answer needs care. The text begins with the code in brackets, so that one kind can be filtered:

    >>> import warnings
    >>> warnings.filterwarnings("ignore", message=r"\\[no-held-out-data\\]")

    Attributes
    ----------
    code : str
        Stable: scripts may test for it.
    text : str
        What was found, and what to try.
    """

    def __init__(self, code: str, text: str) -> None:
        super().__init__(f"[{code}] {text}")
        self.code, self.text = code, text


def usage(what: str, hint: str) -> UsageError:
    """An argument is wrong."""
    return UsageError(f"{what}; {hint}", what=what, hint=hint)


_CLASSES: dict[int, type[Error]] = {2: UsageError, 3: DataError, 4: NotUsableError}


def _made_again(kind: type[Error], line: str, file: str, what: str, hint: str) -> Error:
    return kind(line, file=file, what=what, hint=hint)


def of(error: _mbk.Error) -> Error:
    """The exception for what the core says."""
    kind = _CLASSES.get(error.exit_code, Error)
    return kind(str(error), file=error.file, what=error.what, hint=error.hint)


@contextmanager
def translated() -> Iterator[None]:
    """What the core raises, as an exception of this package."""
    try:
        yield
    except _mbk.Error as error:
        raise of(error) from None
