"""A window: only a stretch around the contacts moves, the rest of all lines stands still.

How far a node is from the contacts is measured along the lines, through what joins them. What is beyond the window is
no part of its runs: a run within it is shorter, and some nodes at its ends stand still, so that what is cut there acts
on none that moves. Waves come back from the ends of the window as from supports; what a node has of kinetic energy
where the window leaves it is lost, and its displacement stays.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.system.contacts import AWAY, FREE, GONE
from ropewalk.system.structure import DAMPED, Buffers, Structure, SystemState
from ropewalk.system.travel import Tables

# Nodes at a cut that stand still: three links on, second differences and their own are whole.
STILL = 4
# Part of the window that contacts travel before it follows them, and the most steps that it waits.
WAITS, LONGEST = 0.1, 1000


class Window:
    """The window of a motion.

    Args:
        structure: all of it.
        width: m, on both sides of each contact.
    """

    def __init__(self, structure: Structure, width: float) -> None:
        self.whole, self._width = structure, width
        restrained, runs = structure.restraints, structure.runs
        self._joined: list[list[tuple[int, int]]] = [[] for _ in runs.first]  # restraints of each run, and where
        for e in range(restrained.mass.size):
            for node in restrained.members(e).tolist():
                s = int(np.searchsorted(runs.first, node, side="right")) - 1
                self._joined[s].append((e, node - int(runs.first[s])))
        self.still = np.zeros(restrained.mass.size, dtype=np.bool_)  # restraints that do

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
        self.still[:] = near > reach
        low, high = np.zeros_like(runs.first), np.zeros_like(runs.first)
        light = np.zeros_like(whole.nodes.light)
        for s, h in enumerate(runs.h):
            n = int(runs.links[s])
            spans = [(x - reach, x + reach) for x in places[s]]
            spans += [
                (i * h - reach + near[e], i * h + reach - near[e]) for e, i in self._joined[s] if near[e] <= reach
            ]
            if not spans:
                high[s] = min(2, n)
                continue
            first = max(int(np.floor(min(a for a, _ in spans) / h)), 0)
            last = min(int(np.ceil(max(b for _, b in spans) / h)), n)
            begin = int(runs.first[s])
            light[begin + first : begin + last + 1] = whole.nodes.light[begin + first : begin + last + 1]
            low[s], high[s] = max(first - STILL, 0), min(last + STILL, n)
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
        """How far restraints are from contacts along the lines, m; `places` of contacts on each run, m along it."""
        near, h = np.full(self.whole.restraints.mass.size, np.inf), self.whole.runs.h
        while True:
            before = near.copy()
            for s, joined in enumerate(self._joined):
                known = [(x, 0.0) for x in places[s]] + [(i * h[s], near[e]) for e, i in joined]
                for e, i in joined:
                    near[e] = min(near[e], *(away + abs(x - i * h[s]) for x, away in known))
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
