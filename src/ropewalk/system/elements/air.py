"""Air as small motion sees it: how the forces of the wind change with velocities and places.

A piece of the length l along t whose middle meets the air with the velocity u, across itself u_n = u - (u t) t, is
pushed by F = rho/2 d l |u_n| u_n. Nodes share what it feels as they share this (`cables.py`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array
from ropewalk.system.elements.structure import Structure


class _Dragged(NamedTuple):
    """All pieces that the air drags, as they stand still in it."""

    k: Array  # (segment,) rho/2 d, kg/m^2
    length: Array  # m
    tangent: Array  # (axis, segment)
    along: Array  # (segment,) m/s, of the air
    across: Array  # (axis, segment) m/s
    ends: Array  # (2, piece) nodes
    shared: sparse.csr_matrix  # (segment, node) how nodes share what pushes at a piece

    def by_ends(self, first: float, second: float) -> sparse.csr_matrix:
        """What is made of the first and the second end of each piece, (segment, node)."""
        count = self.k.size
        entries = np.repeat([first, second], count), (np.tile(np.arange(count), 2), self.ends.ravel())
        return sparse.csr_matrix(entries, shape=self.shared.shape)

    def matrix(self, each: Array, of: sparse.csr_matrix) -> sparse.csc_matrix:
        """Parts (axis, axis, segment) of what the nodes do `of` pieces, as forces on nodes, (place, place)."""
        axes = range(each.shape[0])
        blocks = [[self.shared.T @ sparse.diags(each[a, b]) @ of for b in axes] for a in axes]
        return sparse.bmat(blocks, format="csc")


def damping_by_wind(structure: Structure, r: Array, t: float) -> sparse.csc_matrix:
    """Minus the change of the forces of the wind with velocities, (place, place) N s/m, about what stands still.

        -dF/dv = rho/2 d l (|u_n| (1 - t t) + u_n u_n / |u_n|)

    Args:
        structure: what stands in the air.
        r: (axis, node) m, where.
        t: s, when.
    """
    if (found := _dragged(structure, r, t)) is None:
        return sparse.csc_matrix((r.size, r.size))
    tangent, across, u = found.tangent, found.across, np.linalg.norm(found.across, axis=0)
    pull = u * (np.eye(r.shape[0])[:, :, None] - tangent[:, None] * tangent[None])
    pull += _over(across[:, None] * across[None], u)
    return found.matrix(found.k * found.length * pull, found.by_ends(0.5, 0.5))


def stiffness_by_wind(structure: Structure, r: Array, t: float) -> sparse.csc_matrix:
    """Minus their change with places, (place, place) N/m, not symmetric: a piece that turns or is longer meets more.

    With c from the first end to the second, dl = t dc and l dt = (1 - t t) dc,

        -dF/dc = rho/2 d (|u_n| (t u_n + (u t) (1 - t t)) + (u t) u_n u_n / |u_n| - |u_n| u_n t).

    Args:
        structure, r, t: as of `damping_by_wind`.
    """
    if (found := _dragged(structure, r, t)) is None:
        return sparse.csc_matrix((r.size, r.size))
    tangent, across, u = found.tangent, found.across, np.linalg.norm(found.across, axis=0)
    turned = tangent[:, None] * across[None]
    turned += found.along * (np.eye(r.shape[0])[:, :, None] - tangent[:, None] * tangent[None])
    pull = u * (turned - across[:, None] * tangent[None]) + found.along * _over(across[:, None] * across[None], u)
    return found.matrix(found.k * pull, found.by_ends(-1.0, 1.0))


def _over(what: Array, size: Array) -> Array:
    """What is divided by a size, and nothing where that is none."""
    return np.divide(what, size, out=np.zeros_like(what), where=size > 0.0)


def _dragged(structure: Structure, r: Array, t: float) -> _Dragged | None:
    """All that the air drags; None: nothing, or it stands still."""
    runs, wind, n = structure.runs, structure.wind, r.shape[1]
    speed = float(np.interp(t, wind.time, wind.speed))
    if speed == 0.0 or not wind.direction.any() or not runs.width.any():
        return None
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
    ends, count = np.array([one, other]).astype(int), len(segments)
    chord = r[:, ends[1]] - r[:, ends[0]]
    length = np.maximum(np.linalg.norm(chord, axis=0), 1e-300)
    tangent = chord / length
    along = speed * (wind.direction @ tangent)
    across = speed * wind.direction[:, None] - along * tangent
    rows, columns, parts = np.array(beside).reshape(-1, 3).T
    shifted = sparse.csr_matrix((parts, (rows.astype(int), columns.astype(int))), shape=(count, n))
    found = _Dragged(0.5 * wind.density * width, length, tangent, along, across, ends, shifted)
    return found._replace(shared=found.by_ends(0.5, 0.5) + shifted)
