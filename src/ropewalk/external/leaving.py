"""Who lets code in that ends the process is told so: C's `exit(0)` would look like success."""

from __future__ import annotations

import atexit
import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

_CODE = 1
_in_process: list[str] = []  # who is at work here
_kept: list[Any] = []  # what C must find where it was


@contextmanager
def watched(who: str) -> Iterator[None]:
    """Let an end of the process be told as a failure as long as somebody is at work in it."""
    if not _kept:
        _register()
    _in_process.append(who)
    try:
        yield
    finally:
        with suppress(ValueError):  # Python itself has begun to end
            _in_process.remove(who)


def _register() -> None:
    """Ask C to say when it ends the process; Python takes that back before it ends it itself.

    Where C has no such function, as on Windows, nobody is told.
    """
    try:
        library = ctypes.CDLL(None)
        register, run = library.__cxa_atexit, library.__cxa_finalize
    except (AttributeError, OSError, TypeError):
        _kept.append(None)
        return
    left = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(_left)
    handle = ctypes.create_string_buffer(1)
    _kept.extend([left, handle])
    run.argtypes, run.restype = [ctypes.c_void_p], None
    register.argtypes = [type(left), ctypes.c_void_p, ctypes.c_void_p]
    register(left, None, ctypes.addressof(handle))
    atexit.register(_give_back, run, handle)


def _give_back(run: Any, handle: Any) -> None:
    _in_process.clear()
    run(ctypes.addressof(handle))  # calls what is registered, which says nothing now, and forgets it


def _left(_: object) -> None:
    if not _in_process:
        return
    who = " or ".join(dict.fromkeys(_in_process))
    remedy = "write isolated: true, which runs it in a separate process and keeps the computed part"
    os.write(2, f"{who} has ended the whole process; {remedy}\n".encode())
    os._exit(_CODE)
