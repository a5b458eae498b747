"""Samples: where the same points of a structure are at the same instants, on meshes of different size."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Frame, Integers, Layout

_PLACES = 9  # digits of the part of a line at which a node is one of another mesh, too


def places_of(layout: Layout, scenario: Scenario) -> dict[Hashable, int]:
    """Nodes of a result by what they are on any mesh: a part of a line, or of both sides of a net.

    Args:
        layout: of the result.
        scenario: whose nets say how many cells they have.
    """
    names = np.array(layout.node_line)
    found: dict[Hashable, int] = {}
    for name in dict.fromkeys(layout.node_line):
        here, net = np.flatnonzero(names == name), scenario.nets.get(name)
        if net is None:
            part = layout.node_xi[here] / max(float(layout.node_xi[here[-1]]), np.finfo(float).tiny)
            found |= {(name, round(float(xi), _PLACES)): int(node) for xi, node in zip(part, here, strict=True)}
        elif net.cells is not None and here.size == (net.cells[0] + 1) * (net.cells[1] + 1):
            m, n = net.cells
            j, i = np.divmod(np.arange(here.size), m + 1)
            found |= {
                (name, round(u / m, _PLACES), round(v / n, _PLACES)): int(node)
                for u, v, node in zip(i.tolist(), j.tolist(), here, strict=True)
            }
    return found


@dataclass
class Samples:
    """Places of points on one mesh, output after output.

    Args:
        nodes: of the result, that stand for the points; -1 where none does.
        outputs: (point, axis) m of each instant: nodes, then contacts and bodies; NaN where one is nowhere.
    """

    nodes: Integers
    outputs: list[Array]

    @classmethod
    def at(cls, places: Iterable[Hashable], known: dict[Hashable, int]) -> Samples:
        """None yet, at the points of these places.

        Args:
            places: what `places_of` the coarsest mesh has.
            known: what `places_of` this mesh has.
        """
        return cls(np.array([known.get(place, -1) for place in places], dtype=np.int64), [])

    def add(self, frame: Frame) -> None:
        """Take those of an instant."""
        nodes = np.where(self.nodes[:, None] >= 0, frame.position[self.nodes], np.nan)
        self.outputs.append(np.concatenate([nodes, frame.contact_position, frame.body_position]))

    def less(self, other: Samples) -> Array:
        """Distances (time, point, axis) from those of another mesh in m, up to where either ends."""
        both = min(len(self.outputs), len(other.outputs))
        return np.array(self.outputs[:both]) - np.array(other.outputs[:both])
