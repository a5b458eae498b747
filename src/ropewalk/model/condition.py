"""What has become of an overhead line since it was fitted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import core_schema

from ropewalk.errors import Refused
from ropewalk.model._base import Declaration, Finding
from ropewalk.model.quantity import Count, Number, Share

MOST_WORN = 0.5
"""Part of the cross-section: what is worn further is no round wire with a flat any more."""
_MOST = 2000


@dataclass(frozen=True)
class _SpanAndNumber:
    """Annotation: droppers as pairs of counts, their span and their number in it."""

    def read(self, value: object) -> tuple[tuple[int, int], ...]:
        remedy = "write pairs [span, number], both counted from 1, for example [[5, 4], [5, 5]]"
        entries = value.tolist() if hasattr(value, "tolist") else value
        if not isinstance(entries, list | tuple):
            raise Refused("expected droppers", remedy)
        found = []
        for entry in entries:
            if not isinstance(entry, list | tuple) or len(entry) != 2:
                raise Refused("expected a span and the number of a dropper in it", remedy)
            span, number = (Count(1, _MOST).read(one) for one in entry)
            found.append((span, number))
        return tuple(found)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, _: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        one = {"type": "integer", "minimum": 1, "maximum": _MOST}
        return {"type": "array", "items": {"type": "array", "items": one, "minItems": 2, "maxItems": 2}}


class Condition(Declaration):
    """What has changed since a line was fitted as wanted: its droppers keep the lengths that they were given then.

    Where weights keep the tension, neither wear nor temperature changes it. Between anchored ends it changes: a worn
    wire at the same strain pulls less, a warm wire is longer.
    """

    missing_droppers: Annotated[tuple[tuple[int, int], ...], _SpanAndNumber()] = Field(
        default=(), description="droppers that have failed and fallen off with their clamps: pairs [span, number in it]"
    )
    wear: Share = Field(
        default=0.0,
        description="part of the cross-section of the contact wire that is worn off, by which mass and EA are less; EI "
        "is that of a round wire with a flat",
    )
    temperature_rise: Number = Field(default=0.0, description="since fitting, in K; negative: it is colder")
    expansion: Share = Field(default=1.7e-5, description="thermal expansion of wires and droppers, in 1/K")

    def findings(self, droppers: Sequence[int], *, fixed_aside: bool) -> Iterator[Finding]:
        """Find what cannot be, and what is not computed.

        Args:
            droppers: how many there are in each span.
            fixed_aside: whether the wires have a stagger and their ends are anchored.
        """
        for i, (span, number) in enumerate(self.missing_droppers):
            key, given = ("condition", "missing_droppers", i), f"[{span}, {number}]"
            if span > len(droppers):
                yield Finding(key, "no such span", given, f"the spans are 1 to {len(droppers)}")
            elif number > droppers[span - 1]:
                yield Finding(key, "no such dropper", given, f"span {span} has 1 to {droppers[span - 1]}")
            elif (span, number) in self.missing_droppers[:i]:
                yield Finding(key, "is named twice", given, "name each dropper once")
        if self.wear > MOST_WORN:
            remedy = f"write at most {MOST_WORN:g}, part of the cross-section"
            yield Finding(("condition", "wear"), "no contact wire is worn so far", f"{self.wear:g}", remedy)
        if self.expansion != type(self).model_fields["expansion"].default and not self.temperature_rise:
            wrong, remedy = "nothing expands at the same temperature", "add temperature_rise, or leave expansion out"
            yield Finding(("condition", "expansion"), wrong, f"{self.expansion:g} 1/K", remedy)
        for name in ("wear", "temperature_rise") if fixed_aside else ():
            if value := getattr(self, name):
                wrong = "goes with tensions that weights keep, or with steady arms without stagger"
                remedy = f"write ends: weights, or leave stagger or {name} out"
                yield Finding(("condition", name), wrong, f"{value:g}", remedy)
