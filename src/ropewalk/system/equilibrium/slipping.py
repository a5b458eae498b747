"""Slip of lines over sheaves at rest: what they are pulled by there, and Newton's method on it."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.solve.minimum import cause
from ropewalk.solve.search_budget import spend

_NUDGE = 1e-6  # of a link, by which lines are slipped to see what that changes
_NEUTRAL = 1e-12  # of the largest stiffness, where a part has none


def missed(rest: Any, friction: Array, slips: Array) -> tuple[Array, float]:
    """By how much more lines are pulled ahead of sheaves than friction bears, (sheave,) N, and the largest tension.

    Args:
        rest: `SplitRest` of the lines.
        friction: (sheave,) coefficients.
        slips: (sheave,) 1 where lines slip ahead, -1 where back: there friction bears all that it can; 0: what it must.
    """
    rest.potential.forces(rest.shape)
    out, largest = np.zeros(len(rest.sheaves)), 0.0
    for j, s in enumerate(rest.run[: out.size].tolist()):
        (one, before), (two, after) = rest.at_end(s, 1), rest.at_end(s + 1, 0)
        angle = float(np.arccos(np.clip(before @ after, -1.0, 1.0)))
        ratio = float(np.exp(friction[j] * angle))
        most, least = (max(T * ratio, T / ratio) for T in (one, two))
        goes = slips[j] or float(two > most) - float(one > least)
        out[j] = two - most if goes > 0.0 else (least - one if goes < 0.0 else 0.0)
        largest = max(largest, abs(one), abs(two))
    return out, largest


def slip(rest: Any, miss: Array, friction: Array, goes: Array) -> tuple[Array, Array]:
    """By how far sheaves come ahead on their lines, (sheave,) m, by Newton's method, and how shapes go with that."""
    slips, nudge = np.flatnonzero(miss), _NUDGE * float(rest.structure.runs.h.min())
    before = rest.potential.out_of_balance(rest.shape)
    spend(rest.shape)
    K = rest.potential.stiffness(rest.shape).tocsc()
    try:
        solve = scipy.sparse.linalg.splu(K)
    except RuntimeError:  # a part is slack, as between a mass on a rail and what holds both
        if not rest.is_loaded:
            raise EquilibriumError(f"no equilibrium was found: {cause(rest.potential, rest.shape)}") from None
        little = _NEUTRAL * float(np.abs(K.diagonal()).max())
        solve = scipy.sparse.linalg.splu((K + little * sparse.identity(K.shape[0])).tocsc())
    J, ways = np.zeros((slips.size, slips.size)), np.zeros((rest.shape.size, slips.size))
    for column, j in enumerate(slips.tolist()):
        other = rest.put(rest.x + nudge * (np.arange(rest.x.size) == j))
        ways[:, column] = rest.potential.free @ solve.solve(other.potential.out_of_balance(rest.shape) - before)
        moved = other._replace(shape=rest.shape + ways[:, column])
        J[:, column] = (missed(moved, friction, goes)[0] - miss)[slips] / nudge
    out = np.zeros(miss.size)
    curvature, along = np.linalg.eigh(0.5 * (J + J.T))
    if curvature.min(initial=1.0) > 0.0:
        out[slips] = -np.linalg.solve(J, miss[slips])
    else:  # balanced there, it would be so as on a tip: downhill
        out[slips] = -along @ ((miss[slips] @ along) / np.maximum(np.abs(curvature), 1e-300))
    return out, ways @ out[slips] / nudge
