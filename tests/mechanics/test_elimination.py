"""Few equations solved in place, against LAPACK."""

import numpy as np
import pytest

from ropewalk.mechanics.compiled import lean
from ropewalk.mechanics.elimination import solve, solve_definite


@lean  # kernels that kernels call cannot be called from Python
def definite(A, b, n):
    solve_definite(A, b, n)


@lean
def pivoting(A, b, n):
    solve(A, b, n)


@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_definite_equations_are_solved(n):
    random = np.random.default_rng(n)
    G = random.normal(size=(n, n))
    A, b = G @ G.T + np.eye(n), random.normal(size=n)
    room, x = np.hstack([A, np.full((n, 1), np.nan)]), b.copy()  # what is beside them is not looked at
    definite(room, x, n)
    np.testing.assert_allclose(x, np.linalg.solve(A, b), rtol=0.0, atol=1e-12 * np.abs(b).max() * np.linalg.cond(A))


@pytest.mark.parametrize("n", [2, 3, 7])
def test_a_pivot_that_is_zero_is_gone_around(n):
    random = np.random.default_rng(n)
    A, b = random.normal(size=(n, n)), random.normal(size=n)
    A[0, 0] = 0.0
    room, x = A.copy(), b.copy()
    pivoting(room, x, n)
    np.testing.assert_allclose(x, np.linalg.solve(A, b), rtol=0.0, atol=1e-13 * np.abs(b).max() * np.linalg.cond(A))
