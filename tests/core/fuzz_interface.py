"""Spoilt blocks between guard pages, in the checked build of the core: nothing outside of a block is touched.

    python tests/core/fuzz_interface.py LIBRARY SECONDS SEED

Each round spoils some words of Model, State or Workspace, headers included, binds, and computes everything if rw_bind
admits it. A touched guard page, an index out of a view and an undefined operation end the process by a signal.
"""

from __future__ import annotations

import ctypes
import mmap
import sys
from pathlib import Path
from time import monotonic

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parents[1]))
from core_structures import bridge, loaded, loose, net, over_sheaves, rope, taut_lines, tripod
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import RunProperties
from ropewalk.engine.library import library, variants

PAGE, MOST = mmap.PAGESIZE, 1 << 20
NASTY = np.array([np.nan, np.inf, -np.inf, -1.0, 0.0, 1e308, 5e-324, 1e-9, 1e9]).view(np.int64)
WORDS = (-1, 0, 1, 2, 3, 7, 15, 16, 40, 41, 50, 51, 2**31, 2**31 + 1, 2**62, -(2**63))


class Guarded:
    """Memory that ends at a page which nobody may touch, and begins behind one."""

    def __init__(self) -> None:
        self._pages = mmap.mmap(-1, MOST + 2 * PAGE)
        self._start = ctypes.addressof(ctypes.c_char.from_buffer(self._pages))
        protect = ctypes.CDLL(None, use_errno=True).mprotect
        for page in (self._start, self._start + PAGE + MOST):
            if protect(ctypes.c_void_p(page), ctypes.c_size_t(PAGE), 0):
                raise OSError(ctypes.get_errno(), "mprotect")

    def place(self, block: NDArray[np.uint8], at_end: bool) -> NDArray[np.int64]:
        """Copy a block to the end, or to the beginning; return its words."""
        offset = PAGE + (MOST - block.size if at_end else 0)
        words = np.frombuffer(self._pages, dtype=np.int64, count=block.size // 8, offset=offset)
        words[:] = block.view(np.int64)
        return words


def spoil(words: NDArray[np.int64], draw: np.random.Generator) -> None:
    """Change some words: of the header, or of any array."""
    for _ in range(draw.integers(1, 4)):
        at = draw.integers(0, 16) if draw.random() < 0.2 else draw.integers(32, words.size)
        kind = draw.integers(0, 4)
        if kind == 0:
            words[at] = draw.choice(NASTY)
        elif kind == 1:
            words[at] = draw.choice(WORDS)
        elif kind == 2:
            words[at] = words[draw.integers(0, words.size)]
        else:
            words[at] ^= 1 << int(draw.integers(0, 63))


def compute(core: ctypes.CDLL, bases: ctypes.Array[ctypes.c_void_p], size: int, draw: np.random.Generator) -> None:
    """Call everything that bound blocks allow."""
    done, stop = ctypes.c_int64(), ctypes.c_int32()
    core.rw_advance(
        int(draw.integers(0, len(variants()))), bases, 0, 1, 3, 1e-3, ctypes.byref(stop), ctypes.byref(done)
    )
    velocities, forces = np.zeros((2, size))
    core.rw_forces(bases, velocities.ctypes.data, forces.ctypes.data)
    core.rw_energies(bases, forces.ctypes.data)
    core.rw_sheaves(bases, velocities.ctypes.data)
    core.rw_pass(bases)
    count = core.rw_entries(bases)
    entries = np.zeros((4, max(count, 0)))
    core.rw_linearise(bases, velocities.ctypes.data, forces.ctypes.data, *(each.ctypes.data for each in entries))


def main(path: str, seconds: float, seed: int) -> None:
    """Print how many rounds there were, and how many of them were computed."""
    core, draw = library(Path(path)), np.random.default_rng(seed)
    sources: list[Bound] = [
        rope(5),
        rope(130, 3, RunProperties(0.5, 1.0, 1e4, 9.0, curved=False)),
        bridge(),
        bridge(3, 9.0, force=-50.0),
        tripod(),
        over_sheaves(2, 5.0, 0.2),
        taut_lines(),
        taut_lines(3, 40.0),
        loaded(),
        loaded(3, RunProperties(0.5, 1.0, 1e4, 20.0, 40.0), 22.2),
        loose(damping=9.0),
        net(),
        net((20, 2), damping=0.3, free=True, parts=2),
    ]
    pages, rounds, computed, end = [Guarded() for _ in range(3)], 0, 0, monotonic() + seconds
    while monotonic() < end:
        source = sources[draw.integers(0, len(sources))]
        blocks = [each.memory for each in (source.model, source.state, source.work)]
        at_end = draw.random() < 0.8
        placed = [page.place(block, at_end) for page, block in zip(pages, blocks, strict=True)]
        spoil(placed[draw.choice(3, p=[0.6, 0.3, 0.1])], draw)
        bases = (ctypes.c_void_p * 3)(*(each.ctypes.data for each in placed))
        finding = (ctypes.c_int64 * 3)()
        if core.rw_bind(bases, (ctypes.c_int64 * 3)(*(each.size for each in blocks)), finding) == 0:
            compute(core, bases, source.model.mobility.size, draw)
            computed += 1
        rounds += 1
    print(f"{rounds} rounds, {computed} computed, seed {seed}")


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), int(sys.argv[3]))
