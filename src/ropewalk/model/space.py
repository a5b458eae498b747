"""The plane and the space: whether a scenario leaves the x-z plane, and what must then be said."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.line import Line, spatial
from ropewalk.model.load import GivenForces
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic
from ropewalk.model.support import Elastic
from ropewalk.model.travel import Course
from ropewalk.model.trolley import Trolley
from ropewalk.model.vehicle import Vehicle


def leaving(parts: Parts) -> str:
    """Find what leaves the x-z plane, in words; empty if nothing does."""
    owners = [
        ("lines", parts.lines), ("overhead_lines", parts.overhead), ("nets", parts.nets), ("joints", parts.joints),
        ("loads", parts.loads),
    ]  # fmt: skip
    if parts.wind is not None and any(spatial(vector)[1] != 0.0 for vector in parts.wind.vectors()):
        return "wind"
    for block, members in owners:
        for name, member in members.items():
            if member is not None and any(spatial(vector)[1] != 0.0 for vector in member.vectors()):
                return f"{block}.{name}"
    if isinstance(parts.run, Dynamic) and any(spatial(vector)[1] != 0.0 for vector in parts.run.start.vectors()):
        return "run.start"
    return ""


def check_space(parts: Parts) -> Iterator[Finding]:
    """Find what is said for the plane only, in a scenario that leaves it."""
    why = leaving(parts)
    if not why:
        return
    for name, line in parts.lines.items():
        if line is not None:
            inner = ((("supports", key), support) for key, support in line.supports.items())
            for path, support in (*(((key,), support) for key, support in line.ends()), *inner):
                if isinstance(support, Elastic):
                    yield from _sideways(("lines", name, *path), support, why)
    for name, load in parts.loads.items():
        if isinstance(load, Oscillator):
            yield from _sideways(("loads", name), load, why)
    for name, load, on, line in parts.complete():
        if isinstance(load, GivenForces | MovingMass | Oscillator | Trolley | Vehicle | Matrices):
            yield from _along_x(name, load, on, line)


def _sideways(path: tuple[str, ...], restrained: Elastic | Oscillator, why: str) -> Iterator[Finding]:
    """Two values: without a word from the user the third is neither nothing nor that of x."""
    for key, letter in (("stiffness", "k"), ("damping", "c")):
        values = getattr(restrained, key)
        if isinstance(values, tuple) and len(values) == 2:
            wrong = f"{why} leaves the x-z plane, and two values do not define the direction y"
            nothing = "" if key == "stiffness" else f" ({letter}y: 0 for none)"
            remedy = f"write [{letter}x, {letter}y, {letter}z]{nothing}, or one value for all directions"
            yield Finding((*path, key), wrong, f"[{values[0]:g}, {values[1]:g}]", remedy)


def _along_x(
    name: str, load: GivenForces | MovingMass | Oscillator | Trolley | Vehicle | Matrices, on: str, line: Line
) -> Iterator[Finding]:
    """What is measured along x, or held by a force along x, on a line that does not run along x."""
    start, end = spatial(line.start), spatial(line.end)
    if abs(end[1] - start[1]) <= 1e-9 * line.distance:
        return
    otherwise = f"turn the axes so that {on} extends along x"
    if isinstance(load.travel, Course) and load.travel.measured == "horizontal":
        wrong = f"horizontal means along x, and the ends of {on} differ in y"
        yield Finding(
            ("loads", name, "travel", "measured"), wrong, "horizontal", f"write slip or material, or {otherwise}"
        )
    contact = getattr(load, "contact", "clamped")
    if contact != "clamped":
        wrong = f"the force that holds such a contact acts along x, and the ends of {on} differ in y"
        yield Finding(("loads", name, "contact"), wrong, contact, f"write clamped, or {otherwise}")
