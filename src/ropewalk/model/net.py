"""Nets and membranes: thin structures that span a surface."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, Variants, report
from ropewalk.model.quantity import (
    AxialDamping,
    Count,
    Displacement,
    MassPerLength,
    OneOrEach,
    Point,
    PositiveForce,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    Rate,
    Viscosity,
)

MassPerArea = Annotated[float, Quantity("kg/m^2", "positive")]
Slackness = Annotated[float, Quantity("dimensionless", "positive")]
Tensions = Annotated[float | tuple[float, float] | tuple[float, float, float], OneOrEach("N/m", "positive")]
Forces = Annotated[float | tuple[float, float] | tuple[float, float, float], OneOrEach("N", "positive")]
PoissonRatio = Annotated[float, Quantity("dimensionless", "not negative")]
EdgeViscosity = Annotated[float, Quantity("N*s/m^2", "not negative")]

_COARSE = 20  # cells on the shorter side where no number is given
_MANY = 1e15  # more than can be counted
_Cells = Annotated[int, Count(1, 2_000)]


class ClampedEdge(Declaration):
    """An edge that does not move."""

    kind: Literal["clamped"] = "clamped"


class SoftEdge(Declaration):
    """An edge on springs and dampers all around, without force where it is laid out; its corners are on them, too."""

    kind: Literal["soft"] = "soft"
    stiffness: Annotated[float, Quantity("N/m^2", "positive")] = Field(
        description="of the springs per length of the edge, the same in all directions"
    )
    damping: EdgeViscosity = Field(default=0.0, description="of the dampers per length of the edge")


class CableEdge(Declaration):
    """An edge cable all around, with the corners held."""

    kind: Literal["cable"] = "cable"
    axial_stiffness: PositiveForce = Field(description="EA of the edge cable")
    mass: MassPerLength = Field(description="of the edge cable, per length")
    tension: PositiveForce | None = Field(default=None, description="of the edge cable as laid out (default: none)")


Edge = Annotated[ClampedEdge | SoftEdge | CableEdge, Variants("edge")]


class Sheet(Declaration):
    """What nets and membranes have in common: where they are laid out, and how they are held.

    They are laid out flat: a parallelogram given by a corner and two sides, or any outline given by its corners. A
    place on them is [u, v]: metres along both sides from the corner as laid out; with an outline, along its first side
    and across it, from its first corner.
    """

    corner: Point | None = Field(default=None, description="of a parallelogram: where u = v = 0")
    sides: tuple[Displacement, Displacement] | None = Field(
        default=None, description="of a parallelogram: two vectors from the corner, at a right angle for nets"
    )
    cells: tuple[_Cells, _Cells] | None = Field(
        default=None, description="of a parallelogram: number of cells along both sides (default: 20 on the shorter)"
    )
    boundary: tuple[Point, ...] | None = Field(
        default=None, description="corners of any flat outline in order, instead of corner and sides"
    )
    spacing: PositiveLength | None = Field(default=None, description="of the nodes within an outline, needed for it")
    edge: Edge = Field(default=ClampedEdge(), description="support of the edge")
    drag: Rate = Field(default=0.0, description="mass-proportional damping: force -drag * mass * velocity")

    def layout(self) -> list[Finding]:
        """Find problems of where it is laid out."""
        findings = []
        if (self.boundary is None) == (self.corner is None and self.sides is None):
            remedy = "give corner and sides (a parallelogram), or boundary and spacing (any outline)"
            return [Finding((), "the outline is not determined", remedy=remedy)]
        if self.boundary is None:
            for key in ("corner", "sides"):
                if getattr(self, key) is None:
                    findings.append(Finding((key,), "is required", remedy="a parallelogram needs corner and sides"))
            if self.spacing is not None:
                findings.append(Finding(("spacing",), "is for boundary", f"{self.spacing:g} m", "write cells"))
            if self.sides is not None:
                findings += self._sides(self.sides)
            return findings
        for key in ("cells",):
            if getattr(self, key) is not None:
                findings.append(Finding((key,), "is for corner and sides", remedy="write spacing"))
        if self.spacing is None:
            findings.append(Finding(("spacing",), "is required for an outline", remedy="add spacing in m"))
        if len(self.boundary) < 3:
            wrong, remedy = f"an outline of {len(self.boundary)} corners", "give three or more"
            findings.append(Finding(("boundary",), wrong, remedy=remedy))
        return findings

    def _sides(self, sides: tuple[tuple[float, ...], tuple[float, ...]]) -> list[Finding]:
        first, second = (_three(side) for side in sides)
        a, b, across = math.hypot(*first), math.hypot(*second), math.hypot(*_cross(first, second))
        if across <= 1e-6 * a * b or a * b == 0.0:
            remedy = "give two vectors in different directions, for example [[4, 0, 0], [0, 3, 0]]"
            return [Finding(("sides",), "the sides span no area", remedy=remedy)]
        return []

    @property
    def divisions(self) -> tuple[int, int]:
        """Number of cells of a parallelogram along both sides."""
        if self.cells is not None:
            return self.cells
        assert self.sides is not None
        a, b = (math.hypot(*side) for side in self.sides)
        return round(min(_COARSE * max(1.0, a / b), _MANY)), round(min(_COARSE * max(1.0, b / a), _MANY))

    @property
    def nodes(self) -> int:
        """Number of nodes; of an outline about that, by its area and its length."""
        if self.boundary is None or self.spacing is None:
            m, n = self.divisions
            return (m + 1) * (n + 1)
        corners = [_three(corner) for corner in self.boundary]
        pairs = list(zip(corners, corners[1:] + corners[:1], strict=True))
        area = 0.5 * math.hypot(*map(sum, zip(*(_cross(*pair) for pair in pairs), strict=True)))
        length = sum(math.dist(*pair) for pair in pairs)
        return int(min((area / self.spacing + length) / self.spacing, _MANY))

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all places and directions that it is given by; a net is never in the x-z plane alone."""
        yield (0.0, 1.0, 0.0)


class Net(Sheet):
    """A net of two families of threads that cross, along u and along v; threads pull and never push.

    With corner and sides, a thread runs along every line of cells, and `mesh` says how far apart they are in truth: one
    computed thread stands for those around it. Within an outline the threads are smeared over triangles, which gives
    the same net as the triangles get small.
    """

    kind: Literal["net"] = "net"
    axial_stiffness: PositiveForce = Field(description="EA of one thread")
    mass: MassPerLength = Field(description="of one thread, per unstrained length")
    mesh: PositiveLength | None = Field(
        default=None, description="distance of the threads as laid out (default: the cells; an outline needs it)"
    )
    tension: Forces | None = Field(default=None, description="of one thread as laid out: one value or [Tu, Tv]")
    slack: Slackness | None = Field(
        default=None, description="instead of tension: unstrained length of threads over their length as laid out"
    )
    axial_damping: AxialDamping = Field(default=0.0, description="Kelvin-Voigt c of one thread")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = [*self.layout(), *_tension_or_slack(self.tension, self.slack)]
        if self.boundary is not None and self.mesh is None:
            findings.append(Finding(("mesh",), "is required for an outline", remedy="add the distance of threads"))
        if self.sides is not None and not findings:
            a, b = (_three(side) for side in self.sides)
            if abs(sum(p * q for p, q in zip(a, b, strict=True))) > 1e-9 * math.hypot(*a) * math.hypot(*b):
                findings.append(Finding(("sides",), "threads cross at right angles", remedy="make them orthogonal"))
        report("net", findings)
        return self


class Membrane(Sheet):
    """A thin elastic skin that pulls and never pushes: where it would be compressed it wrinkles or goes slack.

    Tension field theory with the second Piola-Kirchhoff stress linear in the Green strain, in plane stress.
    """

    kind: Literal["membrane"] = "membrane"
    stiffness: PositiveStiffness = Field(description="E t: Young's modulus times thickness")
    poisson: PoissonRatio = Field(default=0.3, description="Poisson's ratio, below 0.5")
    mass: MassPerArea = Field(description="per unstrained area")
    tension: Tensions | None = Field(default=None, description="per width as laid out: one value or [Nu, Nv]")
    slack: Slackness | None = Field(
        default=None, description="instead of tension: unstrained size over the size as laid out"
    )
    damping: Viscosity = Field(default=0.0, description="Kelvin-Voigt: stress per width and rate of strain")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = [*self.layout(), *_tension_or_slack(self.tension, self.slack)]
        if self.poisson >= 0.5:
            findings.append(Finding(("poisson",), "is too large", f"{self.poisson:g}", "write a value below 0.5"))
        report("membrane", findings)
        return self


AnyNet = Annotated[Net | Membrane, Variants("net")]
"""A net or a membrane."""


def _tension_or_slack(tension: object, slack: float | None) -> list[Finding]:
    findings = []
    if tension is not None and slack is not None:
        findings.append(Finding(("slack",), "tension and slack exclude each other", remedy="give one of them"))
    if isinstance(tension, tuple) and len(tension) == 3:
        findings.append(Finding(("tension",), "has 3 values", remedy="write one value, or two: along u and along v"))
    if slack is not None and not 0.5 <= slack <= 2.0:
        wrong, remedy = "the unstrained size over that as laid out", "write for example 1.02 for 2 % more than needed"
        findings.append(Finding(("slack",), wrong, f"{slack:g}", remedy))
    return findings


def _cross(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _three(vector: tuple[float, ...]) -> tuple[float, float, float]:
    return (vector[0], 0.0, vector[1]) if len(vector) == 2 else (vector[0], vector[1], vector[2])
