"""Equilibrium of ropes that rub at sheaves: they stick where they are until friction bears no more."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from ropewalk.engine.bound import Bound
from ropewalk.engine.equilibrium import Search, SearchOutcome, find_equilibrium

Array = NDArray[np.float64]
SLIP = 1e-10
"""What friction misses where a rope slips, over the largest tension at a sheave."""
_ROUNDS = 50
_NUDGE = 1e-6
"""Of a link, to see what a slip changes."""


def follow_slips(bound: Bound, iterations: int = 200) -> SearchOutcome:
    """Move the State to the equilibrium that its ropes stick or slip to; the State is the history of slips.

    Loads and places of supports may change from one call to the next, by as little as it takes that no rope slips to
    and fro in between.

    Args:
        bound: structure.
        iterations: largest number of steps of Newton's method between two changes of friction.
    """
    model, count = bound.model, 0
    forces = np.where(model.sheave_friction > 0.0, np.nan, 0.0)
    for _ in range(_ROUNDS):
        found = find_equilibrium(bound, iterations, forces)
        count += found.iterations
        if found.outcome != "found":
            break
        sheaves, pull = bound.sheaves(), bound.forces()[0, model.sheave_split]
        begins = np.isnan(forces) & (np.abs(pull) > sheaves.most + SLIP * _largest(bound))
        forces[begins] = -np.copysign(sheaves.most, pull)[begins]
        slips = np.flatnonzero((model.sheave_friction > 0.0) & ~np.isnan(forces))
        miss = forces - np.copysign(sheaves.most, forces)
        if not begins.any() and np.abs(miss[slips]).max(initial=0.0) <= SLIP * _largest(bound):
            return found._replace(iterations=count)
        forces[slips] -= np.linalg.solve(_derivatives(bound, forces, slips), miss[slips])
    return found._replace(outcome="not found", iterations=count)


def _largest(bound: Bound) -> float:
    sheaves = bound.sheaves()
    return float(np.maximum(sheaves.before, sheaves.behind).max(initial=0.0))


def _derivatives(bound: Bound, forces: Array, slips: NDArray[np.int64]) -> Array:
    """Return how what friction misses changes with the forces on splits, (slip, slip)."""
    search, splits = Search(bound, forces), bound.model.sheave_split[slips]
    solve, position = splu(search.stiffness(bound.linearise())).solve, bound.state.position
    found, begin = np.eye(slips.size), position.copy()
    for column, split in enumerate(splits):
        unit = np.zeros(position.size)
        unit[split] = 1.0
        way = (search.free @ solve(search.free.T @ unit)).reshape(position.shape)
        size = _NUDGE * float(bound.model.link_length.min()) / float(np.abs(way).max())
        sides = []
        for sign in (1.0, -1.0):
            position[:] = begin + sign * size * way
            sides.append(np.copysign(bound.sheaves().most, forces)[slips])
        found[:, column] -= (sides[0] - sides[1]) / (2.0 * size)
    position[:] = begin
    return found
