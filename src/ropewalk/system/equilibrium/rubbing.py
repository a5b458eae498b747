"""Friction on saddles in slow motion: every rest follows from the one before, as what lies there slips or sticks.

A node that lies on a saddle is held where it was by a spring, as stiff as the one that bears it, and slips as soon as
that would pull with more than friction bears (Coulomb):

    t = -k w  where k |w| <= mu N, else  t = -mu N w/|w|;   w = (1 - n n^T) (d - a),

with the way n in which it is pressed with the force N, its place d from the saddle, and the place a at which the spring
was without force at the rest before. What comes to a saddle has been without force before. Lines are laid without
friction, and loads come to them then.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.solve import minimum
from ropewalk.solve.symmetric import Way
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.slow_hysteresis import LaggingPotential


def is_rubbing(structure: Structure) -> bool:
    """Whether lines of a structure rub on saddles."""
    return structure.saddles is not None and bool((structure.saddles.friction > 0.0).any())


class _Rubbed(NamedTuple):
    """A node that lies on a saddle with friction."""

    saddle: int
    node: int
    own: int  # node of the saddle
    force: Array  # (axis,) N, on the node
    stiffness: Array  # (axis, axis) N/m, by how much that falls with its way from the saddle
    slips: bool


class RubbingPotential(LaggingPotential):
    """Potential energy of lines on saddles, with friction, which has none."""

    def __init__(self, *arguments: Any, **keywords: Any) -> None:
        super().__init__(*arguments, **keywords)
        assert self.structure.saddles is not None
        self._saddles = self.structure.saddles
        self.laid = self._away(self.loaded.rest)  # (saddle, axis, node) m, from each saddle, at rest without loads
        self.kept = self.laid  # where springs are without force
        self._slides = True  # whether what slips is part of the stiffness, which is not symmetric then
        self._smooth = False  # whether there is no friction, for a while

    @property
    def is_symmetric(self) -> bool:  # type: ignore[override]
        """Whether the stiffness is, see `Potential`."""
        return self._smooth

    def approaches(self, start: Array, way: Way) -> Iterator[Array]:
        """The rest without friction, and how that is approached."""
        if self._smooth:
            yield from super().approaches(start, way)
            return
        self._smooth = True
        try:
            found = minimum.settle(self, start, way)
        finally:
            self._smooth = False
        yield found

    def keep(self, shape: Array) -> Array:
        """Where springs are without force if they pull as they do in a shape, as `kept`."""
        r = self.put(shape)[0]
        found = self._away(r)
        for rubbed in self._rubbed(r):
            found[rubbed.saddle, :, rubbed.node] += rubbed.force / self._saddles.k[rubbed.saddle]
        return found

    def stability(self, shape: Array) -> tuple[sparse.csc_matrix, Integers]:
        """What slips has no stiffness by its friction."""
        self._slides = False
        try:
            return super().stability(shape)
        finally:
            self._slides = True

    def stiffness(self, shape: Array, *, convex: bool = False) -> sparse.csc_matrix:
        K, r = super().stiffness(shape, convex=convex), self.put(shape)[0]
        n, axes = r.shape[1], np.arange(self.axes)
        rows, columns, values = [], [], []
        for rubbed in self._rubbed(r):
            if rubbed.slips and not self._slides:
                continue
            at = [axes * n + node for node in (rubbed.node, rubbed.own)]
            for i, one in enumerate(at):
                for j, other in enumerate(at):
                    rows.append(np.repeat(one, self.axes))
                    columns.append(np.tile(other, self.axes))
                    values.append((1.0 if i == j else -1.0) * rubbed.stiffness.ravel())
        if not rows:
            return K
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        F = sparse.csc_matrix(entries, shape=(self.free.shape[0],) * 2)
        return (K + self.free.T @ F @ self.free).tocsc()

    def _look(self, shape: Array) -> tuple[Array, Array]:
        r, u = super()._look(shape)
        for rubbed in self._rubbed(r):
            self.buffers.force[:, rubbed.node] += rubbed.force
            self.buffers.force[:, rubbed.own] -= rubbed.force
        return r, u

    def _away(self, r: Array) -> Array:
        """Places of all nodes from each saddle, (saddle, axis, node) m."""
        return np.asarray(r[None] - r[:, self._saddles.node].T[:, :, None])

    def _rubbed(self, r: Array) -> list[_Rubbed]:
        """What friction does at places of all nodes (axis, node) in m."""
        found, one = list[_Rubbed](), np.eye(self.axes)
        if self._smooth:
            return found
        for e, nodes, depth, slope, _ in self._saddles.touched(r):
            mu, k, own = float(self._saddles.friction[e]), float(self._saddles.k[e]), int(self._saddles.node[e])
            for i, g, p in zip(nodes.tolist(), depth, slope.T, strict=True):
                if mu == 0.0:
                    continue
                steep = float(np.linalg.norm(p))
                flat, bears = one - np.outer(p, p) / steep**2, mu * k * float(g) * steep
                w = flat @ (r[:, i] - r[:, own] - self.kept[e, :, i])
                size = float(np.linalg.norm(w))
                if k * size <= bears:
                    found.append(_Rubbed(e, i, own, -k * w, k * flat, False))
                    continue
                way = w / size
                K = mu * k * steep * np.outer(way, p) + bears / size * (flat - np.outer(way, way))
                found.append(_Rubbed(e, i, own, -bears * way, K, True))
        return found
