"""Overhead lines: what a pantograph takes its current from, one section of it, in the words of the railway."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import accumulate, pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.condition import Condition
from ropewalk.model.dropper_cut import DropperCut, not_there
from ropewalk.model.limits import Limits
from ropewalk.model.overhead_wire import ContactWire, MessengerWire, StitchWire
from ropewalk.model.quantity import (
    Count,
    Heights,
    LengthRows,
    LinearMass,
    Mass,
    Places,
    Point,
    PositiveForce,
    PositiveLength,
    PositiveStiffness,
    Radii,
    Sags,
    Staggers,
    Stiffness,
    Stiffnesses,
    Viscosities,
    Viscosity,
)
from ropewalk.model.spans import MOST_SPANS, FirstAndLast, ListOrSpans, Spans

FEWEST_ELEMENTS = 16
"""In the shortest span: fewer show neither the droppers nor a wave."""
STEEPEST = 0.05
"""Slope of a contact wire between two supports; those that trains run below stay under 1 : 100."""
MOST_ASIDE = 0.5
"""Distance of neighbouring staggers over the length of their span; the contact wire is as long as that."""
TIGHTEST = 0.5
"""Length of a span over the radius of its curve."""
_DROPPERS_PER_SPAN = 9
_STEADY_ARM_MASS = 0.333  # kg: a third of an arm of 1 kg, as a hinged rod moves with the wire at its end


class Droppers(Declaration):
    """What hangs the contact wire from the messenger: ties that carry tension only, unless `pushes` is given."""

    at: Places | None = Field(
        default=None, description="distances from the start of every span, or one such list for each span"
    )
    per_span: Annotated[int, Count(1, 1000)] | None = Field(
        default=None,
        description="number of droppers at equal distances in every span, the outer ones half a distance from the "
        f"supports, instead of `at` (default: {_DROPPERS_PER_SPAN})",
    )
    lengths: LengthRows | None = Field(
        default=None,
        description="unstrained length of each dropper of a span, or one such list for each span (default: computed "
        "from pre_sag)",
    )
    stiffness: PositiveStiffness = Field(default=100e3, description="in tension")
    pushes: Stiffness = Field(default=0.0, description="stiffness in compression")
    damping: Viscosity = Field(default=0.0, description="while it pulls")
    mass: Mass | None = Field(default=None, description="of each dropper; or give mass_per_length")
    mass_per_length: LinearMass | None = Field(default=None, description="of droppers, instead of `mass`")
    contact_clamp: Mass = Field(default=0.0, description="mass of the clamp on the contact wire")
    messenger_clamp: Mass = Field(default=0.0, description="mass of the clamp on the messenger or stitch wire")
    strength: PositiveForce | None = Field(
        default=None,
        description="tensile strength of a dropper, which then fails (default: unlimited)",
    )
    cut: DropperCut | None = Field(default=None, description="droppers that fail at a time (default: none)")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if self.at is not None and self.per_span is not None:
            remedy = "give the places (at) or their number (per_span), not both"
            findings.append(Finding(("per_span",), "at and per_span exclude each other", f"{self.per_span}", remedy))
        if self.mass is not None and self.mass_per_length is not None:
            wrong, remedy = "mass and mass_per_length exclude each other", "give one of them"
            findings.append(Finding(("mass_per_length",), wrong, f"{self.mass_per_length:g} kg/m", remedy))
        if self.pushes > self.stiffness:
            remedy = f"write at most {self.stiffness:g} N/m; 0, the default, is a dropper that slackens"
            findings.append(
                Finding(("pushes",), "a dropper cannot push harder than it pulls", f"{self.pushes:g} N/m", remedy)
            )
        report("droppers", findings)
        return self


class SteadyArms(Declaration):
    """What holds the contact wire at the supports between spans, at the height of its ends.

    Without stagger an arm is what moves of it, and a constant force upwards that keeps the wire level there. With
    stagger it is a hinged link to the mast, whose pull bends the wire in plan view; it is inclined so that it keeps
    the wire level, too. Free arms keep it aside only.
    """

    mass: Mass | None = Field(
        default=None,
        description=f"that moves with the wire (default: {_STEADY_ARM_MASS:g} kg, a third of an arm of 1 kg)",
    )
    mass_per_length: LinearMass | None = Field(
        default=None,
        description="of the arm, a hinged rod, instead of `mass`: a third of its mass moves with the wire and half its "
        "weight hangs there",
    )
    length: PositiveLength = Field(default=1.2, description="unstrained length")
    axial_stiffness: PositiveForce = Field(default=17e6, description="EA")
    stagger: Staggers | None = Field(
        default=None,
        description="lateral offset of the wire: at the first end to the left (y > 0), then on alternating sides; "
        "or a list, one value for each support with both ends",
    )
    free: bool = Field(
        default=False,
        description="whether nothing but the droppers holds the wire up at the supports; arms with stagger are level",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if self.mass is not None and self.mass_per_length is not None:
            wrong, remedy = "mass and mass_per_length exclude each other", "give one of them"
            findings.append(Finding(("mass_per_length",), wrong, f"{self.mass_per_length:g} kg/m", remedy))
        if self.stagger == 0.0:
            wrong, remedy = "an arm without stagger has no direction", "leave stagger out"
            findings.append(Finding(("stagger",), wrong, "0 m", remedy))
        if self.stagger is None:
            wrong = "an arm without stagger is a mass and a constant force"
            own = ["axial_stiffness", *(["length"] if self.mass_per_length is None else [])]
            for key in own:
                if (value := getattr(self, key)) != type(self).model_fields[key].default:
                    findings.append(Finding((key,), wrong, f"{value:g}", f"add stagger, or leave {key} out"))
        report("steady arms", findings)
        return self

    @property
    def moving_mass(self) -> float:
        """What moves with the wire, kg."""
        if self.mass_per_length is not None:
            return self.mass_per_length * self.length / 3.0
        return _STEADY_ARM_MASS if self.mass is None else self.mass

    @property
    def hanging_mass(self) -> float:
        """Whose weight hangs on the wire, kg."""
        return self.moving_mass if self.mass_per_length is None else 0.5 * self.mass_per_length * self.length


class MessengerSupports(Declaration):
    """What holds the messenger at the supports between spans, at the system height at rest."""

    stiffness: Stiffnesses | None = Field(
        default=None, description="one value for all directions, or [kx, kz] or [kx, ky, kz] (default: rigid)"
    )
    damping: Viscosities = Field(default=0.0, description="one value for all directions, or [cx, cz], [cx, cy, cz]")
    along: Literal["swings", "held"] | None = Field(
        default=None,
        description="`swings`: the cantilever turns and the messenger is free along the line; `held`: it is held "
        "along the line as well (default: `swings`, or `held` if a stiffness along the line is given)",
    )
    stagger: Literal["same", "straight"] = Field(
        default="same",
        description="same: the messenger stands over the contact wire; straight: it runs straight, and droppers lean",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if isinstance(self.stiffness, tuple) and self.along == "swings":
            wrong = "a messenger with along: swings has no stiffness along the line"
            remedy = f"write along: held, or one number, {self.stiffness[-1]:g} N/m"
            findings.append(Finding(("along",), wrong, f"{self.stiffness[0]:g} N/m", remedy))
        report("messenger supports", findings)
        return self

    @property
    def swings(self) -> bool:
        """Whether the messenger is free along the line."""
        return self.along == "swings" or (self.along is None and not isinstance(self.stiffness, tuple))


CONTACT_WIRE = "contact"
"""Name of the contact wire in results, behind that of its overhead line."""


class OverheadLine(Declaration):
    """One section of overhead line along x: a contact wire that hangs by droppers from a messenger wire."""

    spans: Annotated[tuple[float, ...] | Spans, ListOrSpans()] = Field(
        description="{count, length}, or a list of the lengths of all spans, in order"
    )
    start: Point = Field(default=(0.0, 0.0), description="start of the contact wire; the line extends along x")
    contact_wire: ContactWire = Field(default=ContactWire.as_written(), description="the wire that pantographs touch")
    messenger_wire: MessengerWire = Field(default=MessengerWire.as_written(), description="the wire that carries it")
    droppers: Droppers = Field(default=Droppers.as_written(), description="droppers between messenger and contact wire")
    system_height: PositiveLength = Field(default=1.2, description="of the messenger over the contact wire at supports")
    heights: Heights | None = Field(
        default=None,
        description="heights of registration: how much higher than `start` the contact wire is at each support with "
        "both ends; in between it rises evenly, and the messenger with it (default: 0)",
    )
    radius: Radii | None = Field(
        default=None,
        description="of the track in plan view, one value, or a list for all spans: positive where it turns left "
        "(y > 0), 0 where it is straight; staggers count from its middle (default: straight)",
    )
    overlap: str | None = Field(
        default=None,
        description="name of the overhead line that begins parallel to the last spans of this one: pantographs press "
        "on both contact wires and pass over",
    )
    pre_sag: Sags | None = Field(
        default=None,
        description="pre-sag of the contact wire, its depth below the supports: at each dropper of a span, one such "
        "list "
        "for each span, or the largest value, in the middle of a parabola through the outer droppers (default: 0)",
    )
    steady_arms: SteadyArms = Field(
        default=SteadyArms.as_written(), description="steady arms of the contact wire at the supports"
    )
    messenger_supports: MessengerSupports = Field(
        default=MessengerSupports.as_written(), description="supports of the messenger"
    )
    stitch_wire: StitchWire | None = Field(default=None, description="an auxiliary wire at the supports")
    ends: Literal["weights", "anchored"] = Field(
        default="weights",
        description="of both wires: weights keep the tension constant, or the ends are fixed; both are equal in "
        "linearised motion",
    )
    element: PositiveLength = Field(default=0.25, description="target length of the links of all wires")
    analysed_spans: Annotated[tuple[int, int], FirstAndLast()] | None = Field(
        default=None,
        description="first and last span, counted from 1, that statistics speak of (default: all but a quarter of the "
        "spans, rounded up, at either end)",
    )
    condition: Condition | None = Field(default=None, description="changes since installation (default: none)")
    limits: Limits | None = Field(
        default=None,
        description="limits of current collection, for comparison in summaries and reports",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = [*self._spans(), *self._places()]
        if not findings:  # how many droppers there are is known
            findings = [*self._for_each_dropper(), *self._supports(), *self._failing()]
            if self.condition is not None:
                aside = self.ends == "anchored" and self.steady_arms.stagger is not None
                findings += self.condition.findings([len(row) for row in self.dropper_places], fixed_aside=aside)
        report("overhead line", findings)
        return self

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all places of the line."""
        yield self.start

    @property
    def span_lengths(self) -> tuple[float, ...]:
        """Lengths of all spans, m."""
        return (self.spans.length,) * self.spans.count if isinstance(self.spans, Spans) else self.spans

    @property
    def length(self) -> float:
        """Length of the section, m."""
        return math.fsum(self.span_lengths)

    @property
    def dropper_places(self) -> list[tuple[float, ...]]:
        """Distances of the droppers of each span from its start, m."""
        lengths, at = self.span_lengths, self.droppers.at
        if at is not None:
            return list(self._each(at))
        count = self.droppers.per_span or _DROPPERS_PER_SPAN
        return [tuple((i + 0.5) * length / count for i in range(count)) for length in lengths]

    @property
    def sags(self) -> list[tuple[float, ...]]:
        """Pre-sag at the droppers of each span, m."""
        sag = 0.0 if self.pre_sag is None else self.pre_sag
        if isinstance(sag, tuple):
            return list(self._each(sag))
        found = []
        for places in self.dropper_places:
            middle, half = 0.5 * (places[0] + places[-1]), 0.5 * (places[-1] - places[0])
            found.append(tuple(sag * (1.0 - ((x - middle) / half) ** 2) if half else sag for x in places))
        return found

    @property
    def registered(self) -> tuple[float, ...]:
        """How much higher than at the start the contact wire is wanted at all supports with both ends, m."""
        return (0.0,) * (len(self.span_lengths) + 1) if self.heights is None else self.heights

    @property
    def curvatures(self) -> tuple[float, ...]:
        """Curvature of the track in each span, positive to the left, 1/m."""
        radius, count = self.radius, len(self.span_lengths)
        radii = radius if isinstance(radius, tuple) else (radius or 0.0,) * count
        return tuple(1.0 / r if r else 0.0 for r in radii)

    @property
    def dropper_lengths(self) -> list[tuple[float, ...]] | None:
        """Unstrained lengths of the droppers of each span, m, where they are given."""
        return None if self.droppers.lengths is None else list(self._each(self.droppers.lengths))

    @property
    def staggers(self) -> tuple[float, ...] | None:
        """How far aside the contact wire is at all supports with both ends, m."""
        stagger = self.steady_arms.stagger
        if isinstance(stagger, float):
            return tuple(stagger * (-1.0) ** i for i in range(len(self.span_lengths) + 1))
        return stagger

    @property
    def analysed(self) -> tuple[int, int]:
        """First and last span of statistics, counted from 1."""
        if self.analysed_spans is not None:
            return self.analysed_spans
        count = len(self.span_lengths)
        left_out = min(math.ceil(count / 4), (count - 1) // 2)
        return left_out + 1, count - left_out

    def _each(self, rows: Any) -> tuple[tuple[float, ...], ...]:
        """One row for each span."""
        return rows if isinstance(rows[0], tuple) else (rows,) * len(self.span_lengths)

    def _failing(self) -> Iterator[Finding]:
        """Droppers that fail on the way and are none, or are missing before."""
        cut, path = self.droppers.cut, ("droppers", "cut", "droppers")
        if cut is None:
            return
        if not cut.droppers:
            yield Finding(path, "names none", "[]", "name those that fail, or leave cut out")
        yield from not_there(path, cut.droppers, [len(row) for row in self.dropper_places])
        for i, one in enumerate(cut.droppers):
            if self.condition is not None and one in self.condition.missing_droppers:
                yield Finding((*path, i), "is also in condition.missing_droppers", f"{list(one)}", "name it once")

    def _spans(self) -> Iterator[Finding]:
        lengths = self.span_lengths
        if len(lengths) > MOST_SPANS:
            wrong, remedy = "too many spans", f"write at most {MOST_SPANS}"
            yield Finding(("spans",), wrong, f"{len(lengths)} spans", remedy)
        shortest = min(lengths)
        if self.element > shortest / FEWEST_ELEMENTS:
            remedy = f"write at most {shortest / FEWEST_ELEMENTS:.3g} m, a {FEWEST_ELEMENTS}th of the shortest span"
            yield Finding(("element",), "the links are too long for the spans", f"{self.element:g} m", remedy)
        if self.analysed_spans is not None:
            first, last = self.analysed_spans
            if first > last or last > len(lengths):
                wrong = "not spans of this line" if last > len(lengths) else "the first span is after the last"
                remedy = f"write the first and the last span, from 1 to {len(lengths)}"
                yield Finding(("analysed_spans",), wrong, f"[{first}, {last}]", remedy)

    def _places(self) -> Iterator[Finding]:
        """Droppers outside their spans, or out of order."""
        at, lengths = self.droppers.at, self.span_lengths
        if at is None:
            return
        if isinstance(at[0], tuple) and len(at) != len(lengths):
            remedy = "give one list for each span, or one for all"
            given = f"{len(at)} lists for {len(lengths)} spans"
            yield Finding(("droppers", "at"), "does not go with the spans", given, remedy)
            return
        listed = set()  # one list for all spans is wrong once
        for span, (places, length) in enumerate(zip(self._each(at), lengths, strict=True)):
            for i, x in enumerate(places):
                path = ("droppers", "at", span, i) if isinstance(at[0], tuple) else ("droppers", "at", i)
                if path in listed:
                    continue
                given = f"{x:g} m in span {span + 1} of {length:g} m"
                if not 0.0 < x < length:
                    listed.add(path)
                    remedy = f"write places between 0 m and {length:g} m, from the start of the span"
                    if not isinstance(at[0], tuple) and len(set(lengths)) > 1:
                        remedy += "; spans of different lengths take a list of lists, one for each, or per_span"
                    yield Finding(path, "the dropper stands outside its span", given, remedy)
                elif i and x - places[i - 1] < self.element:
                    listed.add(path)
                    before = f"{places[i - 1]:g} m"
                    wrong = f"must be at least an element ({self.element:g} m) beyond the dropper before it"
                    remedy = f"the dropper before it is at {before}: sort the places, leave one out, or lower element"
                    yield Finding(path, wrong, given, remedy)

    def _for_each_dropper(self) -> Iterator[Finding]:
        """Lists with an entry for each dropper."""
        places = self.dropper_places
        for key, rows, what in (
            (("droppers", "lengths"), self.droppers.lengths, "lengths"),
            (("pre_sag",), self.pre_sag, "values"),
        ):
            if not isinstance(rows, tuple):
                continue
            nested = isinstance(rows[0], tuple)
            if nested and len(rows) != len(places):
                given = f"{len(rows)} lists for {len(places)} spans"
                yield Finding(key, "does not go with the spans", given, "give one list for each span, or one for all")
                continue
            for span, (row, at) in enumerate(zip(self._each(rows), places, strict=True)):
                if len(row) != len(at):
                    given = f"{len(row)} {what} for the {len(at)} droppers of span {span + 1}"
                    path = (*key, span) if nested else key
                    yield Finding(path, "does not go with the droppers", given, f"give {len(at)} {what}")
                    break
        if self.droppers.lengths is not None and self.pre_sag is not None:
            wrong, remedy = "lengths and pre_sag exclude each other", "write the lengths or pre_sag, not both"
            yield Finding(("pre_sag",), wrong, remedy=remedy)

    def _supports(self) -> Iterator[Finding]:
        lengths, stagger, stitch = self.span_lengths, self.steady_arms.stagger, self.stitch_wire
        if isinstance(stagger, tuple) and len(stagger) != len(lengths) + 1:
            wrong, given = "does not go with the supports", f"{len(stagger)} values for {len(lengths)} spans"
            remedy = f"give {len(lengths) + 1} values, both ends included, or one for alternating sides"
            yield Finding(("steady_arms", "stagger"), wrong, given, remedy)
        for i, (span, a, b) in enumerate(zip(lengths, self.staggers or (), (self.staggers or ())[1:], strict=False)):
            if abs(b - a) > MOST_ASIDE * span:
                wrong = f"leads the contact wire {abs(b - a):g} m aside over span {i + 1} of {span:g} m"
                yield Finding(("steady_arms", "stagger"), wrong, "", "check its unit; about 200 mm are usual")
                break
        if self.heights is not None and len(self.heights) != len(lengths) + 1:
            wrong, given = "do not go with the supports", f"{len(self.heights)} values for {len(lengths)} spans"
            yield Finding(("heights",), wrong, given, f"give {len(lengths) + 1} values, both ends included")
        elif self.heights is not None:
            steep = [abs(b - a) / length for (a, b), length in zip(pairwise(self.heights), lengths, strict=True)]
            if max(steep) > STEEPEST:
                span = steep.index(max(steep)) + 1
                given, remedy = f"1 : {1.0 / max(steep):.3g} in span {span}", "write heights that differ less"
                yield Finding(("heights",), f"steeper than 1 : {1.0 / STEEPEST:g}", given, remedy)
        if self.messenger_supports.stagger == "straight" and stagger is None:
            wrong, remedy = "the contact wire is straight, too", "give steady_arms a stagger, or leave this out"
            yield Finding(("messenger_supports", "stagger"), wrong, "straight", remedy)
        yield from self._curve()
        if stitch is None:
            return
        if len(lengths) == 1:
            wrong, remedy = "there is no support between spans", "leave stitch_wire out, or add spans"
            yield Finding(("stitch_wire",), wrong, "1 span", remedy)
        elif stitch.tension >= self.messenger_wire.tension:
            remedy = f"write less than that of messenger_wire, {self.messenger_wire.tension:g} N"
            wrong = "takes over all of the messenger's tension between its clamps"
            yield Finding(("stitch_wire", "tension"), wrong, f"{stitch.tension:g} N", remedy)
        elif stitch.length >= min(lengths):
            remedy = f"write less than {min(lengths):g} m, the shortest span"
            wrong = "stitch wires of neighbouring supports would overlap"
            yield Finding(("stitch_wire", "length"), wrong, f"{stitch.length:g} m", remedy)
        elif stitch.length < FEWEST_ELEMENTS * self.element:
            remedy = f"write at least {FEWEST_ELEMENTS * self.element:g} m, or a smaller element"
            yield Finding(("stitch_wire", "length"), "too short for the elements", f"{stitch.length:g} m", remedy)
        else:
            reach = 0.5 * stitch.length - self.element
            near = [p[0] < reach for p in self.dropper_places[1:]]
            near += [s - p[-1] < reach for p, s in zip(self.dropper_places, lengths, strict=True)][:-1]
            if not all(near):
                wrong = "no dropper hangs from the stitch wire on one side of a support"
                remedy = "make it longer, or put droppers closer to the supports"
                yield Finding(("stitch_wire", "length"), wrong, f"{stitch.length:g} m", remedy)

    def _curve(self) -> Iterator[Finding]:
        """Curves whose radii do not go with the spans, or without arms that bear them."""
        lengths, path = self.span_lengths, ("radius",)
        if self.radius is None:
            return
        if isinstance(self.radius, tuple) and len(self.radius) != len(lengths):
            given, remedy = f"{len(self.radius)} values for {len(lengths)} spans", f"give {len(lengths)} values, or one"
            yield Finding(path, "does not go with the spans", given, remedy)
            return
        tight = [abs(k) * length for k, length in zip(self.curvatures, lengths, strict=True)]
        if max(tight) > TIGHTEST:
            span = tight.index(max(tight))
            given, least = f"{1.0 / abs(self.curvatures[span]):g} m in span {span + 1}", lengths[span] / TIGHTEST
            yield Finding(path, "the curve is too tight for its spans", given, f"write {least:g} m or more")
        elif self.steady_arms.stagger is None:
            wrong, remedy = "steady arms bear the wire on a curve", "give steady_arms a stagger, for each support"
            yield Finding(path, wrong, remedy=remedy)
        elif self.messenger_supports.stagger == "straight":
            wrong, remedy = "a straight messenger does not follow a curve", "leave messenger_supports.stagger out"
            yield Finding(path, wrong, remedy=remedy)


def stations_of(line: OverheadLine) -> list[float]:
    """Distances of all supports from the start of the line, both ends included, m."""
    return [0.0, *accumulate(line.span_lengths)]
