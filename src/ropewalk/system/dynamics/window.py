"""A window: only a stretch around the contacts moves, all other parts of lines stand still.

Distances from contacts are measured along lines, through joints. Runs end at the window, and some nodes at its ends
stand still, so that what is cut there acts on none that moves: waves return from there as from supports. The kinetic
energy of a node that the window leaves is lost. A bridge under a track moves as a whole as soon as the window comes.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.csgraph import connected_components

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.contact.contact_record import AWAY, FREE, GONE
from ropewalk.system.contact.tables import Tables
from ropewalk.system.elements.structure import DAMPED, Buffers, Runs, Structure, SystemState
from ropewalk.system.elements.ties import Ties

# Nodes at a cut that stand still: three links on, second differences and their own are whole.
STILL = 4
# Part of the window that contacts travel before it follows them, and the most steps that it waits.
WAITS, LONGEST = 0.1, 1000


class Window:
    """The window of a motion.

    Args:
        structure: all of it.
        width: m, on both sides of each contact.
        bridges: runs that move as a whole.
    """

    def __init__(self, structure: Structure, width: float, bridges: Collection[int] = ()) -> None:
        self.whole, self._width, self._bridges = structure, width, bridges
        restrained, runs = structure.restraints, structure.runs
        joints = [_points(structure, restrained.members(e)) for e in range(restrained.mass.size)]
        self._columns = columns_of(structure.ties, runs, structure.nodes.mass.size)
        joints += [column.points for column in self._columns]
        where = [(run, e, at) for e, points in enumerate(joints) for run, at in points]
        here = [[(e, at) for run, e, at in where if run == s] for s in range(runs.h.size)]
        # Of each run: numbers of the joints on it, restraints and then columns, and where they are, m.
        self._joined = [(np.array([e for e, _ in own], dtype=np.int64), np.array([x for _, x in own])) for own in here]
        self.still = np.zeros(restrained.mass.size, dtype=np.bool_)  # restraints that do

    @staticmethod
    def of(scenario: Scenario, assembled: Assembled, width: float) -> Window:
        """The window of a scenario that is laid out, on both sides of its contacts, m."""
        over = {name for track in scenario.tracks.values() for name in track.over}
        bridges = [s for s, name in enumerate(assembled.line) if name in over]
        return Window(assembled.structure, width, bridges)

    def wait(self, contacts: Any, tables: Tables, step: float) -> int:
        """For how many steps of a length in s contacts stay where the window is open, at their largest speeds."""
        fastest = 0.0
        for contact in contacts[contacts["state"] != GONE]:
            first = int(contact["speed_first"])
            speeds = [abs(float(contact["speed"]))]
            if contact["travel"] != FREE:
                speeds.append(float(np.abs(tables.speed_value[first : first + int(contact["speed_count"])]).max()))
            fastest = max(fastest, *speeds)
        return int(np.clip(WAITS * self._width / max(fastest * step, 1e-300), 1, LONGEST))

    def around(self, contacts: Any, state: SystemState) -> Structure:
        """The structure with what is within the window alone; all of it if no contact is near a line."""
        whole, reach = self.whole, (1.0 + 2.0 * WAITS) * self._width
        runs, lines = whole.runs, whole.lines
        places: list[list[float]] = [[] for _ in runs.first]
        for contact, s in zip(contacts, state.s, strict=True):
            line, length = int(contact["line"]), float(lines.length[contact["line"]])
            if contact["state"] == GONE or not -reach <= s <= length + reach:
                continue
            if contact["state"] == AWAY and contact["been"] == 1:
                continue
            own = np.arange(lines.first[line], lines.first[line] + lines.runs[line])
            run = int(own[max(int(np.searchsorted(lines.begin[own], s, side="right")) - 1, 0)])
            places[run].append(float(np.clip(s - lines.begin[run], 0.0, runs.links[run] * runs.h[run])))
        self.still[:] = False
        if not any(places):
            return whole
        near = self._distances(places)
        self.still[:] = near[: self.still.size] > reach
        low, high = np.zeros_like(runs.first), np.zeros_like(runs.first)
        light = np.zeros_like(whole.nodes.light)
        for s, h in enumerate(runs.h):
            n = int(runs.links[s])
            spans = [(x - reach, x + reach) for x in places[s]]
            joined = zip(*self._joined[s], strict=True)
            spans += [(x - reach + near[e], x + reach - near[e]) for e, x in joined if near[e] <= reach]
            if spans and s in self._bridges:
                spans = [(0.0, n * h)]
            if not spans:
                high[s] = min(2, n)
                continue
            first = max(int(np.floor(min(a for a, _ in spans) / h)), 0)
            last = min(int(np.ceil(max(b for _, b in spans) / h)), n)
            begin = int(runs.first[s])
            light[begin + first : begin + last + 1] = whole.nodes.light[begin + first : begin + last + 1]
            low[s], high[s] = max(first - STILL, 0), min(last + STILL, n)
        for column, away in zip(self._columns, near[self.still.size :], strict=True):
            if away <= reach:
                light[column.masses] = whole.nodes.light[column.masses]
        clamped = runs.clamped * np.stack([low == 0, high == runs.links], axis=1)
        restrained, moves = whole.restraints, ~self.still
        return whole._replace(
            runs=runs._replace(first=runs.first + low, links=high - low, clamped=clamped),
            lines=lines._replace(begin=lines.begin + low * runs.h),
            nodes=whole.nodes._replace(light=light),
            restraints=restrained._replace(
                free=restrained.free * moves[:, None, None], entries=np.where(moves, restrained.entries, 1)
            ),
        )  # fmt: skip

    def _distances(self, places: list[list[float]]) -> Array:
        """How far joints are from contacts along the lines, m; `places` of contacts on each run, m along it."""
        near = np.full(self.whole.restraints.mass.size + len(self._columns), np.inf)
        while True:
            before = near.copy()
            for s, ((e, x), own) in enumerate(zip(self._joined, places, strict=True)):
                if e.size:
                    known, away = np.concatenate([own, x]), np.concatenate([np.zeros(len(own)), near[e]])
                    along = 0.0 if s in self._bridges else np.abs(known - x[:, None])
                    np.minimum.at(near, e, np.min(away + along, axis=-1))
            if np.array_equal(near, before):
                return near

    def leave(self, narrow: Structure, state: SystemState, buffers: Buffers) -> None:
        """Let what the window has left stand still."""
        nodes, restrained = self.whole.nodes, self.whole.restraints
        stands = (narrow.nodes.light == 0.0) & (nodes.light > 0.0)
        lost = 0.5 * float((nodes.mass * state.v**2)[:, stands].sum())
        for e in np.flatnonzero(self.still):
            own = restrained.members(int(e))
            lost += 0.5 * float(
                (nodes.mass[own] * state.v[:, own] ** 2).sum() + restrained.mass[e] * (state.v[:, own[0]] ** 2).sum()
            )
            stands[own] = True
        state.work[DAMPED] += lost
        state.v[:, stands] = 0.0
        buffers.rate[stands] = 0.0


class TiedColumn(NamedTuple):
    """Ties with the masses between them, which join points of runs as a sleeper with its pads and ballast does."""

    points: list[tuple[int, float]]  # runs, and m along them
    masses: Integers  # nodes


def columns_of(ties: Ties | None, runs: Runs, nodes: int) -> list[TiedColumn]:
    """What ties join: those with a mass in common are one column.

    Args:
        ties: of a structure.
        runs: whose points they tie.
        nodes: how many there are, those of runs and masses.
    """
    if ties is None or not ties.first.size:
        return []
    on_run = np.zeros(nodes, dtype=np.bool_)
    for first, links in zip(runs.first.tolist(), runs.links.tolist(), strict=True):
        on_run[first : first + links + 1] = True
    parts = ties.parts(nodes).tocsc()
    masses = abs(parts) @ sparse.diags(np.where(on_run, 0.0, 1.0))
    count, group = connected_components(masses @ masses.T, directed=False)
    found = []
    for number in range(count):
        own = parts[group == number].tocoo()
        points: list[tuple[int, float]] = []
        for first, links, h, s in zip(runs.first, runs.links, runs.h, range(runs.h.size), strict=True):
            mine = (own.col >= first) & (own.col <= first + links) & on_run[own.col]
            if mine.any():
                i, part = own.col[mine] - first, own.data[mine]
                points.append((s, float(h * (part @ i) / part.sum())))
        found.append(TiedColumn(points, np.unique(own.col[~on_run[own.col]])))
    return found


def _points(structure: Structure, nodes: Integers) -> list[tuple[int, float]]:
    """Runs of nodes, and how far along them they are, m: those of sheaves and saddles where lines lie."""
    runs, sheaves, saddles = structure.runs, structure.sheaves, structure.saddles
    last, found = int((runs.first + runs.links).max()), list[tuple[int, float]]()
    for node in nodes.tolist():
        if node <= last:
            s = int(np.searchsorted(runs.first, node, side="right")) - 1
            found.append((s, float((node - runs.first[s]) * runs.h[s])))
            continue
        if sheaves is not None:
            for s in sheaves.run[sheaves.node == node].tolist():
                found += [(s, float(runs.links[s] * runs.h[s])), (s + 1, 0.0)]
        if saddles is not None:
            found += _points(structure, saddles.about.node[saddles.about.node[:, 1] == node, 0])
    return found
