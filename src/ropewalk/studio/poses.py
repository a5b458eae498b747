"""The rope that answers while its load is dragged: an equilibrium for every place, and the linear theory beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.linear.chord import Chord, chords
from ropewalk.model.load import MovingForce
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


@dataclass(frozen=True)
class Asked:
    """What is asked of a dragged load."""

    load: str
    x: float  # m, where the pointer is, along the first axis
    contact: str = "clamped"
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
    warnings: tuple[str, ...]


def draggable(scenario: Scenario) -> list[str]:
    """Loads that can be dragged: forces and masses on lines."""
    return [
        name for name, load in scenario.loads.items()
        if isinstance(load, MovingForce | MovingMass) and load.on in scenario.lines
    ]  # fmt: skip


def force_of(scenario: Scenario, name: str) -> tuple[float, ...]:
    """The force of a load that can be dragged, at the beginning: as given, or its weight."""
    load = scenario.loads[name]
    if isinstance(load, MovingForce):
        given = load.force
        if callable(given):
            return given(0.0)
        return given if isinstance(given, tuple) else given.value[0]
    assert isinstance(load, MovingMass)
    return (0.0,) * (len(scenario.lines[load.on].start) - 1) + (-load.mass * scenario.gravity,)


class Dragging:
    """A scenario whose loads are dragged."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self._line: tuple[Any, Any] = (None, None)  # what was asked of a line, and that line
        self._chord: tuple[Any, Chord | None] = (None, None)
        self.attributes = scenario_attributes(scenario)
        self._checked: tuple[Any, Any] = (None, None)  # what was asked but the place; that scenario and its load
        self._last: tuple[float, float, float] | None = None  # xi, x where that led, and dx/dxi

    def posed(self, asked: Asked) -> Pose:
        """The equilibrium with the load under the pointer.

        Raises:
            RopewalkError: there is none, or what is asked cannot be.
        """
        if asked.load not in draggable(self.scenario):
            raise RopewalkError(f"load {asked.load}: forces and masses on lines can be dragged, nothing else")
        on = self.scenario.loads[asked.load].on
        line = self._line_of(on, asked.line)
        first, last = line.start[0], line.end[0]
        low, high = sorted((first + _EDGE * (last - first), last - _EDGE * (last - first)))
        x = min(max(asked.x, low), high)
        length = line.length if line.length is not None else line.distance
        ratio = length / (last - first)
        tried, xi = 0, (x - first) * ratio
        if self._last is not None:
            xi = self._last[0] + (x - self._last[1]) / self._last[2]
        before: tuple[float, float] | None = None
        while True:
            xi = min(max(xi, _EDGE * length), (1.0 - _EDGE) * length)
            frame, layout, run_info = self._at(asked, on, line, xi)
            tried, found = tried + 1, float(frame.contact_position[self._contact(layout, asked.load), 0])
            slope = 1.0 / ratio
            if before is not None and abs(xi - before[0]) > 1e-12 * length:
                slope = (found - before[1]) / (xi - before[0])
            if slope * ratio < 0.05:  # a load that turns back: the chain rule helps no further
                slope = 1.0 / ratio
            self._last = (xi, found, slope)
            if abs(found - x) <= _NEAR * abs(last - first) or tried == _TRIES:
                break
            before, xi = (xi, found), xi + (x - found) / slope
        return Pose(frame, layout, xi, self._linear_shape(asked, on, line, found), tuple(run_info.warnings))

    def released(self, asked: Asked, xi: float, until: float = 6.0) -> Scenario:
        """The motion that begins when the load is let go where it was dragged to: it slides along its line as a mass.

        Raises:
            RopewalkError: without gravity nothing falls, or its force is no weight.
        """
        force = self._force(asked)
        gravity = self.scenario.gravity
        if gravity <= 0.0 or not force[-1] < 0.0 or any(force[:-1]):
            raise RopewalkError("only a load with a vertical force can be released")
        on = self.scenario.loads[asked.load].on
        line = self._line_of(on, asked.line)
        mass = {"kind": "mass", "on": on, "mass": -force[-1] / gravity, "travel": {"kind": "free", "from": xi}}
        run = Dynamic(until=until, every=1.0 / 60.0, start={"with_loads": True})
        loads = {asked.load: mass}
        wind = self._wind(asked, line)
        return Scenario(
            title=f"{self.scenario.title}, released"[:200], gravity=gravity, lines={on: _felt(line, wind)}, loads=loads,
            wind=wind, run=run,
        )  # fmt: skip

    def _force(self, asked: Asked) -> tuple[float, ...]:
        given = force_of(self.scenario, asked.load)
        return given if asked.weight is None else (*given[:-1], -asked.weight)

    def _wind(self, asked: Asked, line: Any) -> Wind | None:
        if asked.wind is None:
            return self.scenario.wind
        direction = (1.0, 0.0) if len(line.start) == 2 else (0.0, 1.0, 0.0)
        return Wind(direction=direction, speed=asked.wind) if asked.wind else None

    def _line_of(self, on: str, changes: Mapping[str, Any]) -> Any:
        key = on, repr(sorted(changes.items()))
        if self._line[0] != key:
            line = self.scenario.lines[on]
            if unknown := set(changes) - set(KEYS):
                raise RopewalkError(f"line {on}: {', '.join(sorted(unknown))} cannot be changed by hand")
            given = {**line.model_dump(by_alias=True, exclude_unset=True), **changes}
            self._line, self._last = (key, type(line).model_validate(given) if changes else line), None
        return self._line[1]

    def _at(self, asked: Asked, on: str, line: Any, xi: float) -> tuple[Frame, Layout, RunInfo]:
        scenario, load = self._still(asked, on, line)
        travel = load.travel.model_copy(update={"start": xi})
        moved = {**scenario.loads, asked.load: load.model_copy(update={"travel": travel})}
        scenario = scenario.model_copy(update={"loads": moved})
        run_info = RunInfo()
        run = run_of(scenario, run_info)
        return next(iter(run.blocks()))[0], run.layout, run_info

    def _still(self, asked: Asked, on: str, line: Any) -> tuple[Scenario, MovingForce]:
        """The dragged load as a force on its line, checked once for all places: checks took a third of an answer."""
        key = asked.load, asked.contact, self._force(asked), asked.wind, repr(line)
        if self._checked[0] != key:
            contact: Any = asked.contact
            travel = Travel.model_validate({"speed": 1.0, "measured": "material", "from": 0.5 * line.distance})
            load = MovingForce(on=on, force=self._force(asked), contact=contact, travel=travel)
            wind = self._wind(asked, line)
            scenario = Scenario(
                gravity=self.scenario.gravity,
                lines={name: _felt(one, wind) for name, one in {**self.scenario.lines, on: line}.items()},
                loads={**self.scenario.loads, asked.load: load}, joints=self.scenario.joints, wind=wind,
                run=Equilibrium(),
            )  # fmt: skip
            self._checked = key, (scenario, load)
        found: tuple[Scenario, MovingForce] = self._checked[1]
        return found

    @staticmethod
    def _contact(layout: Layout, load: str) -> int:
        return layout.contact_load.index(load)

    def _linear_shape(self, asked: Asked, on: str, line: Any, x: float) -> Array | None:
        """The string of the linear theory under its weight and the force, with its tension at rest without it.

        A force F at a on a string of span L under the tension T deflects it by F min(x, a) (L - max(x, a)) / (T L).
        """
        key = on, repr(line)
        if self._chord[0] != key:
            self._chord = key, self._chord_of(on, line)
        chord = self._chord[1]
        if chord is None:
            return None
        along: Array = np.linspace(0.0, chord.length, LINEAR_POINTS)
        gravity = np.zeros(chord.start.size)
        gravity[-1] = -self.scenario.gravity
        a = (x - chord.start[0]) / chord.along[0]
        along = np.sort(np.append(along[:-1], (a, chord.length)))
        influence = np.minimum(along, a) * (chord.length - np.maximum(along, a)) / (chord.tension * chord.length)
        push = chord.across @ np.array(self._force(asked))
        return np.asarray(chord.point(along, gravity) + np.outer(influence, push @ chord.across))

    def _chord_of(self, on: str, line: Any) -> Chord | None:
        # Its supports may be joints: then it has no chord.
        lone = Scenario(gravity=self.scenario.gravity, lines={on: _felt(line, None)}, run=Equilibrium())
        if line.bending_stiffness or lone.is_network:
            return None
        try:
            return chords(setting_of(lone, 0.0), lone, RunInfo())[0]
        except RopewalkError:
            return None


def _felt(line: Any, wind: Wind | None) -> Any:
    """A line of an equilibrium: where there is no wind it has nothing to feel it by, and nothing has been cut yet."""
    return line.model_copy(update={"cut": None} if wind else {"cut": None, "wind_drag": 0.0})
