"""Notes of many instants: kernels copy what frames will be made of, so that Python need not wake for each of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined

DONE, STEPS = 0, 1  # entries of `gone`
_WORD = 8  # bytes of a number


class Notes(NamedTuple):
    """Room for what some arrays are at several instants. Kernels take them as numbers, whatever they are."""

    sources: tuple[Array, ...]  # (number,) the arrays themselves
    rows: tuple[Array, ...]  # (instant, number) of each
    gone: Integers  # instants that have been noted, and steps that were taken on the way

    @staticmethod
    def empty(sources: tuple[Array, ...], most: int) -> Notes:
        """Room for a number of instants of what `numbers_of` gives."""
        buffer, rows, begin = np.empty(most * sum(source.size for source in sources)), list[Array](), 0
        for source in sources:
            end = begin + most * source.size
            rows.append(buffer[begin:end].reshape(most, source.size))
            begin = end
        return Notes(sources, tuple(rows), np.zeros(2, dtype=np.int64))

    @property
    def noted(self) -> int:
        """How many instants have been noted."""
        return int(self.gone[DONE])

    def extend(self, others: Notes) -> None:
        """Take over what others have noted of the same arrays."""
        begin, end = self.noted, self.noted + others.noted
        for row, other in zip(self.rows, others.rows, strict=True):
            row[begin:end] = other[: others.noted]
        self.gone[DONE] = end

    def add(self) -> None:
        """Note the present instant."""
        for source, row in zip(self.sources, self.rows, strict=True):
            row[self.gone[DONE]] = source
        self.gone[DONE] += 1


def numbers_of(arrays: Sequence[NDArray[Any]]) -> tuple[Array, ...]:
    """Arrays as rows of numbers of 8 bytes, (number,), which share their memory."""
    found = []
    for array in arrays:
        plain = array.view(np.ndarray)
        if plain.dtype.itemsize % _WORD or not plain.flags.c_contiguous:
            raise TypeError(f"an array of {plain.dtype} cannot be noted")
        found.append(plain.reshape(-1).view(np.float64))
    return tuple(found)


def columns(notes: Sequence[Notes], arrays: Sequence[NDArray[Any]]) -> list[Any]:
    """What has been noted of each array, (instant, ...), one note after the other.

    Args:
        notes: of these arrays.
        arrays: as `numbers_of` was given them, for their shapes and kinds.
    """
    found = []
    for k, array in enumerate(arrays):
        parts = [note.rows[k][: note.noted] for note in notes]
        rows = parts[0] if len(parts) == 1 else np.concatenate(parts)
        shape = (len(rows), *array.shape)
        found.append(rows.view(array.dtype).reshape(shape) if rows.size else np.zeros(shape, array.dtype))
    return found


@inlined
def write_note(notes):
    """Note the present instant, as `Notes.add` does."""
    i = notes.gone[DONE]
    for k in range(len(notes.sources)):
        source, rows = notes.sources[k], notes.rows[k]
        for j in range(source.size):
            rows[i, j] = source[j]
    notes.gone[DONE] = i + 1
