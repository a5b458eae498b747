"""How a load touches its line: the words of it, and what goes with them."""

from __future__ import annotations

from typing import Literal

from ropewalk.model._base import Finding, Path

FrictionModel = Literal["capstan", "block"]
Side = Literal["above", "below"]

LIFT_OFF = "whether it may leave the line; it lands again without bouncing"
SIDE = "side of the line on which it moves; below requires lift_off"
CONTACT_STIFFNESS = "normal stiffness of a unilateral contact, requires lift_off (default: rigid)"


def one_sided(side: Side, *, lift_off: bool) -> list[Finding]:
    """Find a side of the line that a load is on which cannot leave it: such a contact pushes and pulls."""
    if side == "above" or lift_off:
        return []
    wrong, remedy = "side needs lift_off", "write lift_off: true, or leave side out"
    return [Finding(("side",), wrong, side, remedy)]


def soft_contact(path: Path, stiffness: float | None, *, lift_off: bool) -> list[Finding]:
    """Find a contact stiffness (N/m, at `path`) of a load that cannot leave the line."""
    if stiffness is None or lift_off:
        return []
    wrong, remedy = "contact_stiffness needs lift_off", "write lift_off: true, or leave contact_stiffness out"
    return [Finding(path, wrong, f"{stiffness:g} N/m", remedy)]
