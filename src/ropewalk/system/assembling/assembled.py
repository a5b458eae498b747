"""A structure put together, with the names that results give to its parts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.overhead.section import Section
from ropewalk.system.assembling.surface_paths import Nets
from ropewalk.system.elements.structure import Structure


class Attached(NamedTuple):
    """What results tell of the ties of a structure, and which points of lines they watch."""

    tie: tuple[str, ...]  # names of those that are shown, which come first
    station: tuple[float, ...]  # m along the line that each of them hangs on
    support: tuple[str, ...]  # names of what ties to the ground hold
    holds: Integers  # (tie,) which of these each is; -1: it is none
    watched: tuple[str, ...]
    watched_station: tuple[float, ...]  # m
    watch: sparse.csr_matrix  # (watched, node) parts of nodes
    fails: Mapping[int, tuple[float, float]] = MappingProxyType({})  # ties that may fail: when, s, and at which pull, N

    @property
    def sampled(self) -> bool:
        """Whether results tell of any by itself."""
        return bool(self.tie or self.watched)


@dataclass(frozen=True, eq=False)
class Assembled:
    """A structure, and what results name of it."""

    structure: Structure
    axes: tuple[str, ...]
    near: Array  # (axis, node) m, about where its nodes rest
    station: Array  # (node,) m along the line of each
    line: tuple[str, ...]  # (run,) but for those of ways on nets, which come last
    on: dict[str, int]  # line on which each load travels, and each contact of loads that come to several
    supports: tuple[tuple[str, int], ...]  # names of supports, and which restraints they are
    nets: Nets | None = None
    attached: Attached | None = None
    sheave: tuple[str, ...] = ()  # names of sheaves, in their order
    stretch: Array | None = None  # (run,) stretch of links whose strain counts from the state that they rest in
    sections: Mapping[str, Section] = field(default_factory=dict)  # overhead lines at rest, by names
    bow: Array | None = None  # (node,) m to the left, from where lines are computed to where results show them: curves


def on_of(on: Mapping[str, int], wheel: ContactPoint) -> int:
    """The line of a contact: of its own where its load comes to several, or that of its load."""
    return on[wheel.name] if wheel.name in on else on[wheel.load]
