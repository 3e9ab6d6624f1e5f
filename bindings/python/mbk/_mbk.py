"""The core of mbk, called through its interface in C (bindings/c/mbk.h). Internal; use 'import mbk'."""

from __future__ import annotations

import atexit
import ctypes
import os
import pathlib
import threading
import time
from collections.abc import Callable, Generator
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_ssize_t, c_void_p
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

_LIBRARY = "mbk.dll" if os.name == "nt" else "libmbk.so.1"
_VERSION = 2  # of the interface: MBK_API_VERSION
_FOR_PYTHON = 2
_STOPPED = 130


# ---- the library


def _library() -> ctypes.CDLL:
    """The library beside this file, as in a wheel, otherwise that of the system."""
    beside = pathlib.Path(__file__).with_name(_LIBRARY)
    try:
        return ctypes.CDLL(str(beside) if beside.exists() else _LIBRARY)
    except OSError as error:
        raise ImportError(f"mbk cannot load its library {_LIBRARY}, which should be {beside} or in a folder of the system "
                          f"({error}); install mbk again") from None


_running_free = _library()  # these calls let other Python threads run
_holding = ctypes.PyDLL(_LIBRARY, handle=_running_free._handle)  # these take less time than that would


def _function(library: ctypes.CDLL, name: str, result: Any, *arguments: Any) -> Any:
    try:
        found = library[name]
    except AttributeError:
        raise ImportError(f"the library {_LIBRARY} of mbk is older than this package; install both of one version") from None
    found.restype, found.argtypes = result, arguments
    return found


class _Signal(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("unit", c_char_p), ("values", c_void_p), ("count", c_size_t), ("rows", c_size_t),
                ("stride", c_ssize_t)]


class _Option(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("value", c_char_p)]


class _Event(ctypes.Structure):
    _fields_ = [("time", c_double), ("name", c_char_p), ("value", c_double)]


class _Facts(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("rate_hz", c_double), ("metadata", POINTER(_Option)), ("metadata_count", c_size_t),
                ("events", POINTER(_Event)), ("event_count", c_size_t), ("release", c_void_p), ("owner", c_void_p),
                ("language", c_int), ("rests", POINTER(c_void_p))]


class _Source(ctypes.Structure):
    _fields_ = [("path", c_char_p), ("format", c_char_p), ("sha256", c_char_p), ("trial", c_char_p)]


_Progress = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_double)
_Interrupted = ctypes.CFUNCTYPE(c_int, c_void_p)


class _Request(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("command", c_char_p), ("options", POINTER(_Option)), ("option_count", c_size_t),
                ("words", POINTER(c_char_p)), ("word_count", c_size_t), ("recordings", POINTER(c_void_p)),
                ("recording_count", c_size_t), ("documents", POINTER(c_char_p)), ("document_count", c_size_t),
                ("stop", c_void_p), ("progress", _Progress), ("context", c_void_p), ("language", c_int),
                ("interrupted", _Interrupted)]


_P = c_void_p
_api_version = _function(_holding, "mbk_api_version", c_int)
if _api_version() < _VERSION:
    raise ImportError(f"the library {_LIBRARY} of mbk is older than this package; install both of one version")
_version = _function(_holding, "mbk_version", c_char_p)
_commands = _function(_holding, "mbk_commands", c_char_p)
_in_language = _function(_holding, "mbk_in_language", c_int, c_char_p, c_int, _P, _P)
_error_what = _function(_holding, "mbk_error_what", c_char_p, _P)
_error_where = _function(_holding, "mbk_error_where", c_char_p, _P)
_error_hint = _function(_holding, "mbk_error_hint", c_char_p, _P)
_error_line = _function(_holding, "mbk_error_line", c_char_p, _P)
_error_exit_code = _function(_holding, "mbk_error_exit_code", c_int, _P)
_error_free = _function(_holding, "mbk_error_free", None, _P)
_recording_new = _function(_holding, "mbk_recording_new", c_int, _P, c_size_t, _P, _P, _P)
_recording_free = _function(_holding, "mbk_recording_free", None, _P)
_recording_values = _function(_holding, "mbk_recording_values", _P, _P, c_char_p, _P)
_recording_meaning = _function(_holding, "mbk_recording_meaning", c_int, _P, c_int, _P, _P)
_signal_count = _function(_holding, "mbk_recording_signal_count", c_size_t, _P)
_signal_name = _function(_holding, "mbk_recording_signal_name", c_char_p, _P, c_size_t)
_signal_unit = _function(_holding, "mbk_recording_signal_unit", c_char_p, _P, c_size_t)
_signal_frame = _function(_holding, "mbk_recording_signal_frame", c_char_p, _P, c_size_t)
_signal_values = _function(_holding, "mbk_recording_signal_values", _P, _P, c_size_t, _P)
_metadata_count = _function(_holding, "mbk_recording_metadata_count", c_size_t, _P)
_metadata = _function(_holding, "mbk_recording_metadata", _Option, _P, c_size_t)
_event_count = _function(_holding, "mbk_recording_event_count", c_size_t, _P)
_event = _function(_holding, "mbk_recording_event", _Event, _P, c_size_t)
_note_count = _function(_holding, "mbk_recording_note_count", c_size_t, _P)
_note = _function(_holding, "mbk_recording_note", c_char_p, _P, c_size_t)
_source_count = _function(_holding, "mbk_recording_source_count", c_size_t, _P)
_source = _function(_holding, "mbk_recording_source", _Source, _P, c_size_t)
_call = _function(_running_free, "mbk_call", c_int, _P, _P, _P)
_read_all = _function(_running_free, "mbk_read_all", c_int, _P, _P, _P)
_answer_text = _function(_holding, "mbk_answer_text", c_char_p, _P)
_answer_is_json = _function(_holding, "mbk_answer_is_json", c_int, _P)
_answer_exit_code = _function(_holding, "mbk_answer_exit_code", c_int, _P)
_warning_count = _function(_holding, "mbk_answer_warning_count", c_size_t, _P)
_warning_code = _function(_holding, "mbk_answer_warning_code", c_char_p, _P, c_size_t)
_warning_text = _function(_holding, "mbk_answer_warning_text", c_char_p, _P, c_size_t)
_message_count = _function(_holding, "mbk_answer_message_count", c_size_t, _P)
_message = _function(_holding, "mbk_answer_message", c_char_p, _P, c_size_t)
_answer_error_count = _function(_holding, "mbk_answer_error_count", c_size_t, _P)
_answer_error = _function(_holding, "mbk_answer_error", _P, _P, c_size_t)
_recording_count = _function(_holding, "mbk_answer_recording_count", c_size_t, _P)
_answer_recording = _function(_holding, "mbk_answer_recording", _P, _P, c_size_t)
_answer_free = _function(_holding, "mbk_answer_free", None, _P)


def _keep_freed_memory() -> None:
    """glibc keeps twice as much freed memory as the largest block that it had mapped for itself and got back (mallopt(3),
    M_MMAP_THRESHOLD), as an array that Python frees. A measurement takes and frees 20 MB; a block that nobody touches
    lets that stay, where it would go to the system after each call and come back page by page."""
    take = ctypes.pythonapi["PyMem_RawMalloc"]
    give = ctypes.pythonapi["PyMem_RawFree"]
    take.restype, take.argtypes, give.restype, give.argtypes = c_void_p, (c_size_t,), None, (c_void_p,)
    give(take(16 << 20))


_keep_freed_memory()
__version__: str = _version().decode()


# ---- texts and errors


class Error(ValueError):
    """What is wrong (what), where (file) and what to do about it (hint)."""

    file: str = ""
    what: str = ""
    hint: str = ""
    exit_code: int = 3


def _text(found: bytes) -> str:
    return found.decode("utf-8", "surrogateescape")


def _made(line: str, file: str, what: str, hint: str, exit_code: int) -> Error:
    error = Error(line)
    error.file, error.what, error.hint, error.exit_code = file, what, hint, exit_code
    return error


def _usage(what: str, hint: str) -> Error:
    return _made(f"{what}; {hint}", "", what, hint, 2)


def _error_at(at: Any) -> Error:
    return _made(_text(_error_line(at)), _text(_error_where(at)), _text(_error_what(at)), _text(_error_hint(at)),
                 _error_exit_code(at))


def _taken(error: c_void_p) -> Error:
    """The error of a call that failed."""
    made = _error_at(error)
    _error_free(error)
    return made


def _typed(value: Any) -> bytes:
    """A value as it would be typed. A file name may be invalid UTF-8."""
    if isinstance(value, str):
        made = os.fsencode(value)
    elif isinstance(value, bytes):
        made = value
    elif isinstance(value, bool):
        made = b"true" if value else b"false"
    elif hasattr(value, "__fspath__"):
        return _typed(value.__fspath__())
    elif hasattr(value, "item") and not hasattr(value, "__len__"):  # of NumPy
        return _typed(value.item())
    else:
        made = os.fsencode(str(value))
    return _whole(made)


def _given(value: object) -> bytes:
    """A text that is not typed: a name, a unit, a document."""
    return _whole(str(value).encode("utf-8", "surrogateescape"))


def _whole(text: bytes) -> bytes:
    """C would not see what follows a zero byte."""
    if b"\0" in text:
        raise _usage("a text contains a zero byte", "remove it")
    return text


def in_python(text: str) -> str:
    """A message for the command line with its options and commands as in Python."""
    answer, error = c_void_p(), c_void_p()
    if _in_language(_given(text), _FOR_PYTHON, byref(answer), byref(error)):
        raise _taken(error)
    made = _text(_answer_text(answer))
    _answer_free(answer)
    return made


def describe() -> str:
    """The document of 'mbk manual --json'."""
    return _text(_commands())


def recording_word(k: int) -> str:
    """The word that refers to the recording k of a call."""
    return f"<recording {k + 1}>"


def document_word(k: int) -> str:
    """The word that refers to the document k of a call."""
    return f"<result {k + 1}>.json"


# ---- arrays


def _real_array(name: str, given: Any) -> npt.NDArray[Any]:
    try:
        if hasattr(given, "mask") and hasattr(given, "filled"):  # masked values become NaN
            given = given.astype(np.float64).filled(np.nan)
        array = np.asarray(given)
    except Exception:
        raise _usage(f"'{name}' is not an array", "give a one-dimensional array of numbers") from None
    if array.dtype.kind not in "fiub":
        raise _usage(f"'{name}' is an array of {array.dtype}", "give real numbers, such as float64")
    if array.ndim not in (1, 2):
        raise _usage(f"'{name}' has {array.ndim} dimensions", "give one dimension, or two for a matrix of signals")
    return array


def _rests(array: npt.NDArray[Any], rounded: npt.NDArray[np.float64]) -> npt.NDArray[np.int16] | None:
    """Differences between 64-bit integers and their nearest doubles, in the order of memory; None if there are none.
    They are computed modulo 2^64, because a rounded integer may be one more than the largest."""
    if array.dtype.kind not in "iu" or array.dtype.itemsize < 8:
        return None
    high = np.floor(rounded / 2.0**32)
    low = rounded - high * 2.0**32
    nearest = (high.astype(np.int64).astype(np.uint64) << np.uint64(32)) + low.astype(np.uint64)
    rests = (array.astype(np.uint64) - nearest).astype(np.int64).astype(np.int16)
    return np.ascontiguousarray(rests.ravel(order="F")) if rests.any() else None


def _address(array: npt.NDArray[Any]) -> int:
    at: int = array.__array_interface__["data"][0]
    return at


class _Numbers:
    """Numbers of the library, for NumPy: read-only and without a copy."""

    __slots__ = ("__array_interface__", "keeper")

    def __init__(self, at: int, count: int, keeper: object) -> None:
        self.__array_interface__ = {"data": (at, True), "shape": (count,), "typestr": "<f8", "version": 3}
        self.keeper = keeper


class Recording:
    """Signals in memory. Immutable; threads may share it."""

    __slots__ = ("_at", "_owners", "_read")

    def __init__(
        self,
        channels: dict[str, Any],
        rate_hz: float = 0.0,
        units: dict[str, str] | None = None,
        metadata: dict[str, str] | None = None,
        events: list[tuple[float, str, float]] | None = None,
    ) -> None:
        self._at: int | None = None
        self._read: _Meaning | None = None
        if not isinstance(channels, dict):
            raise TypeError(f"channels has the type {type(channels).__name__}, not dict")
        known = {str(name): unit for name, unit in (units or {}).items()}
        signals = (_Signal * len(channels))()
        rests: list[npt.NDArray[np.int16] | None] = []
        # The numbers stay as long as this object, which the calls that use it and the views of its numbers hold. mbk
        # therefore need not call back: it could do so from a thread for which Python has ended.
        self._owners: list[npt.NDArray[np.float64]] = []
        for signal, (key, given) in zip(signals, channels.items()):
            name = str(key)
            array = _real_array(name, given)
            plain = np.require(array, np.float64, ("ALIGNED", "C" if array.ndim == 1 else "F"))
            self._owners.append(plain)
            rests.append(_rests(array, plain))
            signal.name, signal.unit = _given(name), _given(known.get(name, ""))
            signal.values, signal.count, signal.stride = _address(plain), plain.size, 1
            signal.rows = 0 if array.ndim == 1 else array.shape[0]
        names = {str(name) for name in channels}
        for name in sorted(known):
            if name not in names:
                raise _usage(f"there is a unit for '{name}', but no such signal", "correct its name")
        pairs: list[Any] = [(_given(name), _given(value)) for name, value in (metadata or {}).items()]
        happened: list[Any] = [(float(at), _given(name), float(value)) for at, name, value in (events or [])]
        listed = (_Option * len(pairs))(*pairs)
        events_listed = (_Event * len(happened))(*happened)
        apart = (c_void_p * len(rests))(*[None if one is None else _address(one) for one in rests])
        facts = _Facts(ctypes.sizeof(_Facts), rate_hz, listed, len(pairs), events_listed, len(happened), _NOTHING, None,
                       _FOR_PYTHON, apart)
        made, error = c_void_p(), c_void_p()
        if _recording_new(signals, len(signals), byref(facts), byref(made), byref(error)):
            raise _taken(error)
        self._at = made.value

    @classmethod
    def _of(cls, at: int) -> Recording:
        made = cls.__new__(cls)
        made._at, made._owners, made._read = at, [], None
        return made

    def __del__(self, free: Callable[[Any], None] = _recording_free) -> None:
        if self._at is not None:
            free(self._at)

    def channel(self, name: str) -> npt.NDArray[np.float64]:
        """Numbers of a signal, by its name or that of its channel. KeyError if there is none."""
        if not isinstance(name, str):
            raise TypeError(f"a name has the type {type(name).__name__}, not str")
        count = c_size_t()
        at = None if "\0" in name else _recording_values(self._at, _given(name), byref(count))
        if at is None:
            raise KeyError(name)
        return np.asarray(_Numbers(at, count.value, self))

    @property
    def signals(self) -> list[tuple[str, str]]:
        """Names and units as given."""
        return [(_text(_signal_name(self._at, k)), _text(_signal_unit(self._at, k))) for k in range(_signal_count(self._at))]

    def _meaning(self) -> _Meaning:
        if self._read is None:
            self._read = _Meaning(self._at)
        return self._read

    @property
    def channels(self) -> list[tuple[str, str, str]]:
        """Names, SI units and frames of the recognised channels."""
        return list(self._meaning().channels)

    @property
    def samples(self) -> int:
        """Number of samples."""
        return self._meaning().samples

    @property
    def metadata(self) -> dict[str, str]:
        """Other properties, by name."""
        return dict(self._meaning().metadata)

    @property
    def notes(self) -> list[str]:
        """Notes about how it was read."""
        return list(self._meaning().notes)

    @property
    def events(self) -> list[tuple[float, str, float]]:
        """Time [s], name and value of each event."""
        return list(self._meaning().events)

    @property
    def sources(self) -> list[dict[str, str]]:
        """Files that the recording was read from."""
        return [dict(one) for one in self._meaning().sources]


_NOTHING = ctypes.cast(_error_free, c_void_p).value  # as `release`, called with NULL: it does nothing


class _Meaning:
    """What commands take a recording for."""

    __slots__ = ("channels", "events", "metadata", "notes", "samples", "sources")

    def __init__(self, recording: int | None) -> None:
        at, error, count = c_void_p(), c_void_p(), c_size_t()
        if _recording_meaning(recording, _FOR_PYTHON, byref(at), byref(error)):
            raise _taken(error)
        _signal_values(at, 0, byref(count))  # the time
        self.samples = count.value
        self.channels = [(_text(_signal_name(at, k)), _text(_signal_unit(at, k)), _text(_signal_frame(at, k)))
                         for k in range(1, _signal_count(at))]
        entries = [_metadata(at, k) for k in range(_metadata_count(at))]
        self.metadata = {_text(one.name): _text(one.value) for one in entries}
        self.notes = [_text(_note(at, k)) for k in range(_note_count(at))]
        happened = [_event(at, k) for k in range(_event_count(at))]
        self.events = [(float(one.time), _text(one.name), float(one.value)) for one in happened]
        files = [_source(at, k) for k in range(_source_count(at))]
        self.sources = [{"path": _text(one.path), "format": _text(one.format), "sha256": _text(one.sha256),
                         "trial": _text(one.trial)} for one in files]
        _recording_free(at)


# ---- calls


_ending_thread: int | None = None  # the thread that ends the interpreter, once it does
_running: set[object] = set()  # calls


def _others_are_ending() -> bool:
    return _ending_thread is not None and _ending_thread != threading.get_ident()


def _end_calls() -> None:
    """Ends the calls of daemon threads, and waits for them: Python ends such a thread where it asks for the interpreter's
    lock, which it must not do in the middle of the library, nor may the library go on when the process ends."""
    global _ending_thread
    _ending_thread = threading.get_ident()
    last = time.monotonic() + 10.0
    while _running and time.monotonic() < last:
        time.sleep(0.001)


atexit.register(_end_calls)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_running.clear)


def _watch(kept: list[BaseException]) -> Generator[int, Any, None]:
    """Says to `send`, on the thread of a call, whether to stop it. A generator that waits inside `try`, because Python runs
    the handlers of signals before the first instruction of a function, where none of it could catch KeyboardInterrupt."""
    while True:
        try:
            while True:
                yield 1 if kept or _others_are_ending() else 0
        except GeneratorExit:
            raise
        except BaseException as error:
            kept.append(error)


class Answer:
    """The answer of a command.

    json: the document of --json, or ""; text: what the command prints; warnings: code and text of each, which ends with
    the advice; messages: what the program would print on standard error; errors: of files or recordings that failed
    while others succeeded.
    """

    __slots__ = ("errors", "exit_code", "json", "messages", "text", "warnings")

    def __init__(self, at: c_void_p) -> None:
        self.text = _text(_answer_text(at))
        self.json = self.text if _answer_is_json(at) else ""
        self.exit_code: int = _answer_exit_code(at)
        self.warnings = [(_text(_warning_code(at, k)), _text(_warning_text(at, k))) for k in range(_warning_count(at))]
        self.messages = [_text(_message(at, k)) for k in range(_message_count(at))]
        self.errors = [_error_at(_answer_error(at, k)) for k in range(_answer_error_count(at))]


def _options(options: dict[str, Any]) -> list[Any]:
    """Each with one value; an option is repeated for several. None and False: not given."""
    made: list[Any] = []
    for key, value in options.items():
        name = _given(key).replace(b"_", b"-")
        if value is None or value is False and name != b"json":
            continue
        if isinstance(value, (list, tuple)):
            made += [(name, _typed(one)) for one in value]
        else:
            made.append((name, _typed(value)))
    return made


def _run(
    use: Any,
    command: str,
    options: dict[str, Any],
    recordings: list[Recording],
    files: list[Any],
    documents: list[str],
    progress: Callable[[str, float], object] | None,
) -> c_void_p:
    """The answer of `use`, run without the interpreter's lock. Ctrl-C and an exception in `progress` end it."""
    pairs = _options(options)
    listed = (_Option * len(pairs))(*pairs) if pairs else None
    words = (c_char_p * len(files))(*map(_typed, files)) if files else None
    texts = (c_char_p * len(documents))(*map(_given, documents)) if documents else None
    held = (c_void_p * len(recordings))(*[one._at for one in recordings]) if recordings else None
    kept: list[BaseException] = []
    watch = _watch(kept)
    next(watch)

    def report(_context: Any, what: bytes, fraction: float) -> None:
        try:
            progress(_text(what), fraction)  # type: ignore[misc]
        except BaseException as error:
            kept.append(error)

    request = _Request(_REQUEST_SIZE, _typed(command), listed, len(pairs), words, len(files), held, len(recordings), texts,
                       len(documents), None, _NO_PROGRESS if progress is None else _Progress(report), None, _FOR_PYTHON,
                       _Interrupted(watch.send))
    answer, error = c_void_p(), c_void_p()
    _running.add(watch)
    try:
        if _others_are_ending():
            kept.append(_made("stopped", "", "stopped", "", 3))
        else:
            code = use(byref(request), byref(answer), byref(error))
    finally:
        _running.discard(watch)
    if kept:
        _answer_free(answer)
        _error_free(error)
        raise kept[0]
    if not answer:
        failed = _taken(error)
        failed.exit_code = 3 if code == _STOPPED else failed.exit_code
        raise failed
    return answer


_REQUEST_SIZE = ctypes.sizeof(_Request)
_NO_PROGRESS: Any = ctypes.cast(0, _Progress)


def call(
    command: str,
    options: dict[str, Any] = {},  # noqa: B006: never changed
    recordings: list[Recording] = [],  # noqa: B006
    files: list[Any] = [],  # noqa: B006
    documents: list[str] = [],  # noqa: B006
    progress: Callable[[str, float], object] | None = None,
) -> Answer:
    """Runs a command on files and on what is in memory."""
    at = _run(_call, command, options, recordings, files, documents, progress)
    try:
        return Answer(at)
    finally:
        _answer_free(at)


def read_all(files: list[Any], options: dict[str, Any] = {}) -> list[Recording]:  # noqa: B006
    """Every recording in the files."""
    at = _run(_read_all, "read", options, [], files, [], None)
    try:
        return [Recording._of(_answer_recording(at, k)) for k in range(_recording_count(at))]
    finally:
        _answer_free(at)
