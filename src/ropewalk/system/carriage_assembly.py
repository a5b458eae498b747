"""Carriages, hauling ropes and hoists of a scenario, as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import records
from ropewalk.mechanics.loading import Loading
from ropewalk.mechanics.multibody_system import STRETCH
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.carriage import Carriage
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.trolley import Trolley
from ropewalk.system.bodies import BodyArrays
from ropewalk.system.carriages import BAR, HAUL, Carriages, to_drive
from ropewalk.system.structure import Buffers, Structure

# Acceleration in m/s^2 with which the weight of a carriage stretches its bars by STRETCH, also where gravity is 0.
_G = 9.81
# Damping ratio of bars.
_RATIO = 0.05


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
            haul = load.haul
            other = on.get(haul.over_to or "", [-1])
            hauls.append({
                "first": on[name][0], "wheels": load.count, "other": other[0], "others": len(other),
                "to": 1 if haul.to == "end" else -1, "stiffness": haul.axial_stiffness, "damping": haul.axial_damping,
                "beyond": haul.beyond, "driven": int(haul.over_to is None), "length": 1.0,
            })  # fmt: skip
        _note_mobility(contacts, bodies, on[name], wheels)
    if not bars:
        return bodies
    return bodies._replace(
        carriages=Carriages(_filled(BAR, bars), np.array(points, dtype=np.int64), _filled(HAUL, hauls))
    )


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


def _filled(kind: np.dtype[Any], rows: list[dict[str, Any]]) -> Any:
    found = records(len(rows), kind)
    for record, row in zip(found, rows, strict=True):
        for key, value in row.items():
            record[key] = value
    return found


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
        tether["shortest"] = tether["length"] - max(float(gone.at(np.linspace(0.0, until, 1001)).max()), 0.0)
        time, value, path = [*time, t], [*value, v], [*path, gone.path]
    none = np.zeros(0)
    return bodies._replace(
        hoist_time=np.concatenate([none, *time]), hoist_value=np.concatenate([none, *value]),
        hoist_path=np.concatenate([none, *path]),
    )  # fmt: skip


def hang_cabins(scenario: Scenario, loading: Loading, bodies: BodyArrays, u: Array, w: Array, dim: int) -> None:
    """Put cabins below their carriages, with the angles of their hangers at the start, and let them go along."""
    swings = [load.cabin.swing for load in scenario.loads.values() if isinstance(load, Carriage) and load.cabin]
    hangers = [bar for bar in bodies.carriages.bars if bar["frame"] >= 0]
    for bar, swing in zip(hangers, swings, strict=True):
        wheels, cabin = bodies.carriages.ends(bar)
        axes, first = np.arange(dim), int(cabin[0])
        way = np.zeros(dim)
        way[0], way[-1] = np.sin(swing), -np.cos(swing)
        mass = float(-bodies.force[first + dim - 1])
        length = float(bar["length"]) + mass * np.cos(swing) / float(bar["stiffness"])
        u[first + axes] = u[wheels[:, None] + axes].mean(axis=0) + length * way
        w[first + axes] = w[wheels[:, None] + axes].mean(axis=0)


def space_wheels(scenario: Scenario, loading: Loading, contacts: Any, dim: int) -> None:
    """Let wheels of carriages begin as far apart as their rockers have them, on a line that is stretched."""
    for name, load in scenario.loads.items():
        if isinstance(load, Carriage):
            own = [k for k, wheel in enumerate(loading.wheels) if wheel.load == name]
            apart = np.linalg.norm(np.diff(contacts["p"][own, :dim], axis=0), axis=1)
            gaps = np.diff(contacts["begin"][own]) * np.diff(load.places) / apart
            places = np.concatenate([[0.0], np.cumsum(gaps)])
            contacts["begin"][own] = load.travel.start + places - places.mean()
            contacts["been"][own] = 0  # they begin anew


def hold_carriages(scenario: Scenario, loading: Loading, carriages: Carriages, contacts: Any) -> Array:
    """Let hauling ropes pull as holds carriages on frictionless wheels where they are; returns their pulls, (haul,) N.

    Of two carriages on one rope it is the mean of what both need.
    """
    dim, pulls = len(loading.axes), []
    for haul in carriages.hauls:
        ends = [(haul["first"], haul["wheels"]), (haul["other"], haul["others"])][: 2 - haul["driven"]]
        needed, ways = 0.0, []
        for first, count in ends:
            load, way = scenario.loads[loading.wheels[first].load], contacts["along"][first : first + count, :dim]
            assert isinstance(load, Carriage)
            ways.append(way / np.linalg.norm(way, axis=1)[:, None])
            needed += load.whole * scenario.gravity * float(ways[-1][:, -1].mean()) / len(ends)
        pulls.append(max(float(haul["to"]) * needed, 0.0))
        for (first, count), way in zip(ends, ways, strict=True):
            contacts["hauled"][first : first + count, :dim] = haul["to"] * pulls[-1] / count * way
    return np.array(pulls)


def pay_out(carriages: Carriages, structure: Structure, buffers: Buffers, contacts: Any, pull: Array) -> None:
    """Let hauling ropes be as long as makes them pull with (haul,) N where carriages stand."""
    for haul, own in zip(carriages.hauls, pull, strict=True):
        far = to_drive(structure, buffers, contacts, haul["first"], haul["wheels"], haul["to"]) + haul["beyond"]
        if not haul["driven"]:
            far += to_drive(structure, buffers, contacts, haul["other"], haul["others"], haul["to"]) + haul["beyond"]
        haul["strain"] = own / haul["stiffness"]
        haul["length"], haul["pull"] = far / (1.0 + haul["strain"]), own
