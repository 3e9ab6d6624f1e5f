"""Live view of a trial: a client for the console of `mbk run`. It only receives data and never moves a robot."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import re
import socket
import struct
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mbk import _documents, _errors

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import numpy.typing as npt

COLUMNS = ("time", "hand_x", "hand_y", "force_x", "force_y", "reference_x", "reference_y", "acceleration_x",
           "acceleration_y", "torque_1", "torque_2", "compute_us", "lateness_us")
_HEADER = struct.Struct("<4sHHIIdd")
_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_LONGEST = 1 << 26  # bytes of a message
_TEXT, _BYTES, _CLOSE, _PING, _PONG = 1, 2, 8, 9, 10


class _Socket:
    """The part of WebSocket (RFC 6455) that the console uses."""

    def __init__(self, host: str, port: int, token: str, timeout: float) -> None:
        where = f"{host}:{port}"
        try:
            self.socket = socket.create_connection((host, port), timeout)
        except OSError as error:
            raise _refused(where, f"no console answers ({error.strerror or error})",
                           "start 'mbk run --console' in a terminal, or correct the port") from None
        self.buffer = bytearray()
        try:
            self._open(where, token)
        except BaseException:
            self.socket.close()
            raise
        self.socket.settimeout(None)

    def _open(self, where: str, token: str) -> None:
        key = base64.b64encode(os.urandom(16))
        self.socket.sendall(
            f"GET /stream?token={token} HTTP/1.1\r\nHost: {where}\r\nOrigin: http://{where}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key.decode()}\r\n\r\n".encode())
        try:
            while b"\r\n\r\n" not in self.buffer:
                if len(self.buffer) > 65536:
                    raise _refused(where, "no console answers", "use the address that 'mbk run' prints")
                self._fill()
        except (OSError, EOFError):
            raise _refused(where, "no console answers", "use the address that 'mbk run' prints") from None
        head, _, rest = bytes(self.buffer).partition(b"\r\n\r\n")
        self.buffer = bytearray(rest)
        status = head.split(b"\r\n")[0].split(b" ")[1:2]
        if status != [b"101"]:
            code = b"".join(status).decode("ascii", "replace")
            if code == "503":
                raise _refused(where, "the console accepts no more pages", "close one page")
            raise _errors.UsageError(f"{where}: the console rejects the token (HTTP {code}); use a token that this run "
                                     "of 'mbk run' printed", file=where, what=f"the console rejects the token (HTTP {code})",
                                     hint="use a token that this run of 'mbk run' printed")
        accepted = base64.b64encode(hashlib.sha1(key + _GUID).digest())
        if not re.search(rb"(?i)\r\nsec-websocket-accept:\s*" + re.escape(accepted), head):
            raise _refused(where, "the server at this address is not a console", "use the address that 'mbk run' prints")

    def _fill(self) -> None:
        part = self.socket.recv(1 << 18)
        if not part:
            raise EOFError("the console has ended")
        self.buffer += part

    def _take(self, count: int) -> bytes:
        while len(self.buffer) < count:
            self._fill()
        taken = bytes(self.buffer[:count])
        del self.buffer[:count]
        return taken

    def _send(self, opcode: int, payload: bytes) -> None:
        mask = os.urandom(4)
        masked = bytes(byte ^ mask[k % 4] for k, byte in enumerate(payload))
        self.socket.sendall(bytes([0x80 | opcode, 0x80 | len(payload)]) + mask + masked)

    def messages(self) -> Iterator[tuple[int, bytes]]:
        """Yields each message with its kind and answers pings. Raises EOFError when the console ends."""
        whole, kind = bytearray(), 0
        while True:
            first, second = self._take(2)
            size = second & 0x7F
            if size == 126:
                size = struct.unpack("!H", self._take(2))[0]
            elif size == 127:
                size = struct.unpack("!Q", self._take(8))[0]
            if size + len(whole) > _LONGEST or second & 0x80:
                raise EOFError("the data are not a message of a console")
            payload, opcode = self._take(size), first & 0x0F
            if opcode == _PING:
                self._send(_PONG, payload[:125])
            elif opcode == _CLOSE:
                raise EOFError("the console has ended")
            elif opcode <= _BYTES:
                kind = opcode or kind
                whole += payload
                if first & 0x80:
                    yield kind, bytes(whole)
                    whole.clear()

    def close(self) -> None:
        try:
            self.socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self.socket.close()


def _refused(where: str, what: str, hint: str) -> _errors.DataError:
    return _errors.DataError(f"{where}: {what}; {hint}", file=where, what=what, hint=hint)


class Live:
    """A running trial, as its console shows it. Made by `live`; close it, or use it in a ``with`` statement.

    A background thread receives the data; attributes always have the latest values.

    Attributes
    ----------
    state : dict
        The latest state: `phase`, `running`, `time_s`, `safety`, `trials`, … (schema `console`).
    estimate : Result or None
        The latest M, B and K with their intervals, while the trial is still running.
    """

    def __init__(self, host: str, port: int, token: str, *, timeout: float = 10.0, keep_s: float = 120.0) -> None:
        self._socket = _Socket(host, port, token, timeout)
        self._changed = threading.Condition()
        self._keep_s = keep_s
        self._blocks: deque[npt.NDArray[np.float64]] = deque()
        self._trial = -1
        self._count = 0  # of messages
        self._ended: str | None = None
        self.state: dict[str, Any] = {}
        self.estimate: _documents.Result | None = None
        self._reader = threading.Thread(target=self._read, name="mbk.live", daemon=True)
        self._reader.start()

    def _read(self) -> None:
        try:
            for kind, message in self._socket.messages():
                with self._changed:
                    if kind == _TEXT:
                        self._take_text(json.loads(message))
                    else:
                        self._take_samples(message)
                    self._count += 1
                    self._changed.notify_all()
        except (OSError, EOFError, ValueError, KeyError, struct.error) as error:
            with self._changed:
                self._ended = str(error) or type(error).__name__
                self._changed.notify_all()

    def _take_text(self, message: dict[str, Any]) -> None:
        if message["type"] == "state":
            self.state = message
        elif message["type"] == "estimate":
            result = message.get("result")
            self.estimate = _documents.Result(json.dumps(result, ensure_ascii=False)) if result else None

    def _take_samples(self, message: bytes) -> None:
        magic, version, columns, samples, trial, first, _ = _HEADER.unpack_from(message)
        if magic != b"MBKF" or version != 1 or columns < len(COLUMNS):
            raise ValueError("the console sends a newer version of the stream")
        block = np.frombuffer(message, dtype="<f4", count=columns * samples, offset=_HEADER.size)
        block = block.reshape(samples, columns)[:, :len(COLUMNS)].astype(np.float64)
        block[:, 0] += first
        if trial != self._trial:
            self._trial = trial
            self._blocks.clear()
        self._blocks.append(block)
        while self._blocks[0][-1, 0] < block[-1, 0] - self._keep_s:
            self._blocks.popleft()

    @property
    def open(self) -> bool:
        """Whether the console is still sending."""
        return self._ended is None

    @property
    def trial(self) -> int:
        """Number of the trial that the samples belong to, from 0; -1: none yet."""
        return self._trial

    def samples(self, last_s: float | None = None) -> dict[str, npt.NDArray[np.float64]]:
        """Samples of the current trial.

        Parameters
        ----------
        last_s : float, optional
            Only the last `last_s` seconds [s] (default: all samples kept).

        Returns
        -------
        dict of str to numpy.ndarray
            Shape (samples,): `time` [s]; `hand_x`, `hand_y` [m]; `force_x`, `force_y` of the hand on the robot [N];
            `reference_x`, `reference_y` [m or N]; `acceleration_x`, `acceleration_y` [m/s²]; `torque_1`, `torque_2`
            [N·m]; `compute_us`, `lateness_us` of the ticks [µs].
        """
        with self._changed:
            blocks = list(self._blocks)
        table = np.concatenate(blocks) if blocks else np.empty((0, len(COLUMNS)))
        if last_s is not None and len(table):
            table = table[table[:, 0] >= table[-1, 0] - last_s]
        return {name: table[:, k].copy() for k, name in enumerate(COLUMNS)}

    def wait(self, until: Callable[[Live], object], timeout: float = 60.0) -> bool:
        """Waits until a condition is true; checks it at each message.

        Parameters
        ----------
        until : callable
            Function of this object: ``lambda trial: trial.estimate is not None``.
        timeout : float
            Maximum time to wait [s].

        Returns
        -------
        bool
            Whether the condition is true; False after the timeout or when the console has ended.
        """
        end = time.monotonic() + timeout
        seen = -1
        while True:
            with self._changed:
                while self._count == seen and self._ended is None and time.monotonic() < end:
                    self._changed.wait(min(0.25, max(0.0, end - time.monotonic())))
                seen, ended = self._count, self._ended is not None
            if until(self):
                return True
            if ended or time.monotonic() >= end:
                return False

    def __iter__(self) -> Iterator[Live]:
        """Yields this object at each new message, until the console ends."""
        seen = 0
        while True:
            with self._changed:
                while self._count == seen and self._ended is None:
                    self._changed.wait(0.25)
                if self._count == seen:
                    return
                seen = self._count
            yield self

    def plot(self, last_s: float = 8.0,
             axes: Sequence[matplotlib.axes.Axes] | None = None) -> matplotlib.figure.Figure:
        """Position and force of the last seconds, with the reference dashed."""
        from mbk import _plots

        return _plots.live(self.samples(last_s), self._reference_unit(), axes)

    def _reference_unit(self) -> str:
        trials = self.state.get("trials", [])
        return str(trials[self._trial]["reference_unit"]) if 0 <= self._trial < len(trials) else "m"

    def close(self) -> None:
        """Disconnects. The trial continues."""
        self._socket.close()
        if self._reader is not threading.current_thread():
            self._reader.join(5.0)

    def __enter__(self) -> Live:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        if not self.open:
            return f"<mbk.Live: {self._ended}>"
        return f"<mbk.Live: {self.state.get('phase', 'connected')}, {self.state.get('time_s', 0.0):.1f} s>"


def live(address: str, token: str | None = None, *, timeout: float = 10.0, keep_s: float = 120.0) -> Live:
    """Connects to the console of `mbk run` and shows its trial.

    Parameters
    ----------
    address : str
        ``"127.0.0.1:40113"``, or an address that `mbk run` prints, with its token.
    token : str, optional
        A token that `mbk run` prints; the viewer token is enough.
    timeout : float
        Time limit for the console to answer [s].
    keep_s : float
        Duration of the samples to keep [s].

    Returns
    -------
    Live

    Raises
    ------
    DataError
        No console answers at the address.
    UsageError
        The token does not belong to this run.

    Examples
    --------
    >>> with mbk.live("127.0.0.1:40113", "91ab…") as trial:      # doctest: +SKIP
    ...     trial.wait(lambda now: now.estimate is not None)
    ...     print(trial.estimate.model.K)
    """
    match = re.fullmatch(r"(?:http://)?([\w.-]+):(\d+)(?:/[\w/]*(?:\?token=(\w+))?)?", address.strip())
    token = token or (match[3] if match else None)
    if not match or not 0 < int(match[2]) < 65536 or not token or not re.fullmatch(r"\w+", token):
        raise _errors.UsageError(f"'{address}' is not an address with a token; write mbk.live(\"127.0.0.1:40113\", token) as "
                                 "'mbk run' prints them", what=f"'{address}' is not an address with a token",
                                 hint="write mbk.live(\"127.0.0.1:40113\", token) as 'mbk run' prints them")
    return Live(match[1], int(match[2]), token, timeout=timeout, keep_s=keep_s)
