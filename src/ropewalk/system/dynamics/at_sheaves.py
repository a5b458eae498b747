"""Where implicit steps end over sheaves: as a node comes to one, and as a load comes to the link over it."""

from __future__ import annotations

import numpy as np

from ropewalk.system.contact.contact_record import ON
from ropewalk.system.dynamics.carrier import System
from ropewalk.system.elements.sheaves import pass_nodes_entry


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
