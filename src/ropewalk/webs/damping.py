"""Damping of a web as a matrix: axial dampers of links and fabric, drag, dampers of supports, the wind that blows."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse

from ropewalk.webs.pull import resistance
from ropewalk.webs.web import Array, Integers, Web

_SLOW = 1e-6  # m/s: velocities for which forces of the wind are linear


def damping_of(web: Web, t: float, r: Array) -> Any:
    """Damping (3 node, 3 node) in N s/m about places r (node, 3) in m at time t in s, sparse.

    The forces themselves are asked, for many columns at a time: of nodes so far apart that no force feels two of them.
    """
    size = 3 * web.body.mass.size
    if not (_is_damped(web) or web.wind.direction.any()):
        return sparse.csc_matrix((size, size))
    near = _neighbours(web)
    row, column, value = [], [], []
    for group in _apart(near):
        feels = near[:, group].tocoo()  # rows that feel a node of the group, one each
        for a in range(3):
            v = np.zeros_like(r)
            v[group, a] = _SLOW
            force = (resistance(web, t, r, v) - resistance(web, t, r, -v)) / (-2.0 * _SLOW)
            for b in range(3):
                row.append(3 * feels.row + b)
                column.append(3 * group[feels.col] + a)
                value.append(force[feels.row, b])
    C = sparse.coo_matrix((np.concatenate(value), (np.concatenate(row), np.concatenate(column))), shape=(size, size))
    C = C.tocsc()
    C.eliminate_zeros()
    return C


def _is_damped(web: Web) -> bool:
    fabrics, body = web.cells.fabrics, web.body
    return bool(body.drag.any() or web.links.damping.any() or fabrics[:, 3:5].any() or web.held.damping.any())


def _neighbours(web: Web) -> sparse.csc_matrix:
    """Which nodes are in one link or cell, each with itself, (node, node)."""
    links, cells, n = web.links, web.cells, web.body.mass.size
    own = slice(0, web.own_links)
    parts = [np.stack([links.one[own], links.other[own]], axis=1)]
    corner = cells.node
    parts += [corner[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]
    pairs = np.concatenate([*parts, np.arange(n)[:, None].repeat(2, axis=1)])
    one, two = np.concatenate([pairs, pairs[:, ::-1]]).T
    near = sparse.coo_matrix((np.ones(one.size), (one, two)), shape=(n, n)).tocsc()
    near.data[:] = 1.0
    return near


def _apart(near: sparse.csc_matrix) -> list[Integers]:
    """Groups of nodes no two of which have a neighbour in common."""
    reach, count = (near @ near).tocsr(), near.shape[0]
    colour = np.full(count, -1, dtype=np.int64)
    for i in range(count):
        used = set(colour[reach.indices[reach.indptr[i] : reach.indptr[i + 1]]].tolist())
        colour[i] = next(c for c in range(count) if c not in used)
    return [np.flatnonzero(colour == c) for c in range(int(colour.max(initial=-1)) + 1)]
