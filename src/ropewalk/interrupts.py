"""Ctrl-C, SIGTERM and a lost terminal end a command soon, whatever it is at.

Python hears signals between its own instructions only. Kernels are called for portions of their work
(`mechanics.portions`); the compiler cannot be left halfway, so while it is at work the process ends at once.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
import threading
from types import FrameType

EXIT_CODE = 130  # what shells say of a program that Ctrl-C has ended
_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


class _Heard:
    """What has been heard, and what must not be left halfway."""

    def __init__(self) -> None:
        self.signal = 0
        self.compiling = 0  # compilations under way, one within the other


_heard = _Heard()


def is_interrupted() -> bool:
    """Whether a signal has been heard that is to end the command."""
    return _heard.signal != 0


def note_compiling(begins: bool) -> None:
    """Say that a compilation begins, or has ended."""
    _heard.compiling += 1 if begins else -1


def listen() -> None:
    """Turn signals that end a command into KeyboardInterrupt from now on; those that are ignored stay so."""
    names = [getattr(signal, name) for name in _SIGNALS if hasattr(signal, name)]
    wanted = [number for number in names if signal.getsignal(number) not in (signal.SIG_IGN, None)]
    for number in wanted:
        signal.signal(number, _interrupt)
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    signal.set_wakeup_fd(theirs.detach(), warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(ours, frozenset(wanted)), daemon=True).start()


def _interrupt(number: int, frame: FrameType | None) -> None:
    _heard.signal = number
    if _heard.compiling:
        _leave()
    raise KeyboardInterrupt


def _watch(ours: socket.socket, wanted: frozenset[int]) -> None:
    """Wait for signals beside the compiler, which does not let the main thread hear them."""
    while numbers := ours.recv(64):
        if _heard.compiling and wanted.intersection(numbers):
            _leave()


def _leave() -> None:
    os.write(sys.__stderr__.fileno() if sys.__stderr__ is not None else 2, b"interrupted while compiling\n")
    os._exit(EXIT_CODE)
