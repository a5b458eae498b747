"""Bending of a uniform beam to the fourth order in the mesh, from one stored energy, in units of EI / h^3.

Inside, the stencil has seven points, `d4 - d6 / 6`; ends that turn reflect it, at clamped ones a symmetric block of
three nodes lets x^2 and x^3 be without forces. Nodes next to ends share mass and beds so that sums over nodes are
integrals to the fourth order (docs/notes/wires.md).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from ropewalk.wires.plan import Array

FEWEST = 8  # links of a beam: what nodes next to both ends differ by must not meet
EDGE = 4  # nodes next to an end whose rows differ from those inside
REACH = 3  # nodes on both sides of one that it feels
HIGHEST = 16.0 + 64.0 / 6.0  # the largest eigenvalue of the stencil inside; the ends add less than 0.1 %
# Parts of a link that the first nodes stand for: exact for 1, x, x^2 and x^4, of which squares of deflections consist
# at an end that does not move.
SHARES = np.array([13.0 / 36.0, 29.0 / 24.0, 11.0 / 12.0, 73.0 / 72.0])
# What a point yields beside its spline, in h^3 / EI, as `local_compliance` has it: the exact deflection under a point
# force less what six nodes with their weights see of it.
LOCAL = (1.0 / 54.0, 1.0 / 9.0, 1.0 / 12.0)
_CLAMPED = np.array([[1540.0, -834.0, 228.0], [-834.0, 985.0, -642.0], [228.0, -642.0, 900.0]]) / 96.0


def fourth_order(links: int, clamped: tuple[bool, bool]) -> sparse.csr_matrix:
    """Stiffness of a beam of so many links that is clamped at its start, or its end, or not, (node, node)."""
    one, none = np.ones(links + 1), sparse.csr_matrix((1, links + 1))
    second = sparse.diags([one, -2.0 * one, one], [0, 1, 2], shape=(links - 1, links + 1), format="csr")
    bent = sparse.vstack([none, second, none], format="csr")
    third = bent[1:] - bent[:-1]
    found = sparse.lil_matrix(bent.T @ bent + third.T @ third / 6.0)
    for side, is_clamped in enumerate(clamped):
        if is_clamped:
            first = np.arange(EDGE) if side == 0 else links - np.arange(EDGE)
            more = np.zeros((EDGE, EDGE))
            more[1:, 1:] = _CLAMPED - found[np.ix_(first[1:], first[1:])].toarray()
            more[0, 1:] = more[1:, 0] = -more[1:, 1:].sum(axis=0)
            more[0, 0] = more[1:, 1:].sum()
            found[np.ix_(first, first)] += more
    return found.tocsr()


def shares(links: int, *, fourth: bool) -> Array:
    """Parts of a link that the nodes of a line stand for, (node,): halves at its ends, or `SHARES`."""
    out: Array = np.ones(links + 1)
    near = SHARES if fourth else np.array([0.5])
    out[: near.size] = near
    out[-near.size :] = near[::-1]
    return out
