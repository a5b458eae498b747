"""Inner supports: what holds a line between its ends."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from ropewalk.model._base import Declaration, Variants
from ropewalk.model.history import rows
from ropewalk.model.quantity import BearingStiffnesses, Point, PositiveLength
from ropewalk.model.support import Elastic, Fixed, Guided, Moving


class _Inner(Declaration):
    at: PositiveLength = Field(description="unstrained length from the start of the line to the point that it holds")
    position: Point | None = Field(
        default=None,
        description="position of that point (default: its position on the straight, evenly stretched line)",
    )

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all places and directions that it is given by."""
        if self.position is not None:
            yield self.position
        if isinstance(self, Elastic | Moving):
            yield from rows(self.displacement)
        if isinstance(self, Guided):
            yield self.along


class InnerFixed(Fixed, _Inner):
    """A point of a line, between its ends, that does not move; the line may turn there."""


class InnerElastic(Elastic, _Inner):
    """A soft support between the ends of a line: springs and dampers between a point of it and their place."""

    stiffness: BearingStiffnesses = Field(
        description="of the spring, one value for all directions or [kx, kz], in space [kx, ky, kz]; 0 where it is free"
    )


class InnerGuided(Guided, _Inner):
    """A slider between the ends of a line: it holds a point of the line across a straight rail.

    With along: [1, 0] it is the usual bearing of a continuous beam: held up and down, free along.
    """


class InnerMoving(Moving, _Inner):
    """A point of a line, between its ends, that moves as prescribed: a constant displacement is a settlement."""


InnerSupport = Annotated[InnerFixed | InnerElastic | InnerGuided | InnerMoving, Variants("inner support")]
"""Any support between the ends of a line."""
