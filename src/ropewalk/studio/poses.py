"""The rope that answers while its load is dragged: an equilibrium for every place, and the linear theory beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pydantic.dataclasses

from ropewalk.errors import RopewalkError
from ropewalk.linear.chord import Chord, chords
from ropewalk.model.history import rows
from ropewalk.model.load import Contact, MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.run import Dynamic, Equilibrium
from ropewalk.model.scenario import Scenario
from ropewalk.model.travel import Travel
from ropewalk.model.wind import Wind
from ropewalk.results.contract import scenario_attributes
from ropewalk.results.frame import Array, Frame, Layout, RunInfo
from ropewalk.simulate import run_of
from ropewalk.solve.start import setting_of

LINEAR_POINTS = 101  # points of the shape by the linear theory
_NEAR = 5e-4  # of the span: so close to the pointer the load is
_TRIES = 6  # equilibria for one place of the pointer
_EDGE = 2e-3  # of the length: so close to a support a load is dragged
KEYS = ("start", "end", "length", "tension", "mass", "wind_drag")
"""Keys of a line that are changed by hand."""


@pydantic.dataclasses.dataclass(frozen=True)
class Asked:
    """What is asked of a dragged load."""

    load: str
    x: float  # m, where the pointer is, along the first axis
    contact: Contact = "clamped"
    weight: float | None = None  # N, None: as the scenario says
    wind: float | None = None  # m/s along the first horizontal axis (in space, the second), None: as the scenario says
    line: Mapping[str, Any] = field(default_factory=dict)  # keys of its line that differ from the scenario


@dataclass(frozen=True)
class Pose:
    """An equilibrium with the load where it was dragged to."""

    frame: Frame
    layout: Layout
    xi: float  # m, where it stands on the unstrained line
    linear: Array | None  # (point, axis) m, the string of the linear theory; None where that has nothing to say


def draggable(scenario: Scenario) -> list[str]:
    """Loads that can be dragged: forces and masses on lines."""
    return [
        name for name, load in scenario.loads.items()
        if isinstance(load, MovingForce | MovingMass) and load.on in scenario.lines
    ]  # fmt: skip


def force_of(scenario: Scenario, name: str) -> tuple[float, ...]:
    """The force of a load that can be dragged, at the beginning: as given, or its weight."""
    load: Any = scenario.loads[name]
    if isinstance(load, MovingForce):
        return rows(load.force)[0]
    return (0.0,) * (len(scenario.lines[load.on].start) - 1) + (-load.mass * scenario.gravity,)


class Dragging:
    """A scenario whose loads are dragged."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.attributes = scenario_attributes(scenario)
        self.xi = 0.0  # m, where the load was dragged to last
        self._kept: tuple[Asked, Scenario, Chord | None] | None = None  # checks took a third of an answer
        self._last: tuple[float, float, float] | None = None  # xi, x where that led, and dx/dxi

    def posed(self, asked: Asked) -> Pose:
        """The equilibrium with the load under the pointer.

        Raises:
            RopewalkError: there is none, or what is asked cannot be.
        """
        scenario, chord = self._scenario_of(asked)
        line: Any = scenario.lines[scenario.loads[asked.load].on]
        first, last = line.start[0], line.end[0]
        low, high = sorted((first + _EDGE * (last - first), last - _EDGE * (last - first)))
        x = min(max(asked.x, low), high)
        length = line.distance if line.length is None else line.length
        mean = (last - first) / length
        before = self._last or (0.0, first, mean)
        for _ in range(_TRIES):
            xi = before[0] + (x - before[1]) / before[2]
            xi = min(max(xi, _EDGE * length), (1.0 - _EDGE) * length)
            frame, layout = _equilibrium(scenario, asked.load, xi)
            found = float(frame.contact_position[layout.contact_load.index(asked.load), 0])
            moved = xi - before[0]
            slope = (found - before[1]) / moved if abs(moved) > 1e-6 * length else mean
            # Of a load that turns back the chain rule helps no further.
            before = self._last = xi, found, slope if slope / mean > 0.05 else mean
            if abs(found - x) <= _NEAR * abs(last - first):
                break
        self.xi = xi
        return Pose(frame, layout, xi, None if chord is None else _linear_shape(chord, scenario, asked.load, found))

    def released(self, asked: Asked, xi: float, until: float = 6.0) -> Scenario:
        """The motion that begins when the load is let go where it was dragged to: it slides along its line as a mass.

        Raises:
            RopewalkError: without gravity nothing falls, or its force is no weight.
        """
        scenario, _ = self._scenario_of(asked)
        load: Any = scenario.loads[asked.load]
        if scenario.gravity <= 0.0 or not load.force[-1] < 0.0 or any(load.force[:-1]):
            raise RopewalkError("only a load with a vertical force can be released")
        mass = {"kind": "mass", "on": load.on, "mass": -load.force[-1] / scenario.gravity,
                "travel": {"kind": "free", "from": xi}}  # fmt: skip
        run = Dynamic(until=until, every=1.0 / 60.0, start={"with_loads": True})
        return Scenario(
            title=f"{self.scenario.title}, released"[:200], gravity=scenario.gravity,
            lines={load.on: scenario.lines[load.on]}, loads={asked.load: mass}, wind=scenario.wind, run=run,
        )  # fmt: skip

    def _scenario_of(self, asked: Asked) -> tuple[Scenario, Chord | None]:
        """Return the scenario with the load as a force on its line, and the chord of that: the same for all places.

        Raises:
            RopewalkError: the load cannot be dragged, or a key of its line not be changed by hand.
        """
        same, own = replace(asked, x=0.0), self.scenario
        if self._kept is not None and self._kept[0] == same:
            return self._kept[1:]
        if asked.load not in draggable(own):
            raise RopewalkError(f"load {asked.load}: forces and masses on lines can be dragged, nothing else")
        on = own.loads[asked.load].on
        line: Any = own.lines[on]
        if unknown := set(asked.line) - set(KEYS):
            raise RopewalkError(f"line {on}: {', '.join(sorted(unknown))} cannot be changed by hand")
        if asked.line:
            line = type(line)(**{**line.model_dump(by_alias=True, exclude_unset=True), **asked.line})
        force = force_of(own, asked.load)
        force = force if asked.weight is None else (*force[:-1], -asked.weight)
        wind = own.wind
        if asked.wind is not None:
            direction = (1.0, 0.0) if len(line.start) == 2 else (0.0, 1.0, 0.0)
            wind = Wind(direction=direction, speed=asked.wind) if asked.wind else None
        travel = Travel.model_validate({"speed": 1.0, "measured": "material", "from": 0.5 * line.distance})
        load = MovingForce(on=on, force=force, contact=asked.contact, travel=travel)
        lines = {name: _felt(one, wind) for name, one in {**own.lines, on: line}.items()}
        scenario = Scenario(
            gravity=own.gravity, lines=lines, loads={**own.loads, asked.load: load}, joints=own.joints, wind=wind,
            run=Equilibrium(),
        )  # fmt: skip
        self._kept, self._last = (same, scenario, _chord_of(on, line, own.gravity)), None
        return self._kept[1:]


def _equilibrium(scenario: Scenario, name: str, xi: float) -> tuple[Frame, Layout]:
    """Return the equilibrium with the load at a place of its unstrained line."""
    load: Any = scenario.loads[name]
    load = load.model_copy(update={"travel": load.travel.model_copy(update={"start": xi})})
    run = run_of(scenario.model_copy(update={"loads": {**scenario.loads, name: load}}), RunInfo())
    return next(iter(run.blocks()))[0], run.layout


def _linear_shape(chord: Chord, scenario: Scenario, name: str, x: float) -> Array:
    """The string of the linear theory under its weight and the force, with its tension at rest without it.

    A force F at a on a string of span L under the tension T deflects it by F min(x, a) (L - max(x, a)) / (T L).
    """
    load: Any = scenario.loads[name]
    a = (x - chord.start[0]) / chord.along[0]
    along: Array = np.sort(np.append(np.linspace(0.0, chord.length, LINEAR_POINTS), a))
    influence = np.minimum(along, a) * (chord.length - np.maximum(along, a)) / (chord.tension * chord.length)
    push = chord.across @ np.array(load.force)
    down = np.append(np.zeros(chord.start.size - 1), -scenario.gravity)
    return np.asarray(chord.point(along, down) + np.outer(influence, push @ chord.across))


def _chord_of(on: str, line: Any, gravity: float) -> Chord | None:
    """Return the chord of a line alone; None where it has none, as between joints."""
    lone = Scenario(gravity=gravity, lines={on: _felt(line, None)}, run=Equilibrium())
    if line.bending_stiffness or lone.is_network:
        return None
    try:
        return chords(setting_of(lone, 0.0), lone, RunInfo())[0]
    except RopewalkError:
        return None


def _felt(line: Any, wind: Wind | None) -> Any:
    """A line of an equilibrium: where there is no wind it has nothing to feel it by, and nothing has been cut yet."""
    return line.model_copy(update={"cut": None} if wind else {"cut": None, "wind_drag": 0.0})
