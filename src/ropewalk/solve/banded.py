"""Block-tridiagonal linear systems: one small block for each node of a chain, real or complex."""

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
def substitute(upper, inverse, ratio, x):
    """Solve with a factorised matrix; x (n, d) is the right-hand side and becomes the solution."""
    n, d = x.shape
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
