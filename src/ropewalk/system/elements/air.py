"""Air as small motion sees it: how the forces of the wind change with velocities."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array
from ropewalk.system.elements.structure import Structure


def damping_by_wind(structure: Structure, r: Array, t: float) -> sparse.csc_matrix:
    """Minus the change of the forces of the wind with velocities, (place, place) N s/m, about what stands still.

    A piece of the length l whose middle meets the air at u across itself is pushed by F = rho/2 d l |u| u, so that

        -dF/dv = rho/2 d l (|u| (1 - t t) + u u / |u|),

    t its tangent. Nodes share it as the forces (`cables.py`).

    Args:
        structure: what stands in the air.
        r: (axis, node) m, where.
        t: s, when.
    """
    runs, wind, (axes, n) = structure.runs, structure.wind, r.shape
    speed = float(np.interp(t, wind.time, wind.speed))
    if speed == 0.0 or not wind.direction.any() or not runs.width.any():
        return sparse.csc_matrix((axes * n, axes * n))
    segments: list[tuple[int, int, float]] = []  # nodes, m
    beside: list[tuple[int, int, float]] = []  # piece, node, part that the node bears for an end
    for s in np.flatnonzero(runs.width > 0.0):
        first, links, begin = int(runs.first[s]), int(runs.links[s]), len(segments)
        segments += [(i, i + 1, runs.width[s]) for i in range(first, first + links)]
        for side, (end, way, link) in enumerate(((first, 1, 0), (first + links, -1, links - 1)) if links > 1 else ()):
            near, far = runs.shift[s, side]
            beside += [(begin + link, end + i * way, part) for i, part in enumerate((-near - far, near, far))]
    if structure.sheaves is not None:
        for b, s in zip(structure.sheaves.node.tolist(), structure.sheaves.run, strict=True):
            e = int(runs.first[s] + runs.links[s])
            segments += [(e, b, runs.width[s]), (b, e + 1, runs.width[s])]
    one, other, width = np.array(segments).T
    ends, count = np.concatenate([one, other]).astype(int), len(segments)
    chord = r[:, ends[count:]] - r[:, ends[:count]]
    length = np.maximum(np.linalg.norm(chord, axis=0), 1e-300)
    tangent = chord / length
    across = speed * (wind.direction[:, None] - (wind.direction @ tangent) * tangent)
    u = np.linalg.norm(across, axis=0)
    k = 0.5 * wind.density * width * length
    entries = np.full(2 * count, 0.5), (np.tile(np.arange(count), 2), ends)
    mean = sparse.csr_matrix(entries, shape=(count, n))
    rows, columns, parts = np.array(beside).reshape(-1, 3).T
    shared = mean + sparse.csr_matrix((parts, (rows.astype(int), columns.astype(int))), shape=(count, n))
    pull = u * (np.eye(axes)[:, :, None] - tangent[:, None] * tangent[None])
    pull += np.divide(across[:, None] * across[None], u, out=np.zeros_like(pull), where=u > 0.0)
    blocks = [[shared.T @ sparse.diags(k * pull[a, b]) @ mean for b in range(axes)] for a in range(axes)]
    return sparse.bmat(blocks, format="csc")
