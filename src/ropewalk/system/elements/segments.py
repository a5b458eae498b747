"""Lines whose stiffness, mass and bed vary along them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ropewalk.mechanics.along_lines import bending_along, mean_along
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.model.line import Line

_SAME = 1e-12  # of a bending stiffness


class Segments(NamedTuple):
    """What nodes have; links by their first node."""

    bending: Array  # (node,) N m^2
    smooth: Array  # (link,) N m^2, for what curvature changes by within a link: 0 where it jumps
    rho: Array  # (node,) kg/m
    bed: Array  # (node,) N/m^2

    @staticmethod
    def nothing() -> Segments:
        """Of lines that are the same all along."""
        return Segments(*np.zeros((4, 0)))

    @staticmethod
    def of(lines: Mapping[str, Line], sections: Sequence[tuple[str, Integers, Array]], nodes: int) -> Segments | None:
        """Those of some runs, if a line has segments.

        Args:
            lines: what is there, by name.
            sections: runs: line, nodes as laid out, stations in m.
            nodes: how many there are.
        """
        if not any(line.segments for line in lines.values()):
            return None
        out, first = Segments(*np.zeros((4, nodes))), 0
        for name, _, station in sections:
            n = station.size
            if (line := lines.get(name)) is not None:
                part = slice(first, first + n)
                out.rho[part], out.bed[part] = (mean_along(line, key, station) for key in ("mass", "foundation"))
                if line.bending_stiffness:
                    EI = bending_along(line, station)
                    same = np.abs(np.diff(EI)) <= _SAME * EI[1:]
                    out.bending[part] = EI
                    out.smooth[first : first + n - 1] = np.where(same, EI[1:], 0.0)
            first += n
        return out


@inlined
def vary(segments):
    """Whether lines vary along themselves: asked where a call would hand all arrays on."""
    if segments is None:
        return False
    return segments.rho.size > 0


@lean_inner
def bending_near(segments, runs, run, x):
    """Bending stiffness of a run at the place x in links, N m^2."""
    if segments is None or segments.rho.size == 0:
        return runs.bending[run]
    return segments.bending[runs.first[run] + min(max(int(x + 0.5), 0), runs.links[run])]


@lean_inner
def mass_near(segments, runs, run, x):
    """Mass per length of a run at the place x in links, kg/m."""
    if segments is None or segments.rho.size == 0:
        return runs.rho[run]
    return segments.rho[runs.first[run] + min(max(int(x + 0.5), 0), runs.links[run])]


@lean_inner
def stiffness_at(segments, runs, s, i):
    """Bending stiffness of run s at node i, N m^2."""
    if segments is None or segments.rho.size == 0:
        return runs.bending[s]
    return segments.bending[i]


@lean_inner
def stiffness_within(segments, runs, s, i):
    """Bending stiffness of run s within the link i, N m^2."""
    if segments is None or segments.rho.size == 0:
        return runs.bending[s]
    return segments.smooth[i]


@lean_inner
def bed_at(segments, runs, s, i):
    """Stiffness of the bed of run s at node i, N/m^2."""
    if segments is None or segments.rho.size == 0:
        return runs.bed[s]
    return segments.bed[i]


def of_nodes(structure: Any, contacts: Any) -> Integers:
    """The nodes next to contacts, (..., contact)."""
    runs, run = structure.runs, contacts["run"]
    return np.asarray(runs.first[run] + np.clip((contacts["x"] + 0.5).astype(np.int64), 0, runs.links[run]))


def bending_of(structure: Any, contacts: Any) -> Array:
    """Bending stiffness where contacts are, (..., contact) N m^2."""
    if structure.segments is None:
        return np.asarray(structure.runs.bending[contacts["run"]])
    return np.asarray(structure.segments.bending[of_nodes(structure, contacts)])


def mass_of(structure: Any, contacts: Any) -> Array:
    """Mass per length where contacts are, (..., contact) kg/m."""
    if structure.segments is None:
        return np.asarray(structure.runs.rho[contacts["run"]])
    return np.asarray(structure.segments.rho[of_nodes(structure, contacts)])
