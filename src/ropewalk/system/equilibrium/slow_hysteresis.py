"""Hysteresis in slow motion: every rest follows from the one before, as what each link keeps in mind does.

With the s of `hysteresis.py` as it is, links are springs of the tension T1(e) - s. Those that are at rest together find
s anew from how far they have been stretched or let off since the rest before,

    q = f(e0) - s0 + k (e - e0), |q| <= f(e);   s = f(e) - q,

by rounds in each of which s goes as far as Newton's method for a link under a given tension: e then changes by ds/T1'.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array
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
