"""Lines that are cut on the way: two nodes that were kept together part, each with its half of the mass.

At a time, or after the first step in which a link beside them pulls more than they bear. Both have one place and one
velocity when they part, and what kept them together did no work: energy goes on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.checkpoint import Tree
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.dynamics.carrier import System
from ropewalk.system.dynamics.partings import Parting
from ropewalk.system.elements.structure import DAMPED, Structure

_ROUNDING = 1e-12  # of an instant


class FailingTies(Parting):
    """All ties of a structure that may fail.

    Args:
        assembled: the structure, whose ties change, and which of them fail.
    """

    def __init__(self, assembled: Assembled) -> None:
        attached, ties = assembled.attached, assembled.structure.ties
        fails = {} if attached is None or ties is None else dict(attached.fails)
        self._names = () if attached is None else attached.tie
        self._tie: Integers = np.array(list(fails), dtype=np.int64)
        self._time, self._strength = np.array(list(fails.values())).reshape(-1, 2).T
        self._whole = np.ones(self._tie.size, dtype=np.bool_)
        self._ties = ties
        none = np.zeros((0, 2))
        self._k, self._c = (none, none) if ties is None else (ties.k[self._tie], ties.c[self._tie])

    @property
    def any(self) -> bool:
        """Whether there are any."""
        return self._tie.size > 0

    def next(self) -> float:
        """The next instant in s at which a tie is cut; infinity: there is none."""
        return float(self._time[self._whole].min(initial=np.inf))

    def is_watched(self) -> bool:
        """Whether a tie may still tear."""
        return bool(np.isfinite(self._strength[self._whole]).any())

    def until(self, system: System) -> list[str]:
        """Let ties fail whose time has come."""
        due = self._whole & (self._time * (1.0 - _ROUNDING) <= system.state.t[0])
        return self._fail(due, self._forces(system), system) if due.any() else []

    def excess(self, system: System) -> float:
        """By how much the most pulled tie is above its strength, over this."""
        if not self.is_watched():
            return -1.0
        return float((self._forces(system) / self._strength)[self._whole].max()) - 1.0

    def overpulled(self, system: System) -> list[str]:
        """Let ties fail that pull more than they bear."""
        if not self.is_watched():
            return []
        force = self._forces(system)
        return self._fail(self._whole & (force > self._strength), force, system)

    def crossed(self) -> str | None:
        """Nothing: loads do not travel on ties."""
        return None

    def _forces(self, system: System) -> Array:
        assert self._ties is not None
        return self._ties.forces(system.state.r, system.state.v)[self._tie]

    def _fail(self, which: NDArray[np.bool_], force: Array, system: System) -> list[str]:
        """Let some of them fail under forces (tie,) in N."""
        if not which.any():
            return []
        assert self._ties is not None
        longer = self._ties.look(system.state.r)[2][self._tie]
        k = np.where(longer > 0.0, self._k[:, 0], self._k[:, 1])
        system.state.work[DAMPED] += 0.5 * float((k * longer**2)[which].sum())
        self._whole[which] = False
        self._slacken()
        when = f"at t = {system.state.t[0]:.4g} s"
        return [f"{when} {self._names[self._tie[i]]} failed under {force[i]:.4g} N" for i in np.flatnonzero(which)]

    def _slacken(self) -> None:
        """Leave no stiffness to those that have failed."""
        if self._ties is not None:
            self._ties.k[self._tie] = np.where(self._whole[:, None], self._k, 0.0)
            self._ties.c[self._tie] = np.where(self._whole[:, None], self._c, 0.0)

    def get_state(self) -> Tree:
        """Which of them are whole."""
        return {"whole": self._whole.copy()}

    def set_state(self, tree: Tree) -> None:
        """Ties as they were then."""
        self._whole[:] = tree["whole"]
        self._slacken()


@dataclass(frozen=True)
class _Cut:
    """A cut: when, s; the restraint of both nodes, behind which an empty one stands."""

    line: str
    number: int
    at: float  # m
    time: float  # inf: at none
    strength: float  # N; inf: nothing breaks it
    links: Integers  # those beside it, by their first node
    restraint: int


class Cuts(Parting):
    """All cuts of lines.

    Args:
        scenario: what is there.
        assembled: the same as arrays, of which restraints change.
        contacts: of loads.
        places: (contact,) m, along their lines; changes.
    """

    def __init__(self, scenario: Scenario, assembled: Assembled, contacts: Any, places: Array) -> None:
        self._structure, self._contacts, self._places = assembled.structure, contacts, places
        names = [name for name, line in scenario.lines.items() if line.cut is not None]
        self._cuts = [_found(scenario, assembled, name) for name in names]
        self._done = np.zeros(len(self._cuts), dtype=np.bool_)
        self._behind = np.zeros((len(self._cuts), contacts.size), dtype=np.int64)

    @property
    def any(self) -> bool:
        """Whether there are any."""
        return bool(self._cuts)

    def next(self) -> float:
        """The next instant in s at which a line is cut; infinity: there is none."""
        ahead = [cut.time for cut, done in zip(self._cuts, self._done, strict=True) if not done]
        return min(ahead, default=float("inf"))

    def is_watched(self) -> bool:
        """Whether a line may still break by too much tension."""
        return bool(self._watched())

    def _watched(self) -> list[int]:
        return [i for i, cut in enumerate(self._cuts) if not self._done[i] and math.isfinite(cut.strength)]

    def excess(self, system: System) -> float:
        """By how much the most pulled line is above its strength, over this."""
        cuts = [self._cuts[i] for i in self._watched()]
        return max((float(system.buffers.tension[cut.links].max()) / cut.strength for cut in cuts), default=0.0) - 1.0

    def overpulled(self, system: System) -> list[str]:
        """Part lines that pull more than they bear; returns what is to be told of them."""
        messages = []
        for i in self._watched():
            cut = self._cuts[i]
            if (pull := float(system.buffers.tension[cut.links].max())) > cut.strength:
                self._part(i)
                where = f"t = {system.state.t[0]:.4g} s, {cut.at:g} m from its start"
                messages.append(f"line {cut.line} failed at {where}, at a tension of {pull:.4g} N")
        return messages

    def _part(self, i: int) -> None:
        self._done[i], self._behind[i] = True, self._sides(self._cuts[i])
        _part(self._structure, self._cuts[i].restraint, parted=True)

    def until(self, system: System) -> list[str]:
        """Cut what is to be cut up to now; nothing is to be told of it."""
        for i, cut in enumerate(self._cuts):
            if not self._done[i] and cut.time <= system.state.t[0] * (1.0 + 1e-12):
                self._part(i)
        return []

    def crossed(self) -> str | None:
        """A load that has come to the cut of its line."""
        for i, cut in enumerate(self._cuts):
            if self._done[i] and np.any((self._sides(cut) != self._behind[i]) & (self._contacts["state"] == 1)):
                return f"a load has reached the cut of line {cut.line}; let it stay on its side, or end the run before"
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
    time, strength = (math.inf if own is None else own for own in (cut.time, cut.strength))
    links = np.array([int(structure.runs.first[s] + structure.runs.links[s]) - 1, node])
    return _Cut(name, numbers.index(name), cut.at, time, strength, links, e)


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
