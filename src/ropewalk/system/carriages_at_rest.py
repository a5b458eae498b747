"""Carriages where they begin: wheels that nothing rolls, hauling ropes that hold them, cabins below."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.loading import Loading
from ropewalk.model.carriage import Carriage
from ropewalk.model.scenario import Scenario
from ropewalk.system.bodies import BodyArrays
from ropewalk.system.carriages import to_drive_entry
from ropewalk.system.structure import Buffers, Structure

# Rounds in which places of wheels are found, and the push along the line over that across it that is none any more.
_ROUNDS, _EVEN = 12, 1e-6


class CarriagesAtRest:
    """All carriages of a motion before it begins.

    Args:
        scenario: what is there.
        loading: its loads.
        contacts: records, changed.
        bodies: what has a mass; hauling ropes are changed.
        dim: number of axes.
    """

    def __init__(self, scenario: Scenario, loading: Loading, contacts: Any, bodies: BodyArrays, dim: int) -> None:
        self._scenario, self._loading, self._contacts, self._bodies = scenario, loading, contacts, bodies
        self._dim, self._pull = dim, np.zeros(bodies.carriages.hauls.size)
        self._last: dict[int, tuple[Array, Array]] = {}  # places and pushes of the round before
        self.rounds = _ROUNDS if bodies.carriages.bars.size else 0

    def _each(self) -> Iterator[tuple[Carriage, list[int]]]:
        for name, load in self._scenario.loads.items():
            if isinstance(load, Carriage):
                yield load, [k for k, wheel in enumerate(self._loading.wheels) if wheel.load == name]

    def _begin(self, own: list[int], load: Carriage, places: Array) -> None:
        """Let wheels begin at places of their line in m, moved so that their middle is where it is to be."""
        self._contacts["begin"][own] = load.travel.start + places - places.mean()
        self._contacts["been"][own] = 0  # they begin anew

    def space(self) -> None:
        """Let wheels begin as far apart as rockers have them, on a line that is stretched as where they stand."""
        contacts = self._contacts
        for load, own in self._each():
            apart = np.linalg.norm(np.diff(contacts["p"][own, : self._dim], axis=0), axis=1)
            gaps = np.diff(contacts["begin"][own]) * np.diff(load.places) / apart
            self._begin(own, load, np.concatenate([[0.0], np.cumsum(gaps)]))

    def roll(self, at_rest: Any) -> None:
        """Let wheels roll on until nothing pushes them along, but for what holds all alike.

        Args:
            at_rest: contacts as they rest together with the line; all have stayed at their places on it.
        """
        for load, own in self._each():
            found, begin = at_rest[own], self._contacts["begin"][own]
            push = found["push"] - found["push"].mean()
            if np.abs(push).max() <= _EVEN * np.abs(found["N"]).max():
                continue
            step = -push / (found["moving"] * (found["along"][:, : self._dim] ** 2).sum(axis=1))
            if own[0] in self._last:  # rockers and the line give way, too: as in the last round (Barzilai and Borwein)
                way, rise = begin - self._last[own[0]][0], push - self._last[own[0]][1]
                step = -push * float(way @ rise) / float(rise @ rise)
            self._last[own[0]] = begin, push
            self._begin(own, load, begin + step)

    def hold(self) -> None:
        """Let hauling ropes pull as holds carriages on frictionless wheels where they are, N.

        Of two carriages on one rope it is the mean of what both need.
        """
        for i, haul in enumerate(self._bodies.carriages.hauls):
            ends = [(haul["first"], haul["wheels"]), (haul["other"], haul["others"])][: 2 - haul["driven"]]
            needed, ways = 0.0, []
            for first, count in ends:
                load = self._scenario.loads[self._loading.wheels[first].load]
                way = self._contacts["along"][first : first + count, : self._dim]
                assert isinstance(load, Carriage)
                ways.append(way / np.linalg.norm(way, axis=1)[:, None])
                needed += load.whole * self._scenario.gravity * float(ways[-1][:, -1].mean()) / len(ends)
            self._pull[i] = max(float(haul["to"]) * needed, 0.0)
            for (first, count), way in zip(ends, ways, strict=True):
                self._contacts["hauled"][first : first + count, : self._dim] = haul["to"] * self._pull[i] / count * way

    def hang(self, u: Array, w: Array) -> None:
        """Put cabins below, with the angles of their hangers at the start, and let them go along.

        Args:
            u: coordinates of what has a mass, m, changed.
            w: their velocities, m/s, changed.
        """
        carriages, axes = self._bodies.carriages, np.arange(self._dim)
        swings = [load.cabin.swing for load, _ in self._each() if load.cabin is not None]
        hangers = [bar for bar in carriages.bars if bar["frame"] >= 0]
        for bar, swing in zip(hangers, swings, strict=True):
            wheels, cabin = carriages.ends(bar)
            first = int(cabin[0])
            way = np.zeros(self._dim)
            way[0], way[-1] = np.sin(swing), -np.cos(swing)
            weight = float(-self._bodies.force[first + self._dim - 1])
            length = float(bar["length"]) + weight * np.cos(swing) / float(bar["stiffness"])
            u[first + axes] = u[wheels[:, None] + axes].mean(axis=0) + length * way
            w[first + axes] = w[wheels[:, None] + axes].mean(axis=0)

    def pay_out(self, structure: Structure, buffers: Buffers) -> None:
        """Let hauling ropes be as long as makes them pull where carriages stand as they did there at rest."""
        contacts = self._contacts
        line = structure.lines, structure.runs, buffers.length, contacts
        for haul, own in zip(self._bodies.carriages.hauls, self._pull, strict=True):
            far = to_drive_entry(*line, haul["first"], haul["wheels"], haul["to"]) + haul["beyond"]
            if not haul["driven"]:
                far += to_drive_entry(*line, haul["other"], haul["others"], haul["to"])
                far += haul["beyond"]
            haul["strain"] = own / haul["stiffness"]
            haul["length"], haul["pull"] = far / (1.0 + haul["strain"]), own
