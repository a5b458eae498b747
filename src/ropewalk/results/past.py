"""The past of a run that is taken up again: what its result file tells, and the frames that it holds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.results import contract
from ropewalk.results.checksums import CutShortError, DamagedError, check_whole
from ropewalk.results.files import ResultError
from ropewalk.results.frame import Array, Layout
from ropewalk.results.frames import Frames
from ropewalk.results.slots import newest

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
