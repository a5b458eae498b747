"""Positions at which loads begin: along the line, or where the line in equilibrium has a given x."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import core_schema

from ropewalk.errors import Refused
from ropewalk.model._base import Finding
from ropewalk.model.quantity import Quantity
from ropewalk.model.run import Dynamic, Linear
from ropewalk.units import written

MIDDLE = "middle"


class PositionInX(float):
    """A position along a line, estimated, that is where the line in equilibrium has a given x, m; None: its middle."""

    x: float | None = None

    @classmethod
    def of(cls, x: float | None, estimate: float = 0.0) -> PositionInX:
        """Make one with an estimate along the line, m."""
        found = cls(estimate)
        found.x = x
        return found

    def __str__(self) -> str:
        return MIDDLE if self.x is None else f"{{x: {self.x:g} m}}"


class StartPosition(Quantity):
    """Annotation: a length along a line in m, `middle`, or `{x: ...}`."""

    def read(self, value: object) -> float:
        if isinstance(value, PositionInX):
            return value
        if value == MIDDLE:
            return PositionInX.of(None)
        if isinstance(value, Mapping):
            if set(value) != {"x"}:
                raise Refused("expected a length, middle or {x: ...}", "write for example {x: 5 m}")
            return PositionInX.of(Quantity("m").read(value["x"]))
        return super().read(value)

    def write(self, value: float, info: Any) -> Any:
        """Write it as in a file; in Python a plain length stays a number."""
        if isinstance(value, PositionInX):
            return MIDDLE if value.x is None else {"x": written(value.x, "m") if info.mode == "json" else value.x}
        return written(value, self.unit) if info.mode == "json" else value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        writer = core_schema.plain_serializer_function_ser_schema(self.write, info_arg=True)
        return core_schema.no_info_plain_validator_function(self.read, serialization=writer)

    def json_form(self) -> dict[str, Any]:
        x = {"type": "object", "properties": {"x": {"type": ["number", "string"], "unit": "m"}}, "required": ["x"]}
        number = super().json_form()
        return {"unit": self.unit, "anyOf": [number, {"enum": [MIDDLE]}, {**x, "additionalProperties": False}]}


Start = Annotated[float, StartPosition("m")]
"""A position along a line, or in x."""
StartOffset = Annotated[float, StartPosition("m", "not negative")]


def position_in_x(load: Any) -> PositionInX | None:
    """Return the start of a load that is given in x, None of one that is given along its line."""
    start = getattr(getattr(load, "travel", load), "start", None)
    return start if isinstance(start, PositionInX) else None


def begun_at(load: Any, start: float) -> Any:
    """Return a load that begins elsewhere."""
    if hasattr(load, "travel"):
        return load.model_copy(update={"travel": load.travel.model_copy(update={"start": start})})
    return load.model_copy(update={"start": start})


def estimated(loads: Mapping[str, Any], lines: Mapping[str, Any]) -> dict[str, Any]:
    """Return loads with estimates of starts that are given in x: as if the line lay along its chord."""
    found = dict(loads)
    for name, load in loads.items():
        at, line = position_in_x(load), lines.get(load.on)
        if at is None or line is None:
            continue
        span, length = line.end[0] - line.start[0], line.length or line.distance
        part = 0.5 if at.x is None or span == 0.0 else (at.x - line.start[0]) / span
        travel = getattr(load, "travel", None)
        whole = abs(span) if getattr(travel, "measured", "") == "horizontal" else length
        found[name] = begun_at(load, PositionInX.of(at.x, min(max(part, 0.0), 1.0) * whole))
    return found


def check_positions(parts: Any) -> Iterator[Finding]:
    """Find starts in x where no line has that x, or where it is not known."""
    for name, load in parts.loads.items():
        at = position_in_x(load)
        if at is None:
            continue
        key = ("loads", name, *(("travel", "from") if hasattr(load, "travel") else ("from",)))
        line, on = parts.lines.get(load.on) if load is not None else None, parts.on.get(name, "")
        if on in parts.nets or on in parts.overhead:
            yield Finding(key, "only on lines", str(at), "write the distance from the start in m")
        elif isinstance(parts.run, Dynamic) and parts.run.start.kind != "rest":
            remedy = "write the length along the line in m, or start from rest"
            yield Finding(key, f"only in runs that start from rest, not from a {parts.run.start.kind}", str(at), remedy)
        elif _rests(parts) and (measured := load.starts()[0].measured) != "material":
            remedy = "write measured: material, or the distance in m"
            yield Finding(
                key, f"loads that rest on lines are not located where measured is {measured}", str(at), remedy
            )
        elif line is not None:
            low, high = sorted((line.start[0], line.end[0]))
            level = math.dist(line.start[:-1], line.end[:-1])
            if level == 0.0 or (at.x is not None and not low <= at.x <= high):
                wrong = f"{on} reaches from x = {low:g} m to {high:g} m" if level else f"{on} has no horizontal extent"
                yield Finding(key, wrong, str(at), "write an x in between, or the length along the line in m")


def _rests(parts: Any) -> bool:
    """Return whether a run begins with its loads in equilibrium on their lines."""
    return bool(parts.run.start.with_loads) if isinstance(parts.run, Dynamic) else not isinstance(parts.run, Linear)
