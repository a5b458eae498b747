"""The search for equilibrium, on structures small enough to be solved by hand."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import scipy.sparse as sparse

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.solve.minimum import is_definite, settle

WIDE, HIGH, EA = 1.0, 0.2, 1e3


class Truss:
    """Two bars from supports at -1 m and 1 m to a node between them, pushed down by a force (von Mises 1923).

    Args:
        force: N downwards.
        only: which of x and z may move.
        sliding: whether the supports slide along x with the node: nothing holds it there.
    """

    size, is_symmetric = 2.0 * WIDE, True

    def __init__(self, force: float = 0.0, only: tuple[int, ...] = (0, 1), *, sliding: bool = False) -> None:
        self.given, self.only, self.sliding = np.array([0.0, -force]), list(only), sliding
        self.bar = float(np.hypot(WIDE, HIGH))

    def bars(self, r: Array) -> list[Array]:
        x = 0.0 if self.sliding else r[0]
        return [np.array([x + WIDE, r[1]]), np.array([x - WIDE, r[1]])]

    @property
    def free(self) -> sparse.csc_matrix:
        return sparse.identity(2, format="csc")[:, self.only]

    def energy(self, r: Array) -> float:
        stored = sum(0.5 * EA / self.bar * (np.linalg.norm(d) - self.bar) ** 2 for d in self.bars(r))
        return float(stored - self.given @ r)

    def out_of_balance(self, r: Array) -> Array:
        pull = self.given - sum(EA * (np.linalg.norm(d) / self.bar - 1.0) * d / np.linalg.norm(d) for d in self.bars(r))
        return np.asarray(self._own(pull))[self.only]

    def _own(self, pull: Array) -> Array:
        return pull * [0.0 if self.sliding else 1.0, 1.0]

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        K = np.zeros((2, 2))
        for d in self.bars(r):
            e, length = d / np.linalg.norm(d), np.linalg.norm(d)
            N = EA * (length / self.bar - 1.0)
            K += EA / self.bar * np.outer(e, e) + N / length * (np.eye(2) - np.outer(e, e))
        if self.sliding:
            K[0] = K[:, 0] = 0.0
        return sparse.csc_matrix(K[np.ix_(self.only, self.only)])

    def convex(self, r: Array) -> sparse.csc_matrix:
        return self.stiffness(r)

    def pattern(self, r: Array) -> sparse.csc_matrix:
        return sparse.csc_matrix(np.ones((len(self.only), len(self.only))))

    def stability(self, r: Array) -> tuple[sparse.csc_matrix, np.ndarray]:
        return self.stiffness(r), np.arange(len(self.only))

    def part(self, r: Array, way: Array) -> str:
        return "the node"

    def moved(self, r: Array, step: Array) -> Array:
        out = r.copy()
        out[self.only] += step
        return out

    def arrived(self, r: Array) -> tuple[Array, bool]:
        return r, False

    def approaches(self, start: Array, way: str) -> Iterator[Array]:
        yield from ()


def force_at(z: float) -> float:
    """What holds the node at a height: 2 EA (1 / sqrt(1 + z^2) - 1 / bar) z over 1 m."""
    bar = np.hypot(WIDE, HIGH)
    return float(2.0 * EA * z * (1.0 / np.hypot(WIDE, z) - 1.0 / bar))


@pytest.mark.parametrize("z", [0.15, 0.19, -0.25, -0.6])
def test_a_truss_stands_where_its_bars_bear_the_force(z: float) -> None:
    found = settle(Truss(force_at(z), (1,)), np.array([0.0, z + 0.01]))
    assert found[1] == pytest.approx(z, abs=1e-12)
    assert found[0] == 0.0


def test_beyond_its_limit_it_snaps_through() -> None:
    """At z = 0.115 m the force is largest; a little more of it, and the only rest is below the supports."""
    limit = max(force_at(z) for z in np.linspace(0.05, 0.2, 2001))
    assert settle(Truss(0.99 * limit, (1,)), np.array([0.0, HIGH]))[1] > 0.1
    below = settle(Truss(1.01 * limit, (1,)), np.array([0.0, HIGH]))[1]
    assert below < -HIGH
    assert force_at(below) == pytest.approx(1.01 * limit, rel=1e-9)


@pytest.mark.parametrize("only", [(1,), (0, 1)])
def test_flat_it_is_balanced_and_leaves_that(only: tuple[int, ...]) -> None:
    truss = Truss(only=only)
    assert np.abs(truss.out_of_balance(np.zeros(2))).max() == 0.0
    found = settle(truss, np.zeros(2))
    assert abs(found[1]) == pytest.approx(HIGH, rel=1e-9)
    assert found[0] == pytest.approx(0.0, abs=1e-9)


def test_what_is_free_to_slide_stays() -> None:
    truss = Truss(force_at(0.19), sliding=True)
    found = settle(truss, np.array([0.7, 0.2]))
    assert found == pytest.approx([0.7, 0.19], abs=1e-9)
    assert is_definite(truss.stiffness(found))


def test_what_nothing_holds_against_its_force_is_refused() -> None:
    truss = Truss(sliding=True)
    truss._own = lambda pull: pull + np.array([10.0, 0.0])  # type: ignore[method-assign]
    truss.energy = lambda r: -10.0 * float(r[0])  # type: ignore[method-assign]
    with pytest.raises(EquilibriumError, match=r"no equilibrium was found.*: the node is free to move"):
        settle(truss, np.array([0.0, HIGH]))
