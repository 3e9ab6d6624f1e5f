"""Which interpreters mbk works in."""

from __future__ import annotations

import importlib
from typing import Any


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
