"""Pantographs on the system: what presses them to the wire grows with time, and where they begin they just touch it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.pantograph_matrices import matrices_of
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.history import SpeedTable
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.scenario import Scenario
from ropewalk.overhead.pantograph_loads import expected_lift, push_of
from ropewalk.overhead.section import Section
from ropewalk.system.contact.contact_record import ON
from ropewalk.system.elements.structure import SystemState
from ropewalk.system.loads.bodies import PUSHED, BodyArrays

_PARTS = 64  # of a time in which the speed varies, between which the square of it is a straight line


def with_pantographs(
    bodies: BodyArrays, scenario: Scenario, places: int, until: float, sections: Mapping[str, Section]
) -> BodyArrays:
    """Bodies with the forces on the masses of pantographs, constant ones and those that change in time.

    Args:
        bodies: all that have a mass.
        scenario: what is there.
        places: number of coordinates that are places of contacts; those of bodies come after them.
        until: how long histories are needed, s.
        sections: overhead lines at rest, by names.
    """
    rows, times, values, begin = list[tuple[int, int, int]](), list[Array](), list[Array](), 0
    force = bodies.force.copy()
    for _, load, first in _each(scenario, bodies, places):
        section = sections[load.on]
        time, pushes = _histories(load, section, until)
        for i, row in enumerate(pushes.T):
            if np.ptp(row) == 0.0:
                force[first + i] += row[0]
                continue
            rows.append((first + i, begin, time.size))
            times.append(time)
            values.append(row)
            begin += time.size
    none = np.zeros(0)
    return bodies._replace(
        force=force, pushed=np.array(rows, dtype=PUSHED) if rows else bodies.pushed,
        push_time=np.concatenate([none, *times]), push_value=np.concatenate([none, *values]),
    )  # fmt: skip


def _each(scenario: Scenario, bodies: BodyArrays, places: int) -> Iterator[tuple[int, Pantograph, int]]:
    """All pantographs, with their numbers among the loads and those of their first coordinates."""
    for number, load in enumerate(scenario.loads.values()):
        if isinstance(load, Pantograph):
            yield number, load, places + int(np.flatnonzero(bodies.load[places:] == number)[0])


def _histories(load: Pantograph, section: Section, until: float) -> tuple[Array, Array]:
    """Instants in s, and forces on all coordinates then (instant, coordinate), N; they are linear in between."""
    course, lift = Travelled(*speed_table(load.travel.speed, until)), 0.0
    if load.wanted_mean is not None:
        mean = push_of(load, section.level).wanted(course.speed(np.array([0.5 * until])))
        lift = expected_lift(section, float(mean[0]))
    push, speed = push_of(load, section.level, lift), load.travel.speed
    knots = {0.0, load.ramp, max(until, load.ramp)}
    knots |= set(speed.time) if isinstance(speed, SpeedTable) else set()
    parts = _PARTS if isinstance(speed, SpeedTable) or callable(speed) else 1
    times = np.unique([np.linspace(a, b, parts + 1) for a, b in pairwise(sorted(knots))])
    return times, push(times, course.speed(times))


def stand_below(scenario: Scenario, contacts: Any, bodies: BodyArrays, places: int, state: SystemState) -> None:
    """Let pantographs begin below the lowest wire that they are at: level, touching it, no spring pressed.

    Args:
        scenario: what is there.
        contacts: records, which are located.
        bodies: all that have a mass.
        places: number of coordinates that are places of contacts.
        state: coordinates of pantographs and their velocities are changed.
    """
    axes = state.r.shape[0]
    for number, load, first in _each(scenario, bodies, places):
        own: Integers = np.flatnonzero(contacts["load"] == number)
        on = own[contacts["state"][own] == ON]
        if not on.size:
            continue
        height, count = float(contacts["p"][on, axes - 1].min()), matrices_of(load)[0].shape[0]
        state.u[first : first + count], state.w[first : first + count] = 0.0, 0.0
        state.u[first : first + len(load.parts.masses)] = height
        for k in own:
            at = int(contacts[k]["first"]) + np.arange(axes)
            state.u[at], state.w[at] = contacts[k]["p"][:axes], 0.0
            state.u[at[-1]] = height
