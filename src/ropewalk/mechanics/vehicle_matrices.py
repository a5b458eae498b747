"""Matrices of one vehicle while it is put together, and what results show of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    # Two wheels, their parts in its place, which sum up to 1, and how far it is ahead of each, m; (): one wheel.
    between: tuple[tuple[int, float, float], ...] = ()

    @staticmethod
    def over(name: str, wheels: dict[int, float], at: float, coordinates: tuple[int, ...], mass: float) -> Body:
        """Return a body located between wheels, or beyond them, whatever their order.

        Args:
            name: of the body.
            wheels: places of the wheels by their numbers, m ahead of the middle of the load.
            at: place of the body, m ahead of the same.
            coordinates: (axis,) numbers of its coordinates.
            mass: kg.
        """
        order = sorted(wheels, key=lambda k: wheels[k])
        behind, ahead = [k for k in order if wheels[k] <= at], [k for k in order if wheels[k] > at]
        rear, front = (behind[-1], ahead[0]) if behind and ahead else (order[0], order[-1])
        nearest = min(order, key=lambda k: abs(wheels[k] - at))
        between, length = tuple[tuple[int, float, float], ...](), wheels[front] - wheels[rear]
        if length > 0.0:
            part = (at - wheels[rear]) / length
            between = (rear, 1.0 - part, at - wheels[rear]), (front, part, at - wheels[front])
        return Body(name, nearest, at - wheels[nearest], coordinates, mass, between=between)

    def locate(self, places: Array, on: NDArray[np.bool_], onward: Array | float) -> Array:
        """Return one component of where it is, (instant,) m, or of its velocity.

        Args:
            places: (instant, wheel) m, the component of the places of all wheels.
            on: (instant, wheel) whether wheels are on their lines: one that is off is not moved on.
            onward: (instant,) component of the level direction along its line.
        """
        if not self.between:
            return np.asarray(places[:, self.wheel] + self.ahead * onward)
        (rear, of_rear, before), (front, of_front, beyond) = self.between
        found = of_rear * places[:, rear] + of_front * places[:, front]
        found = np.where(on[:, rear] & ~on[:, front], places[:, rear] + before * onward, found)
        return np.where(on[:, front] & ~on[:, rear], places[:, front] + beyond * onward, found)


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
