"""Carriages, hauling ropes and hoists of a scenario, as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import filled_records
from ropewalk.mechanics.loading import Loading
from ropewalk.mechanics.multibody_system import STRETCH
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.carriage import Carriage, Haul
from ropewalk.model.line import Line
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.trolley import Trolley
from ropewalk.system.loads.bodies import BodyArrays
from ropewalk.system.loads.carriages import BAR, Carriages
from ropewalk.system.loads.hauling_ropes import HAUL, PART

# Acceleration in m/s^2 with which the weight of a carriage stretches its bars by STRETCH, also where gravity is 0.
_G = 9.81
# Damping ratio of bars.
_RATIO = 0.05
# Instants at which is looked how far ropes are taken in, and the least part of a hauling rope that is left.
_INSTANTS, _LEAST = 1001, 1e-3
# Masses of a hauling rope: with 4 a third of it swings along to 1.6 %.
_USUAL = 4
# Part of its way to a station that is left, at least, of a carriage that another one draws: about.
_QUARTER = 0.25


def with_carriages(
    scenario: Scenario, loading: Loading, contacts: Any, bodies: BodyArrays, places: int
) -> BodyArrays:  # fmt: skip
    """Add the bars and the hauling ropes of carriages, and hoists of payloads, to what has a mass.

    Args:
        scenario: what is there.
        loading: its loads.
        contacts: records; mobilities of wheels of carriages are noted.
        bodies: what has a mass.
        places: number of coordinates of contacts, after which those of bodies stand.
    """
    bodies = _with_hoists(scenario, loading, bodies)
    bars, points, hauls = list[dict[str, Any]](), list[int](), list[dict[str, Any]]()
    parts, towers = list[dict[str, Any]](), list[tuple[float, float]]()
    on = {name: [k for k, wheel in enumerate(loading.wheels) if wheel.load == name] for name in scenario.loads}
    for name, load in scenario.loads.items():
        if not isinstance(load, Carriage):
            continue
        wheels = [int(contacts[k]["first"]) for k in on[name]]
        _add_rockers(load, wheels, bars, points)
        if load.cabin is not None:
            assert loading.multibody_system is not None
            body = next(b for b in loading.multibody_system.displayed if b.name == f"{name}.cabin")
            k = load.cabin.mass * _G / STRETCH
            c = 2.0 * _RATIO * np.sqrt(k * load.cabin.mass)
            own = {"frame": len(bars) - 1, "turning": load.cabin.damping}
            bars.append(_bar(points, wheels, [places + body.coordinates[0]], load.cabin.hanger, k, c) | own)
        if load.haul is not None:
            other = on.get(load.haul.over_to or "", [-1])
            own = {"first": on[name][0], "wheels": load.count, "other": other[0], "others": len(other)}
            hauls.append(own | _hauling_rope(scenario, load, load.haul, parts, towers))
        _note_mobility(contacts, bodies, on[name], wheels)
    if not bars:
        return bodies
    return bodies._replace(
        carriages=Carriages(
            filled_records(BAR, bars), np.array(points, dtype=np.int64), filled_records(HAUL, hauls),
            filled_records(PART, parts), np.array(towers).reshape(-1, 2),
        )
    )  # fmt: skip


def _hauling_rope(
    scenario: Scenario, load: Carriage, haul: Haul, parts: list[dict[str, Any]], towers: list[tuple[float, float]]
) -> dict[str, Any]:  # fmt: skip
    """A hauling rope as a record; its parts and towers are added to those of others."""
    masses, g, counter = (haul.elements or _USUAL) if haul.mass else 0, scenario.gravity, haul.counter
    on_way = _towers(scenario.lines[load.on], haul) if haul.sags else []
    found = {
        "to": 1 if haul.to == "end" else -1, "stiffness": haul.axial_stiffness, "damping": haul.axial_damping,
        "mass": haul.mass, "weight": haul.mass * g, "beyond": haul.beyond, "driven": int(haul.over_to is None),
        "length": shortest(scenario, load, haul), "hangs": int(haul.sags), "part": len(parts), "masses": masses,
        "tower": len(towers), "towers": len(on_way),
    }  # fmt: skip
    if counter is not None:
        found |= {"counter": counter.tension, "counter_weight": counter.mass * g, "counter_mass": counter.mass}
        found |= {"counter_stiffness": counter.axial_stiffness or haul.axial_stiffness}
        found |= {"counter_place": nearest(scenario, load, haul)}
    if haul.sheave is not None:
        found |= {"bears": haul.sheave.slip_ratio}
    parts += [{}] * (masses + 1)
    towers += on_way
    return found


def _towers(line: Line, haul: Haul) -> list[tuple[float, float]]:
    """Where a hauling rope lies on rollers, from the drive on: along the rope, and level from the end of the line, m.

    Crowns of saddles, and inner supports where they hold the line, joined by straight ways.
    """
    start, end, length = np.array(line.start), np.array(line.end), line.length or line.distance
    places = [np.array(saddle.at) for saddle in line.saddles.values()]
    for support in line.supports.values():
        straight = start + (end - start) * support.at / length
        places.append(straight if support.position is None else np.array(support.position))
    places = sorted([start, *places, end], key=lambda at: float((at - start)[:-1] @ (end - start)[:-1]))
    if haul.to == "end":
        places.reverse()
    ways = np.diff(places, axis=0)
    along = haul.beyond + np.cumsum(np.linalg.norm(ways, axis=1))
    level = np.cumsum(np.linalg.norm(ways[:, :-1], axis=1))
    return list(zip(along[:-1].tolist(), level[:-1].tolist(), strict=True))


def shortest(scenario: Scenario, load: Carriage, haul: Haul) -> float:
    """The shortest in m that a hauling rope will be, about: with it its stiffness is the largest."""
    there, until = haul.beyond + _ahead(scenario, load, haul), 0.0
    if haul.over_to is not None:
        other = scenario.loads[haul.over_to]
        assert isinstance(other, Carriage)
        return there + haul.beyond + _ahead(scenario, other, haul)
    if isinstance(scenario.run, Dynamic):
        until = scenario.run.until
    gone = Travelled(*speed_table(haul.speed, until))
    return max(there - _most(gone, until), _LEAST * there)


def nearest(scenario: Scenario, load: Carriage, haul: Haul) -> float:
    """How near in m a carriage will come to the station of its counter rope, about."""
    line = scenario.lines[load.on]
    there = (line.length or line.distance) - _ahead(scenario, load, haul)
    if haul.over_to is not None or not isinstance(scenario.run, Dynamic):
        return _QUARTER * there
    back = _most(Travelled(*speed_table(haul.speed, scenario.run.until)), scenario.run.until, -1.0)
    return max(there - back, _LEAST * there)


def _most(taken_in: Travelled, until: float, sign: float = 1.0) -> float:
    """The most that is taken in of a rope, or let out if the sign is -1, until a time in s, m."""
    return float((sign * taken_in.at(np.linspace(0.0, until, _INSTANTS))).max())


def _ahead(scenario: Scenario, load: Carriage, haul: Haul) -> float:
    """Length of the line between a carriage at the beginning and the end where its drive is, m."""
    line = scenario.lines[load.on]
    return (line.length or line.distance) - load.travel.start if haul.to == "end" else load.travel.start


def _add_rockers(load: Carriage, wheels: list[int], bars: list[dict[str, Any]], points: list[int]) -> None:
    groups = [[wheel] for wheel in wheels]
    for length in load.rockers:
        for behind, ahead in zip(groups[::2], groups[1::2], strict=True):
            k = load.whole * _G / STRETCH * 2.0 * len(ahead) / len(wheels)
            c = 2.0 * _RATIO * np.sqrt(0.5 * k * load.mass * len(ahead) / len(wheels))
            bars.append(_bar(points, behind, ahead, length, k, c))
        groups = [behind + ahead for behind, ahead in zip(groups[::2], groups[1::2], strict=True)]


def _bar(points: list[int], upper: list[int], lower: list[int], length: float, k: float, c: float) -> dict[str, Any]:
    first = len(points)
    points += [*upper, *lower]
    return {
        "upper": first, "uppers": len(upper), "lower": first + len(upper), "lowers": len(lower), "length": length,
        "stiffness": k, "damping": c, "frame": -1,
    }  # fmt: skip


def _note_mobility(contacts: Any, bodies: BodyArrays, on: list[int], wheels: list[int]) -> None:
    """Note what a force accelerates at wheels of one carriage: the others follow."""
    inverse = part_of(bodies, wheels[0])[1]
    for k in on:
        contacts[k]["light"] = np.diag(inverse).max()


def part_of(bodies: BodyArrays, coordinate: int) -> tuple[Integers, Array]:
    """Coordinates of the part that one belongs to, and the inverse of its mass matrix."""
    for p, n in enumerate(bodies.size):
        if coordinate in bodies.at[p, :n]:
            return bodies.at[p, :n], np.asarray(np.linalg.inv(bodies.M[p, :n, :n]))
    raise ValueError(f"coordinate {coordinate} belongs to no part")


def _with_hoists(scenario: Scenario, loading: Loading, bodies: BodyArrays) -> BodyArrays:
    until = scenario.run.until if isinstance(scenario.run, Dynamic) else 0.0
    time, value, path = list[Array](), list[Array](), list[Array]()
    for tether in bodies.tethers:
        load = scenario.loads[loading.wheels[tether["contact"]].load]
        tether["begin"] = tether["shortest"] = tether["length"]
        if not isinstance(load, Trolley) or (not callable(load.payload.hoist) and load.payload.hoist == 0.0):
            continue
        t, v = speed_table(load.payload.hoist, until)
        tether["hoist_first"], tether["hoist_count"] = sum(own.size for own in time), t.size
        gone = Travelled(t, v)
        tether["shortest"] = tether["length"] - max(_most(gone, until), 0.0)
        time, value, path = [*time, t], [*value, v], [*path, gone.path]
    none = np.zeros(0)
    return bodies._replace(
        hoist_time=np.concatenate([none, *time]), hoist_value=np.concatenate([none, *value]),
        hoist_path=np.concatenate([none, *path]),
    )  # fmt: skip
