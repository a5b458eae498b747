"""Droppers that fail on the way, and how one is named: by its span and its number in it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field

from ropewalk.errors import Refused
from ropewalk.model._base import Declaration, FieldReader, Finding, Path
from ropewalk.model.quantity import Count, PositiveTime

_MOST = 10_000


@dataclass(frozen=True)
class SpanAndNumber(FieldReader):
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

    def json_form(self) -> dict[str, Any]:
        one = {"type": "integer", "minimum": 1, "maximum": _MOST}
        return {"type": "array", "items": {"type": "array", "items": one, "minItems": 2, "maxItems": 2}}


class DropperCut(Declaration):
    """Some droppers fail at a time: from then on they pull no more.

    What they had stored is lost, the remainder of them continues to hang on both wires.
    """

    droppers: Annotated[tuple[tuple[int, int], ...], SpanAndNumber()] = Field(
        description="which: pairs [span, number in it], both counted from 1"
    )
    time: PositiveTime = Field(description="when")


def not_there(path: Path, named: Sequence[tuple[int, int]], droppers: Sequence[int]) -> Iterator[Finding]:
    """Find droppers that are named, and are none of a line, or are named twice.

    Args:
        path: of the key that names them.
        named: span and number in it.
        droppers: how many there are in each span.
    """
    for i, (span, number) in enumerate(named):
        key, given = (*path, i), f"[{span}, {number}]"
        if span > len(droppers):
            yield Finding(key, "no such span", given, f"the spans are 1 to {len(droppers)}")
        elif number > droppers[span - 1]:
            yield Finding(key, "no such dropper", given, f"span {span} has 1 to {droppers[span - 1]}")
        elif (span, number) in named[:i]:
            yield Finding(key, "is named twice", given, "name each dropper once")
