"""Rows of hangers: many alike lines between two others, by one block."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Self

from pydantic import Field, model_validator

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.joint import Joined
from ropewalk.model.law import TensionOnly
from ropewalk.model.line import Line, spatial
from ropewalk.model.missing import missing
from ropewalk.model.quantity import Count, Lengths, MassPerLength, PositiveForce, Station

_SAME = 1e-9  # of a length


class Hangers(Declaration):
    """A row of upright hangers from a line above to a line below, as long as the wanted place of that one demands."""

    above: str = Field(alias="from", description="name of the line that they hang from")
    below: str = Field(alias="to", description="name of the line that hangs on them")
    count: Annotated[int, Count(1, 1000)] | None = Field(
        default=None, description="number of hangers at equal distances along the line below; or give `at`"
    )
    at: Lengths | None = Field(
        default=None, description="places on the line below, unstrained lengths from its start; or give `count`"
    )
    camber: Station = Field(
        default=0.0,
        description="camber: in equilibrium the hangers hold the line below on a parabola of this rise above its chord",
    )
    mass: MassPerLength = Field(description="mass per unstrained length of each")
    axial_stiffness: PositiveForce = Field(description="EA of each; they carry tension only")
    elements: Annotated[int, Count(1, 1000)] = Field(default=1, description="number of links of each")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if (self.count is None) == (self.at is None):
            wrong = "at and count exclude each other" if self.at is not None else "the positions are not determined"
            findings.append(Finding(("count",), wrong, remedy="write count, or the positions (at)"))
        if self.at is not None and any(b <= a for a, b in zip(self.at, self.at[1:], strict=False)):
            findings.append(Finding(("at",), "places must rise", str(list(self.at)), "sort them, and give each once"))
        report("hangers", findings)
        return self

    def places(self, length: float) -> tuple[float, ...]:
        """Places on the line below, whose unstrained length is given, m."""
        if self.at is not None:
            return self.at
        assert self.count is not None
        return tuple(length * i / (self.count + 1) for i in range(1, self.count + 1))

    def rise(self, part: float) -> float:
        """How far the wanted place of the line below is above the straight one at a part of its span, m."""
        return 4.0 * self.camber * part * (1.0 - part)


def unstrained(line: Line) -> float:
    """Unstrained length of a line, m; about that of one that is given by its tension."""
    if line.length is not None:
        return line.length
    assert line.tension is not None
    return line.distance / (1.0 + line.tension / (line.axial_stiffness or math.inf))


def check_hangers(
    hangers: Mapping[str, Hangers], lines: Mapping[str, Line | None], gravity: float
) -> Iterator[Finding]:
    """Find what rows of hangers cannot be put between, and names that they take from others."""
    for name, row in hangers.items():
        path, wrong = ("hangers", name), False
        for key, other in (("from", row.above), ("to", row.below)):
            if other not in lines:
                remedy = did_you_mean(other, [*lines], otherwise=f"lines here: {', '.join(lines)}")
                yield Finding((*path, key), "no such line", repr(other), remedy)
                wrong = True
        if row.above == row.below:
            yield Finding((*path, "to"), "is the line that they hang from", repr(row.below), "name another line")
            wrong = True
        above, below = lines.get(row.above), lines.get(row.below)
        if wrong or above is None or below is None:
            continue
        if gravity == 0.0:
            yield Finding(path, "without gravity hangers carry no load", remedy="give gravity, or leave hangers out")
            continue
        for key, other, line in (("from", row.above, above), ("to", row.below, below)):
            feature = "a joined line, or one over sheaves or saddles," if line.is_joined else ""
            if key == "from" and line.bending_stiffness:
                feature = "a line with bending stiffness above"
            if feature:
                remedy = "name a line between two supports, above one without bending stiffness"
                yield missing((*path, key), "rows of hangers", other, remedy, feature=feature)
                wrong = True
        length = unstrained(below)
        if not wrong and row.at is not None and row.at[-1] >= length * (1.0 - _SAME):
            given, remedy = f"{row.at[-1]:g} m", f"stay within its {length:.6g} m"
            yield Finding((*path, "at"), f"is not between the ends of {row.below}", given, remedy)
            wrong = True
        taken = next((one for one in _names(name, row, length) if one in lines), None)
        if taken is not None:
            yield Finding(path, f"a line has the name {taken} of one of them", remedy="give the row another name")
        if not wrong and None in guessed(name, row, lines, gravity).values():
            remedy = "raise its ends, or make it shorter"
            yield Finding((*path, "from"), f"does not hang above {row.below}", repr(row.above), remedy)


def _names(name: str, row: Hangers, length: float) -> list[str]:
    return [f"{name}-{i + 1}" for i in range(len(row.places(length)))]


def guessed(name: str, row: Hangers, lines: Mapping[str, Line | None], gravity: float) -> dict[str, Line | None]:
    """The hangers of a row as lines, about as long as they have to be: the line above as a parabola.

    With all weight w on the horizontal, H = w L^2/(8 f) (Irvine 1981).

    Args:
        name: of the row.
        row: whose they are.
        lines: of the scenario.
        gravity: m/s^2.

    Returns:
        Lines by their names; None for one that would have no length.
    """
    above, below = lines[row.above], lines[row.below]
    assert above is not None
    assert below is not None
    (x0, y0, z0), (x1, y1, z1) = spatial(above.start), spatial(above.end)
    (u0, v0, w0), (u1, v1, w1) = spatial(below.start), spatial(below.end)
    span, length = math.hypot(x1 - x0, y1 - y0), unstrained(below)
    if span == 0.0:
        return dict.fromkeys(_names(name, row, length))
    weight = gravity * (above.mass + below.mass * length / span)
    sag = 0.1 * span
    for _ in range(50):  # of what stretches and hangs
        H = weight * span**2 / (8.0 * sag) if sag > 0.0 else math.inf
        if above.tension is not None:
            sag = weight * span**2 / (8.0 * above.tension)
            break
        assert above.length is not None
        long = above.length * (1.0 + H / (above.axial_stiffness or math.inf))
        chord = math.hypot(span, z1 - z0)
        sag = 0.5 * (sag + math.sqrt(0.375 * span * max(long - chord, 1e-6 * chord)))
    whole, found = unstrained(above), dict[str, Line | None]()
    for label, at in zip(_names(name, row, length), row.places(length), strict=True):
        part = at / length
        foot = (u0 + part * (u1 - u0), v0 + part * (v1 - v0), w0 + part * (w1 - w0) + row.rise(part))
        along = ((foot[0] - x0) * (x1 - x0) + (foot[1] - y0) * (y1 - y0)) / span**2
        if not 0.0 < along < 1.0:
            found[label] = None
            continue
        head = (
            x0 + along * (x1 - x0),
            y0 + along * (y1 - y0),
            z0 + along * (z1 - z0) - 4.0 * sag * along * (1.0 - along),
        )
        slope = 4.0 * sag / span
        arc = (_arc(slope * (1.0 - 2.0 * along)), _arc(slope))
        up = head[2] - foot[2]
        if up <= 0.0:
            found[label] = None
            continue
        found[label] = hanger(row, head, foot, whole * 0.5 * (1.0 - arc[0] / arc[1]), at, up)
    return found


def _arc(slope: float) -> float:
    """Length of a parabola from its vertex to a slope, over the neglected part."""
    return slope * math.sqrt(1.0 + slope**2) + math.asinh(slope)


def hanger(
    row: Hangers, head: tuple[float, ...], foot: tuple[float, ...], above: float, below: float, length: float
) -> Line:
    """One hanger.

    Args:
        row: whose it is.
        head: m, about where its upper end is.
        foot: m, about where its lower end is.
        above: m, unstrained, from the start of the line above.
        below: m, of that below.
        length: m, its own, unstrained.
    """
    return Line(
        start=head, end=foot, length=length, mass=row.mass, axial_stiffness=row.axial_stiffness, law=TensionOnly(),
        elements=row.elements, start_support=Joined(to=row.above, at=above), end_support=Joined(to=row.below, at=below),
    )  # fmt: skip
