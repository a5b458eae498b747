"""What the engine of cable runs and joints supports."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import missing
from ropewalk.model.joint import Joined
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.parts import Parts
from ropewalk.model.vehicle import Vehicle
from ropewalk.webs import capabilities as webs

_SYSTEM = "joined lines and lines in wind"


def _only_lines(parts: Parts) -> Iterator[Finding]:
    if parts.overhead:
        yield missing(("overhead_lines",), _SYSTEM, remedy="compute them in a scenario of their own")
    for name in parts.nets:
        yield missing(("nets", name), _SYSTEM, remedy="compute nets in a scenario of their own")
    for name, line in parts.lines.items():
        if line is not None and line.sheaves:
            yield missing(("lines", name, "sheaves"), _SYSTEM, remedy="end the line at the sheave")


def between_nodes(name: str, elements: int) -> Finding:
    """Say that something is joined between nodes to a line that bends there."""
    feature, remedy = "a line joined between two nodes of another", "choose elements so that one of its nodes is there"
    return missing(("lines", name, "elements"), "lines with bending stiffness", str(elements), remedy, feature=feature)


def _joined_between_nodes(parts: Parts) -> Iterator[Finding]:
    for name, line in parts.lines.items():
        if line is None or not line.bending_stiffness:
            continue
        length = line.length or line.distance
        for other in parts.lines.values():
            for _, support in other.supports() if other is not None else ():
                if isinstance(support, Joined) and support.to == name and isinstance(support.at, float):
                    place = support.at / length * line.elements
                    if abs(place - round(place)) > 1e-9 * line.elements:
                        yield between_nodes(name, line.elements)


def _contact_stiffness(parts: Parts) -> Iterator[Finding]:
    feature, remedy = "a contact stiffness", "leave it out"
    for name, load in parts.loads.items():
        if isinstance(load, Oscillator) and load.contact_stiffness is not None:
            given = f"{load.contact_stiffness:g} N/m"
            yield missing(("loads", name, "contact_stiffness"), _SYSTEM, given, remedy, feature=feature)
        if isinstance(load, Vehicle):
            for part, wheel in load.wheels.items():
                if wheel.contact_stiffness is not None:
                    given, path = (
                        f"{wheel.contact_stiffness:g} N/m",
                        ("loads", name, "wheels", part, "contact_stiffness"),
                    )
                    yield missing(path, _SYSTEM, given, remedy, feature=feature)


# What the engine of networks supports of motions, but for what this one supports as well, or otherwise.
_ALIKE = {
    key: values
    for key, values in webs.MOTION.only.items()
    if key not in ("run.kind", "run.method", "lines.bending_stiffness", "lines.foundation", "loads.air_drag")
}
MOTION = replace(
    webs.MOTION,
    what=_SYSTEM,
    only={
        "run.kind": ("dynamic",),
        "run.method": webs.MOTION.only["run.method"],
        "run.start.kind": ("rest",),
        "run.start.with_loads": (False,),
        **_ALIKE,
        "loads.kind": ("force", "mass", "oscillator", "trolley", "vehicle", "matrices"),
    },
    instead={
        **webs.MOTION.instead,
        "run.start.with_loads": "leave it out, or write kind: force with its weight as force",
    },
    more=(_only_lines, _joined_between_nodes, _contact_stiffness),
)
