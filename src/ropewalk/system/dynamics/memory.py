"""Memory of links with hysteresis and of lines over sheaves in the steps of an implicit method.

At each stage it follows from the beginning of the step, as if everything went straight on (docs/notes/implicit.md).
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.system.contact.contact_record import ON
from ropewalk.system.dynamics import motion
from ropewalk.system.dynamics.carrier import System
from ropewalk.system.elements.sheaves import pass_nodes_entry
from ropewalk.system.elements.structure import LAGGED, RUBBED
from ropewalk.system.equilibrium.rubbing import bounds, kept


class AtSheaves:
    """Nodes and loads of a system that come to sheaves."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._sheaves = None if system.structure.is_linearised else system.structure.sheaves

    @property
    def any(self) -> bool:
        """Whether any may come to one."""
        return self._sheaves is not None

    def passed(self) -> float:
        """How far, in links, the node that is furthest on its way has passed its sheave; negative: none has."""
        runs, r, found = self._system.structure.runs, self._system.state.r, -np.inf
        if self._sheaves is None:
            return found
        for b, run in zip(self._sheaves.node, self._sheaves.run, strict=True):
            e = int(runs.first[run] + runs.links[run])
            for near, far in ((e, e - 1), (e + 1, e + 2)):
                way = r[:, near] - r[:, far]
                found = max(found, float((r[:, near] - r[:, b]) @ way) / float(np.linalg.norm(way) * runs.h[run]))
        return found

    def stood(self) -> float:
        """How far, in links, a load has come onto the link over a sheave; negative: none has."""
        structure, state, found = self._system.structure, self._system.state, -np.inf
        if self._sheaves is None:
            return found
        runs, lines = structure.runs, structure.lines
        for run in self._sheaves.run:
            low, high = lines.begin[run] + runs.links[run] * runs.h[run], lines.begin[run + 1]
            for s, contact in zip(state.s, self._system.contacts, strict=True):
                first = lines.first[contact["line"]]
                if contact["state"] == ON and first <= run < first + lines.runs[contact["line"]]:
                    found = max(found, float(min(s - low, high - s) / runs.h[run]))
        return found

    def let_pass(self) -> bool:
        """Let nodes that have come to a sheave pass; returns whether lines have not come to their ends there."""
        own, state = self._system.structure.for_kernels, self._system.state
        return bool(
            pass_nodes_entry(
                own.sheaves, own.lines, own.runs, own.nodes.mass, own.inertia, state.r, state.v, state.work
            )
        )


# Rounds in which what links keep in mind and the kinks that it makes find each other, and the part of it to which.
_ROUNDS, _FOUND = 20, 1e-13


class Memory:
    """What is kept in mind of the beginning of a step.

    Args:
        system: what moves.
    """

    def __init__(self, system: System) -> None:
        self._system, runs = system, system.structure.runs
        self._lagging: list[int] = np.flatnonzero(runs.hysteresis[:, 0] > 0.0).tolist()
        self._lag = system.buffers.lag.copy()
        self.softer = np.zeros(self._lag.shape[1])  # N, by which links are softer than where they are loaded
        sheaves = system.structure.sheaves
        self._sheaves = None if sheaves is None or system.structure.is_linearised else sheaves
        self._behind = (
            np.zeros((2, 0)) if self._sheaves is None else np.stack([self._sheaves.ahead, self._sheaves.drive])
        )
        self.slips = False

    @property
    def any(self) -> bool:
        """Whether there is anything to keep in mind."""
        return bool(self._lagging) or self._sheaves is not None

    def begin(self) -> None:
        """Keep in mind what is there now, as it came about at once."""
        self._lag[:], self.slips = self._system.buffers.lag, False
        if self._sheaves is not None:
            self._behind[:] = self._sheaves.ahead, self._sheaves.drive
        self._soften()

    def recall(self) -> None:
        """Let lines be over their sheaves as at the beginning of the step."""
        if self._sheaves is not None:
            self._sheaves.ahead[:], self._sheaves.drive[:] = self._behind

    def look(self) -> None:
        """Find all forces at the places of now, as they follow from the beginning of the step."""
        work = self._system.state.work.copy()
        for _ in range(_ROUNDS):
            self.recall()
            self._system.advance(0.0, motion.GIVEN)
            if not self._let_off():
                break
        self._system.state.work[:] = work

    def _let_off(self) -> bool:
        """Let links be let off as their strains are; returns whether that changes what they pull with."""
        buffers, changed = self._system.buffers, False
        for s in self._lagging:
            part = self._links(s)
            was, now = buffers.lag[0, part], self._kept(s)[0]
            most = float(np.abs(buffers.tension[part]).max() + np.abs(now).max())
            changed = changed or float(np.abs(now - was).max()) > _FOUND * most
            buffers.lag[0, part] = now
        return changed

    def keep(self) -> None:
        """Begin the next step where everything is now; what has been lost goes to the works."""
        state, buffers, runs = self._system.state, self._system.buffers, self._system.structure.runs
        self._soften()
        for s in self._lagging:
            part, p = self._links(s), runs.hysteresis[s]
            strain = buffers.strain[part]
            before, q = bounds(p, self._lag[1, part]) - self._lag[0, part], bounds(p, strain) - buffers.lag[0, part]
            gone = strain - self._lag[1, part] - (q - before) / p[0]
            state.work[LAGGED] += float(runs.h[s] * (0.5 * (before + q) * gone).sum())
            self._lag[:, part] = buffers.lag[0, part], strain
        if self._sheaves is not None:
            slipped, drive = self._sheaves.ahead - self._behind[0], 0.5 * (self._sheaves.drive + self._behind[1])
            rubs = self._sheaves.friction > 0.0
            self.slips = bool((slipped[rubs] != 0.0).any())
            state.work[RUBBED] += float((drive * slipped)[rubs].sum())
            self._behind[:] = self._sheaves.ahead, self._sheaves.drive

    def _links(self, s: int) -> slice:
        runs = self._system.structure.runs
        return slice(int(runs.first[s]), int(runs.first[s] + runs.links[s]))

    def _kept(self, s: int) -> tuple[Array, Array]:
        part, runs = self._links(s), self._system.structure.runs
        return kept(runs.hysteresis[s], self._system.buffers.strain[part], self._lag[:, part])

    def _soften(self) -> None:
        for s in self._lagging:
            self.softer[self._links(s)] = self._kept(s)[1]
