"""Exceptions and warnings."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from mbk import _mbk


class Error(ValueError):
    """mbk could not compute a result.

    Attributes
    ----------
    file : str
        Where the error is: a file or an option; may be empty.
    what : str
        What is wrong.
    hint : str
        What to do; may be empty.
    exit_code : int
        Exit code of the command.
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


class WrongTypeError(UsageError, TypeError):
    """An argument has a type that the function does not accept."""


class DataError(Error):
    """A file or a recording cannot be read or used (exit code 3)."""

    exit_code = 3


class NotUsableError(Error):
    """An input is marked as not usable, such as a robot that could not be identified (exit code 4)."""

    exit_code = 4


class MbkWarning(UserWarning):
    """A result needs care. The message begins with the code in brackets, so that you can filter one kind:

    >>> import warnings
    >>> warnings.filterwarnings("ignore", message=r"\\[no-held-out-data\\]")

    Attributes
    ----------
    code : str
        Stable, so that scripts may test for it.
    text : str
        What was found; what to do.
    """

    def __init__(self, code: str, text: str) -> None:
        super().__init__(f"[{code}] {text}")
        self.code, self.text = code, text


def usage(what: str, hint: str) -> UsageError:
    """Makes the error for a wrong argument."""
    return UsageError(f"{what}; {hint}", what=what, hint=hint)


def wrong_type(given: object, what: str, hint: str) -> WrongTypeError:
    """Makes the error for an argument of the wrong type."""
    what = f"the type {type(given).__name__} {what}"
    return WrongTypeError(f"{what}; {hint}", what=what, hint=hint)


_CLASSES: dict[int, type[Error]] = {2: UsageError, 3: DataError, 4: NotUsableError}


def _made_again(kind: type[Error], line: str, file: str, what: str, hint: str) -> Error:
    return kind(line, file=file, what=what, hint=hint)


def of(error: _mbk.Error) -> Error:
    """The exception for an error of the core."""
    kind = _CLASSES.get(error.exit_code, Error)
    return kind(str(error), file=error.file, what=error.what, hint=error.hint)


@contextmanager
def translated() -> Iterator[None]:
    """Raises errors of the core as exceptions of this package."""
    try:
        yield
    except _mbk.Error as error:
        raise of(error) from None
