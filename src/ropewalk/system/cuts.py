"""Lines that are cut on the way: two nodes that were kept together part, each with its half of the mass.

Both have one place and one velocity when they part, and what kept them together did no work: energy goes on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.mechanics.chain import Array
from ropewalk.model.scenario import Scenario
from ropewalk.system import motion
from ropewalk.system.asking import Asking
from ropewalk.system.assembled import Assembled
from ropewalk.system.structure import Structure


@dataclass(frozen=True)
class _Cut:
    """A cut: when, s; the restraint of both nodes, behind which an empty one stands."""

    line: str
    number: int
    at: float  # m
    time: float
    restraint: int


class Cuts:
    """All cuts of lines.

    Args:
        scenario: what is there.
        assembled: the same as arrays, of which restraints change.
        contacts: of loads.
        places: (contact,) m, along their lines; changes.
    """

    def __init__(self, scenario: Scenario, assembled: Assembled, contacts: Any, places: Array) -> None:
        structure = assembled.structure
        self._structure, self._contacts, self._places = structure, contacts, places
        names = [name for name, line in scenario.lines.items() if line.cut is not None]
        self._cuts = [_found(scenario, assembled, name) for name in names]
        self._done = np.zeros(len(self._cuts), dtype=np.bool_)
        self._behind = np.zeros((len(self._cuts), contacts.size), dtype=np.int64)

    def next(self) -> float:
        """The next instant in s at which a line is cut; infinity: there is none."""
        ahead = [cut.time for cut, done in zip(self._cuts, self._done, strict=True) if not done]
        return min(ahead, default=float("inf"))

    def to(self, asking: Asking, end: float) -> int:
        """Go on to a time in s, and cut on the way what is to be cut; returns as `Asking.to`."""
        while (time := self.next()) <= end:
            if time > asking.carrier.t and (status := asking.to(time)) != motion.RUNNING:
                return status
            self.cut_until(time)
        return asking.to(end) if end > asking.carrier.t else motion.RUNNING

    def cut_until(self, t: float) -> None:
        """Cut what is to be cut up to t in s."""
        for i, cut in enumerate(self._cuts):
            if not self._done[i] and cut.time <= t * (1.0 + 1e-12):
                self._done[i] = True
                self._behind[i] = self._sides(cut)
                _part(self._structure, cut.restraint, parted=True)

    def crossed(self) -> str | None:
        """A load that has come to the cut of its line."""
        for i, cut in enumerate(self._cuts):
            if self._done[i] and np.any((self._sides(cut) != self._behind[i]) & (self._contacts["state"] == 1)):
                return f"a load has come to where line {cut.line} is cut; let it stay on its side, or end before"
        return None

    def _sides(self, cut: _Cut) -> Any:
        own = self._contacts["line"] == cut.number
        return np.where(own, np.where(self._places < cut.at, -1, 1), 0)

    def get_state(self) -> Tree:
        """What has been cut."""
        return {"done": self._done.copy(), "behind": self._behind.copy()}

    def set_state(self, tree: Tree) -> None:
        """Lines as they were then."""
        self._done[:], self._behind[:] = tree["done"], tree["behind"]
        for cut, done in zip(self._cuts, self._done, strict=True):
            _part(self._structure, cut.restraint, parted=bool(done))


def runs_ahead_of_cuts(scenario: Scenario, line: Sequence[str], begin: Array) -> list[int]:
    """Runs behind whose last node a line is cut.

    Args:
        scenario: what is there.
        line: (run,) names.
        begin: (run,) m, where each begins on its line.
    """
    found = []
    for s in range(len(line) - 1):
        cut = scenario.lines[line[s]].cut if line[s] in scenario.lines else None
        if cut is not None and line[s + 1] == line[s] and abs(begin[s + 1] - cut.at) <= 1e-6 * cut.at:
            found.append(s)
    return found


def _found(scenario: Scenario, assembled: Assembled, name: str) -> _Cut:
    structure, cut = assembled.structure, scenario.lines[name].cut
    assert cut is not None
    begin = structure.lines.begin
    (s,) = [s for s in runs_ahead_of_cuts(scenario, assembled.line, begin) if assembled.line[s] == name]
    node, restrained = int(structure.runs.first[s + 1]), structure.restraints
    (e,) = [e for e in range(restrained.mass.size) if node in restrained.members(e)]
    numbers = list(dict.fromkeys(assembled.line))
    return _Cut(name, numbers.index(name), cut.at, cut.time, e)


def _part(structure: Structure, e: int, *, parted: bool) -> None:
    """Let the two nodes of a restraint go their ways, the second one in the restraint behind, or keep them together."""
    restrained, nodes, spare = structure.restraints, structure.nodes, e + 1
    one, other = restrained.node[restrained.first[e]], restrained.node[restrained.first[e] + 1]
    restrained.nodes[e] = 1 if parted else 2
    restrained.nodes[spare] = 1 if parted else 0
    restrained.first[spare] = restrained.first[e] + (1 if parted else 2)
    restrained.free[spare] = np.eye(nodes.force.shape[0]) if parted else 0.0
    mass = nodes.mass[[one, other]]
    nodes.mobile[[one, other]] = 1.0 / mass if parted else 1.0 / mass.sum()
