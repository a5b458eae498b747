"""Blocks of memory that Python and the core share: Model, State and Workspace, with a NumPy view of each array.

The arrays are those of `src/core/fields.def`, which the compiled core hands over as text. A block has a header and no
pointers: a copy of the block of a State is a checkpoint.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.engine.library import library
from ropewalk.errors import RopewalkError

Part = Literal["MODEL", "STATE", "WORK"]
PARTS: tuple[Part, ...] = ("MODEL", "STATE", "WORK")
_HEADER, _LINE, _MARGIN = 256, 64, 16


class FieldRow(NamedTuple):
    """An array of a block: a row of `fields.def`."""

    part: Part
    name: str
    kind: str
    rows: str
    columns: str
    values: str
    unit: str
    meaning: str

    def shape(self, sizes: Mapping[str, int]) -> tuple[int, ...]:
        """Return the shape of its view."""
        return tuple(sizes[name] for name in (self.rows, self.columns) if name != "ONE") or (1,)


@cache
def fields() -> tuple[FieldRow, ...]:
    """Return the arrays of all blocks in the order of the table."""
    return tuple(FieldRow(line[0], *line[1:]) for line in _table() if line[0] != "DIMENSION")  # type: ignore[arg-type]


@cache
def dimensions() -> dict[str, str]:
    """Return the names of all dimensions of arrays and their meanings, in the order of the headers."""
    return {line[1]: line[2] for line in _table() if line[0] == "DIMENSION"}


def _table() -> list[list[str]]:
    return [line.split("\t") for line in library().rw_fields().decode().splitlines()]


class Block:
    """Memory of a Model, a State or a Workspace. Its arrays are attributes: `block.position[axis, node]`."""

    def __init__(self, part: Part, sizes: Mapping[str, int]) -> None:
        """Lay out a block whose arrays are zero.

        Args:
            part: of the table.
            sizes: of the dimensions of the structure; those that are not named are 0.

        Raises:
            RopewalkError: a size is negative or too large, or a structure has no nodes or neither 2 nor 3 axes.
        """
        counts = np.array([sizes.get(name, 0) for name in dimensions()], dtype=np.int64)
        seal = ctypes.c_uint64()
        size = library().rw_layout(PARTS.index(part), counts.ctypes.data, ctypes.addressof(seal))
        if size == 0:
            raise RopewalkError(
                f"sizes {dict(sizes)}: a structure needs AXES = 2 or 3, NODES, and VISCOUS = 0 or NODES"
            )
        store = np.zeros(size + _LINE, dtype=np.uint8)
        start = -store.ctypes.data % _LINE
        self.part, self.sizes = part, dict(zip(dimensions(), counts.tolist(), strict=True))
        self.memory: NDArray[np.uint8] = store[start : start + size]
        self.memory[:32].view(np.uint64)[:3] = seal.value, PARTS.index(part), size
        self.memory[32 : 32 + counts.nbytes].view(np.int64)[:] = counts
        self._arrays = self._views()

    def _views(self) -> dict[str, NDArray[Any]]:
        views, offset = dict[str, NDArray[Any]](), _HEADER
        for field in (each for each in fields() if each.part == self.part):
            rows, columns = self.sizes[field.rows], self.sizes[field.columns]
            stride = -(-columns // 8) * 8 + _MARGIN
            kind = np.float64 if field.kind == "double" else np.int64
            whole = self.memory[offset : offset + 8 * rows * stride].view(kind).reshape(rows, stride)
            views[field.name] = whole[:, :columns] if field.rows != "ONE" else whole[0, :columns]
            offset += 8 * rows * stride
        return views

    def __getattr__(self, name: str) -> NDArray[Any]:
        """Return the view of an array."""
        try:
            return self.__dict__["_arrays"][name]  # type: ignore[no-any-return]
        except KeyError:
            raise AttributeError(f"{self.__dict__.get('part', 'a block')} has no array {name}") from None

    def names(self) -> Iterable[str]:
        """Return the names of its arrays."""
        return self._arrays

    def set(self, **arrays: ArrayLike) -> None:
        """Set whole arrays by their names.

        Raises:
            RopewalkError: an array has another shape or kind of numbers.
        """
        for name, values in arrays.items():
            given, view = np.asarray(values), getattr(self, name)
            if given.shape != view.shape:
                raise RopewalkError(f"{name}: shape {given.shape}; the structure has {view.shape}")
            if not np.can_cast(given.dtype, view.dtype, "same_kind"):
                raise RopewalkError(f"{name}: numbers of the type {given.dtype}; it holds {view.dtype}")
            view[...] = given

    def freeze(self, indices: bool = False) -> None:
        """Make all arrays read-only, or those of indices."""
        for view in (*self._arrays.values(), self.memory):
            view.flags.writeable &= indices and view.dtype != np.int64

    def copy(self) -> Block:
        """Return a copy: of a State, a checkpoint."""
        copied = Block(self.part, self.sizes)
        copied.memory[:] = self.memory
        return copied
