"""Spreads: how what people differ in is distributed among them."""

from __future__ import annotations

from statistics import NormalDist
from typing import Annotated, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import Frequency, Mass, Offset, PositiveLength, PositiveMass, Quantity

WIDEST = 3.0
"""Standard deviations from the mean beyond which there is nobody."""
_NORMAL = NormalDist()
_OUTSIDE = _NORMAL.cdf(-WIDEST)


class Spread(Declaration):
    """A normal distribution that is cut off three standard deviations from its mean."""

    mean: float
    deviation: float

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.least <= 0.0:
            wrong, remedy = "three deviations reach from the mean to zero", f"write less than {self.mean / WIDEST:.4g}"
            report("spread", [Finding(("deviation",), wrong, f"{self.deviation:g}", remedy)])
        return self

    @property
    def least(self) -> float:
        """The smallest value."""
        return self.mean - WIDEST * self.deviation

    @property
    def most(self) -> float:
        """The largest value."""
        return self.mean + WIDEST * self.deviation

    def at(self, part: float) -> float:
        """The value that a part of all, 0 to 1, is smaller than."""
        return self.mean + self.deviation * _NORMAL.inv_cdf(_OUTSIDE + part * (1.0 - 2.0 * _OUTSIDE))


class MassSpread(Spread):
    """Masses: normally distributed, cut off three standard deviations from the mean."""

    mean: PositiveMass = Field(description="of all")
    deviation: Mass = Field(default=0.0, description="standard deviation")


class FrequencySpread(Spread):
    """Frequencies: normally distributed, cut off three standard deviations from the mean."""

    mean: Frequency = Field(description="of all")
    deviation: Annotated[float, Quantity("Hz", "not negative")] = Field(default=0.0, description="standard deviation")


class LengthSpread(Spread):
    """Lengths: normally distributed, cut off three standard deviations from the mean."""

    mean: PositiveLength = Field(description="of all")
    deviation: Offset = Field(default=0.0, description="standard deviation")
