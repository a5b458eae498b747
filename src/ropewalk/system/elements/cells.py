"""Triangles of nets and membranes as plain arrays."""

from __future__ import annotations

from typing import NamedTuple

from ropewalk.mechanics.chain import Array, Integers

THREADS, SHEET = 0, 1  # kinds of fabric


class Cells(NamedTuple):
    """Triangles of nets and membranes."""

    node: Integers  # (cell, 3)
    inverse: Array  # (cell, 4) 1/m, of [X2 - X1, X3 - X1] in material coordinates: a b / c d row by row
    area: Array  # (cell,) m^2, unstrained
    membrane_elements: Integers  # (cell,) row of `fabrics`
    fabrics: Array  # (fabric, 7): kind, four constants, and unstrained over laid-out length along u, v
