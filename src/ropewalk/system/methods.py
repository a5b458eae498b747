"""What methods of time integration do not bear in motions of the system.

The sixth order needs forces that depend on places and time alone, and springs as they are: its steps also go back in
time. The implicit method needs forces that depend on places, velocities and time in a smooth way.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import missing
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.load import RUBBING, AnyLoad, Foreign, MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.parts import Parts
from ropewalk.model.run import HIGH_ORDER, Dynamic
from ropewalk.model.travel import FreeTravel
from ropewalk.model.walker import Walker

_MOTION = "motions of lines, networks and nets together with what they carry"


def of_methods(parts: Parts) -> Iterator[Finding]:
    """Find what the method asked for does not bear."""
    if not isinstance(parts.run, Dynamic):
        return
    if parts.run.method in HIGH_ORDER and parts.run.window is not None:
        asked, remedy = parts.run.method, "use auto or verlet, or leave window out"
        yield missing(("run", "method"), _MOTION, asked, remedy, feature=f"{asked} with a window")
    if parts.run.method == "implicit" and parts.run.axial_inertia != 1.0:
        remedy = "use auto or verlet, or leave axial_inertia out: implicit steps are not bound by waves along lines"
        yield missing(("run", "method"), _MOTION, "implicit", remedy, feature="implicit with an axial inertia")
    check = {"rkn6": _not_of_sixth_order, "implicit": _not_implicit}.get(parts.run.method)
    if check is not None and (found := next(check(parts), None)) is not None:
        feature, otherwise = found
        given, remedy = parts.run.method, f"use auto or verlet, or {otherwise}"
        yield missing(("run", "method"), _MOTION, given, remedy, feature=f"{given} with {feature}")


def _not_of_sixth_order(parts: Parts) -> Iterator[tuple[str, str]]:
    if parts.is_airy:
        yield "wind", "leave wind_drag out"
    yield from _over_sheaves(parts)
    for part in (*parts.lines.values(), *parts.nets.values()):
        tree = {} if part is None else part.model_dump()
        held = {key: tree.pop(key, None) for key in ("start_support", "end_support", "supports", "edge")}
        if tree.get("drag"):
            yield "the drag of lines", "leave drag out"
        if _is_damped(tree):
            yield "Kelvin-Voigt damping", "leave axial_damping or damping out"
        if _is_damped(held):
            yield "dampers at supports", "leave their damping out"
    for line in parts.overhead.values():
        tree = {} if line is None else line.model_dump()
        if _has(tree, ("drag", "damping")):
            yield "dampers or the drag of overhead lines", "leave drag and damping out"
    for load in parts.loads.values():
        if load is None:
            continue
        if _is_damped(load.model_dump()):
            yield "dampers or the drag of loads", "leave damping and air_drag out"
        yield from _not_smooth(load)
        if isinstance(load, Walker | Foreign):
            yield "a load that decides on the way", "kind: force"


def _over_sheaves(parts: Parts) -> Iterator[tuple[str, str]]:
    """Nodes pass them all of a sudden, and friction knows the slip before."""
    if parts.runs_over_sheaves:
        yield "lines over sheaves", "end the line at the sheave"


def _not_implicit(parts: Parts) -> Iterator[tuple[str, str]]:
    yield from _over_sheaves(parts)
    for load in parts.loads.values():
        if load is None:
            continue
        if isinstance(load, Footsteps | Walker | Foreign):
            yield "a load that decides on the way", "kind: force"
        if isinstance(load, MovingForce) and parts.is_airy and load.travel.speed != 0.0:  # steps become ever shorter
            yield "a force that moves along in wind", "leave wind_drag out"
        yield from _not_smooth(load)


def _not_smooth(load: AnyLoad) -> Iterator[tuple[str, str]]:
    """Find what lets a load's contact jump, or makes its place depend on the places that it had before."""
    travel = getattr(load, "travel", None)
    if isinstance(travel, FreeTravel):
        yield "free travel", "give it a travel with its speed"
    elif travel is not None and travel.measured != "material":
        yield f"travel that is measured as {travel.measured}", "write measured: material"
    contact = getattr(load, "contact", "clamped")
    if contact in RUBBING or (contact == "frictionless" and isinstance(load, MovingMass)):
        yield f"a contact of kind {contact}", "write contact: clamped"
    if _has(load.model_dump(), ("lift_off", "contact_stiffness")):
        yield "contacts that come off", "leave lift_off and contact_stiffness out"


def _has(tree: Any, keys: tuple[str, ...]) -> bool:
    """Whether one of some keys, somewhere in a tree, is neither left out nor zero."""
    if isinstance(tree, dict):
        return any((key in keys and _is_some(value)) or _has(value, keys) for key, value in tree.items())
    return isinstance(tree, list | tuple) and any(_has(value, keys) for value in tree)


def _is_damped(tree: Any) -> bool:
    return _has(tree, ("damping", "axial_damping", "leg_damping", "air_drag"))


def _is_some(value: Any) -> bool:
    return any(map(_is_some, value)) if isinstance(value, list | tuple) else bool(value)
