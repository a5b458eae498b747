"""Vehicles given by their matrices."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.contact import LIFT_OFF, SIDE, Side, one_sided
from ropewalk.model.quantity import Matrix, Name, Station, TableForce
from ropewalk.model.travel import Place, Travel, prescribed_only


class MatrixWheel(Declaration):
    """A wheel of a vehicle given by matrices: the coordinate that follows the line at its place."""

    at: Station = Field(default=0.0, description="place along the vehicle, ahead of its point 0 if positive")
    coordinate: str = Field(description="name of the coordinate that follows the line, positive upwards")


class Matrices(Declaration):
    """Any linear vehicle: M q'' + C q' + K q = contact forces - weights, some of the q following the line.

    The numbers are in SI units as the coordinates demand (kg and m for a height, kg*m^2 and rad for a pitch). At
    q = 0 nothing is stressed. Heights are positive upwards.
    """

    kind: Literal["matrices"] = "matrices"
    on: str = Field(description="name of the line")
    coordinates: tuple[Name, ...] = Field(min_length=1, description="names of the coordinates, in order")
    mass: Matrix = Field(description="mass matrix, symmetric")
    damping: Matrix | None = Field(
        default=None, description="damping matrix, an unsymmetric part of which is gyroscopic (default: none)"
    )
    stiffness: Matrix = Field(description="stiffness matrix, symmetric")
    wheels: dict[Name, MatrixWheel] = Field(min_length=1, description="the wheels, by name")
    weight: tuple[TableForce, ...] | None = Field(
        default=None,
        description="of each coordinate, positive downwards (default: row sums of the mass matrix times gravity, "
        "which is right where all coordinates are heights)",
    )
    travel: Annotated[Travel, prescribed_only("the travel of a vehicle is prescribed")] = Field(
        description="motion of its point 0; wheels with a positive `at` run ahead of it towards the end of the line"
    )
    lift_off: bool = Field(default=False, description=LIFT_OFF)
    side: Side = Field(default="above", description=SIDE)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        sizes = list(self._sizes())
        side = one_sided(self.side, lift_off=self.lift_off)
        report("matrices", [*side, *self._names(), *(sizes or self._numbers())])
        return self

    def starts(self) -> list[Place]:
        """List where its wheels stand at the beginning; negative: before the start of the line."""
        return [Place(name, self.travel.measured, self.travel.start + w.at) for name, w in self.wheels.items()]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: none."""
        yield from ()

    @property
    def has_gyroscopic_damping(self) -> bool:
        """Whether an unsymmetric part of the damping turns velocities without taking energy, as wheels that spin do."""
        return self.damping is not None and any(True for _ in self._asymmetry("damping", self.damping))

    def _names(self) -> Iterator[Finding]:
        for index, name in enumerate(self.coordinates):
            if name in self.coordinates[:index]:
                remedy = "give every coordinate its own name"
                yield Finding(("coordinates", index), "the name stands twice", repr(name), remedy)
        for name, wheel in self.wheels.items():
            if wheel.coordinate not in self.coordinates:
                remedy = did_you_mean(wheel.coordinate, self.coordinates)
                yield Finding(("wheels", name, "coordinate"), "no such coordinate", repr(wheel.coordinate), remedy)
        for (one, first), (two, second) in combinations(self.wheels.items(), 2):
            if first.coordinate == second.coordinate:
                wrong, remedy = f"wheel {one} has the same coordinate", "give every wheel its own coordinate"
                yield Finding(("wheels", two, "coordinate"), wrong, repr(second.coordinate), remedy)
            elif math.isclose(first.at, second.at, rel_tol=1e-9, abs_tol=1e-9):
                remedy = "write another position (at), or combine both wheels"
                yield Finding(("wheels", two, "at"), f"at the same place as wheel {one}", f"{second.at:g} m", remedy)

    def _sizes(self) -> Iterator[Finding]:
        count = len(self.coordinates)
        size = f"{count} coordinate{'s' if count > 1 else ''}"
        for key, matrix in (("mass", self.mass), ("damping", self.damping), ("stiffness", self.stiffness)):
            if matrix is None:
                continue
            if len(matrix) != count:
                remedy = f"write {count} rows of {count} numbers"
                yield Finding((key,), f"does not go with {size}", f"{len(matrix)} rows", remedy)
                continue
            for index, row in enumerate(matrix):
                if len(row) != count:
                    remedy = f"write {count} numbers in each row"
                    yield Finding((key, index), f"does not go with {size}", f"a row of {len(row)}", remedy)
        if self.weight is not None and len(self.weight) != count:
            remedy = f"write {count} weights, or leave weight out"
            yield Finding(("weight",), f"does not go with {size}", f"{len(self.weight)} weights", remedy)

    def _numbers(self) -> Iterator[Finding]:
        for i, row in enumerate(self.mass):
            if row[i] < 0.0:
                remedy = "a mass matrix has no negative diagonal: check its signs"
                yield Finding(("mass", i, i), "a negative mass", f"{row[i]:g}", remedy)
        yield from self._asymmetry("mass", self.mass)
        # A stiffness with an unsymmetric part has no potential energy: around a loop it would give work for nothing.
        # Such a part of the damping is gyroscopic, as of wheels that spin, and does no work.
        yield from self._asymmetry("stiffness", self.stiffness)

    @staticmethod
    def _asymmetry(key: str, matrix: tuple[tuple[float, ...], ...]) -> Iterator[Finding]:
        size = max(abs(value) for row in matrix for value in row)
        for i, row in enumerate(matrix):
            for j in range(i):
                if not math.isclose(row[j], matrix[j][i], rel_tol=1e-9, abs_tol=1e-12 * size):
                    wrong, remedy = f"the {key} matrix is not symmetric", "write the same number on both sides"
                    given = f"{row[j]:g} here and {matrix[j][i]:g} in row {j}, column {i} (counted from 0)"
                    yield Finding((key, i, j), wrong, given, remedy)
