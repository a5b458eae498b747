"""Hold forces on lines that are divided where loads stand: tensions beside these are those of the links there.

A contact without friction has the same tension behind and ahead. Friction lets them differ up to

    |log(T_behind / T_ahead)| = L,   L = mu angle  (capstan)  or  2 artanh(mu tan(angle/2))  (block),

`angle`: by which the line turns there. What friction does not hold is held by a level force, see `hold_forces.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import BLOCK, CAPSTAN, COULOMB, DRAGGED, FRICTIONLESS, Array, Integers
from ropewalk.results.frame import Frame, Layout
from ropewalk.solve.hold_forces import coefficient_used, log_ratio
from ropewalk.system.equilibrium.split_lines import SplitRest


class FixedStations:
    """The nodes and links of a result."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        lines = dict.fromkeys(layout.link_line)
        node, link = np.array(layout.node_line), np.array(layout.link_line)
        self._node = {name: np.flatnonzero(node == name) for name in lines}
        self._link = {name: np.flatnonzero(link == name) for name in lines}
        self._vertices = np.flatnonzero(~np.isin(node, list(lines)))

    def of(self, rest: SplitRest, own: Frame, other: Layout) -> tuple[Array, Array, Array]:
        """Places of nodes (node, axis) in m, tensions (link,) in N and strains (link,) of links.

        Nodes are those of the curve through the nodes of a run, links have what these have in their middles.
        """
        n, links = len(self.layout.node_line), len(self.layout.link_line)
        position, axial = np.empty((n, rest.r.shape[0])), np.empty((2, links))
        theirs = np.array(other.link_line)
        for name, at in self._node.items():
            xi, mine, runs = self.layout.node_xi[at], self._link[name], rest.runs_of(name)
            ends = np.array([rest.stations(s)[-1] for s in runs[:-1]])
            of_node, of_link = np.searchsorted(ends, xi), np.searchsorted(ends, self.layout.link_xi[mine])
            values, at_links = np.array([own.tension, own.strain])[:, theirs == name], other.link_xi[theirs == name]
            run_of_link = np.searchsorted(ends, at_links)
            for i, s in enumerate(runs):
                nodes = rest.nodes_of(s)
                position[at[of_node == i]] = _through(rest.stations(s), rest.r[:, nodes].T, xi[of_node == i])
                there = run_of_link == i
                axial[:, mine[of_link == i]] = _between(
                    at_links[there], values[:, there].T, self.layout.link_xi[mine[of_link == i]]
                ).T
        if self._vertices.size:
            mine = np.flatnonzero(~np.isin(np.array(other.node_line), list(self._node)))
            position[self._vertices] = own.position[mine]
        return position, axial[0], axial[1]


def _through(at: Array, values: Array, wanted: Array) -> Array:
    """Values on the smooth curve through others."""
    if not wanted.size:
        return np.empty((0, values.shape[1]))
    nodes: Integers = np.searchsorted(at, wanted)
    if np.array_equal(at[np.minimum(nodes, at.size - 1)], wanted):
        return np.asarray(values[nodes])
    if at.size <= 2:
        return _between(at, values, wanted)
    from scipy.interpolate import CubicSpline  # lazy: it takes long to import

    return np.asarray(CubicSpline(at, values)(wanted))


def _between(at: Array, values: Array, wanted: Array) -> Array:
    """Values between others, and beyond the last ones straight on; (wanted, value)."""
    if at.size == 1:
        return np.repeat(values, wanted.size, axis=0)
    i = np.clip(np.searchsorted(at, wanted) - 1, 0, at.size - 2)
    part = ((wanted - at[i]) / (at[i + 1] - at[i]))[:, None]
    return np.asarray((1.0 - part) * values[i] + part * values[i + 1])


# Logarithms of tensions come out to this: above the rounding of rest.
_EQUAL = 1e-9
_BALANCED = 1e-6  # residual of a level force; rounding on a line of 10 GN alone makes 1e-8


class Beside(NamedTuple):
    """What a line is beside a load."""

    behind: float  # N
    ahead: float  # N
    angle: float  # rad, by which it turns

    @staticmethod
    def of(rest: SplitRest, line: str, at: float) -> Beside:
        """That at a place along a line in m."""
        (behind, before), (ahead, after) = rest.beside(line, at)
        return Beside(behind, ahead, float(np.arccos(np.clip(before @ after, -1.0, 1.0))))

    @property
    def ratio(self) -> float:
        """Log of the ratio of both tensions; of a slack line none is known."""
        return float(np.log(self.behind / self.ahead)) if min(self.behind, self.ahead) > 0.0 else np.nan

    def needed(self, *, block: bool) -> float:
        """The friction coefficient that this needs at least."""
        known = np.isfinite(self.ratio) and self.angle > 0.0
        return float(coefficient_used(BLOCK if block else CAPSTAN, self.ratio, self.angle)) if known else np.nan


class SplitHolds:
    """The hold forces of contacts on lines that are divided there.

    Args:
        kind: (contact,) CLAMPED, FRICTIONLESS, COULOMB or DRAGGED.
        friction: (contact,) coefficients.
        block: (contact,) 1: friction of a point, 0: of a line that bends around it.
        ahead: (contact,) +1 or -1, the direction of travel.
    """

    def __init__(self, kind: Integers, friction: Array, block: Integers, ahead: Array) -> None:
        self._kind, self._friction, self._block, self._ahead = kind, friction, block, ahead

    def hold(
        self, inner: Sequence[int], weight: float, settle: Callable[[Array], SplitRest],
        beside: Callable[[SplitRest, int], Beside],
    ) -> tuple[SplitRest, Array]:  # fmt: skip
        """Rest with the level forces that contacts need, and these, (contact,) N.

        Args:
            inner: numbers of contacts between the ends of their lines.
            weight: N, about the forces there.
            settle: finds the rest under level forces of all contacts, (contact,) N.
            beside: tells of a rest at a contact.

        Raises:
            EquilibriumError: nothing holds one of them there, or there is no rest.
        """
        hold, sign = np.zeros(self._kind.size), np.where(self._kind == DRAGGED, self._ahead, 0.0)
        slides = [k for k in inner if self._kind[k] in (FRICTIONLESS, DRAGGED)]
        stands = [k for k in inner if self._kind[k] == COULOMB]
        while True:
            rest = self._balanced(slides, sign, hold, weight, settle, beside)
            slips = []
            for k in stands:
                seen = beside(rest, k)
                if k not in slides and abs(seen.ratio) > self._most(k, seen) + _EQUAL:
                    sign[k] = np.sign(seen.ratio)
                    slips.append(k)
            if not slips:
                return rest, hold
            slides = slides + slips

    def _most(self, k: int, seen: Beside) -> float:
        return float(log_ratio(BLOCK if self._block[k] else CAPSTAN, self._friction[k], seen.angle)[0])

    def _balanced(
        self, slides: list[int], sign: Array, hold: Array, weight: float, settle: Callable[[Array], SplitRest],
        beside: Callable[[SplitRest, int], Beside],
    ) -> SplitRest:  # fmt: skip
        """Rest in which friction bears all that it can, of contacts that slide; their level forces are changed."""
        if not slides or weight == 0.0:
            return settle(hold)
        found: list[SplitRest] = []

        def miss(level: Array) -> Array:
            hold[slides] = level * weight
            found[:] = [settle(hold)]
            seen = [beside(found[0], k) for k in slides]
            limits = [sign[k] * self._most(k, one) if sign[k] else 0.0 for k, one in zip(slides, seen, strict=True)]
            return np.array([one.ratio - limit for one, limit in zip(seen, limits, strict=True)])

        from scipy.optimize import root  # lazy: it takes long to import

        solved = root(miss, hold[slides] / weight, method="hybr", options={"xtol": 1e-12, "eps": 1e-8})
        if not np.abs(miss(solved.x)).max() <= _BALANCED:
            raise EquilibriumError("nothing holds a load there: the force that it takes grows beyond all bounds")
        return found[0]
