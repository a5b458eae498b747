"""Block-tridiagonal linear systems: one small block for each node of a chain, real or complex.

Blocks of 2 x 2 (the plane) and of 3 x 3 are written out: their loops are shorter than what it costs to run them.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import kernel


@kernel
def _invert(block, out):
    """Inverse of a small block by Gauss-Jordan elimination with partial pivoting; returns False if singular."""
    d = block.shape[0]
    for a in range(d):
        for b in range(d):
            out[a, b] = 1.0 if a == b else 0.0
    for a in range(d):
        pivot = a
        for b in range(a + 1, d):
            if abs(block[b, a]) > abs(block[pivot, a]):
                pivot = b
        if abs(block[pivot, a]) == 0.0:
            return False
        if pivot != a:
            for c in range(d):
                block[a, c], block[pivot, c] = block[pivot, c], block[a, c]
                out[a, c], out[pivot, c] = out[pivot, c], out[a, c]
        scale = 1.0 / block[a, a]
        for c in range(d):
            block[a, c] *= scale
            out[a, c] *= scale
        for b in range(d):
            if b != a:
                ratio = block[b, a]
                for c in range(d):
                    block[b, c] -= ratio * block[a, c]
                    out[b, c] -= ratio * out[a, c]
    return True


@kernel
def _factorise_plane(diagonal, upper, lower, inverse, ratio):
    for i in range(diagonal.shape[0]):
        a, b, c, d = diagonal[i, 0, 0], diagonal[i, 0, 1], diagonal[i, 1, 0], diagonal[i, 1, 1]
        if i > 0:
            p, q, r, s = lower[i - 1, 0, 0], lower[i - 1, 0, 1], lower[i - 1, 1, 0], lower[i - 1, 1, 1]
            e, f, g, h = inverse[i - 1, 0, 0], inverse[i - 1, 0, 1], inverse[i - 1, 1, 0], inverse[i - 1, 1, 1]
            p, q, r, s = p * e + q * g, p * f + q * h, r * e + s * g, r * f + s * h
            ratio[i - 1, 0, 0], ratio[i - 1, 0, 1], ratio[i - 1, 1, 0], ratio[i - 1, 1, 1] = p, q, r, s
            e, f, g, h = upper[i - 1, 0, 0], upper[i - 1, 0, 1], upper[i - 1, 1, 0], upper[i - 1, 1, 1]
            a, b, c, d = a - (p * e + q * g), b - (p * f + q * h), c - (r * e + s * g), d - (r * f + s * h)
        determinant = a * d - b * c
        if determinant == 0.0:
            return False
        scale = 1.0 / determinant
        inverse[i, 0, 0], inverse[i, 0, 1] = d * scale, -b * scale
        inverse[i, 1, 0], inverse[i, 1, 1] = -c * scale, a * scale
    return True


@kernel
def _factorise_space(diagonal, upper, lower, inverse, ratio):
    for i in range(diagonal.shape[0]):
        block, out = diagonal[i], inverse[i]
        if i > 0:
            low, up, before, part = lower[i - 1], upper[i - 1], inverse[i - 1], ratio[i - 1]
            for a in range(3):
                for b in range(3):
                    part[a, b] = low[a, 0] * before[0, b] + low[a, 1] * before[1, b] + low[a, 2] * before[2, b]
            for a in range(3):
                for b in range(3):
                    block[a, b] -= part[a, 0] * up[0, b] + part[a, 1] * up[1, b] + part[a, 2] * up[2, b]
        # The inverse from the cross products of the rows.
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            out[0, a] = block[b, 1] * block[c, 2] - block[b, 2] * block[c, 1]
            out[1, a] = block[b, 2] * block[c, 0] - block[b, 0] * block[c, 2]
            out[2, a] = block[b, 0] * block[c, 1] - block[b, 1] * block[c, 0]
        determinant = block[0, 0] * out[0, 0] + block[0, 1] * out[1, 0] + block[0, 2] * out[2, 0]
        if determinant == 0.0:
            return False
        scale = 1.0 / determinant
        for a in range(3):
            for b in range(3):
                out[a, b] *= scale
    return True


@kernel
def factorise(diagonal, upper, lower, inverse, ratio):
    """Block LU of a block-tridiagonal matrix.

    Args:
        diagonal: (n, d, d), destroyed.
        upper, lower: (n - 1, d, d), the blocks (i, i + 1) and (i + 1, i).
        inverse: (n, d, d), overwritten: inverses of the pivot blocks.
        ratio: (n - 1, d, d), overwritten: lower times the inverse before it.

    Returns:
        False if a pivot block is singular.
    """
    n, d = diagonal.shape[0], diagonal.shape[1]
    if d == 2:
        return _factorise_plane(diagonal, upper, lower, inverse, ratio)
    if d == 3:
        return _factorise_space(diagonal, upper, lower, inverse, ratio)
    for i in range(n):
        if i > 0:
            for a in range(d):
                for b in range(d):
                    total = diagonal[i, a, b] * 0.0
                    for c in range(d):
                        total += lower[i - 1, a, c] * inverse[i - 1, c, b]
                    ratio[i - 1, a, b] = total
            for a in range(d):
                for b in range(d):
                    total = diagonal[i, a, b]
                    for c in range(d):
                        total -= ratio[i - 1, a, c] * upper[i - 1, c, b]
                    diagonal[i, a, b] = total
        if not _invert(diagonal[i], inverse[i]):
            return False
    return True


@kernel
def _substitute_plane(upper, inverse, ratio, x):
    n = x.shape[0]
    u, v = x[0, 0], x[0, 1]
    for i in range(1, n):
        u, v = (
            x[i, 0] - (ratio[i - 1, 0, 0] * u + ratio[i - 1, 0, 1] * v),
            x[i, 1] - (ratio[i - 1, 1, 0] * u + ratio[i - 1, 1, 1] * v),
        )
        x[i, 0], x[i, 1] = u, v
    u, v = inverse[n - 1, 0, 0] * u + inverse[n - 1, 0, 1] * v, inverse[n - 1, 1, 0] * u + inverse[n - 1, 1, 1] * v
    x[n - 1, 0], x[n - 1, 1] = u, v
    for i in range(n - 2, -1, -1):
        p = x[i, 0] - (upper[i, 0, 0] * u + upper[i, 0, 1] * v)
        q = x[i, 1] - (upper[i, 1, 0] * u + upper[i, 1, 1] * v)
        u, v = inverse[i, 0, 0] * p + inverse[i, 0, 1] * q, inverse[i, 1, 0] * p + inverse[i, 1, 1] * q
        x[i, 0], x[i, 1] = u, v


@kernel
def _substitute_space(upper, inverse, ratio, x):
    n = x.shape[0]
    for i in range(1, n):
        for a in range(3):
            x[i, a] -= (
                ratio[i - 1, a, 0] * x[i - 1, 0] + ratio[i - 1, a, 1] * x[i - 1, 1] + ratio[i - 1, a, 2] * x[i - 1, 2]
            )
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            for a in range(3):
                x[i, a] -= upper[i, a, 0] * x[i + 1, 0] + upper[i, a, 1] * x[i + 1, 1] + upper[i, a, 2] * x[i + 1, 2]
        p, q, s = x[i, 0], x[i, 1], x[i, 2]
        for a in range(3):
            x[i, a] = inverse[i, a, 0] * p + inverse[i, a, 1] * q + inverse[i, a, 2] * s


@kernel
def substitute(upper, inverse, ratio, x):
    """Solve with a factorised matrix; x (n, d) is the right-hand side and becomes the solution.

    Allocates nothing in the plane and in space.
    """
    n, d = x.shape
    if d == 2:
        _substitute_plane(upper, inverse, ratio, x)
        return
    if d == 3:
        _substitute_space(upper, inverse, ratio, x)
        return
    for i in range(1, n):
        for a in range(d):
            total = x[i, a]
            for b in range(d):
                total -= ratio[i - 1, a, b] * x[i - 1, b]
            x[i, a] = total
    keep = np.zeros(d, dtype=x.dtype)
    for i in range(n - 1, -1, -1):
        for a in range(d):
            total = x[i, a]
            if i < n - 1:
                for b in range(d):
                    total -= upper[i, a, b] * x[i + 1, b]
            keep[a] = total
        for a in range(d):
            total = x[i, a] * 0.0
            for b in range(d):
                total += inverse[i, a, b] * keep[b]
            x[i, a] = total
