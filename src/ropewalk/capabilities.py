"""Which engine computes a scenario, and what that one does not support."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from ropewalk.errors import Problem, ScenarioError
from ropewalk.linear import capabilities as linear
from ropewalk.model._base import Finding
from ropewalk.model.axles import Axles
from ropewalk.model.capabilities import Capabilities, refusal
from ropewalk.model.crowd import Crowd, is_one_of_many
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.load import RUBBING, AnyLoad, ExternalModel, MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.missing import missing
from ropewalk.model.parts import Parts
from ropewalk.model.places import forces_come_close
from ropewalk.model.quantity import AUTO
from ropewalk.model.run import HIGH_ORDER, Dynamic, Equilibrium, Linear
from ropewalk.model.scenario import Scenario
from ropewalk.model.train import Train, TrainSection
from ropewalk.model.walker import Walker
from ropewalk.solve import capabilities as ropes
from ropewalk.system import capabilities as system
from ropewalk.wires import capabilities as wires

_ROUNDING = 1e-9
"""Of the distance between the ends of a line: a length within it is that distance, wherever the line is located."""


@dataclass(frozen=True)
class Engine:
    """What computes scenarios, with what it supports in motion, and at rest or quasi-static."""

    motion: Capabilities
    at_rest: Capabilities


ROPES = Engine(ropes.MOTION, ropes.AT_REST)
WIRES = Engine(wires.MOTION, wires.AT_REST)
SYSTEM = Engine(system.MOTION, system.AT_REST)
LINEAR = Engine(linear.CAPABILITIES, linear.CAPABILITIES)
SUPERPOSED = Engine(system.LINEAR, system.LINEAR)


def engine_of(asked: Parts | Scenario) -> Engine:
    """Choose the engine that computes a scenario."""
    parts = (asked if isinstance(asked, Parts) else asked.parts).on_a_mesh
    if parts.is_for_the_system:
        return SUPERPOSED if isinstance(parts.run, Linear) else SYSTEM
    if isinstance(parts.run, Linear):
        return _of_linear_theory(parts)
    if parts.is_network:
        return SYSTEM
    return _of_beams(parts) if parts.has_bending_stiffness else _of_ropes(parts)


def _of_linear_theory(parts: Parts) -> Engine:
    """Closed forms of lines by themselves; modes of what is joined, held or a surface, or where there are none."""
    if parts.is_network or parts.is_supported or parts.overhead:
        return SUPERPOSED
    refused = _refused(LINEAR, parts)
    return SUPERPOSED if refused and _refused(SUPERPOSED, parts) < refused else LINEAR


def is_system_linearised(scenario: Scenario) -> bool:
    """Whether the engine of the system moves a scenario linearised about rest."""
    return _is_linearised(scenario.parts) and engine_of(scenario) is SYSTEM


def _is_linearised(parts: Parts) -> bool:
    return isinstance(parts.run, Dynamic) and parts.run.geometry == "linearised"


def _of_ropes(parts: Parts) -> Engine:
    """The engine of ropes, or that of the system for motions in ways that only lines of that go."""
    run = parts.run
    steps = (is_one_of_many(name) or _balances(load) for name, load in parts.loads.items())
    if any(steps) or any(isinstance(load, Axles | TrainSection) for load in parts.loads.values()):
        return SYSTEM  # which lets contacts come to their line and leave it, at rest, too
    if not isinstance(run, Dynamic):
        return ROPES
    rubs = any(_rubs(load) for load in parts.loads.values())
    if rubs or run.axial_inertia != 1.0 or _is_linearised(parts) or parts.has_inextensible:
        return SYSTEM
    if forces_come_close(parts) and _refused(SYSTEM, parts) <= _refused(ROPES, parts):
        return SYSTEM
    return SYSTEM if _asks_for_a_method(parts) and _refused(SYSTEM, parts) < _refused(ROPES, parts) else ROPES


def _balances(load: AnyLoad | None) -> bool:
    """Whether it steps in time, and responds to the side."""
    return isinstance(load, Footsteps) and load.balance is not None


def _asks_for_a_method(parts: Parts) -> bool:
    """Whether it names one that only ropes and the system have."""
    return isinstance(parts.run, Dynamic) and parts.run.method in HIGH_ORDER


def _rubs(load: AnyLoad | None) -> bool:
    return isinstance(load, MovingForce) and load.contact in RUBBING


def _of_beams(parts: Parts) -> Engine:
    """The engine of the system for motions of lines that are slack or have inner supports, or if it supports more.

    Overhead lines go to the system with what only that one supports of their motion.

    Linearised motions of straight lines are vertical only with the other one, which is faster for it; with an axial
    inertia it takes longer steps on straight lines, with a window fewer nodes.
    """
    if parts.overhead:
        if not isinstance(parts.run, Dynamic):
            return WIRES
        refused, moves = _refused(WIRES, parts), not _is_linearised(parts)
        return SYSTEM if refused and _refused(SYSTEM, parts) < refused + moves else WIRES
    if isinstance(parts.run, Dynamic) and parts.run.window is not None and not parts.is_supported:
        return WIRES
    if _asks_for_a_method(parts):
        return SYSTEM
    refused, slack = _refused(SYSTEM, parts), False
    for line in parts.lines.values():
        slack = slack or (line is not None and (line.length or 0.0) > line.distance * (1.0 + _ROUNDING))
    run, better = parts.run, False
    if isinstance(run, Dynamic):
        better = slack or (parts.is_supported and not _is_linearised(parts) and run.axial_inertia == 1.0)
        better = better or run.method == "verlet"  # by name; what wires take by themselves is the same method
    return SYSTEM if refused < _refused(WIRES, parts) or (better and not refused) else WIRES


def _refused(engine: Engine, parts: Parts) -> int:
    """How much of the analysis an engine does not support."""
    table = engine.motion if isinstance(parts.run, Dynamic) else engine.at_rest
    return sum(1 for _ in table.unsupported(parts))


def unsupported(parts: Parts) -> Iterator[Finding]:
    """Find what of a scenario its engine does not support, as far as its parts tell which one that is."""
    if parts.run is None:  # what neither a motion nor rest could be computed with
        motion, rest = (list(unsupported(replace(parts, run=run))) for run in (Dynamic(until=1.0), Equilibrium()))
        yield from (found for found in motion if found.path[0] != "run" and found.path in {one.path for one in rest})
        return
    parts = parts.on_a_mesh
    engine = engine_of(parts)
    known = parts.is_complete and None not in parts.lines.values()
    yield from _window_with_all_geometry(engine, parts)
    yield from _window_to_be_found(engine, parts)
    for found in (engine.motion if isinstance(parts.run, Dynamic | Linear) else engine.at_rest).unsupported(parts):
        a_rope = not (parts.is_network or parts.has_bending_stiffness or isinstance(parts.run, Linear))
        if known or not a_rope or found.path[0] != "run":  # a line not known may have bending stiffness
            yield found


def _window_with_all_geometry(engine: Engine, parts: Parts) -> Iterator[Finding]:
    """A window in which wires have nonlinear geometry needs tensions that nothing far from it changes."""
    run, what = parts.run, ""
    if not isinstance(run, Dynamic) or run.window is None or run.geometry == "linearised":
        return
    if not parts.overhead or parts.lines or parts.nets:
        what = "all but overhead lines"
    elif engine is not WIRES:
        what = "overhead lines under such loads"
    elif any(line is not None and line.ends == "anchored" for line in parts.overhead.values()):
        what = "overhead lines with ends: anchored, with tensions that depend on their whole length"
    if what:
        given, remedy = run.written_window, "write geometry: linearised, or leave window out"
        yield missing(("run", "window"), what, given, remedy, feature="a window with geometry: nonlinear")


def _window_to_be_found(engine: Engine, parts: Parts) -> Iterator[Finding]:
    """The width of a window is found by moving what is there several times, from rest."""
    run, what = parts.run, ""
    if not isinstance(run, Dynamic) or not run.finds_window:
        return
    if not parts.overhead or parts.lines or parts.nets:
        what = "all but overhead lines"
    elif engine is not WIRES:
        what = "overhead lines under such loads"
    elif any(isinstance(load, ExternalModel) for load in parts.loads.values()):
        what = "overhead lines under external models, which move but once"
    elif not parts.loads:
        what = "overhead lines without loads"
    if what:
        yield missing(("run", "window"), what, AUTO, "write a width, for example 180 m", feature="window: auto")


def _of_rest(engine: Engine, scenario: Scenario, *, with_loads: bool) -> list[Finding]:
    """What of lines, and of loads if they stand there, an engine does not support at rest."""
    found = engine.at_rest.unsupported(scenario.parts)
    return [one for one in found if one.path[0] == "lines" or (one.path[0] == "loads" and with_loads)]


def _moves_otherwise(scenario: Scenario) -> Iterator[Finding]:
    """What those who find a spectrum at an instant do not know of the motion up to there."""
    run, what = scenario.run, "the spectrum at an instant"
    if isinstance(run, Dynamic) and run.axial_inertia != 1.0 and engine_of(scenario) is SYSTEM:
        yield missing(("run", "axial_inertia"), what, f"{run.axial_inertia:g}", "leave it out")
    for name, load in () if scenario.is_network else scenario.loads.items():
        if isinstance(load, MovingForce) and _rubs(load):
            yield missing(("loads", name, "contact"), what, load.contact, "write clamped or frictionless")


def check_spectrum(scenario: Scenario, *, with_loads: bool, at_rest: bool = True) -> None:
    """Refuse what networks and lines with inner supports do not bear at rest, and loads without matrices with loads.

    Args:
        scenario: whose spectrum is asked for.
        with_loads: whether that is with its loads.
        at_rest: whether it is about rest, not about an instant of a motion.

    Raises:
        ScenarioError: there is such a thing.
    """
    if not at_rest and is_system_linearised(scenario):
        feature, remedy = "linearised geometry", "leave the time out: the linearised motion is about equilibrium"
        what = "the spectrum at an instant of ropes, of joined lines and of parts that only move with them"
        raise refusal(missing(("run", "geometry"), what, "linearised", remedy, feature=feature))
    for found in () if at_rest else _moves_otherwise(scenario):
        raise refusal(found)
    for name, line in scenario.lines.items():
        if line.hysteresis is not None:
            remedy, feature = "leave hysteresis out", "hysteresis"
            raise refusal(missing(("lines", name, "hysteresis"), "spectra", "a block", remedy, feature=feature))
        for key in () if at_rest else line.winches:
            where, remedy = ("lines", name, key, "winch"), "leave the time out"
            raise refusal(missing(where, "the spectrum at an instant", "a block", remedy, feature="a winch"))
    if scenario.is_network:
        for found in _of_rest(SYSTEM, scenario, with_loads=with_loads) if at_rest else ():
            raise refusal(found)
    elif scenario.overhead_lines and engine_of(scenario) is SYSTEM:
        for found in _of_rest(SYSTEM, scenario, with_loads=with_loads):
            raise refusal(found)
    elif scenario.parts.is_supported:
        for found in _of_rest(WIRES, scenario, with_loads=with_loads):
            raise refusal(found)
    if not with_loads:
        return
    remedy = "ask for that of the line alone (no instant, no start.with_loads), or write kind: matrices"
    for name, load in scenario.loads.items():
        if isinstance(load, Walker | Crowd | ExternalModel) or _balances(load):
            raise refusal(missing(("loads", name, "kind"), "the spectrum with loads", load.kind, remedy))


def check_without_feedback(scenario: Scenario) -> None:
    """Refuse loads of which it is not computed what force they exert on rigid ground.

    Raises:
        ScenarioError: there is such a load.
    """
    what = "a run without feedback"
    for name, load in scenario.loads.items():
        if isinstance(load, Crowd):
            raise refusal(missing(("loads", name, "kind"), what, load.kind, "write its people one by one as footsteps"))
        if isinstance(load, Train):
            raise refusal(
                missing(("loads", name, "kind"), what, load.kind, "write kind: axles, the forces of its axles")
            )
        if getattr(load, "also_on", ()):
            wrong = "on rigid ground the distribution of its load to the lines is not determined"
            remedy = "name one line only"
            raise ScenarioError([Problem(f"loads.{name}.also_on", wrong, remedy=remedy)])
        if isinstance(load, ExternalModel) and engine_of(scenario) is WIRES:
            remedy = "leave it out, or ask for ropewalk compare"
            raise refusal(missing(("loads", name, "kind"), f"{what} of beams", load.kind, remedy))
        if load.on in scenario.nets and isinstance(load, MovingMass) and not isinstance(load.travel.speed, float):
            feature, given = "a mass on a net at variable speed", "a speed that varies"
            raise refusal(missing(("loads", name, "travel", "speed"), what, given, "write one number", feature=feature))
