"""The process of an isolated FMU: it answers what the run asks, after `supervision.py` has confined it."""

from __future__ import annotations

import os
import pickle
import tempfile
from collections import deque
from contextlib import suppress
from typing import IO, Any, BinaryIO

from ropewalk.checkpoint import to_bytes
from ropewalk.errors import RopewalkError
from ropewalk.external.slave import LONGEST, REMEMBERED, Slave

AT_ONCE = 200  # messages of an FMU that are sent while a question is answered


def serve(folder: str, trouble: str = "") -> None:
    """Be the child: answer requests from standard input until it ends, with the FMU unpacked in a folder.

    Args:
        folder: for the FMU.
        trouble: why it must not be loaded; empty if it may.
    """
    tempfile.tempdir = folder
    up, down = os.fdopen(os.dup(1), "wb"), os.fdopen(os.dup(0), "rb")
    os.dup2(2, 1)  # what the FMU prints must not get between the answers
    with open(os.devnull, "rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    _serve(down, up, folder, trouble)


def _serve(down: BinaryIO, up: BinaryIO, folder: str, trouble: str) -> None:
    slave: Slave | None = None
    messages = _Messages(up)
    while True:
        try:
            method, arguments, forgotten = pickle.load(down)
        except EOFError:
            method, arguments, forgotten = "close", (), ()
        try:
            if method == "load":
                if trouble:
                    raise RopewalkError(f"{arguments[0].who}: {trouble}")
                slave, answer = Slave(arguments[0], messages.hear, folder), None
            else:
                assert slave is not None
                for number in forgotten:
                    slave.forget(number)
                answer = getattr(slave, method)(*arguments)
            reply = "done", answer
        except RopewalkError as error:
            reply = "failed", str(error)
        except Exception as error:
            reply = "failed", f"{type(error).__name__}: {error}"
        with suppress(BrokenPipeError):
            messages.flush()
            _send(up, reply)
        if method == "close":
            break


class _Messages:
    """What an FMU says, sent at once so that a crash does not take it along; of a flood, the first and the last."""

    def __init__(self, up: BinaryIO) -> None:
        self._up, self._count = up, 0
        self._last: deque[tuple[int, str]] = deque(maxlen=REMEMBERED)

    def hear(self, status: int, text: str) -> None:
        """Send a message, or keep it for the end of the step if there are many."""
        self._count += 1
        if self._count > AT_ONCE:
            self._last.append((status, text[:LONGEST]))
        else:
            _send(self._up, ("said", (status, text[:LONGEST])))

    def flush(self) -> None:
        """Send those that were kept."""
        for said in self._last:
            _send(self._up, ("said", said))
        self._last.clear()
        self._count = 0


def _send(stream: IO[bytes], what: Any) -> None:
    data = to_bytes(what)
    stream.write(len(data).to_bytes(8, "little") + data)
    stream.flush()
