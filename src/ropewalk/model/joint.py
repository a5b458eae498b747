"""Joints and sheaves: what lines meet at, and what they run over."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from pydantic import Field

from ropewalk.model._base import Declaration
from ropewalk.model.quantity import FrictionCoefficient, Mass, Point, Spot, Vector


class Joined(Declaration):
    """The end of a line joined to a joint, to a place along another line, or to a place on a net.

    `start` or `end` of the line says about where that is: the place itself follows from the rest shape.
    """

    kind: Literal["joined"] = "joined"
    to: str = Field(description="name of a joint, a line or a net")
    at: Spot | None = Field(
        default=None, description="unstrained length from the start of that line; on a net [u, v]; not with joints"
    )


class Joint(Declaration):
    """A knot, ring or block that nothing but the lines joined to it holds."""

    mass: Mass = Field(default=0.0, description="of the joint; its weight counts")
    force: Vector = Field(default=(0.0, 0.0), description="constant force on it")

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by."""
        yield self.force


class Sheave(Declaration):
    """A small wheel over which a line runs on: a point, where the line bends and slides."""

    at: Point = Field(description="position; approximate for a sheave on a joint")
    friction: FrictionCoefficient = Field(
        default=0.0, description="coefficient: the line slips where T2/T1 exceeds exp(friction * angle)"
    )
    to: str | None = Field(default=None, description="name of a joint that carries it; left out: it does not move")

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all places that it is given by."""
        yield self.at
