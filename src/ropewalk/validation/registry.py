"""All cases, by groups."""

from __future__ import annotations

from ropewalk.validation import beams, cables, strings
from ropewalk.validation.case import Case

GROUPS: dict[str, tuple[Case, ...]] = {
    "Taut strings": strings.CASES,
    "Cables and highlines": cables.CASES,
    "Beams": beams.CASES,
}
CASES = {case.id: case for cases in GROUPS.values() for case in cases}
