"""Loads the shared libraries that a wheel contains for the C++ module, so that the system need not have them."""

from __future__ import annotations

import ctypes
import importlib
import pathlib
from typing import Any


def load() -> None:
    """Loads each library after its dependencies. A library that the process has already loaded by that name is kept."""
    folder = pathlib.Path(__file__).resolve().parent / "libraries"
    order = folder / "order.txt"
    if order.exists():
        for name in order.read_text(encoding="utf-8").split():
            ctypes.CDLL(str(folder / name))


def refuse_sub_interpreter() -> None:
    """mbk and NumPy work only in the main interpreter: loading them in another one would deadlock on its lock."""
    for name in ("_interpreters", "_xxsubinterpreters"):  # from Python 3.13 on, and before
        try:
            interpreters: Any = importlib.import_module(name)
        except ImportError:
            continue
        if interpreters.get_current() != interpreters.get_main():
            raise ImportError("mbk works only in the main interpreter, not in a sub-interpreter; use threads or "
                              "processes (multiprocessing)")
        return
