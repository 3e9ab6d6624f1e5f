"""Loads what a wheel brings along for the module in C++: then the system need not have it."""

from __future__ import annotations

import ctypes
import pathlib


def load() -> None:
    """Each library after those that it needs. A library that the process has under that name already stays."""
    folder = pathlib.Path(__file__).resolve().parent / "libraries"
    order = folder / "order.txt"
    if order.exists():
        for name in order.read_text(encoding="utf-8").split():
            ctypes.CDLL(str(folder / name))
