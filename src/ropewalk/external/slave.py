"""A slave: one FMU at work, of FMI 2.0 or 3.0, behind four verbs: begin, advance, save and restore.

FMPy loads the library and knows its functions; numbers go to them through arrays that are made once.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import weakref
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import chdir, contextmanager
from math import isfinite
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

from ropewalk.errors import RopewalkError, printable
from ropewalk.external.archive import check_size
from ropewalk.external.binaries import Binary, Listener, Refusal, binary_of
from ropewalk.external.fmu_wiring import Wiring

REMEMBERED = 20  # messages of an FMU
QUOTED = 3  # of these, in an error
UNPACKED = "ropewalk-fmu-"  # how the names of folders with unpacked FMUs begin
LONGEST = 300  # signs of each of them


class Worker(Protocol):
    """An FMU at work, here or in a process of its own."""

    def begin(self, inputs: Sequence[float], until: float) -> list[float]:
        """Set everything, initialise, and give the outputs at the beginning."""

    def advance(self, t: float, h: float, inputs: Sequence[float]) -> list[float]:
        """Go on from t in s by h with the inputs at the end of the step; give the outputs there."""

    def save(self) -> int:
        """Keep the state, under a number."""

    def restore(self, number: int) -> None:
        """Go back to a state that was kept."""

    def pack(self, number: int) -> tuple[bytes, tuple[float, ...]]:
        """A state that was kept, as data."""

    def unpack(self, data: tuple[bytes, tuple[float, ...]]) -> int:
        """Keep a state that was data, under a number."""

    def forget(self, number: int) -> None:
        """Let go of a state that was kept."""

    def close(self) -> None:
        """Let the FMU go."""


class Slave:
    """An FMU at work in this process."""

    def __init__(self, wiring: Wiring, heard: Listener | None = None, folder: str | None = None) -> None:
        """Unpack an FMU and load it.

        Args:
            wiring: what it is and what of it is used.
            heard: is given every message of the FMU.
            folder: to unpack it in; if None one is made, and taken away at the end.

        Raises:
            RopewalkError: it cannot be unpacked, loaded or instantiated.
        """
        self.wiring = wiring
        self._log: deque[tuple[int, str]] = deque(maxlen=REMEMBERED)
        self._heard = heard
        self._states: dict[int, tuple[Any, tuple[float, ...]]] = {}
        self._count = 0
        self._before: tuple[float, ...] = ()
        self._binary: Binary | None = None
        self._tidy: Callable[[], Any] = lambda: None
        if folder is None:
            folder = tempfile.mkdtemp(prefix=UNPACKED)
            self._tidy = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self._resources = Path(folder) / "resources"
        try:
            from fmpy import extract

            check_size(wiring.file)
            extract(wiring.file, folder)
            with chdir(os.getcwd()), _own_modules(self._resources):  # FMPy comes back only where loading succeeds
                self._binary = binary_of(wiring, folder, self._listen)
        except Exception as error:
            self.close()
            remedy = "; it requires the program that exported it: install this" if wiring.needs_tool else ""
            raise self._error(f"cannot be loaded ({error}){remedy}") from error

    @property
    def binary(self) -> Binary:
        """Its library."""
        if self._binary is None:
            raise RopewalkError(f"{self.wiring.who} has been released")
        return self._binary

    def begin(self, inputs: Sequence[float], until: float) -> list[float]:
        """Set everything, initialise, and give the outputs at the beginning.

        Args:
            inputs: in the order of the wiring.
            until: end of the run, s.

        Raises:
            RopewalkError: the FMU refuses that, or gives what is no number.
        """
        binary = self.binary
        for setting in self.wiring.settings:
            with self._explained(f"does not take {setting.name} = {setting.value!r}"):
                binary.set(setting)
        with self._explained("cannot be initialised"):
            binary.inputs[:] = inputs
            binary.put()
            binary.enter(until)
            binary.put()
            binary.leave()
            binary.fetch()
        self._before = tuple(inputs)
        return self._answer(0.0)

    def advance(self, t: float, h: float, inputs: Sequence[float]) -> list[float]:
        """Go on from t in s by h with the inputs at the end of the step; give the outputs there.

        Where the FMU takes slopes, its inputs go linearly to these values; else they have them during the whole step.

        Raises:
            RopewalkError: the FMU refuses the step, or gives what is no number.
        """
        binary = self.binary
        try:
            if self.wiring.is_interpolating:
                binary.inputs[:] = self._before
                binary.put()
                binary.slopes[:] = [(now - before) / h for now, before in zip(inputs, self._before, strict=True)]
                binary.slope()
                self._before = tuple(inputs)
            else:
                binary.inputs[:] = inputs
                binary.put()
            binary.step(t, h)
            binary.fetch()
        except Refusal as refusal:
            self._fail(f"refuses the step from t = {t:g} s to {t + h:g} s", refusal)
        return self._answer(t + h)

    def save(self) -> int:
        """Keep the state, under a number."""
        self._count += 1
        with self._explained("cannot save its state"):
            self._states[self._count] = self.binary.save(), self._before
        return self._count

    def restore(self, number: int) -> None:
        """Go back to a state that was kept."""
        if number not in self._states:
            raise self._error(f"has no state {number}, it was released")
        state, self._before = self._states[number]
        with self._explained("cannot go back to a state"):
            self.binary.restore(state)

    def pack(self, number: int) -> tuple[bytes, tuple[float, ...]]:
        """A state that was kept, as data: its own bytes, and the inputs before."""
        state, before = self._states[number]
        with self._explained("cannot give its state as data"):
            return self.binary.pack(state), before

    def unpack(self, data: tuple[bytes, tuple[float, ...]]) -> int:
        """Keep a state that was data, under a number."""
        self._count += 1
        with self._explained("cannot take its state from data"):
            self._states[self._count] = self.binary.unpack(data[0]), tuple(data[1])
        return self._count

    def forget(self, number: int) -> None:
        """Let go of a state that was kept."""
        state = self._states.pop(number, None)
        if state is not None and self._binary is not None:
            self._binary.forget(state[0])

    def close(self) -> None:
        """Let the FMU go."""
        for number in list(self._states):
            self.forget(number)
        binary, self._binary = self._binary, None
        if binary is not None:
            binary.close()
        resources = str(self._resources)
        sys.path[:] = [path for path in sys.path if path != resources]
        self._tidy()

    def _answer(self, t: float) -> list[float]:
        found = list(self.binary.outputs)
        if not all(map(isfinite, found)):
            name = next(n for n, x in zip(self.wiring.output_names, found, strict=True) if not isfinite(x))
            raise self._error(f"gives no number for {name} at t = {t:g} s; is its step, `every`, too long?")
        return found

    @contextmanager
    def _explained(self, what: str) -> Iterator[None]:
        try:
            yield
        except Refusal as refusal:
            self._fail(what, refusal)

    def _fail(self, what: str, refusal: Refusal) -> None:
        raise self._error(f"{what} ({refusal})") from refusal

    def _error(self, what: str) -> RopewalkError:
        return RopewalkError(f"{self.wiring.who} {what}{quoted(self._log)}")

    def _listen(self, status: int, message: str) -> None:
        self._log.append((status, message))
        if self._heard is not None:
            self._heard(status, message)


def quoted(log: Iterable[tuple[int, str]]) -> str:
    """Write what an FMU has said last as the end of a sentence: of mistakes, if it has."""
    said = [(status, printable(" ".join(message.split())[:LONGEST])) for status, message in log]
    last = [text for status, text in said if status > 0] or [text for _, text in said]
    return f"; its log: {' | '.join(last[-QUOTED:])}" if last else ""


@contextmanager
def _own_modules(resources: Path) -> Iterator[None]:
    """Let an FMU made with Python import its own modules, whatever of the same name is imported already.

    pythonfmu imports the module of an FMU by its name alone: a second FMU whose module is named alike would otherwise
    run the code of the first.
    """
    values = resources / "slavemodule.txt"
    names = set()
    if values.is_file():
        names = {path.stem for path in resources.glob("*.py")} | {path.parent.name for path in resources.glob("*/*.py")}

    def taken() -> dict[str, ModuleType]:
        return {name: sys.modules.pop(name) for name in list(sys.modules) if name.partition(".")[0] in names}

    kept = taken()
    try:
        yield
    finally:
        taken()
        sys.modules.update(kept)
