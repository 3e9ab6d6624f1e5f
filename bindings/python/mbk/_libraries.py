"""Loads what a wheel brings along for the module in C++: then the system need not have it."""

from __future__ import annotations

import ctypes
import importlib
import pathlib
from typing import Any


def load() -> None:
    """Each library after those that it needs. A library that the process has under that name already stays."""
    folder = pathlib.Path(__file__).resolve().parent / "libraries"
    order = folder / "order.txt"
    if order.exists():
        for name in order.read_text(encoding="utf-8").split():
            ctypes.CDLL(str(folder / name))


def refuse_sub_interpreter() -> None:
    """mbk and NumPy belong to the main interpreter: loading them in another one would wait for its lock for ever."""
    for name in ("_interpreters", "_xxsubinterpreters"):  # from Python 3.13 on, and before
        try:
            interpreters: Any = importlib.import_module(name)
        except ImportError:
            continue
        if interpreters.get_current() != interpreters.get_main():
            raise ImportError("mbk works in the main interpreter only, not in a sub-interpreter; use threads, or "
                              "processes (multiprocessing)")
        return
