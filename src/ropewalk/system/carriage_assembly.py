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
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.trolley import Trolley
from ropewalk.system.bodies import BodyArrays
from ropewalk.system.carriages import BAR, HAUL, Carriages

# Acceleration in m/s^2 with which the weight of a carriage stretches its bars by STRETCH, also where gravity is 0.
_G = 9.81
# Damping ratio of bars.
_RATIO = 0.05
# Instants at which is looked how far ropes are taken in, and the least part of a hauling rope that is left.
_INSTANTS, _LEAST = 1001, 1e-3


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
            haul, other = load.haul, on.get(load.haul.over_to or "", [-1])
            hauls.append({
                "first": on[name][0], "wheels": load.count, "other": other[0], "others": len(other),
                "to": 1 if haul.to == "end" else -1, "stiffness": haul.axial_stiffness, "damping": haul.axial_damping,
                "beyond": haul.beyond, "driven": int(haul.over_to is None), "length": shortest(scenario, load, haul),
                "hangs": int(haul.sags), "weight": haul.mass * scenario.gravity,
                "counter": haul.counter.tension if haul.counter is not None else 0.0,
                "counter_weight": haul.counter.mass * scenario.gravity if haul.counter is not None else 0.0,
            })  # fmt: skip
        _note_mobility(contacts, bodies, on[name], wheels)
    if not bars:
        return bodies
    return bodies._replace(
        carriages=Carriages(filled_records(BAR, bars), np.array(points, dtype=np.int64), filled_records(HAUL, hauls))
    )


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


def _most(taken_in: Travelled, until: float) -> float:
    """The most that is taken in of a rope until a time in s, m."""
    return float(taken_in.at(np.linspace(0.0, until, _INSTANTS)).max())


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
