"""Which engine computes a scenario, and what that one does not support."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from ropewalk.linear import capabilities as linear
from ropewalk.model._base import Finding
from ropewalk.model.capabilities import Capabilities, missing, refusal
from ropewalk.model.load import Foreign
from ropewalk.model.mass import MovingMass
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic, Equilibrium, Linear
from ropewalk.model.scenario import Scenario
from ropewalk.model.walker import Walker
from ropewalk.solve import capabilities as ropes
from ropewalk.system import capabilities as system
from ropewalk.webs import capabilities as webs
from ropewalk.wires import capabilities as wires


@dataclass(frozen=True)
class Engine:
    """What computes scenarios, with what it supports in motion, and at rest or in slow motion."""

    motion: Capabilities
    at_rest: Capabilities


ROPES = Engine(ropes.MOTION, ropes.AT_REST)
WIRES = Engine(wires.MOTION, wires.AT_REST)
WEBS = Engine(webs.MOTION, webs.AT_REST)
SYSTEM = Engine(system.MOTION, webs.AT_REST)
LINEAR = Engine(linear.CAPABILITIES, linear.CAPABILITIES)


def engine_of(asked: Parts | Scenario) -> Engine:
    """Choose the engine that computes a scenario."""
    if asked.is_web:
        return _of_networks(asked if isinstance(asked, Parts) else asked.parts)
    if isinstance(asked.run, Linear):
        return LINEAR
    return WIRES if asked.is_stiff else ROPES


def _of_networks(parts: Parts) -> Engine:
    """The engine of the system where it supports a motion of lines, or more of it than that of networks."""
    over_sheaves = any(line is not None and line.sheaves for line in parts.lines.values())
    if not isinstance(parts.run, Dynamic) or parts.nets or over_sheaves:
        return WEBS
    refused = [len(list(engine.motion.unsupported(parts))) for engine in (SYSTEM, WEBS)]
    return SYSTEM if not refused[0] or refused[0] < refused[1] else WEBS


def unsupported(parts: Parts) -> Iterator[Finding]:
    """Find what of a scenario its engine does not support, as far as its parts tell which one that is."""
    if parts.run is None:  # what neither a motion nor rest could be computed with
        motion, rest = (list(unsupported(replace(parts, run=run))) for run in (Dynamic(until=1.0), Equilibrium()))
        yield from (found for found in motion if found.path[0] != "run" and found.path in {one.path for one in rest})
        return
    engine = engine_of(parts)
    known = parts.is_complete and None not in parts.lines.values()
    for found in (engine.motion if isinstance(parts.run, Dynamic | Linear) else engine.at_rest).unsupported(parts):
        if known or engine is not ROPES or found.path[0] != "run":  # a line not known may have bending stiffness
            yield found


def check_spectrum(scenario: Scenario, *, with_loads: bool) -> None:
    """Refuse what networks do not bear at rest, and loads without matrices in a spectrum with loads.

    Raises:
        ScenarioError: there is such a thing.
    """
    if scenario.is_web:
        for found in WEBS.at_rest.unsupported(scenario.parts):
            if found.path[0] == "lines" or (found.path[0] == "loads" and with_loads):
                raise refusal(found)
    if not with_loads:
        return
    remedy = "ask for that of the line alone (no instant, no start.with_loads), or write kind: matrices"
    for name, load in scenario.loads.items():
        if isinstance(load, Walker | Foreign):
            raise refusal(missing(("loads", name, "kind"), "the spectrum with loads", load.kind, remedy))


def check_without_feedback(scenario: Scenario) -> None:
    """Refuse loads of which it is not computed what force they exert on rigid ground.

    Raises:
        ScenarioError: there is such a load.
    """
    what = "a run without feedback"
    for name, load in scenario.loads.items():
        if isinstance(load, Pantograph) or (isinstance(load, Foreign) and engine_of(scenario) is WIRES):
            where = "" if isinstance(load, Pantograph) else " of beams"
            remedy = "leave it out, or ask for ropewalk compare"
            raise refusal(missing(("loads", name, "kind"), what + where, load.kind, remedy))
        if load.on in scenario.nets and isinstance(load, MovingMass) and not isinstance(load.travel.speed, float):
            feature, given = "a mass on a net whose speed varies", "a speed that varies"
            raise refusal(missing(("loads", name, "travel", "speed"), what, given, "write one number", feature=feature))
