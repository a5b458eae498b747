"""Isolation: an FMU at work in a process of its own, so that its crash or endless loop ends the run in order.

Parent and child take turns: a pickled (method, arguments, states to forget) down a pipe, an answer up another, which is
plain data: reading it can run nothing, and what has not the form of an answer is refused. Between them stands a
supervisor (`supervision.py`), which ends the child when the run ends. The child may write in one folder only, where the
FMU is unpacked, and reach no other process and no network, as far as the system keeps it from that (`confinement.py`).
A watcher in the parent ends a child that does not answer in time, whereupon the pipe ends.
"""

from __future__ import annotations

import os
import pickle
import re
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
from math import isfinite
from pathlib import Path
from typing import IO, Any

from ropewalk.checkpoint import CheckpointError, from_bytes
from ropewalk.errors import RopewalkError
from ropewalk.external.fmu_wiring import Wiring
from ropewalk.external.slave import LONGEST, REMEMBERED, UNPACKED, quoted
from ropewalk.external.supervision import EXCESS

LOOK = 0.2  # s, at which the watcher looks
STARTING = 30.0  # s, that loading may take longer: Python itself must start
FAREWELL = 2.0  # s, for an FMU to end by itself
USUAL, LARGEST = 1 << 20, 1 << 30  # bytes of an answer, and of one that is a state
_HEAD, _LONGEST_HEAD = slice(48, 56), 1 << 20  # where an answer says how long its text is, and bytes of that
_CHILD = (
    "import sys; sys.path.append(sys.argv[1]); from ropewalk.external.supervision import main; "
    "main(sys.argv[2], int(sys.argv[3]))"
)
_SECRET = re.compile("token|secret|passw|credential|apikey|api_key|auth|cookie|private|_proxy", re.IGNORECASE)


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
        """End the child, with everything that it has started: its supervisor does, or goes, too."""
        if self.process.poll() is None:
            self.process.terminate()
            with suppress(subprocess.TimeoutExpired):
                self.process.wait(FAREWELL)
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
            [sys.executable, "-c", _CHILD, root, folder, str(os.getpid())],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True,
            env={name: value for name, value in os.environ.items() if not _SECRET.search(name)},
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
        return self._outputs(self._ask("begin", inputs, until), "begin", (inputs, until))

    def advance(self, t: float, h: float, inputs: Sequence[float]) -> list[float]:
        """Go on from t in s by h with the inputs at the end of the step; give the outputs there."""
        return self._outputs(self._ask("advance", t, h, inputs), "advance", (t, h, inputs))

    def save(self) -> int:
        """Keep the state, under a number."""
        return self._number(self._ask("save"), "save")

    def restore(self, number: int) -> None:
        """Go back to a state that was kept."""
        self._ask("restore", number)

    def pack(self, number: int) -> tuple[bytes, tuple[float, ...]]:
        """A state that was kept, as data."""
        answer = self._ask("pack", number)
        if isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], bytes):
            data, before = answer
            if isinstance(before, tuple) and all(isinstance(value, float) for value in before):
                return data, before
        raise self._nonsense("pack", ())

    def unpack(self, data: tuple[bytes, tuple[float, ...]]) -> int:
        """Keep a state that was data, under a number."""
        return self._number(self._ask("unpack", data), "unpack")

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
                kind, answer = _receive(self._up, LARGEST if method == "pack" else USUAL)
                if kind != "said":
                    break
                status, text = answer
                self._log.append((int(status), str(text)[:LONGEST]))
            if kind not in ("done", "failed") or (kind == "failed" and not isinstance(answer, str)):
                raise self._nonsense(method, arguments)
        except (ValueError, TypeError, CheckpointError) as error:
            if self._up.closed:  # it has been lost before
                raise self._lost(_doing(method, arguments)) from error
            raise self._nonsense(method, arguments) from error
        except (EOFError, OSError) as error:
            raise self._lost(_doing(method, arguments)) from error
        watched.due = None
        if kind == "failed":
            raise RopewalkError(answer)
        return answer

    def _outputs(self, answer: Any, method: str, arguments: tuple[Any, ...]) -> list[float]:
        """An answer as outputs, which it is only if it holds a finite number for each."""
        is_complete = isinstance(answer, list) and len(answer) == len(self.wiring.outputs)
        if is_complete and all(isinstance(value, float) and isfinite(value) for value in answer):
            return list(answer)
        raise self._nonsense(method, arguments)

    def _number(self, answer: Any, method: str) -> int:
        if isinstance(answer, int) and not isinstance(answer, bool):
            return answer
        raise self._nonsense(method, ())

    def _nonsense(self, method: str, arguments: tuple[Any, ...]) -> RopewalkError:
        """End a child that gives what is no answer."""
        self._watched.release()
        return RopewalkError(f"{self.wiring.who} gives no answer but something else, {_doing(method, arguments)}")

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
            elif code in EXCESS:
                end = f"{EXCESS[code]}, its process was ended"
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


def _receive(stream: IO[bytes], largest: int = LARGEST) -> Any:
    """What `_send` has sent, of no more than so many bytes.

    Raises:
        EOFError: nothing comes any more.
        CheckpointError: something else comes.
    """
    size = int.from_bytes(_exactly(stream, 8), "little")
    if size > largest:
        raise CheckpointError("an answer that is too large")
    data = _exactly(stream, size)
    if int.from_bytes(data[_HEAD], "little") > _LONGEST_HEAD:  # text takes many times its size when it is read
        raise CheckpointError("an answer that is too large")
    return from_bytes(data)


def _exactly(stream: IO[bytes], size: int) -> bytes:
    data = stream.read(size)
    if len(data) < size:
        raise EOFError
    return data
