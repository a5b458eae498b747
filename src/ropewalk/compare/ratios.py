"""Ratios of field terms: how fast against the waves, how heavy against the pre-tension, how much mass for the line.

Each is found from a scenario, and set by overrides of it. The speed ratio V/c moves the same passage at another speed:
speeds are scaled, and the instants of their tables and the time of the run by the inverse, so that the load comes as
far. The load ratio W/P and the mass ratio m/(rho L) scale the load as a whole: its forces, masses, springs and dampers
alike, which is one and the same load in another unit of mass, so that its own frequencies stay.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ropewalk.errors import Problem, ScenarioError, did_you_mean
from ropewalk.model import (
    Axles,
    Footsteps,
    FreeTravel,
    Line,
    Matrices,
    MovingForce,
    MovingMass,
    Oscillator,
    Scenario,
    SpeedTable,
    Trolley,
    Vehicle,
    Walker,
)
from ropewalk.model.history import rows
from ropewalk.model.line import spatial

RATIOS = ("speed ratio", "load ratio", "mass ratio")
SYMBOLS = {"speed ratio": "V/c", "load ratio": "W/P", "mass ratio": "m/ρL"}

Changes = dict[str, Any]
"""New values of a scenario by their keys, as overrides have them."""

_WITH_MASS = re.compile(r"(-?\d\S*) ((?:kg|N)\b\S*)")  # as declarations write themselves; all such units hold it once
_PLAIN_WITH_MASS = ("mass", "damping", "stiffness")  # of a load given by matrices


@dataclass(frozen=True)
class Pair:
    """A load and the line that a ratio sets it against.

    Args:
        scenario: where both are.
        load: name of the load; empty: the only one.
        line: name of the line; empty: the one that the load is on.
    """

    scenario: Scenario
    load: str = ""
    line: str = ""

    @classmethod
    def of(cls, scenario: Scenario, ratio: str, load: str = "", line: str = "") -> Pair:
        """Find the load and the line.

        Raises:
            ScenarioError: there are several loads and none is named, or a name is unknown.
        """
        loads = scenario.loads
        if not load and len(loads) != 1:
            there = f"there are {', '.join(loads)}" if loads else "there is none"
            remedy = f"name it: {ratio} of {next(iter(loads))}" if loads else "add a load"
            _refuse(ratio, "belongs to one load", there, remedy)
        load = load or next(iter(loads))
        if load not in loads:
            _refuse(ratio, "no such load", load, did_you_mean(load, loads))
        line, known = line or loads[load].on, (*scenario.lines, *scenario.overhead_lines)
        if line not in known:
            _refuse(ratio, "no such line" if known else "there is no line", line, did_you_mean(line, known))
        return cls(scenario, load, line)

    def changes(self, ratio: str, value: float) -> Changes:
        """The changes that give a ratio a value.

        Raises:
            ScenarioError: the load has no such ratio.
            EquilibriumError: the line has no rest to find its tension from.
        """
        now = self.value(ratio)
        return self._speeds(value / now) if ratio == "speed ratio" else dict(self._scaled(value / now))

    def value(self, ratio: str) -> float:
        """The value that a ratio has in the scenario; errors as above."""
        if ratio == "speed ratio":
            return self._top_speed() / self._wave_speed()
        if ratio == "load ratio":
            return self._weight(ratio) / self._rest(ratio)[0]
        _, mass, _ = self._rest(ratio)
        return self._mass(ratio) / mass

    def _rest(self, ratio: str) -> tuple[float, float, float]:
        """Mean tension at rest (N), mass (kg) and chord (m) of the line."""
        scenario, name = self.scenario, self.line
        if name in scenario.overhead_lines:
            wire, spans = scenario.overhead_lines[name].contact_wire, scenario.overhead_lines[name].span_lengths
            return wire.tension, wire.mass * sum(spans), sum(spans)
        line = scenario.lines[name]
        if line.is_joined or line.supports:
            why = f"{name} is joined to other lines, runs over sheaves, or has inner supports"
            _refuse(ratio, why, "", _plain_key(ratio, self.load))
        start, end = spatial(line.start), spatial(line.end)
        chord = math.dist(start, end)
        length, tension = _at_rest(scenario, name, line)
        if ratio != "mass ratio" and not tension > 0.0:
            _refuse(ratio, f"{name} has no tension in equilibrium", f"{tension:.4g} N", _plain_key(ratio, self.load))
        return tension, line.mass * length, chord

    def _wave_speed(self) -> float:
        """Speed of transverse waves along the chord, c = sqrt(P / (mass / chord)), as the linear theory has it; m/s.

        For a load whose speed counts unstrained length or x, in the same measure.
        """
        tension, mass, chord = self._rest("speed ratio")
        c = math.sqrt(tension * chord / mass)
        measured = getattr(getattr(self.scenario.loads[self.load], "travel", None), "measured", "")
        line = self.scenario.lines.get(self.line)
        if line is not None and measured == "material":
            return c * mass / line.mass / chord
        if line is not None and measured == "horizontal":
            return c * abs(line.end[0] - line.start[0]) / chord
        return c

    def _top_speed(self) -> float:
        top = max((abs(speed) for _, value in self._speed_values() for speed in _entries(value)), default=0.0)
        if not top > 0.0:
            _refuse("speed ratio", f"{self.load} does not move", "0 m/s", f"set loads.{self.load}.travel.speed first")
        return top

    def _speed_values(self) -> Iterator[tuple[str, Any]]:
        load = self.scenario.loads[self.load]
        travel: Any = getattr(load, "travel", None)
        if travel is None:
            wrong = f"a load of kind {load.kind} sets its own speed"
            remedy = f"take a key of it as an axis, such as loads.{self.load}.speed or .frequency"
            _refuse("speed ratio", wrong, self.load, remedy)
        found = {"speed": travel.speed}
        if isinstance(travel, FreeTravel) and travel.driver is not None:
            found["driver.speed"] = travel.driver.speed
        for key, value in found.items():
            if callable(value):
                _refuse("speed ratio", "a callable cannot be scaled", f"loads.{self.load}.travel.{key}", "use a table")
            yield f"loads.{self.load}.travel.{key}", value

    def _speeds(self, factor: float) -> Changes:
        """The same passage, faster by a factor."""
        changes: Changes = {}
        for key, value in self._speed_values():
            if isinstance(value, SpeedTable):
                time = [t / factor for t in value.time]
                changes[key] = {"time": time, "value": [speed * factor for speed in value.value]}
            else:
                changes[key] = value * factor
        run = self.scenario.run
        for key in ("until", "every"):
            if getattr(run, key, None) is not None:
                changes[f"run.{key}"] = getattr(run, key) / factor
        return changes

    def _weight(self, ratio: str) -> float:
        """Largest force of the load at rest, with its weight, N."""
        load, gravity = self.scenario.loads[self.load], self.scenario.gravity
        if isinstance(load, Footsteps):
            return load.mass * gravity
        own = 0.0 if isinstance(load, MovingForce | Axles) else self._mass(ratio) * gravity
        force = getattr(load, "force", (0.0, 0.0))
        if callable(force):
            _refuse(ratio, "a callable cannot be scaled", f"loads.{self.load}.force", "use a table {time, value}")
        weight = max(math.hypot(*row[:-1], row[-1] - own) for row in rows(force))
        if not weight > 0.0:
            _refuse(ratio, f"{self.load} weighs nothing", "0 N", "give it a force, or the scenario gravity")
        return weight

    def _mass(self, ratio: str) -> float:
        load = self.scenario.loads[self.load]
        if isinstance(load, MovingMass):
            return load.mass
        if isinstance(load, Oscillator):
            return load.mass + load.wheel_mass
        if isinstance(load, Trolley):
            return load.mass + load.payload.mass
        if isinstance(load, Vehicle):
            return sum(body.mass for body in load.bodies.values()) + sum(wheel.mass for wheel in load.wheels.values())
        if isinstance(load, Walker):
            return load.mass + load.foot_mass
        if isinstance(load, Matrices):
            by_weight = load.weight is not None and self.scenario.gravity > 0.0
            total = math.fsum(load.weight or ()) / self.scenario.gravity if by_weight else _sum(load.mass)
            if total > 0.0:
                return total
        wrong = f"a load of kind {load.kind} has no mass that this ratio could use"
        _refuse(ratio, wrong, self.load, _plain_key(ratio, self.load))
        raise AssertionError

    def _scaled(self, factor: float) -> Iterator[tuple[str, Any]]:
        """All that holds the unit of mass."""
        load = self.scenario.loads[self.load]
        tree = load.model_dump(mode="json", by_alias=True, exclude_none=True)
        if isinstance(load, Matrices):
            for key in _PLAIN_WITH_MASS:
                if key in tree:
                    tree[key] = [[f"{float(cell)!r} kg" for cell in row] for row in tree[key]]
        for key, value in _leaves(tree, f"loads.{self.load}"):
            changed = _times(value, factor)
            if changed != value:
                yield key, changed


def _at_rest(scenario: Scenario, name: str, line: Line) -> tuple[float, float]:
    """Unstrained length (m) and mean tension (N) of a line at rest without loads."""
    from ropewalk.solve.start import setting_of

    lone = scenario.model_copy(update={"lines": {name: line}, "loads": {}, "joints": {}, "nets": {}, "wind": None})
    setting = setting_of(lone, 0.0)
    length, rest = float(setting.strands.h[0] * setting.strands.links[0]), setting.bare[0]
    if line.has_bending_stiffness and line.tension is None:
        return length, 0.0  # what a beam pulls by its sag is no pre-tension
    if line.tension is not None:
        return length, line.tension
    return length, float(rest.tension.mean()) if rest is not None else 0.0


def _entries(speed: Any) -> tuple[float, ...]:
    return speed.value if isinstance(speed, SpeedTable) else (float(speed),)


def _sum(matrix: tuple[tuple[float, ...], ...]) -> float:
    return math.fsum(cell for row in matrix for cell in row)


def _leaves(tree: Mapping[str, Any], at: str) -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{at}.{key}")
        else:
            yield f"{at}.{key}", value


def _times(value: Any, factor: float) -> Any:
    """A dumped value, in SI, with everything in it that holds the unit of mass multiplied."""
    if isinstance(value, list):
        return [_times(entry, factor) for entry in value]
    found = _WITH_MASS.fullmatch(value) if isinstance(value, str) else None
    return float(found[1]) * factor if found else value


def _plain_key(ratio: str, load: str) -> str:
    key = f"loads.{load}.travel.speed" if ratio == "speed ratio" else f"loads.{load}.mass or .force"
    return f"take a key of the scenario as an axis, such as {key}"


def _refuse(ratio: str, wrong: str, given: str, remedy: str) -> None:
    raise ScenarioError([Problem(ratio, wrong, given, remedy)])
