"""The mode in which a structure begins to move: counted among those that move in one direction."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.solve.free_vibration import lowest

_ALIKE = 1e-6  # of a frequency: closer ones are one, and any of their shapes together is a mode
_MOST, _FIRST = 4, 12  # modes that are looked at for each one wanted, and how many more at first
_PART = 0.5  # of its square that a mode has in the direction; of the largest displacement that it has on a line


def mode_of(K: Any, M: Any, moves: Any, number: int, direction: Array, on: NDArray[np.bool_] | None = None) -> Array:
    """The shape of a mode at rest, (node, 3), whose largest displacement is 1 and goes towards the direction.

    Args:
        K, M: (unknown, unknown) stiffness in N/m and mass in kg, sparse.
        moves: (3 node, unknown), displacements x, y, z of one node after the other.
        number: of the mode, from 1, among those that move in the direction rather than across it.
        direction: (3,).
        on: (node,) count those modes only that move these nodes at least half as far as any.

    Raises:
        EquilibriumError: there are not so many.
    """
    count, along = K.shape[0], direction / np.linalg.norm(direction)
    wanted = min(count, _MOST * number + _FIRST)
    while True:
        found = list(_towards(K, M, moves, wanted, along, on))
        if len(found) >= number:
            shape = found[number - 1]
            size = np.linalg.norm(shape, axis=1)
            top = int(size.argmax())
            sign = 1.0 if shape[top] @ along >= 0.0 else -1.0
            return np.asarray(sign * shape / size[top])
        if wanted == count:
            raise EquilibriumError(
                f"run.start.number: on this mesh there are only {len(found)} modes in the direction "
                f"{direction.tolist()}; write a smaller one, or more elements"
            )
        wanted = min(count, 2 * wanted)


def _towards(K: Any, M: Any, moves: Any, wanted: int, along: Array, on: NDArray[np.bool_] | None) -> Iterator[Array]:
    """Shapes (node, 3) of the lowest modes that move in a direction, of those alike the ones that do so most."""
    w, shapes = lowest(K, M, wanted)
    moved = np.asarray((moves @ shapes).T).reshape(w.size, -1, 3)
    first = 0
    while first < w.size:
        last = first + 1
        while last < w.size and w[last] - w[first] <= _ALIKE * abs(w[first]):
            last += 1
        own = moved[first:last]
        towards, all_of_it = own @ along, own.reshape(last - first, -1)
        # Of the shapes that belong to one frequency: those with the largest and smallest part in the direction.
        part, turned = np.linalg.eigh(
            np.linalg.solve(np.linalg.cholesky(gram := all_of_it @ all_of_it.T), towards @ towards.T)
            @ np.linalg.inv(np.linalg.cholesky(gram)).T
        )
        back = np.linalg.inv(np.linalg.cholesky(gram)).T @ turned
        for j in range(last - first)[::-1]:
            if w[first] <= 0.0 or part[j] < _PART:
                continue
            shape = np.tensordot(back[:, j], own, axes=1)
            size = np.linalg.norm(shape, axis=1)
            if on is None or size[on].max(initial=0.0) >= _PART * size.max():
                yield shape
        first = last
