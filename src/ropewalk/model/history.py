"""Values that change in time: a constant, a table, or (through the Python API) a callable."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration
from ropewalk.units import Force, Speed, Time


def _check_times(time: tuple[float, ...], values: int) -> None:
    if len(time) != values:
        raise ValueError(f"{len(time)} times but {values} values: give one for each")
    if any(b < a for a, b in pairwise(time)):
        raise ValueError("the times must not fall from entry to entry (two equal times make a jump)")


class SpeedTable(Declaration):
    """A speed given at instants, linear in between and constant outside."""

    time: tuple[Time, ...] = Field(min_length=1)
    value: tuple[Speed, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        _check_times(self.time, len(self.value))
        return self


Vector = tuple[Force, Force] | tuple[Force, Force, Force]
"""A force [Fx, Fz] or [Fx, Fy, Fz]."""


class ForceTable(Declaration):
    """A force given at instants, linear in between and constant outside."""

    time: tuple[Time, ...] = Field(min_length=1)
    value: tuple[Vector, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        _check_times(self.time, len(self.value))
        return self


SpeedHistory = Speed | SpeedTable | Callable[[float], float]
ForceHistory = Vector | ForceTable | Callable[[float], tuple[float, ...]]
