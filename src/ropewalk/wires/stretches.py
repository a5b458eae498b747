"""The heights of long lines, found piece by piece: a factorisation of the whole line would take most of the memory.

What happens far away is not felt: forces die out along lines within some spans. Each piece is solved together with what
is next to it on both sides, where nothing moves at its borders; what is left over is solved once more, until it is
nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
from numpy.typing import NDArray

from ropewalk.wires.plan import Array

AT_ONCE = 120_000
"""Unknowns that are solved for at once: 250 spans with links of 0.25 m."""
_PIECE, _BESIDE = 60_000, 8_000  # nodes in a piece, and on both sides of it: 125 and 17 spans
_ROUNDS = 8
_LEFT = 1e-12  # of what is given: nothing


def solve_by_stretches(
    K: Any, C: Any, local: Array, free: NDArray[np.bool_], load: Array, gap: Array, x: Array, *, roughly: bool = False
) -> tuple[Array, Array] | None:
    """Solve K z = load + C' force, C z + local force = gap for free control points; None: that does not converge.

    Args:
        K, C: (node, node) N/m, and (point, node).
        local: (point,) m/N.
        free: (node,) which move.
        load, gap: (node,) N, and (point,) m.
        x: (node,) m along the line.
        roughly: whether a first guess is enough.
    """
    K, C = sparse.csr_matrix(K), sparse.csr_matrix(C)
    nodes = np.flatnonzero(free)
    nodes = nodes[np.argsort(x[nodes], kind="stable")]
    at = x[C.indices[C.indptr[:-1]]] if C.shape[0] else np.zeros(0)  # m, of each point
    shares = (C != 0.0).astype(np.int64)
    z, force, before = np.zeros(free.size), np.zeros(C.shape[0]), np.inf
    begins = list(range(0, nodes.size, _PIECE))
    for _ in range(_ROUNDS):
        out, off = load + C.T @ force - K @ z, gap - C @ z - local * force
        moved, pulled = np.zeros_like(z), np.zeros_like(force)
        for i in begins:
            j, last = min(i + _PIECE, nodes.size), i == begins[-1]
            own = np.sort(nodes[max(i - _BESIDE, 0) : j + _BESIDE])
            points = np.flatnonzero((at >= x[own].min()) & (at <= x[own].max()))
            outside = free.copy()
            outside[own] = False
            points = points[shares[points] @ outside == 0]  # a point that borders share would be led by nothing
            A, B = K[own][:, own], C[points][:, own]
            system = sparse.bmat([[A, -B.T], [B, sparse.diags(local[points])]]) if points.size else A
            found = scipy.sparse.linalg.spsolve(sparse.csc_matrix(system), np.concatenate([out[own], off[points]]))
            inner = np.isin(own, nodes[i:j], assume_unique=True)
            moved[own[inner]] = found[: own.size][inner]
            begin, end = -np.inf if i == 0 else x[nodes[i]], np.inf if last else x[nodes[j]]
            kept = (at[points] >= begin) & (at[points] < end)
            pulled[points[kept]] = found[own.size :][kept]
        z, force = z + moved, force + pulled
        out, off = (load + C.T @ force - K @ z)[nodes], gap - C @ z - local * force
        left = max(_part(out, load[nodes], K.diagonal().max() * np.abs(z).max()), _part(off, gap, np.abs(z).max()))
        if roughly or left <= _LEFT:
            return z, force
        if not left < before:
            return None
        before = left
    return None


def _part(left: Array, given: Array, other: float) -> float:
    """The largest of what is left, over the largest of what is given, and of something as large that it comes from."""
    size = max(float(np.abs(given).max(initial=0.0)), other)
    return float(np.abs(left).max(initial=0.0)) / size if size > 0.0 else 0.0
