"""How the wind damps small motion: what it pushes with changes with the velocities of nodes."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.system.structure import Structure


def _pieces(structure: Structure) -> tuple[Integers, Integers, Array]:
    """Both nodes of all links and of the pieces beside sheaves, and their widths in m."""
    runs, sheaves, none = structure.runs, structure.sheaves, np.zeros(0, dtype=np.int64)
    one = [first + np.arange(links) for first, links in zip(runs.first, runs.links, strict=True)]
    width = [np.full(links, w) for w, links in zip(runs.width, runs.links, strict=True)]
    other = [nodes + 1 for nodes in one]
    if sheaves is not None:
        ends = runs.first[sheaves.run] + runs.links[sheaves.run]
        one, other = [*one, ends, sheaves.node], [*other, sheaves.node, ends + 1]
        width = [*width, runs.width[sheaves.run], runs.width[sheaves.run]]
    return np.concatenate([none, *one]), np.concatenate([none, *other]), np.concatenate([np.zeros(0), *width])


def damping_by_wind(structure: Structure, r: Array, t: float) -> sparse.csc_matrix:
    """Forces of the wind over velocities of what stands still, (place, place) N s/m.

    The force k |p| p on a piece, with p across it of the velocity of the air past it, half of it at each node.

    Args:
        structure: what stands in the wind.
        r: (axis, node) m.
        t: s.
    """
    axes, n = r.shape
    i, j, width = _pieces(structure)
    wind = structure.wind
    felt = width > 0.0
    i, j, width = i[felt], j[felt], width[felt]
    u = float(np.interp(t, wind.time, wind.speed)) * wind.direction
    if not i.size or not u.any():
        return sparse.csc_matrix((axes * n, axes * n))
    way = (r[:, j] - r[:, i]).T
    length = np.linalg.norm(way, axis=1)
    unit = way / length[:, None]
    p = u - (unit @ u)[:, None] * unit
    fast = np.maximum(np.linalg.norm(p, axis=1), 1e-300)
    across = np.eye(axes) - unit[:, :, None] * unit[:, None, :]
    k = 0.125 * wind.density * width * length * fast
    block = k[:, None, None] * (across + p[:, :, None] * p[:, None, :] / fast[:, None, None] ** 2)
    row, column, value = [], [], []
    for one in (i, j):
        for other in (i, j):
            for a in range(axes):
                for b in range(axes):
                    row.append(a * n + one)
                    column.append(b * n + other)
                    value.append(block[:, a, b])
    entries = np.concatenate(value), (np.concatenate(row), np.concatenate(column))
    return sparse.coo_matrix(entries, shape=(axes * n, axes * n)).tocsc()
