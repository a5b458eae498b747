"""Carriages where they begin: wheels that nothing rolls, hauling ropes that hold them, cabins below."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.hanging_rope import hang_by_tension_entry
from ropewalk.mechanics.loading import Loading
from ropewalk.model.carriage import Carriage
from ropewalk.model.scenario import Scenario
from ropewalk.system.elements.structure import Buffers, Structure
from ropewalk.system.loads.bodies import BodyArrays
from ropewalk.system.loads.hauling_ropes import lay_out_entry

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
        self._short = dict[str, float]()  # N, by which ropes would have to push, by names of their carriages
        self._last: dict[int, tuple[Array, Array]] = {}  # places and pushes of the round before
        self._u: Array | None = None  # m, coordinates, once they are known
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

    def hold(self, structure: Structure, r: Array) -> None:
        """Let hauling ropes pull as holds carriages on frictionless wheels where they are, N.

        Of two carriages on one rope it is the mean of what both need.

        Args:
            structure: what carries them.
            r: (axis, node) m.

        Raises:
            EquilibriumError: a rope that hangs freely cannot hold its carriage there.
        """
        for i, haul in enumerate(self._bodies.carriages.hauls):
            ends = [(haul["first"], haul["wheels"]), (haul["other"], haul["others"])][: 2 - haul["driven"]]
            ways = [self._way(first, count) for first, count in ends]
            haul["level"] = np.linalg.norm(self._to_station(structure, r, ends[0][0], int(haul["to"]))[:-1])
            back = [self._back(haul, structure, r, first) for first, _ in ends]
            needed = [
                self._weight(first) * float(way[:, -1].mean()) for (first, _), way in zip(ends, ways, strict=True)
            ]
            if haul["hangs"]:
                (first, count), way = ends[0], ways[0].mean(axis=0)
                self._pull[i], free = self._hang(haul, structure, r, needed[0] - float(back[0] @ way))
                self._contacts["hauled"][first : first + count, : self._dim] = (free + back[0]) / count
                continue
            # what pulls back, pulls along the line
            need = [float(haul["to"]) * own + float(np.linalg.norm(b)) for own, b in zip(needed, back, strict=True)]
            self._pull[i] = max(float(np.mean(need)), 0.0)
            self._short[self._loading.wheels[int(haul["first"])].load] = max(-float(np.mean(need)), 0.0)
            for (first, count), way, b in zip(ends, ways, back, strict=True):
                along = haul["to"] * (self._pull[i] - np.linalg.norm(b)) / count
                self._contacts["hauled"][first : first + count, : self._dim] = along * way

    def slack(self) -> list[str]:
        """Hauling ropes, in words, that would have to push to hold their carriages where they begin."""
        return [
            f"the hauling rope of {name} is slack at t = 0 s: there the track rope falls towards its drive, with "
            f"{short:.4g} N along it, and a rope only pulls, so that {name} rolls on by itself; begin where it rises "
            f"towards the drive, give loads.{name}.haul a counter rope, or write a driver instead"
            for name, short in self._short.items()
            if short > 0.0
        ]

    def _weight(self, first: int) -> float:
        """Weight of the carriage with this first contact, N."""
        load = self._scenario.loads[self._loading.wheels[first].load]
        assert isinstance(load, Carriage)
        return load.whole * self._scenario.gravity

    def _way(self, first: int, count: int) -> Array:
        """Unit vectors along the line at some contacts, (contact, axis)."""
        way = self._contacts["along"][first : first + count, : self._dim]
        return np.asarray(way / np.linalg.norm(way, axis=1)[:, None])

    def _to_station(self, structure: Structure, r: Array, first: int, to: int) -> Array:
        """From the middle of a carriage to the end (`to` is 1) or the start (-1) of its line, (axis,) m."""
        load, lines, runs = self._loading.wheels[first].load, structure.lines, structure.runs
        own = self._contacts[[k for k, wheel in enumerate(self._loading.wheels) if wheel.load == load]]
        axes = np.arange(self._dim)
        place = own["p"][:, : self._dim] if self._u is None else self._u[own["first"][:, None] + axes]
        s = int(lines.first[self._contacts[first]["line"]])
        node = int(runs.first[s])
        if to > 0:
            s += int(lines.runs[self._contacts[first]["line"]]) - 1
            node = int(runs.first[s] + runs.links[s])
        return np.asarray(r[:, node] - place.mean(axis=0))

    def _back(self, haul: Any, structure: Structure, r: Array, first: int) -> Array:
        """Pull of the counter rope at a carriage, (axis,) N; towards its station where it is led."""
        if not haul["counter"]:
            return np.zeros(self._dim)
        away = self._to_station(structure, r, first, -int(haul["to"]))
        pull = max(float(haul["counter"] - haul["counter_weight"] * away[-1]), 0.0)
        if not haul["hangs"]:
            return np.asarray(pull * away / np.linalg.norm(away))
        if haul["towers"]:
            along = -float(haul["to"]) * self._way(first, int(haul["wheels"])).mean(axis=0)
            weighs = self._weighs(haul, along, away, float(haul["counter_weight"]), -int(haul["to"]))
            return np.asarray(np.sqrt(max(pull**2 - float(weighs @ weighs), 0.0)) * along + weighs)
        far = float(np.linalg.norm(away[:-1]))
        level, up = hang_by_tension_entry(far, float(away[-1]), float(haul["counter"]), float(haul["counter_weight"]))
        return np.append(level * away[:-1] / far, up)

    def _weighs(self, haul: Any, along: Array, away: Array, weight: float, to: int) -> Array:
        """Half of the rope from a carriage to the next roller or station, across its way, (axis,) N.

        Args:
            haul: the hauling rope.
            along: (axis,) unit vector from the carriage on.
            away: (axis,) m, to the station.
            weight: N/m.
            to: 1 towards the end of the line, -1 towards its start.
        """
        far, ahead = float(np.linalg.norm(away[:-1])), self._bodies.carriages.towers
        ahead = ahead[haul["tower"] : haul["tower"] + haul["towers"], 1]
        level = far if to == haul["to"] else float(haul["level"])
        between = level - ahead if to == haul["to"] else ahead - level
        span = float(np.linalg.norm(away)) * min([*between[between > 0.0].tolist(), far]) / far
        return np.asarray(0.5 * weight * span * (float(along[-1]) * along - np.eye(self._dim)[-1]))

    def _hang(self, haul: Any, structure: Structure, r: Array, needed: float) -> tuple[float, Array]:
        """Pull of a rope that hangs freely, N, and all that it does to its carriage, (axis,) N.

        Args:
            haul: the rope.
            structure: what carries it.
            r: (axis, node) m.
            needed: N, along the line and as it goes, of both.
        """
        away = self._to_station(structure, r, int(haul["first"]), int(haul["to"]))
        way = self._way(haul["first"], haul["wheels"]).mean(axis=0)
        along = way * haul["to"] if haul["towers"] else away / np.linalg.norm(away)
        weighs = self._weighs(haul, along, away, float(haul["weight"]), int(haul["to"]))
        pull = (needed - float(weighs @ way)) / float(along @ way)
        if pull <= 0.0:
            name = self._loading.wheels[int(haul["first"])].load
            raise EquilibriumError(
                f"the hauling rope of {name} cannot hold it where it begins, which takes {haul['to'] * needed:.4g} N "
                "along its line: let it begin where the line rises towards its drive, or give haul a counter rope"
            )
        return pull, pull * along + weighs

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

    def pay_out(self, structure: Structure, buffers: Buffers, r: Array, u: Array) -> None:
        """Let hauling ropes be as long as makes them pull where carriages stand as they did there at rest.

        Args:
            structure: what carries them.
            buffers: lengths of its links.
            r: (axis, node) m.
            u: coordinates of what has a mass, m.
        """
        contacts, carriages, self._u = self._contacts, self._bodies.carriages, u
        if carriages.hauls["hangs"].any():  # they feel how far carriages press down the line below them
            self.hold(structure, r)
        now = structure.for_kernels, buffers.for_kernels(structure)
        for e, haul in enumerate(carriages.hauls):
            load = self._scenario.loads[self._loading.wheels[int(haul["first"])].load]
            assert isinstance(load, Carriage)
            assert load.haul is not None
            speed = speed_table(load.haul.speed, 0.0)[1][0] if load.haul.speed is not None else 0.0
            lay_out_entry(carriages, *now, r, u, contacts, e, float(self._pull[e]), float(speed))
