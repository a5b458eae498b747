"""What travels on a network: where its contacts are at which time, and with which force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.mechanics.assembly import speed_table, vector_table
from ropewalk.mechanics.contact_points import ContactPoint, wheels_of
from ropewalk.mechanics.multibody_system import MARGIN
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.line import Line
from ropewalk.model.load import MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.scenario import Scenario
from ropewalk.model.travel import Travel
from ropewalk.networks.network import (
    FORCE,
    LEAVES,
    MASS,
    OFF,
    REFUSED,
    STAYS,
    Array,
    ContactSchedule,
    Integers,
    Locations,
)

_AXES = ("x", "y", "z")
_AT_END = {"leave": LEAVES, "stay": STAYS, "refuse": REFUSED}


@dataclass(frozen=True, eq=False)
class MovingLoad:
    """A contact: its line or net, its mass, and how it advances."""

    name: str
    on: str
    mass: float  # kg
    knots: Array  # (4, knot): time in s, place in m, speed in m/s and slope of the speed in m/s^2 after it
    at_end: int  # LEAVES, STAYS or REFUSED
    share: float  # of its line, how far from the ends of that these are for it
    force_time: Array
    force: Array  # (3, entry) N

    @property
    def kind(self) -> int:
        """FORCE or MASS."""
        return MASS if self.mass else FORCE


@dataclass(frozen=True, eq=False)
class Strand:
    """A line of a network: its nodes in order and where they are along it."""

    name: str
    node: Integers
    station: Array  # m, unstrained
    first: int  # its first link


def moving_loads_of(scenario: Scenario, until: float) -> list[MovingLoad]:
    """All contacts of all loads on lines."""
    return [
        _moving_load(wheel, scenario.loads[wheel.load], scenario.lines[wheel.on], until)
        for wheel in wheels_of(scenario)
    ]


def _moving_load(wheel: ContactPoint, load: Any, line: Line, until: float) -> MovingLoad:
    times, force = vector_table(wheel.force, until, _AXES)
    assert isinstance(load, MovingForce | MovingMass)
    assert isinstance(load.travel, Travel)
    share = MARGIN / line.elements if wheel.mass else 0.0
    knots = _course(wheel.start, wheel.speed, until)
    return MovingLoad(wheel.name, wheel.on, wheel.mass, knots, _AT_END[load.travel.at_end], share, times, force)


def _course(start: float, speed: Any, until: float) -> Array:
    """Knots of a travel whose speed is linear between the entries of a table; up to `until`, which changes none."""
    times, values = speed_table(speed, until)
    later, end = times > 0.0, max(until, 1e-300)
    t = np.concatenate(([0.0], times[later]))
    v = np.concatenate((values[:1] if times[0] > 0.0 else [np.interp(0.0, times, values)], values[later]))
    gap = np.diff(t)
    slope = np.concatenate((np.divide(np.diff(v), gap, out=np.zeros_like(gap), where=gap > 0.0), [0.0]))
    knots = np.array([t, start + Travelled(t, v).path, v, slope])[:, t < end]
    (_, there, rate, change), late = knots[:, -1], end - knots[0, -1]
    last = [[end], [there + late * (rate + 0.5 * change * late)], [rate + change * late], [0.0]]
    return np.concatenate([knots, last], axis=1)


def course_of(moving_loads: list[MovingLoad], lengths: Mapping[str, float]) -> ContactSchedule:
    """All contacts as tables; `lengths` of lines in m."""

    def first(counts: list[int]) -> Any:
        return np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64) if counts else np.zeros(0, np.int64)

    knots, forces = ([a.shape[-1] for a in arrays] for arrays in (
        [c.knots for c in moving_loads], [c.force for c in moving_loads]))  # fmt: skip
    time, place, speed, slope = np.concatenate([np.zeros((4, 0)), *(c.knots for c in moving_loads)], axis=1).copy()
    length = np.array([lengths[c.on] for c in moving_loads], dtype=float)
    start, share = np.array([(c.knots[1, 0], c.share) for c in moving_loads]).reshape(-1, 2).T
    buffers = share * length
    return ContactSchedule(
        first(knots), np.array(knots, dtype=np.int64), time, place, speed, slope, length,
        np.minimum(buffers, np.maximum(start, 0.0)), np.maximum(length - buffers, np.minimum(start, length)),
        np.array([c.at_end for c in moving_loads], dtype=np.int64),
        first(forces), np.array(forces, dtype=np.int64),
        np.concatenate([np.zeros(0), *(c.force_time for c in moving_loads)]),
        np.concatenate([np.zeros((3, 0)), *(c.force for c in moving_loads)], axis=1),
    )  # fmt: skip


def locations_of(moving_loads: list[MovingLoad], strands: Sequence[Strand]) -> Locations:
    """All contacts, nowhere yet."""
    contacts = len(moving_loads)
    strand, begin = {}, 0
    for one in strands:
        strand[one.name] = one, begin
        begin += one.station.size
    first, segments, base, cell = np.zeros((4, contacts), dtype=np.int64)
    for k, t in enumerate(moving_loads):
        one, base[k] = strand[t.on]
        first[k], segments[k], cell[k] = one.first, one.node.size - 1, one.first
    off, weight, load = np.full(contacts, -1, dtype=np.int64), np.zeros((contacts, 2)), np.zeros((contacts, 3))
    wanted = np.array([t.kind for t in moving_loads], dtype=np.int64)
    return Locations(
        kind=np.full(contacts, OFF, dtype=np.int64), wanted=wanted,
        first=first.copy(), segments=segments.copy(), xi=np.zeros(contacts), load=load, speed=np.zeros(contacts),
        cell=cell.copy(), split_link=off, last=off.copy(), weight=weight,
        station=np.concatenate([np.zeros(0), *(one.station for one in strands)]), first_station=base.copy(),
        mass=np.array([t.mass for t in moving_loads], dtype=float),
    )  # fmt: skip
