"""All cases, by groups."""

from __future__ import annotations

from ropewalk.validation import (
    beams,
    bridges,
    cables,
    nets,
    overhead_lines,
    people,
    taut_string,
    waves,
    wheels,
)
from ropewalk.validation.known_case import KnownCase

GROUPS: dict[str, tuple[KnownCase, ...]] = {
    "Taut strings": (*taut_string.CASES, *waves.CASES),
    "Cables and highlines": cables.CASES,
    "Saddles, sheaves, friction, pendulums": wheels.CASES,
    "Beams": beams.CASES,
    "Bridges and trains": bridges.CASES,
    "Overhead lines": overhead_lines.CASES,
    "Membranes and nets": nets.CASES,
    "Walkers and crowds": people.CASES,
}
CASES = {case.id: case for cases in GROUPS.values() for case in cases}
