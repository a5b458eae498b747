"""Matrices of one vehicle while it is put together, and what results show of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ropewalk.mechanics.chain import Array

BESIDE, MIDDLE = -1, -2
"""Of a body, along an axis: it is where its wheel is, or in the middle of the track."""


@dataclass(frozen=True)
class Body:
    """A body of a load, as results show it: where its place is found."""

    name: str
    wheel: int  # where what has no coordinate of its own is: above this wheel,
    ahead: float  # m, and so far ahead of it
    coordinates: tuple[int, ...]  # (axis,) number of the coordinate, BESIDE: that of the wheel, MIDDLE: none
    mass: float  # kg
    others: tuple[int, ...] = ()  # wheels on lines beside that of the first one, which stand for it when it is off


@dataclass
class VehicleMatrices:
    """A vehicle while it is put together: u = (coordinates, places of wheels)."""

    coordinates: int
    locations: list[tuple[int, int]]  # wheel and axis of each place
    M: Array
    C: Array
    K: Array
    load: Array
    drag: dict[int, float] = field(default_factory=dict)  # kg/m, by coordinate
    tethers: list[dict[str, Any]] = field(default_factory=list)
    buffers: list[dict[str, Any]] = field(default_factory=list)

    @staticmethod
    def of(coordinates: int, locations: list[tuple[int, int]]) -> VehicleMatrices:
        size = coordinates + len(locations)
        block = np.zeros((size, size))
        return VehicleMatrices(coordinates, locations, block, block.copy(), block.copy(), np.zeros(size))

    def join(self, row: Array, stiffness: float, damping: float) -> None:
        """Add a spring and a damper whose elongation is row @ u."""
        self.K += stiffness * np.outer(row, row)
        self.C += damping * np.outer(row, row)
