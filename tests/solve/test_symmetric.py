"""Solving with the stiffness of webs: both ways agree, say what is not definite, and find the lowest modes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.solve.symmetric import IndefiniteError, Solver, Way, modes

WAYS: tuple[Way, ...] = ("band", "sparse")


def stiffness(edges: Array, count: int, seed: int = 0, ground: float = 0.1) -> Any:
    """A graph of springs in space, each with a definite block of 3 x 3, and weaker ones to the ground."""
    root = np.random.default_rng(seed).normal(size=(len(edges), 3, 3))
    block = root @ root.transpose(0, 2, 1) + 0.1 * np.eye(3)
    one, two = edges.T
    node = np.stack([np.concatenate([one, two, one, two]), np.concatenate([one, two, two, one])])
    row, column = (
        3 * node[i, :, np.newaxis, np.newaxis] + np.arange(3).reshape((3, 1) if i == 0 else 3) for i in (0, 1)
    )
    entries = np.concatenate([block, block, -block, -block]).ravel()
    where = tuple(np.broadcast_to(axis, (4 * len(edges), 3, 3)).ravel() for axis in (row, column))
    return sparse.csr_array(sparse.coo_array((entries, where), shape=(3 * count,) * 2)) + ground * sparse.eye_array(
        3 * count, format="csr"
    )


def net(m: int, n: int) -> Array:
    number = np.arange(m * n).reshape(n, m)
    along = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
    return np.concatenate([along, np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)])


@st.composite
def graphs(draw: st.DrawFn) -> tuple[Array, int]:
    """Any graph, in one piece or in several, its nodes in any order."""
    count = draw(st.integers(2, 25))
    node = st.integers(0, count - 1)
    edges = draw(st.lists(st.tuples(node, node).filter(lambda ends: ends[0] != ends[1]), max_size=60))
    return np.array(edges, dtype=np.int64).reshape(-1, 2), count


@settings(deadline=None, max_examples=60)
@given(graphs(), st.integers(0, 1000))
def test_both_ways_give_the_answer_for_any_graph(graph: tuple[Array, int], seed: int) -> None:
    K = stiffness(*graph, seed=seed)
    b = np.random.default_rng(seed).normal(size=(K.shape[0], 2))
    exact = np.linalg.solve(K.toarray(), b)
    for way in WAYS:
        solver = Solver(K, way)
        solver.factorise(K)
        assert solver.is_definite
        # condition up to 1e4 with weak springs to the ground
        assert solver.solve(b) == pytest.approx(exact, rel=1e-10, abs=1e-11 * np.abs(exact).max())
        assert solver.solve(b[:, 1]) == pytest.approx(exact[:, 1], rel=1e-10, abs=1e-11 * np.abs(exact).max())


@pytest.mark.parametrize("way", WAYS)
def test_one_order_serves_many_matrices(way: Way) -> None:
    pattern = stiffness(net(6, 9), 54)
    solver, rng = Solver(pattern, way), np.random.default_rng(3)
    b = rng.normal(size=162)
    for seed in range(3):
        K = stiffness(net(6, 9), 54, seed=seed)
        if seed == 2:  # fewer entries than the pattern, and dense
            K = K.toarray()
            K[:30, 30:] = K[30:, :30] = 0.0
        solver.factorise(K)
        # condition 1e3
        assert K @ solver.solve(b) == pytest.approx(b, abs=1e-11)


def test_the_band_of_a_net_is_as_wide_as_its_short_side() -> None:
    order = np.random.default_rng(0).permutation(5 * 40)
    solver = Solver(stiffness(order[net(5, 40)], 200))
    # Levels of Cuthill and McKee hold five nodes of three unknowns, and neighbours are in the next one at most.
    assert solver.width <= 2 * 3 * 5
    assert solver.way == "band"


def test_narrow_bands_are_solved_as_bands_and_wide_nets_sparsely() -> None:
    def pattern(m: int, n: int) -> Any:
        edges = net(m, n)
        ones = np.ones(len(edges))
        return sparse.coo_array((ones, tuple(edges.T)), (m * n,) * 2) + sparse.coo_array(
            (ones, tuple(edges[:, ::-1].T)), (m * n,) * 2
        )

    # One unknown for each node: the width is that of the net.
    assert Solver(pattern(10, 2000)).way == "band"
    assert Solver(pattern(40, 40)).way == "band"
    # A wheel: all nodes at one.
    hub = np.stack([np.zeros(7999), np.arange(1, 8000)], axis=1).astype(np.int64)
    wheel = sparse.coo_array((np.ones(7999), tuple(hub.T)), (8000, 8000))
    assert Solver(wheel + wheel.T).way == "sparse"


def indefinite(kind: str) -> Any:
    K = stiffness(net(4, 5), 20).tolil()
    if kind == "negative":
        K[30, 30] = -5.0
    elif kind == "zero":  # an unknown that nothing holds
        K[30, :] = 0.0
        K[:, 30] = 0.0
    elif kind == "floating":  # no springs to the ground: singular but for rounding
        return stiffness(net(4, 5), 20, ground=0.0)
    elif kind == "saddle":  # positive diagonal
        K[30, 33] = K[33, 30] = 1e3
    return K.tocsr()


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind", ["negative", "zero", "floating", "saddle"])
def test_what_is_not_definite_is_said_to_be_so(way: Way, kind: str) -> None:
    K, good = indefinite(kind), stiffness(net(4, 5), 20)
    solver = Solver(abs(K) + abs(good), way)
    solver.factorise(good)
    with pytest.raises(IndefiniteError, match="not positive definite: unknown") as caught:
        solver.factorise(K)
    assert not solver.is_definite
    if kind == "zero":
        assert caught.value.unknown == 30
    with pytest.raises(RopewalkError, match="no factor"):
        solver.solve(np.ones(60))
    solver.factorise(good)  # and it goes on
    assert good @ solver.solve(np.ones(60)) == pytest.approx(np.ones(60), abs=1e-11)


@pytest.mark.parametrize("way", WAYS)
def test_the_unknown_that_is_named_is_the_one_that_yields(way: Way) -> None:
    diagonal = np.ones(12)
    diagonal[7] = -1.0
    K = sparse.diags_array(diagonal).tocsr() + 0.01 * (sparse.eye_array(12, k=1) + sparse.eye_array(12, k=-1)).tocsr()
    with pytest.raises(IndefiniteError) as caught:
        Solver(K, way).factorise(K)
    assert caught.value.unknown == 7


def string(count: int, tension: float = 3.0) -> Any:
    """Masses at unit distances on a taut string between fixed ends, across it."""
    return tension * sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(count, count)).tocsr()


@pytest.mark.parametrize("count", [1, 5, 300, 1500])
def test_modes_of_a_string_of_masses_are_exact(count: int) -> None:
    wanted = min(6, count)
    frequencies, shapes = modes(string(count), np.full(count, 0.5), 6)
    j, i = np.arange(1, wanted + 1), np.arange(1, count + 1)[:, np.newaxis]
    # The largest eigenvalue is (n/j)^2 times the one looked for: its rounding counts.
    exact = 2.0 * np.sqrt(3.0 / 0.5) * np.sin(0.5 * np.pi * j / (count + 1))
    assert frequencies == pytest.approx(exact, rel=1e-9)
    sines = np.sin(np.pi * i * j / (count + 1)) * np.sqrt(2.0 / (0.5 * (count + 1)))
    assert np.abs(np.sum(0.5 * shapes * sines, axis=0)) == pytest.approx(1.0, abs=1e-9)
    assert np.all(shapes.max(axis=0) == np.abs(shapes).max(axis=0))


def test_modes_with_unequal_masses_are_those_of_the_dense_problem_and_come_in_pairs() -> None:
    K = stiffness(net(13, 13), 169)  # 507 unknowns: by inverse iteration
    mass = np.random.default_rng(1).uniform(0.2, 3.0, 507)
    frequencies, shapes = modes(K, mass, 8)
    exact = scipy.linalg.eigh(K.toarray(), np.diag(mass), eigvals_only=True)[:8]
    assert frequencies == pytest.approx(np.sqrt(exact), rel=1e-10)  # accuracy of both eigenvalue solvers
    assert shapes.T @ (mass[:, np.newaxis] * shapes) == pytest.approx(np.eye(8), abs=1e-9)
    # A square net across itself: modes (1, 2) and (2, 1) have one frequency, and both are found.
    m, chain = 30, string(30)
    unit = sparse.eye_array(m)
    square = (sparse.kron(chain, unit) + sparse.kron(unit, chain)).tocsr()
    pairs, _ = modes(square, np.ones(m * m), 6)
    line = 12.0 * np.sin(0.5 * np.pi * np.arange(1, 7) / (m + 1)) ** 2
    expected = np.sort((line[:, np.newaxis] + line).ravel())[:6]
    assert pairs == pytest.approx(np.sqrt(expected), rel=1e-9)


@pytest.mark.parametrize("count", [40, 800])
def test_free_and_buckled_webs_have_zeros_and_negative_numbers(count: int) -> None:
    free = string(count).tolil()
    free[0, 0] = free[-1, -1] = 3.0  # ends that nothing holds
    frequencies, _ = modes(free.tocsr(), np.ones(count), 2)
    assert frequencies[0] == pytest.approx(0.0, abs=1e-6)  # root of the rounding of squares up to 12
    assert frequencies[1] == pytest.approx(2.0 * np.sqrt(3.0) * np.sin(0.5 * np.pi / count), rel=1e-6)
    pushed = string(count) - 0.5 * sparse.eye_array(count)
    frequencies, _ = modes(pushed.tocsr(), np.ones(count), 3)
    squares = 12.0 * np.sin(0.5 * np.pi * np.arange(1, 4) / (count + 1)) ** 2 - 0.5
    assert frequencies == pytest.approx(np.sign(squares) * np.sqrt(np.abs(squares)), rel=1e-8)


def test_the_first_mode_of_a_fine_mesh_is_not_taken_for_none() -> None:
    """A string of 4000 links that is 2e5 times softer across than along: squares of 9e-12 beside 12."""
    count, soft = 4000, 5e-6
    K = sparse.csr_array(sparse.block_diag([string(count), soft * string(count)]))
    frequencies, _ = modes(K, np.ones(2 * count), 3)
    exact = np.sqrt(12.0 * soft) * np.sin(0.5 * np.pi * np.arange(1, 4) / (count + 1))
    assert frequencies == pytest.approx(exact, rel=1e-3)  # rounding of 12


def test_impossible_systems_are_refused() -> None:
    K = string(5)
    for way in WAYS:
        solver = Solver(K, way)
        with pytest.raises(ValueError, match="for 5 unknowns, not for a matrix of shape"):
            solver.factorise(string(6))
        with pytest.raises(ValueError, match=r"entry at \(0, 4\) that is not in the pattern"):
            solver.factorise(K.toarray() + np.eye(5, k=4) + np.eye(5, k=-4))
        bad = K.copy()
        bad.data[4] = np.nan
        with pytest.raises(ValueError, match="not finite in row 1"):
            solver.factorise(bad)
    with pytest.raises(ValueError, match="pattern of a stiffness is symmetric"):
        Solver(np.eye(4) + np.eye(4, k=1))
    with pytest.raises(ValueError, match="square"):
        Solver(np.ones((3, 4)))
    with pytest.raises(ValueError, match=r"^way must"):
        Solver(K, "dense")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^mass must be of shape"):
        modes(K, np.ones(4), 2)
    with pytest.raises(ValueError, match="but unknown 2 has not"):
        modes(K, np.array([1.0, 1.0, 0.0, 1.0, 1.0]), 2)
    with pytest.raises(ValueError, match=r"^how_many must"):
        modes(K, np.ones(5), 0)
