"""Ties to the first order: each keeps the stiffness and the damper that it has at rest, whatever its length becomes.

What pulls with T0 at rest along the unit vector n, at the length l, pulls with

    F = T0 + k n a + c n a',   on its ends with   F n + T0/l (a - (n a) n),

where a is the way by which its ends have gone apart. A dropper that is taut would push, and one that is slack hang on.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.results.frame import RunInfo
from ropewalk.system.assembling.assembled import Attached
from ropewalk.system.elements.ties import Ties

_ROUNDING = 1e-9  # of the largest pull at rest: no more than rounding pushes


class TiesAboutRest:
    """All ties of a structure, and which of them would have slackened or gripped.

    Args:
        rest: (axis, node) m.
    """

    def __init__(self, ties: Ties, rest: Array, attached: Attached) -> None:
        self._way, length, self._longer = ties.look(rest)
        side = np.where(self._longer > 0.0, 0, 1)
        every = np.arange(side.size)
        self._k, self._c, self._pull = ties.k[every, side], ties.c[every, side], ties.forces(rest)
        turns = ~ties.way.any(axis=1)
        self._turn = np.where(turns, self._pull / np.where(length > 0.0, length, 1.0), 0.0)
        self._parts, self._attached = ties.parts(rest.shape[1]), attached
        self._differs = np.flatnonzero(ties.k[:, 0] != ties.k[:, 1])  # where it is longer and where it is shorter
        self._noted: set[int] = set()

    def forces(self, x: Array, v: Array) -> tuple[Array, Array]:
        """Forces (tie,) and what each does to its second end (tie, axis), N.

        Args:
            x: (axis, node) m, from rest.
            v: m/s.
        """
        away, rate = np.asarray(self._parts @ x.T), np.asarray(self._parts @ v.T)
        along = (self._way * away).sum(axis=1)
        force = self._pull + self._k * along + self._c * (self._way * rate).sum(axis=1)
        across = away - along[:, None] * self._way
        return force, force[:, None] * self._way + self._turn[:, None] * across

    def doubt(self, x: Array, t: float, run_info: RunInfo) -> None:
        """Doubt the run once for each tie that would have slackened, or gripped, by time t in s."""
        along = (self._way * np.asarray(self._parts @ x.T)).sum(axis=1)
        little = _ROUNDING * float(np.abs(self._pull).max(initial=0.0))
        for e in self._differs.tolist():
            slack = self._longer[e] <= 0.0
            past = self._longer[e] + along[e]
            if e in self._noted or (past > 0.0) != slack or abs(past) * max(self._k[e], 1.0) <= little:
                continue
            self._noted.add(e)
            if len(self._noted) == 1:
                name = self._attached.tie[e] if e < len(self._attached.tie) else "a tie"
                what = f"at t = {t:.4g} s {name} would {'pull, which is slack' if slack else 'be slack, which is taut'}"
                cause = "linear theory includes only the droppers that are taut in equilibrium"
                run_info.doubt(f"{what} at rest", cause, "run.kind", "ask for kind: dynamic, geometry: linearised")
