"""Hysteresis: a line gives back less when it is let off than it has taken when it was pulled."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.law import Hooke, Law, Tabulated, TensionOnly, Webbing
from ropewalk.model.quantity import Factor, PositiveForce, TableForce


class Hysteresis(Declaration):
    """Loading follows `law`, unloading another curve below it; between both, a spring and a slider that rubs.

    The difference is friction within the line, whatever the speed. Give `ratio`, or `unloading` with a law of kind
    table. A motion begins on the curve of loading.
    """

    ratio: Factor | None = Field(default=None, description="of the tensions of unloading and loading at one strain")
    unloading: tuple[TableForce, ...] | None = Field(
        default=None, description="tensions of unloading at the strains of the table of `law`"
    )
    stiffness: PositiveForce = Field(
        description="EA of the spring: stiffness without slip, parallel to the slope of the mean curve"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("hysteresis", self._contradictions())
        return self

    def _contradictions(self) -> Iterator[Finding]:
        if self.ratio is None and self.unloading is None:
            yield Finding((), "there is no curve of unloading", remedy="add ratio, for example 0.8, or unloading")
        if self.ratio is not None and self.unloading is not None:
            yield Finding(("ratio",), "ratio and unloading exclude each other", remedy="give one of them")
        if self.ratio is not None and self.ratio >= 1.0:
            wrong = "the unloading tension would not be below the loading tension"
            remedy = "write less than 1, for example 0.8"
            yield Finding(("ratio",), wrong, f"{self.ratio:g}", remedy)
        for i, tension in enumerate(self.unloading or ()):
            if tension < 0.0:
                wrong, remedy = "the line would be in compression during unloading", "write no tension below zero"
                yield Finding(("unloading", i), wrong, f"{tension:g} N", remedy)
                break

    def halves(self, law: Tabulated) -> tuple[float, ...]:
        """Half of what loading and unloading differ by at the strains of a table, N."""
        if self.unloading is None:
            return tuple(0.5 * (1.0 - (self.ratio or 0.0)) * max(loading, 0.0) for loading in law.tension)
        return tuple(0.5 * (one - other) for one, other in zip(law.tension, self.unloading, strict=True))


def check_hysteresis(hysteresis: Hysteresis, law: Law, axial_stiffness: float | None) -> Iterator[Finding]:
    """Find what does not fit of the hysteresis of a line to its law, whose stiffness in N may be that of the line."""
    path = ("hysteresis",)
    if not isinstance(law, Hooke | TensionOnly | Webbing | Tabulated):
        wrong, remedy = "is for the laws hooke, tension_only, webbing and table", "write the law as a table"
        yield Finding(path, wrong, f"law {law.kind}", remedy)
        return
    if not isinstance(law, Tabulated):
        if hysteresis.unloading is not None:
            wrong = "tensions of unloading stand at the strains of a table"
            yield Finding((*path, "unloading"), wrong, f"law {law.kind}", "write law: {kind: table, ...}, or ratio")
        elif hysteresis.ratio is not None:
            loading = law.axial_stiffness if isinstance(law, Webbing) else axial_stiffness
            yield from _too_soft(hysteresis, 0.5 * (1.0 - hysteresis.ratio) * (loading or 0.0))
        return
    if hysteresis.unloading is not None:
        if len(hysteresis.unloading) != len(law.strain):
            wrong = f"{len(hysteresis.unloading)} tensions of unloading do not go with {len(law.strain)} strains"
            yield Finding((*path, "unloading"), wrong, remedy="give one for each strain of the law")
            return
        for i, (one, other) in enumerate(zip(law.tension, hysteresis.unloading, strict=True)):
            if other > one:
                wrong, remedy = "the unloading tension would exceed the loading tension", f"write {one:g} N at most"
                yield Finding((*path, "unloading", i), wrong, f"{other:g} N", remedy)
                return
    if law.strain[0] > 0.0:
        wrong, remedy = "the curves of loading and unloading start at strain 0", "begin the table at strain 0"
        yield Finding(("law", "strain", 0), wrong, f"{law.strain[0]:g}", remedy)
    half, strain = hysteresis.halves(law), law.strain
    slopes = [(b - a) / (e1 - e0) for (a, b), (e0, e1) in zip(pairwise(half), pairwise(strain), strict=True)]
    if slopes[-1] < 0.0:
        wrong = "beyond the last strain, the unloading curve would rise above the loading curve"
        remedy = "add a point, or remove the last one: both curves continue with their last slopes"
        yield Finding((*path, "unloading", len(half) - 1), wrong, remedy=remedy)
    yield from _too_soft(hysteresis, max(slopes))


def _too_soft(hysteresis: Hysteresis, least: float) -> Iterator[Finding]:
    """Say that the spring does not follow the curve of loading, half of whose distance from that of unloading grows."""
    if hysteresis.stiffness < least:
        wrong, given = "is too little: loading would not follow the law", f"{hysteresis.stiffness:g} N"
        yield Finding(("hysteresis", "stiffness"), wrong, given, f"write {least:.4g} N or more")
