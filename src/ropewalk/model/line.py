"""Lines: slender bodies described along their unstrained arc length."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.cut import Cut, check_cut
from ropewalk.model.damping import Damping
from ropewalk.model.history import rows
from ropewalk.model.hysteresis import Hysteresis, check_hysteresis
from ropewalk.model.inner_support import InnerSupport
from ropewalk.model.joint import Joined, Sheave
from ropewalk.model.law import LAWS_WITH_OWN_STIFFNESS, Hooke, Inextensible, Law
from ropewalk.model.profile import Profile
from ropewalk.model.quantity import (
    AxialDamping,
    BedStiffness,
    BendingStiffness,
    Count,
    MassPerLength,
    Name,
    Point,
    PositiveForce,
    PositiveLength,
    Rate,
    Retardation,
    Width,
)
from ropewalk.model.saddle import Saddle
from ropewalk.model.segment import Segment, check_segments
from ropewalk.model.support import Elastic, Fixed, Guided, Moving, Support

LARGEST_STRAIN = 10.0
"""A line that must be stretched further than this to reach both its ends is taken for a slip of the pen."""


def spatial(point: tuple[float, ...]) -> tuple[float, float, float]:
    """Write a point or vector given as (x, z) or (x, y, z) with all three components."""
    return (point[0], 0.0, point[1]) if len(point) == 2 else (point[0], point[1], point[2])


USUAL = 100
"""Number of links where none is written."""
SHORTEST = 1e-6  # m, of a line that is given by its tension


class Line(Declaration):
    """A string, rope or wire between two supports."""

    start: Point = Field(description="position of the start (material coordinate 0)")
    end: Point = Field(description="position of the end")
    length: PositiveLength | None = Field(default=None, description="unstrained length; or give `tension`")
    tension: PositiveForce | None = Field(default=None, description="mean tension in equilibrium, instead of `length`")
    mass: MassPerLength = Field(description="mass per unstrained length")
    axial_stiffness: PositiveForce | None = Field(
        default=None, description="EA, needed by the laws without a stiffness of their own"
    )
    law: Law = Field(default=Hooke(), description="tension as a function of strain")
    axial_damping: AxialDamping = Field(default=0.0, description="Kelvin-Voigt c: T = T(eps) + c eps_t")
    hysteresis: Hysteresis | None = Field(
        default=None,
        description="difference between loading and unloading tensions; in dynamic and quasi-static runs",
    )
    bending_stiffness: BendingStiffness = Field(default=0.0, description="EI; used by kind: linear and dynamic")
    foundation: BedStiffness = Field(
        default=0.0, description="of an elastic bed, per length; used by kind: linear and dynamic"
    )
    drag: Rate = Field(default=0.0, description="mass-proportional damping: force -drag * mass * velocity")
    retardation: Retardation = Field(
        default=0.0, description="beta of Rayleigh damping, in proportion to stiffness (drag is alpha); of beams"
    )
    damping: Damping | None = Field(default=None, description="ratio of its modes, instead of drag and retardation")
    start_support: Support = Field(default=Fixed(), description="support at the start")
    end_support: Support = Field(default=Fixed(), description="support at the end")
    supports: dict[Name, InnerSupport] = Field(
        default_factory=dict, description="between its ends, by name: piers, bearings, saddles that hold it"
    )
    elements: Annotated[int, Count(1, 10_000_000, auto=USUAL)] = Field(
        default=USUAL,
        description="number of links; auto: chosen for `accuracy` of the run (other commands take 100)",
    )
    sheaves: dict[Name, Sheave] = Field(
        default_factory=dict, description="sheaves over which the line runs, in order from start to end, by name"
    )
    saddles: dict[Name, Saddle] = Field(
        default_factory=dict, description="saddles on which the line lies, in order from start to end"
    )
    profile: Profile | None = Field(
        default=None,
        description="of the road or track on the line and before and behind it, which wheels follow",
    )
    segments: dict[Name, Segment] = Field(
        default_factory=dict, description="parts of it, by name, with another stiffness, mass or bed: steps, damage"
    )
    strength: PositiveForce | None = Field(
        default=None,
        description="tensile strength; where the tension exceeds it the run becomes doubtful, and the line stays "
        "intact",
    )
    cut: Cut | None = Field(default=None, description="position and time of a failure")
    wind_drag: Width = Field(default=0.0, description="drag coefficient times width, for wind across the line")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        given = {name for name in type(self).model_fields if getattr(self, name) is not None}
        own = (*self._geometry(), *self._clamped(), *self._inner(), *self._damped())
        if self.cut is not None:
            places = {name: support.at for name, support in self.supports.items()}
            own += tuple(check_cut(self.cut, self.length, self.distance, places))
        if self.hysteresis is not None:
            own += tuple(check_hysteresis(self.hysteresis, self.law, self.axial_stiffness))
        own += tuple(check_segments(self.segments, self.length or self.distance, bends=bool(self.bending_stiffness)))
        report("line", [*contradictions(given, self.law.kind), *own])
        return self

    def _geometry(self) -> list[Finding]:
        if self.tension is not None and self.distance < SHORTEST:
            wrong = f"start and end are {self.distance:g} m apart, practically one point: no tension can be reached"
            return [Finding(("tension",), wrong, remedy="give length instead of tension, or other ends")]
        if self.length is not None and self.distance > (1.0 + LARGEST_STRAIN) * self.length:
            wrong = f"the line would be stretched to {self.distance / self.length:.3g} times its length"
            remedy = f"start and end are {self.distance:g} m apart: check length, start and end"
            return [Finding(("length",), wrong, f"{self.length:g} m", remedy)]
        if isinstance(self.law, Inextensible):
            return self._inextensible()
        return []

    def _inextensible(self) -> list[Finding]:
        findings = []
        if self.axial_damping:
            wrong, remedy = "an inextensible line does not stretch and cannot damp it", "leave axial_damping out"
            findings.append(Finding(("axial_damping",), wrong, f"{self.axial_damping:g} N*s", remedy))
        if self.is_restrained_fast and self.length is not None and self.length <= self.distance:
            wrong, remedy = "an inextensible line must be longer than the distance of its ends", "give it sag, or a law"
            given = f"{self.length:.10g} m over {self.distance:.10g} m"
            findings.append(Finding(("length",), wrong, given, remedy))
        return findings

    def _damped(self) -> Iterator[Finding]:
        for key in ("drag", "retardation") if self.damping is not None else ():
            if getattr(self, key):
                wrong, remedy = "damping sets it", f"leave {key} out, or write drag and retardation instead of damping"
                yield Finding((key,), wrong, f"{getattr(self, key):g}", remedy)

    def _clamped(self) -> Iterator[Finding]:
        for key, support in self.ends():
            if isinstance(support, Fixed) and support.clamped and not self.bending_stiffness:
                wrong = "a line without bending stiffness turns freely"
                remedy = "add bending_stiffness (EI), or leave clamped out"
                yield Finding((key, "clamped"), wrong, "true", remedy)

    def _inner(self) -> Iterator[Finding]:
        """What does not fit together of its inner supports."""
        near = 1e-9 * (self.length or self.distance)
        taken: dict[str, float] = {}
        for name, support in self.supports.items():
            path = ("supports", name)
            if name in ("start", "end"):
                yield Finding(path, f"the {name} of the line has the same name", remedy="give it another name")
            if isinstance(support, Fixed) and support.clamped:
                wrong, remedy = "an inner support lets the line turn", "end two lines there, each of them clamped"
                yield Finding((*path, "clamped"), wrong, "true", remedy)
            if self.length is not None and support.at >= self.length - near:
                wrong = f"is not between the ends of the line ({self.length:g} m long)"
                remedy = "stay within its length"
                yield Finding((*path, "at"), wrong, f"{support.at:g} m", remedy)
            for other, at in taken.items():
                if abs(at - support.at) <= near:
                    wrong, remedy = f"inner support {other} is at the same place", "put both into one"
                    yield Finding((*path, "at"), wrong, f"{support.at:g} m", remedy)
            taken[name] = support.at
            if getattr(support, "winch", None) is not None:
                wrong, remedy = "a winch pulls at an end of a line", "leave winch out, or end the line there"
                yield Finding((*path, "winch"), wrong, remedy=remedy)
            if support.position is None and any(isinstance(end, Joined) for _, end in self.ends()):
                wrong, remedy = "is required: the path of a joined line is not declared", "write position: [x, z]"
                yield Finding((*path, "position"), wrong, remedy=remedy)
        for key in ("sheaves", "saddles"):
            if self.supports and getattr(self, key):
                wrong = f"a line over {key} has no inner supports"
                remedy = "end it at one, and begin another line there"
                yield Finding(("supports",), wrong, ", ".join(self.supports), remedy)
        if self.sheaves and self.saddles:
            wrong, remedy = "a line over sheaves has no saddles", "write sheaves as saddles, or saddles as sheaves"
            yield Finding(("saddles",), wrong, ", ".join(self.saddles), remedy)

    def ends(self) -> tuple[tuple[str, Support], ...]:
        """The keys of the supports of its ends, with them."""
        return ("start_support", self.start_support), ("end_support", self.end_support)

    @property
    def winches(self) -> tuple[str, ...]:
        """The keys of its supports at which a winch pulls."""
        return tuple(key for key, support in self.ends() if getattr(support, "winch", None) is not None)

    @property
    def is_joined(self) -> bool:
        """Whether it is joined to something, or runs over sheaves or saddles."""
        return bool(self.sheaves or self.saddles) or any(isinstance(support, Joined) for _, support in self.ends())

    @property
    def alpha(self) -> float:
        """Damping in proportion to mass, 1/s."""
        return self.damping.alpha if self.damping is not None else self.drag

    @property
    def beta(self) -> float:
        """Damping in proportion to stiffness, s."""
        return self.damping.beta if self.damping is not None else self.retardation

    @property
    def has_bending_stiffness(self) -> bool:
        """Whether it has bending stiffness or lies on a bed."""
        beds = (segment.foundation for segment in self.segments.values())
        return bool(self.bending_stiffness or self.foundation or any(beds))

    @property
    def is_restrained_fast(self) -> bool:
        """Whether neither end can yield."""
        return all(isinstance(support, Fixed | Moving) for support in (self.start_support, self.end_support))

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all places and directions of the line, its supports and its sheaves."""
        yield from (self.start, self.end)
        for sheave in self.sheaves.values():
            yield from sheave.vectors()
        for saddle in self.saddles.values():
            yield from saddle.vectors()
        for inner in self.supports.values():
            yield from inner.vectors()
        for _, support in self.ends():
            if isinstance(support, Elastic | Moving):
                yield from rows(support.displacement)
            if isinstance(support, Guided):
                yield support.along

    def place_of(self, support: InnerSupport, length: float) -> tuple[float, float, float]:
        """Where an inner support of a line of an unstrained length in m stands, [x, y, z] m."""
        if support.position is not None:
            return spatial(support.position)
        part, start, end = support.at / length, spatial(self.start), spatial(self.end)
        x, y, z = ((1.0 - part) * a + part * b for a, b in zip(start, end, strict=True))
        return x, y, z

    @property
    def distance(self) -> float:
        """Distance between the ends in m, by way of the sheaves or saddles."""
        sheaves, saddles = self.sheaves.values(), self.saddles.values()
        places = [self.start, *(s.at for s in sheaves), *(s.at for s in saddles), self.end]
        return sum(math.dist(spatial(a), spatial(b)) for a, b in pairwise(places))


def contradictions(given: Collection[str], law: str | None) -> list[Finding]:
    """Find keys of a line that are missing or exclude each other, from their names alone.

    Args:
        given: the keys that have a value.
        law: the kind of the law, None where it is not known.
    """
    findings = []
    if "length" in given and "tension" in given:
        remedy = "give length (unstrained) or tension (mean tension in equilibrium), not both"
        findings.append(Finding(("tension",), "length and tension exclude each other", remedy=remedy))
    if "length" not in given and "tension" not in given:
        remedy = "add length (unstrained, in m) or tension (mean tension in equilibrium, in N)"
        findings.append(Finding((), "the line is not determined", remedy=remedy))
    own = law in {model.model_fields["kind"].default for model in LAWS_WITH_OWN_STIFFNESS}
    if own and "axial_stiffness" in given:
        own_stiffness = "does not stretch" if law == "inextensible" else "has a stiffness of its own"
        wrong = f"law {law} {own_stiffness}"
        findings.append(Finding(("axial_stiffness",), wrong, remedy="leave axial_stiffness out"))
    if law is not None and not own and "axial_stiffness" not in given:
        remedy = "add axial_stiffness (EA, in N), for example 100 kN"
        findings.append(Finding(("axial_stiffness",), f"is required by law {law}", remedy=remedy))
    return findings
