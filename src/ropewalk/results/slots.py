"""Checkpoints in a result file, and the past of a run that is taken up again from one.

Checkpoints stand in two places that are written in turns, so that one is whole whenever the run is killed. They are a
variable of bytes (slot, byte) before the frames (docs/notes/result-file.md). A checkpoint counts if its checksum is
right and the file holds all frames before it.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.checkpoint import ENGINE_NUMBER, CheckpointError, Tree, from_bytes, to_bytes
from ropewalk.errors import RopewalkError
from ropewalk.results import contract
from ropewalk.results.checksums import CutShortError, DamagedError, check_whole
from ropewalk.results.contract import CHECKPOINT
from ropewalk.results.files import ResultError
from ropewalk.results.frame import Array, Layout
from ropewalk.results.frames import Frames

if TYPE_CHECKING:
    from ropewalk.model import Scenario

SECONDS = 1.0  # between two checkpoints
SHARE = 0.01  # of the time of a run that they may take
SPARE, SPARE_BYTES = 1.25, 16 * 1024  # room in a slot for a state that grows
_SLOTS = 2
_DIMENSIONS = ("checkpoint_slot", "checkpoint_byte")


class Slots:
    """The checkpoints of a file that is being written.

    Args:
        take: gives what is to be stored, with the number of `frames` before it; None: there is nothing.
        number: of the last checkpoint that the file has.
    """

    def __init__(self, take: Callable[[], Tree | None], number: int = 0) -> None:
        self._take, self._number = take, number
        self._variable: Any = None
        self._first: bytes | None = None
        self._next = time.monotonic()
        self.lacking = ""  # why there are none

    def is_due(self, *, at_once: bool) -> bool:
        """Whether there is place for the next one, and it is time for it."""
        return self._variable is not None and (at_once or time.monotonic() >= self._next)

    def define(self, file: Any) -> None:
        """Make place in a file that is being created, if the run has a state that can be stored."""
        try:
            self._first = self._bytes()
        except RopewalkError as problem:
            self.lacking = str(problem)
        if self._first is None:
            return
        size = (int(SPARE * len(self._first)) + SPARE_BYTES) // 8 * 8
        for name, length in zip(_DIMENSIONS, (_SLOTS, size), strict=True):
            file.createDimension(name, length)
        file.createVariable(CHECKPOINT, "i1", _DIMENSIONS).long_name = "checkpoint of `ropewalk resume`"
        self.use(file)

    def use(self, file: Any) -> None:
        """Write into a file from now on."""
        self._variable = file.variables.get(CHECKPOINT)
        if self._variable is not None:
            self._variable.set_auto_maskandscale(False)

    def write(self, file: Any) -> None:
        """Write a checkpoint over the older one of the two; one that does not fit is left out."""
        begun = time.monotonic()
        try:
            data, self._first = self._first or self._bytes(), None
        except RopewalkError:
            return
        if data is not None and len(data) <= self._variable.shape[1]:
            self._number += 1
            self._variable[self._number % _SLOTS, : len(data)] = np.frombuffer(data, np.int8)
            file.sync()
        now = time.monotonic()
        self._next = now + max(SECONDS, (now - begun) / SHARE)

    def _bytes(self) -> bytes | None:
        tree = self._take()
        return None if tree is None else to_bytes({"number": self._number + 1, "engine_number": ENGINE_NUMBER, **tree})


def newest(file: Any, frames: int) -> Tree | None:
    """The last whole checkpoint of an open file that has a number of frames; None: there is none."""
    variable, found = file.variables.get(CHECKPOINT), None
    if variable is None or variable.dimensions != _DIMENSIONS:
        return None
    variable.set_auto_maskandscale(False)
    for slot in range(variable.shape[0]):
        with suppress(CheckpointError, KeyError, TypeError):
            tree = from_bytes(np.ascontiguousarray(variable[slot]).tobytes())
            if 1 <= tree["run"]["frames"] <= frames and (found is None or tree["number"] > found["number"]):
                found = tree
    return found


def digests(scenario: Scenario) -> dict[str, str]:
    """SHA-256 of the files, next to stored results, that a scenario takes its data from, by the keys that name them."""
    named = {
        f"loads.{name}.{key}": getattr(load, key, None)
        for name, load in scenario.loads.items()
        for key in ("file", "irregularity")
    }
    for key, files in [(key, files) for key, files in named.items() if isinstance(files, dict)]:
        named[key] = None
        named |= {f"{key}.{line}": file for line, file in files.items()}
    named |= {f"lines.{name}.profile.file": line.profile.file for name, line in scenario.lines.items() if line.profile}
    found = {}
    for key, file in named.items():
        if file is not None:
            with suppress(OSError):
                found[key] = hashlib.sha256(Path(file).read_bytes()).hexdigest()
    return found


def cut(path: Path, frames: int) -> None:
    """Let a closed file end after a number of frames: that number stands behind the first four bytes."""
    with path.open("r+b") as stream:
        stream.seek(4)
        stream.write(frames.to_bytes(4, "big"))


_BLOCK = 64  # frames that are read at a time


@dataclass(frozen=True)
class Past:
    """A result file as a run left it.

    Args:
        path: the file.
        attributes: of the file.
        times: (frame,) s of all frames that it holds, those after the checkpoint among them.
        checkpoint: the last one; None: there is none.
        cut_short: whether the file ends before the frames that it is to have.
    """

    path: Path
    attributes: dict[str, Any]
    times: Array
    checkpoint: Tree | None
    cut_short: bool = False

    @property
    def stored(self) -> int:
        """How many frames the file holds."""
        return int(self.times.size)

    @property
    def count(self) -> int:
        """How many of them stand before the checkpoint."""
        return int(self.checkpoint["run"]["frames"]) if self.checkpoint is not None else 0

    @property
    def number(self) -> int:
        """Number of the checkpoint."""
        return int(self.checkpoint["number"]) if self.checkpoint is not None else 0

    @staticmethod
    def of(path: Path) -> Past:
        """Look into a result file.

        Raises:
            ResultError: there is no such file, it cannot be read, or it is no result of ropewalk.
        """
        import netCDF4

        if not path.is_file():
            raise ResultError(f"{path}: there is no such file")
        whole = None
        try:
            check_whole(path)
        except CutShortError as problem:
            whole = problem.whole
        except DamagedError as problem:
            raise ResultError(f"{path}: {problem}; run it again") from problem
        try:
            with netCDF4.Dataset(path) as file:
                attributes = {name: file.getncattr(name) for name in file.ncattrs()}
                times = np.asarray(file.variables["time"][:]) if "time" in file.variables else np.zeros(0)
                times = np.ma.getdata(times).astype(np.float64)[:whole]
                return Past(path, attributes, times, newest(file, times.size), cut_short=whole is not None)
        except (OSError, ValueError, RuntimeError, MemoryError) as problem:
            raise ResultError(f"{path}: cannot be read ({problem})") from problem

    def frames(self, layout: Layout) -> Iterator[Frames]:
        """The frames before the checkpoint, some at a time.

        Raises:
            ResultError: they are of another layout.
        """
        import netCDF4

        shapes = contract.shapes(layout)
        with netCDF4.Dataset(self.path) as file:
            file.set_auto_maskandscale(False)
            for name, shape in shapes.items():
                found = file.variables[name].shape[1:] if name in file.variables else None
                if found != shape and not (found is None and 0 in shape):
                    raise ResultError(f"{self.path}: the size of {name} does not match the scenario in the file")
            for first in range(0, self.count, _BLOCK):
                last = min(first + _BLOCK, self.count)
                block = {
                    name: np.asarray(file.variables[name][first:last])
                    if name in file.variables
                    else np.zeros((last - first, *shape))
                    for name, shape in shapes.items()
                }
                yield Frames(self.times[first:last], block)
