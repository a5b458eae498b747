"""Ctrl-C, SIGTERM and a lost terminal end a command soon, whatever it is at.

Python hears signals between its own instructions only. Kernels are called for portions of their work
(`mechanics.portions`). Numba and LLVM cannot be left halfway: LLVM calls Python back and drops exceptions, and goes on
without the machine code that it asked for. The process ends at once while kernels are compiled or loaded. Where an
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
from collections.abc import Callable, Iterator
from contextlib import contextmanager
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
        self.loading = 0  # the same for kernels that are taken from the cache
        self.deferred = 0  # blocks that are completed first, one within the other
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


def note_loading(begins: bool) -> None:
    """Record that a kernel is being loaded from the cache, or has been loaded."""
    _heard.loading += 1 if begins else -1


@contextmanager
def deferred() -> Iterator[None]:
    """Complete a short block, such as the start of a process, before a signal is raised as KeyboardInterrupt."""
    _heard.deferred += 1
    try:
        yield
    finally:
        _heard.deferred -= 1
        if _heard.signal and not _heard.deferred:
            raise KeyboardInterrupt


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
    if _heard.deferred:
        return
    if _heard.compiling or _heard.loading:
        _leave()
    if not loses_exceptions(frame):
        raise KeyboardInterrupt
    if time.monotonic() > _heard.since + _IMPORTS:
        _leave()
    _hear_again()


def loses_exceptions(frame: FrameType | None) -> bool:
    """Return whether an exception raised in this frame may be dropped on its way to the caller.

    LLVM calls Python back and goes on after an exception; extension modules that are being imported replace it.
    """
    while frame is not None:
        name = str(frame.f_globals.get("__name__"))
        if name == "importlib._bootstrap" or name.startswith("llvmlite."):
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
        if (_heard.compiling or _heard.loading) and wanted.intersection(numbers):
            _leave()
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


def _leave() -> None:
    if not _heard.leaving.acquire(blocking=False):
        time.sleep(1.0)  # the other thread is about to end us
        return
    message = "interrupted while compiling" if _heard.compiling else "interrupted"
    os.write(sys.__stderr__.fileno() if sys.__stderr__ is not None else 2, f"{message}{_heard.kept()}\n".encode())
    os._exit(EXIT_CODE)
