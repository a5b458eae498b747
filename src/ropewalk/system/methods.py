"""What methods of time integration do not bear in motions of the system.

The sixth order by composition needs forces that depend on places and time alone, and springs as they are: its steps
also go back in time (Blanes & Casas 2005: beyond the second order, steps of real kicks and drifts must). Where
something damps it is that of an implicit method. These need forces that depend on places, velocities and time in a
smooth way.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ropewalk.model._base import Finding
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.law import Inextensible
from ropewalk.model.load import RUBBING, AnyLoad, ExternalModel
from ropewalk.model.mass import MovingMass
from ropewalk.model.missing import missing
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts
from ropewalk.model.run import HIGH_ORDER, Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Moving
from ropewalk.model.travel import FreeTravel
from ropewalk.model.walker import Walker

_MOTION = "motions of lines, networks and nets together with their loads"


def of_methods(parts: Parts) -> Iterator[Finding]:
    """Find what the method asked for does not bear."""
    if not isinstance(parts.run, Dynamic):
        return
    if parts.run.method in HIGH_ORDER and parts.run.window is not None:
        asked, remedy = parts.run.method, "use auto or verlet, or leave window out"
        yield missing(("run", "method"), _MOTION, asked, remedy, feature=f"{asked} with a window")
    implicit = parts.run.method == "implicit" or (parts.run.method == "rkn6" and first_damper(parts) is not None)
    if implicit and parts.run.axial_inertia != 1.0:
        asked, feature = parts.run.method, "implicit with an axial inertia"
        remedy = "use auto or verlet, or leave axial_inertia out: implicit steps are not bound by waves along lines"
        yield missing(("run", "method"), _MOTION, asked, remedy, feature=feature)
    if parts.run.method in HIGH_ORDER and (found := next(_not_smooth(parts), None)) is not None:
        feature, otherwise = found
        given, remedy = parts.run.method, f"use auto or verlet, or {otherwise}"
        yield missing(("run", "method"), _MOTION, given, remedy, feature=f"{given} with {feature}")


def first_damper(parts: Parts) -> str | None:
    """What depends on velocities, if anything does, or keeps lengths, as messages name it."""
    if parts.has_inextensible:
        return "lines that do not stretch"
    if parts.is_airy:
        return "wind"
    if parts.runs_over_sheaves:
        return "lines with nodes that pass sheaves"
    if any(line is not None and line.hysteresis is not None for line in parts.lines.values()):
        return "hysteresis"
    for part in (*parts.lines.values(), *parts.nets.values()):
        tree = {} if part is None else part.model_dump()
        restrained = {key: tree.pop(key, None) for key in ("start_support", "end_support", "supports", "edge")}
        if tree.get("drag"):
            return "the drag of lines"
        if _is_damped(tree):
            return "Kelvin-Voigt damping"
        if _is_damped(restrained):
            return "dampers at supports"
    if any(_is_damped(track.model_dump()) for track in parts.tracks.values() if track is not None):
        return "the dampers of tracks"
    for line in parts.overhead.values():
        if line is not None and (line.droppers.strength is not None or line.droppers.cut is not None):
            return "droppers that fail"
        if _has({} if line is None else line.model_dump(), ("drag", "damping")):
            return "dampers or the drag of overhead lines"
    if any(isinstance(load, Pantograph) for load in parts.loads.values()):
        return "pantographs, which may leave the wire"
    if any(_is_damped(load.model_dump()) for load in parts.loads.values() if load is not None):
        return "dampers or the drag of loads"
    return None


def _not_smooth(parts: Parts) -> Iterator[tuple[str, str]]:
    """Find what makes forces jump, or depend on what their places were before."""
    for name, line in parts.lines.items():
        for saddle, own in line.saddles.items() if line is not None else ():
            if own.friction:
                what = f"dry friction on saddles ({name}.{saddle}), which jumps as nodes begin and end to slip,"
                yield what, "give saddles no friction"
    if parts.has_hoists:  # springs that change in time
        yield "a payload with a rope of variable length", "leave hoist out"
    for line in parts.lines.values():
        ends = () if line is None or not isinstance(line.law, Inextensible) else line.ends()
        if any(isinstance(support, Moving) for _, support in ends):  # whose speed jumps, and all with it
            yield "a support that moves an inextensible line", "give the line an axial_stiffness with law hooke"
    for load in parts.loads.values():
        if load is None:
            continue
        if isinstance(load, Footsteps | Walker | ExternalModel):
            yield "a load with a controller", "kind: force"
        yield from _jumps(load)


def _jumps(load: AnyLoad) -> Iterator[tuple[str, str]]:
    """Find what lets a load's contact jump, or makes its place depend on the places that it had before."""
    travel = getattr(load, "travel", None)
    if isinstance(load, Pantograph):  # at particles of the wire; its force goes to zero before it leaves
        return
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


def shaken(scenario: Scenario) -> list[str]:
    """Loads that rub by themselves on lines whose own waves nothing damps (docs/notes/contacts-on-splines.md)."""
    return [
        f"loads.{name} slides with friction on {load.on}, along which waves are not damped: they shake the contact, "
        f"and friction bears less than it should; give lines.{load.on} an axial_damping"
        for name, load in scenario.loads.items()
        if isinstance(travel := getattr(load, "travel", None), FreeTravel) and travel.friction > 0.0
        if (line := scenario.lines.get(load.on)) is not None and not line.axial_damping
    ]
