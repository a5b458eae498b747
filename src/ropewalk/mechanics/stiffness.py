"""Stiffness and damping of the links as blocks, one for each link: dT/dr of the force vector that a link exerts."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import kernel


@kernel
def link_stiffness(p, rest, r, i, block):
    """Tangent stiffness of link i: T'/rest along it and T/length across it, N/m, into block (axis, axis)."""
    dim = r.shape[0]
    square = 0.0
    for a in range(dim):
        square += (r[a, i + 1] - r[a, i]) ** 2
    length = np.sqrt(square)
    eps = length / rest - 1.0
    along, across = law.tangent(p, eps) / rest, law.tension(p, eps) / length
    for a in range(dim):
        da = r[a, i + 1] - r[a, i]
        for b in range(dim):
            block[a, b] = (along - across) * da * (r[b, i + 1] - r[b, i]) / square
        block[a, a] += across


@kernel
def link_damping(c, rest, r, i, block):
    """Kelvin-Voigt damping of link i: c/rest along it, N s/m, into block (axis, axis)."""
    dim = r.shape[0]
    square = 0.0
    for a in range(dim):
        square += (r[a, i + 1] - r[a, i]) ** 2
    for a in range(dim):
        for b in range(dim):
            block[a, b] = c / rest * (r[a, i + 1] - r[a, i]) * (r[b, i + 1] - r[b, i]) / square


@kernel
def strand_blocks(p, c, ell, r, diagonal, off, damping_diagonal, damping_off):
    """Stiffness and damping matrices of the inner nodes of one strand as block-tridiagonal matrices.

    Args:
        p, c: axial law and Kelvin-Voigt damping.
        ell: (link,) unstrained lengths, m.
        r: (axis, node) m.
        diagonal, damping_diagonal: (node - 2, axis, axis), overwritten.
        off, damping_off: (node - 3, axis, axis), overwritten: the blocks (i, i + 1), equal to (i + 1, i).
    """
    dim, n = r.shape[0], ell.size
    stiff, damp = np.zeros((dim, dim)), np.zeros((dim, dim))
    for i in range(n - 1):
        for a in range(dim):
            for b in range(dim):
                diagonal[i, a, b] = damping_diagonal[i, a, b] = 0.0
    for i in range(n):
        link_stiffness(p, ell[i], r, i, stiff)
        link_damping(c, ell[i], r, i, damp)
        for a in range(dim):
            for b in range(dim):
                for node in range(max(i - 1, 0), min(i + 1, n - 1)):
                    diagonal[node, a, b] += stiff[a, b]
                    damping_diagonal[node, a, b] += damp[a, b]
                if 0 < i < n - 1:
                    off[i - 1, a, b] = -stiff[a, b]
                    damping_off[i - 1, a, b] = -damp[a, b]
