"""Hysteresis and friction on saddles in quasi-static motion: every equilibrium follows from the one before.

With the s of `hysteresis.py` as it is, links are springs of the tension T1(e) - s. Those that are at rest together find
s anew from how far they have been stretched or let off since the rest before,

    q = f(e0) - s0 + k (e - e0), |q| <= f(e);   s = f(e) - q,

by rounds in each of which s goes as far as Newton's method for a link under a given tension: e then changes by ds/T1'.

A node that lies on a saddle is held where it was by a spring, as stiff as the one that bears it, and slips as soon as
that would pull with more than friction bears (Coulomb; docs/notes/saddles.md):

    t = -k w  where k |w| <= mu N, else  t = -mu N w/|w|;   w = (1 - n n^T) (d - a),

with the way n in which it is pressed with the force N, its place d from the saddle, and the place a at which the spring
was without force at the rest before. Lines are laid without friction, and loads come to them then.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.solve import minimum
from ropewalk.solve.symmetric import Way
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.statics import SystemPotential

_ROUNDS, _CLOSE = 100, 1e-9
_FARTHEST = 10.0  # times what s misses, that a round changes it by


def is_lagging(structure: Structure) -> bool:
    """Whether links of a structure keep in mind what they have been through."""
    return bool((structure.runs.hysteresis[:, 0] > 0.0).any())


class LaggingPotential(SystemPotential):
    """Potential energy of links that keep what they have in mind: W1 - s e per unstrained length."""

    def energy(self, shape: Array) -> float:
        """Potential energy, J."""
        total, runs = super().energy(shape), self.structure.runs
        for s in np.flatnonzero(runs.hysteresis[:, 0] > 0.0):
            part, p, h = slice(runs.first[s], runs.first[s] + runs.links[s]), runs.hysteresis[s], float(runs.h[s])
            strain, kept = self.buffers.strain[part], self.buffers.lag[0, part]
            q = bounds(p, strain) - kept
            lengths = np.full(strain.size, h)
            total += float(law.stored_total(p[1:], np.maximum(strain, 0.0), lengths))
            total -= h * float((0.5 * q * q / p[0] + kept * strain).sum())
        return total


def settle_after(potential: SystemPotential, settle: Callable[[Array], Array], shape: Array, before: Array) -> Array:
    """Rest next to a shape, after another one.

    Args:
        potential: of the structure; what links keep in mind there changes.
        shape: see `SystemPotential`.
        before: (2, node) what links had in mind at the rest before, N, and their strains there.
    """
    lag, runs = potential.buffers.lag, potential.structure.runs
    lag[:] = before
    for _ in range(_ROUNDS):
        shape = settle(shape)
        worst, pull = 0.0, float(np.abs(potential.buffers.tension).max())
        for s in np.flatnonzero(runs.hysteresis[:, 0] > 0.0):
            part = slice(runs.first[s], runs.first[s] + runs.links[s])
            strain, p = potential.buffers.strain[part], runs.hysteresis[s]
            wanted, slope = kept(p, strain, before[:, part])
            missing = wanted - lag[0, part]
            stiff = law.tangents(runs.law[s], strain)
            gain = np.divide(stiff, stiff - slope, out=np.ones_like(stiff), where=stiff - slope > stiff / _FARTHEST)
            lag[0, part] += gain * missing
            lag[1, part] = strain
            worst = max(worst, float(np.abs(missing).max()))
        if worst <= _CLOSE * pull:
            return shape
    raise EquilibriumError("hysteresis finds no rest next to the one before: ask for more positions")


def kept(p: Array, strain: Array, before: Array) -> tuple[Array, Array]:
    """What links keep in mind at strains after (s, e) before, N, and how it changes with the strain, N."""
    most, past = bounds(p, strain), bounds(p, before[1])
    rise = np.where(strain > 0.0, law.tangents(p[1:], np.maximum(strain, 0.0)), 0.0)
    q = past - before[0] + p[0] * (strain - before[1])
    slope = np.where(q > most, 0.0, np.where(q < -most, 2.0 * rise, rise - p[0]))
    return most - np.clip(q, -most, most), slope


def bounds(p: Array, strain: Array) -> Array:
    """Half of what unloading differs from loading by at strains, N."""
    return np.asarray(np.maximum(law.tensions(p[1:], np.maximum(strain, 0.0)), 0.0))


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
