"""Crabs: rigid bodies that stay level on several lines, at one place along x.

Contacts of a crab share its coordinates, and what each line bears is a matter of that line. Wheels roll: nothing is won
by moving one along its line, push = 0 (`contacts.py`). What is moved from outside has its place along x given, and the
force that moves it balances all others. Here is where wheels begin: at places of their lines that are at the crab's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.model.line import spatial
from ropewalk.model.scenario import Scenario
from ropewalk.system.contact.contact_record import BODY, ON
from ropewalk.system.elements.spline import WIDTH
from ropewalk.system.elements.structure import SystemState

# Rounds in which places of lines are found, and the miss in m that is none any more.
_ROUNDS, _CLOSE = 50, 1e-12
# Part of the force on a line that is no push along it any more, and of a place by which it is varied to find out.
_EVEN, _VARIED = 1e-7, 1e-9
# Part of these places to which they are found.
_FOUND = 1e-9


class Crabs:
    """All loads on several lines before they move.

    Args:
        scenario: what is there.
        wheels: of all loads.
        contacts: records, changed.
        bodies: what has a mass.
    """

    def __init__(self, scenario: Scenario, wheels: Sequence[ContactPoint], contacts: Any, bodies: Any) -> None:
        self._contacts, self._bodies = contacts, bodies
        self.each = list[list[int]]()
        for k, wheel in enumerate(wheels):
            if wheel.with_last and not wheels[k - 1].with_last:
                self.each.append([k - 1])
            if wheel.with_last:
                self.each[-1].append(k)
        for own in self.each:
            first, lines = wheels[own[0]], [scenario.lines[wheels[k].on] for k in own]
            contacts["moved"][own] = first.moved
            contacts["origin"][own] = lines[0].start[0] + first.start
            aside = np.array([spatial(line.start)[1] for line in lines])
            contacts["aside"][own, 1] = aside - aside.mean() if np.ptp(aside) > 0.0 else 0.0

    def reach(self, locate: Callable[[], object]) -> None:
        """Let wheels begin at places of their lines, as these are now, that are at their crab's place along x.

        Args:
            locate: puts all contacts where they begin.

        Raises:
            EquilibriumError: a line does not come to that place.
        """
        contacts = self._contacts
        for own in self.each:
            if not contacts["moved"][own[0]]:
                contacts["been"][own] = 0
                locate()
                contacts["origin"][own] = contacts["p"][own[0], 0]
            for _ in range(_ROUNDS):
                contacts["been"][own] = 0
                locate()
                if (contacts["state"][own] != ON).any():
                    raise EquilibriumError("a load on several lines would begin beyond the end of one of them")
                miss = contacts["origin"][own] - contacts["p"][own, 0]
                if np.abs(miss).max() <= _CLOSE * np.abs(contacts["origin"][own]).max():
                    break
                contacts["begin"][own] += miss / contacts["along"][own, 0]

    def roll(self, locate: Callable[[], object], settle: Callable[[], Any], state: SystemState) -> None:
        """Let wheels of crabs that rest with all loads roll until nothing pushes them along; something holds each crab.

        Args:
            locate: puts all contacts where they begin.
            settle: finds lines and loads at rest next to where they are; gives contacts there.
            state: where they are.

        Raises:
            EquilibriumError: there is no such rest.
        """
        contacts = self._contacts
        if not self.each:
            return
        moved, every = contacts["moved"].copy(), [k for own in self.each for k in own]
        lead = [i for own in self.each for i in (every.index(own[0]),) if not moved[own[0]]]  # they begin as told

        known = dict[bytes, Array]()

        def push(places: Array) -> Array:
            if places.tobytes() in known:  # the solver asks again for where it begins
                return known[places.tobytes()]
            for i, k in enumerate(every):
                if i not in lead:
                    contacts["begin"][k] = places[i]
            for own in self.each:
                if not moved[own[0]]:
                    contacts["origin"][own] = places[every.index(own[0])]
            contacts["been"][every] = 0
            state.u[contacts["first"][every]] = contacts["origin"][every]
            locate()
            known[places.tobytes()] = np.asarray(settle()[every]["push"] / weight)
            return known[places.tobytes()]

        contacts["moved"][every] = 0  # gripped by its lines each crab has moved along as they gave way
        locate()
        found = settle()[every]
        contacts["begin"][every] += (contacts["origin"][every] - state.u[found["first"]]) / found["along"][:, 0]
        contacts["moved"][every] = 1
        begin = np.where(np.isin(np.arange(len(every)), lead), contacts["origin"][every], contacts["begin"][every])
        weight = float(-self._bodies.force.sum())
        from scipy.optimize import root  # lazy: it takes long to import

        solved = root(push, begin, options={"xtol": _FOUND, "eps": _VARIED})
        even = np.abs(push(solved.x)).max() <= _EVEN
        contacts["moved"][:] = moved
        if not even:
            raise EquilibriumError("nothing holds a load on several lines there: they would have to yield too far")

    def hold(self, state: SystemState) -> None:
        """Note what holds crabs that are moved from outside, N, and how fast they are."""
        for own in self.each:
            first = self._contacts[own[0]]
            if not first["moved"]:
                continue
            force = float(first["given"][0] - self._contacts["N"][own, 0].sum())
            tethers = self._bodies.tethers
            for tether in tethers[tethers["contact"] == own[0]]:
                above, below = (int(at) + np.arange(state.r.shape[0]) for at in (first["first"], tether["first"]))
                way = state.u[below] - state.u[above]
                long = float(np.linalg.norm(way))
                force += float(tether["stiffness"] * max(long - tether["length"], 0.0) * way[0] / long)
            first["evened"], first["goes"] = -force, state.w[int(first["first"])]


def stand_on_lines(wheels: Sequence[ContactPoint], contacts: Any, state: SystemState) -> None:
    """Put bodies on their lines, with the speeds that they begin with; crabs where their contacts are on average.

    Args:
        wheels: in order.
        contacts: records, which are located; speeds of those that roll are noted.
        state: coordinates of bodies and their velocities are changed.
    """
    axes = state.r.shape[0]
    for wheel, contact in zip(wheels, contacts, strict=True):
        if wheel.moved and wheel.free is not None:
            contact["speed"] = wheel.free.speed / contact["along"][0]
        elif wheel.free is not None:
            contact["speed"] = wheel.free.speed / np.linalg.norm(contact["along"])
    on = np.flatnonzero((contacts["kind"] == BODY) & (contacts["state"] == ON))
    count = np.bincount(contacts["first"][on], minlength=state.u.size)
    at = contacts["first"][on][:, None] + np.arange(axes)
    state.u[at], state.w[at] = 0.0, 0.0
    for contact in contacts[on]:
        own, part = contact["first"] + np.arange(axes), 1.0 / count[contact["first"]]
        near = slice(contact["near"], contact["near"] + WIDTH)
        weight = contact["weight"][: state.v[0, near].size]
        state.u[own] += part * (contact["p"] - contact["aside"])[:axes]
        state.w[own] += part * (state.v[:, near] @ weight + contact["speed"] * contact["along"][:axes])
