"""Ctrl-C, SIGTERM and a lost terminal end a command soon, whatever it is at.

Python hears signals between its own instructions only. Kernels are called for portions of their work
(`mechanics.portions`); the compiler cannot be left halfway, so while it is at work the process ends at once. Where an
exception would be lost (while modules are imported, in destructors) the signal is heard once more a little later.
"""

from __future__ import annotations

import _thread
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType
from typing import Any

EXIT_CODE = 130  # what shells say of a program that Ctrl-C has ended
_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")
_AGAIN = 0.01  # s until a signal is heard once more
_IMPORTS = 0.3  # s that imports may go on when a signal has been heard: what they are in the middle of is lost


class _Heard:
    """What has been heard, and what must not be left halfway."""

    def __init__(self) -> None:
        self.signal = 0
        self.since = 0.0  # s on a clock, when it was heard first
        self.compiling = 0  # compilations under way, one within the other
        self.again = False  # whether it is to be heard once more
        self.ending = False  # whether the process ends anyhow
        self.kept: Callable[[], str] = str  # what there is to say of a file that has been begun
        self.waker: socket.socket | None = None  # of the thread that sees to that
        self.leaving = threading.Lock()  # taken by the thread that ends the process


_heard = _Heard()


def is_interrupted() -> bool:
    """Whether a signal has been heard that is to end the command."""
    return _heard.signal != 0


def note_compiling(begins: bool) -> None:
    """Say that a compilation begins, or has ended."""
    _heard.compiling += 1 if begins else -1


def note_kept(kept: Callable[[], str]) -> None:
    """Say what is to be told of a file that has been begun, if the command ends."""
    _heard.kept = kept


def note_ending() -> None:
    """Record that the command has come to its end: a signal changes nothing any more."""
    _heard.ending = True


def listen() -> None:
    """Turn signals that end a command into KeyboardInterrupt from now on; those that are ignored stay so."""
    names = [getattr(signal, name) for name in _SIGNALS if hasattr(signal, name)]
    wanted = [number for number in names if signal.getsignal(number) not in (signal.SIG_IGN, None)]
    for number in wanted:
        signal.signal(number, _interrupt)
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    _heard.waker = theirs
    signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    sys.unraisablehook = _lost
    threading.Thread(target=_watch, args=(ours, frozenset(wanted)), daemon=True).start()


def _interrupt(number: int, frame: FrameType | None) -> None:
    if _heard.ending:
        return
    if not _heard.signal:
        _heard.signal, _heard.since = number, time.monotonic()
    if _heard.compiling:
        _leave("interrupted while compiling")
    if not _imports(frame):
        raise KeyboardInterrupt
    if time.monotonic() > _heard.since + _IMPORTS:
        _leave("interrupted")
    _hear_again()


def _imports(frame: FrameType | None) -> bool:
    """Whether modules are being imported; what extension modules make of an exception then is anything."""
    while frame is not None:
        if frame.f_globals.get("__name__") == "importlib._bootstrap":
            return True
        frame = frame.f_back
    return False


def _lost(found: Any) -> None:
    """What is raised in a destructor goes no further: an interrupt is heard once more, everything else is told."""
    if is_interrupted() and issubclass(found.exc_type, KeyboardInterrupt):
        _hear_again()
    else:
        sys.__unraisablehook__(found)


def _hear_again() -> None:
    _heard.again = True
    if _heard.waker is not None:
        _heard.waker.send(bytes([_heard.signal]))


def _watch(ours: socket.socket, wanted: frozenset[int]) -> None:
    """Wait for signals next to the compiler, which does not let the main thread hear them."""
    while numbers := ours.recv(64):
        if _heard.compiling and wanted.intersection(numbers):
            _leave("interrupted while compiling")
        if _heard.again:
            _heard.again = False
            time.sleep(_AGAIN)
            _send(_heard.signal)


def _send(number: int) -> None:
    """Send the main thread a signal, which ends what it waits for."""
    if hasattr(signal, "pthread_kill") and (main := threading.main_thread().ident) is not None:
        signal.pthread_kill(main, number)
    else:
        _thread.interrupt_main(signal.Signals(number))


def _leave(message: str) -> None:
    if not _heard.leaving.acquire(blocking=False):
        time.sleep(1.0)  # the other thread is about to end us
        return
    os.write(sys.__stderr__.fileno() if sys.__stderr__ is not None else 2, f"{message}{_heard.kept()}\n".encode())
    os._exit(EXIT_CODE)
