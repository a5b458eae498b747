"""Saddles: round bodies over which a line slides."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, Variants, report
from ropewalk.model.history import rows
from ropewalk.model.quantity import FrictionCoefficient, Point, PositiveLength
from ropewalk.model.support import Elastic, Fixed, Guided, Moving


class Saddle(Declaration):
    """A round body that a line lies on, slides over and may lift off: the shoe or saddle of a tower.

    The line finds by itself how much of it lies there, and loads run over it.
    """

    at: Point = Field(description="its crown, the highest point of its groove")
    radius: PositiveLength = Field(description="of the groove along the line; the line lies on the upper half")
    friction: FrictionCoefficient = Field(
        default=0.0, description="coefficient: the line slips where T2/T1 exceeds exp(friction * angle)"
    )
    support: Annotated[Fixed | Elastic | Guided | Moving, Variants("support")] = Field(
        default=Fixed(), description="support of the saddle; elastic or guided for a flexible tower"
    )

    @model_validator(mode="after")
    def _without_winch(self) -> Self:
        if getattr(self.support, "winch", None) is not None:
            wrong, remedy = "a winch pulls at an end of a line", "leave winch out"
            report("saddle", [Finding(("support", "winch"), wrong, remedy=remedy)])
        return self

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all places and directions that it is given by."""
        yield self.at
        if isinstance(self.support, Elastic | Moving):
            yield from rows(self.support.displacement)
        if isinstance(self.support, Guided):
            yield self.support.along
