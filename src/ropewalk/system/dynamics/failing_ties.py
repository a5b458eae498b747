"""Ties that fail on the way, as droppers do: from then on they are without force, and what they had stored is lost."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ropewalk.checkpoint import Tree
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.dynamics.carrier import System
from ropewalk.system.dynamics.partings import Parting
from ropewalk.system.elements.structure import DAMPED

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
