"""Isolation: an FMU at work in a process of its own, so that its crash or endless loop ends the run in order.

Parent and child take turns: a pickled (method, arguments, states to forget) down a pipe, an answer up another, which is
plain data: reading it can run nothing. The child may write in one folder only, where the FMU is unpacked, and knows no
network, as far as the system keeps it from that (`confinement.py`). A watcher in the parent kills a child that does not
answer in time, whereupon the pipe ends; one in the child ends it when its parent is gone.
"""

from __future__ import annotations

import os
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import weakref
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, BinaryIO

from ropewalk.checkpoint import CheckpointError, from_bytes, to_bytes
from ropewalk.errors import RopewalkError
from ropewalk.external.confinement import leave_network, write_only_in
from ropewalk.external.fmu_wiring import Wiring
from ropewalk.external.slave import REMEMBERED, UNPACKED, Slave, quoted

LOOK = 0.2  # s, at which the watchers look
STARTING = 30.0  # s, that loading may take longer: Python itself must start
FAREWELL = 2.0  # s, for an FMU to end by itself
LARGEST = 1 << 30  # bytes of an answer, which a state may be
_CHILD = "import sys; sys.path.append(sys.argv[1]); from ropewalk.external.isolation import serve; serve(sys.argv[2])"


@dataclass
class _Watched:
    """A child and when its answer is due."""

    process: subprocess.Popen[bytes]
    folder: str  # where its FMU is unpacked
    due: float | None = None  # s on the clock
    is_late: bool = False
    is_over: threading.Event = field(default_factory=threading.Event)

    def watch(self) -> None:
        """Kill the child when it takes too long."""
        while not self.is_over.wait(LOOK):
            due = self.due
            if due is not None and time.monotonic() > due:
                self.is_late = True
                self.kill()
                return

    def kill(self) -> None:
        """End the child, with everything that it has started."""
        if self.process.poll() is None:
            with suppress(OSError):
                if hasattr(os, "killpg"):
                    os.killpg(self.process.pid, signal.SIGKILL)
            self.process.kill()
            self.process.wait()

    def release(self) -> None:
        """End it, close the pipes and tidy up; not for the watcher, the other thread may still be reading."""
        self.is_over.set()
        self.kill()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()
        shutil.rmtree(self.folder, ignore_errors=True)


class Isolated:
    """An FMU at work in a process of its own.

    Args:
        wiring: what it is and what of it is used.
        patience: s on the wall clock, after which an FMU that does not answer is given up.

    Raises:
        RopewalkError: it cannot be loaded.
    """

    def __init__(self, wiring: Wiring, patience: float) -> None:
        self.wiring, self.patience = wiring, patience
        self._log: deque[tuple[int, str]] = deque(maxlen=REMEMBERED)
        self._forgotten: list[int] = []
        root = str(Path(__file__).parents[2])
        folder = tempfile.mkdtemp(prefix=UNPACKED)
        process = subprocess.Popen(
            [sys.executable, "-c", _CHILD, root, folder],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True,
        )  # fmt: skip
        assert process.stdin is not None
        assert process.stdout is not None
        self._down, self._up = process.stdin, process.stdout
        self._watched = _Watched(process, folder)
        weakref.finalize(self, self._watched.release)
        threading.Thread(target=self._watched.watch, daemon=True).start()
        self._ask("load", wiring, patience=patience + STARTING)

    def begin(self, inputs: Sequence[float], until: float) -> list[float]:
        """Set everything, initialise, and give the outputs at the beginning."""
        return list(self._ask("begin", inputs, until))

    def advance(self, t: float, h: float, inputs: Sequence[float]) -> list[float]:
        """Go on from t in s by h with the inputs at the end of the step; give the outputs there."""
        return list(self._ask("advance", t, h, inputs))

    def save(self) -> int:
        """Keep the state, under a number."""
        return int(self._ask("save"))

    def restore(self, number: int) -> None:
        """Go back to a state that was kept."""
        self._ask("restore", number)

    def pack(self, number: int) -> tuple[bytes, tuple[float, ...]]:
        """A state that was kept, as data."""
        data, before = self._ask("pack", number)
        return data, before

    def unpack(self, data: tuple[bytes, tuple[float, ...]]) -> int:
        """Keep a state that was data, under a number."""
        return int(self._ask("unpack", data))

    def forget(self, number: int) -> None:
        """Let go of a state that was kept: the child hears of it with the next question."""
        self._forgotten.append(number)

    def close(self) -> None:
        """Let the FMU go, and end its process."""
        watched = self._watched
        if watched.process.poll() is None and watched.due is None:
            with suppress(RopewalkError, subprocess.TimeoutExpired):
                self._ask("close", patience=min(self.patience, FAREWELL))
                watched.process.wait(FAREWELL)
        watched.release()

    def _ask(self, method: str, *arguments: Any, patience: float | None = None) -> Any:
        """Have the child do something, and wait for its answer.

        `due` stays set when this is interrupted: then an answer may still come, and nothing more can be asked.
        """
        watched = self._watched
        forgotten, self._forgotten = self._forgotten, []
        watched.due = time.monotonic() + (self.patience if patience is None else patience)
        try:
            self._down.write(pickle.dumps((method, arguments, forgotten)))
            self._down.flush()
            while True:
                kind, answer = _receive(self._up)
                if kind != "said":
                    break
                self._log.append(answer)
        except (EOFError, OSError, ValueError, TypeError, CheckpointError) as error:
            raise self._lost(_doing(method, arguments)) from error
        watched.due = None
        if kind == "failed":
            raise RopewalkError(answer)
        return answer

    def _lost(self, doing: str) -> RopewalkError:
        """Say what has become of a child that does not answer."""
        process, watched = self._watched.process, self._watched
        if watched.is_late:
            end = f"has not answered for {self.patience:g} s on the clock (`patience`) and was given up"
        else:
            with suppress(subprocess.TimeoutExpired):
                process.wait(FAREWELL)
            code = process.poll()
            if code is None:
                end = "no longer answers"
            elif code < 0:
                end = f"has crashed, its process was ended by {_signal(-code)}"
            else:
                end = f"has ended its process, with exit code {code}"
        watched.release()
        return RopewalkError(f"{self.wiring.who} {end}, {doing}{quoted(self._log)}")


def _doing(method: str, arguments: tuple[Any, ...]) -> str:
    if method == "advance":
        t, h = arguments[:2]
        return f"in the step from t = {t:g} s to {t + h:g} s"
    return {"load": "when it was loaded", "begin": "when it was initialised"}.get(method, f"when it was to {method}")


def _signal(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _send(stream: IO[bytes], what: Any) -> None:
    data = to_bytes(what)
    stream.write(len(data).to_bytes(8, "little") + data)
    stream.flush()


def _receive(stream: IO[bytes]) -> Any:
    """What `_send` has sent.

    Raises:
        EOFError: nothing comes any more.
        CheckpointError: something else comes.
    """
    size = int.from_bytes(_exactly(stream, 8), "little")
    if size > LARGEST:
        raise CheckpointError("an answer that is too large")
    return from_bytes(_exactly(stream, size))


def _exactly(stream: IO[bytes], size: int) -> bytes:
    data = stream.read(size)
    if len(data) < size:
        raise EOFError
    return data


def serve(folder: str) -> None:
    """Be the child: do what is asked through standard input until it ends, with the FMU unpacked in a folder."""
    parent = os.getppid()
    os.environ["TMPDIR"] = tempfile.tempdir = folder
    leave_network()
    up, down = os.fdopen(os.dup(1), "wb"), os.fdopen(os.dup(0), "rb")
    os.dup2(2, 1)  # what the FMU prints must not get between the answers
    with open(os.devnull, "rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    over = threading.Event()
    watcher = threading.Thread(target=_end_with, args=(parent, folder, over), daemon=True)
    watcher.start()  # before this thread may no longer take the folder away
    write_only_in(folder)
    try:
        _serve(down, up, folder)
    finally:
        over.set()
        watcher.join()


def _serve(down: BinaryIO, up: BinaryIO, folder: str) -> None:
    slave: Slave | None = None
    while True:
        try:
            method, arguments, forgotten = pickle.load(down)
        except EOFError:
            method, arguments, forgotten = "close", (), ()
        try:
            if method == "load":
                slave, answer = Slave(arguments[0], lambda *said: _send(up, ("said", said)), folder), None
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
            _send(up, reply)
        if method == "close":
            break


def _end_with(parent: int, folder: str, over: threading.Event) -> None:
    """Tidy up when all is over; when the parent is gone end this process, too, whatever the FMU is doing."""
    while os.getppid() == parent and not over.wait(LOOK):
        pass
    shutil.rmtree(folder, ignore_errors=True)
    if not over.is_set():
        os._exit(1)
