"""Few linear equations within a step: Gauss's elimination in place."""

from __future__ import annotations

from ropewalk.mechanics.compiled import lean_inner


@lean_inner
def solve_definite(A, b, n):
    """Solve A x = b of the first n rows in place; A, positive definite, is lost, and b becomes x."""
    for c in range(n):
        for i in range(c + 1, n):
            factor = A[i, c] / A[c, c]
            if factor != 0.0:
                for j in range(c, n):
                    A[i, j] -= factor * A[c, j]
                b[i] -= factor * b[c]
    _substitute(A, b, n)


@lean_inner
def solve(A, b, n):
    """The same with pivoting, for any A that is not singular."""
    for c in range(n):
        pivot = c
        for i in range(c + 1, n):
            if abs(A[i, c]) > abs(A[pivot, c]):
                pivot = i
        if pivot != c:
            for j in range(c, n):
                A[c, j], A[pivot, j] = A[pivot, j], A[c, j]
            b[c], b[pivot] = b[pivot], b[c]
        for i in range(c + 1, n):
            factor = A[i, c] / A[c, c]
            for j in range(c, n):
                A[i, j] -= factor * A[c, j]
            b[i] -= factor * b[c]
    _substitute(A, b, n)


@lean_inner
def _substitute(A, b, n):
    """Solve A x = b in place, with A above its diagonal only."""
    for c in range(n - 1, -1, -1):
        for j in range(c + 1, n):
            b[c] -= A[c, j] * b[j]
        b[c] /= A[c, c]
