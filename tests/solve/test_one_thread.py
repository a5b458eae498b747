"""Linear algebra of runs is computed in one thread, whatever the process allows otherwise."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg
from scipy import sparse
from threadpoolctl import ThreadpoolController

from ropewalk.solve.free_vibration import lowest
from ropewalk.solve.modal import _coupled
from ropewalk.solve.one_thread import one_thread
from ropewalk.solve.symmetric import Solver, modes


def threads() -> set[int]:
    """How many threads libraries of linear algebra may take now."""
    return {library["num_threads"] for library in ThreadpoolController().info() if library["user_api"] == "blas"}


@pytest.fixture
def two_threads() -> Any:
    with ThreadpoolController().limit(limits=2, user_api="blas"):
        yield


def chain(count: int) -> Any:
    """Springs in a row, between two walls."""
    return sparse.diags([2.0, -1.0, -1.0], [0, 1, -1], shape=(count, count), format="csr")


@pytest.mark.usefixtures("two_threads")
def test_it_lasts_as_long_as_it_is_asked_for() -> None:
    assert threads() == {2}
    with one_thread():
        assert threads() == {1}
    assert threads() == {2}


@pytest.mark.usefixtures("two_threads")
@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("cholesky_banded", lambda: Solver(chain(40), "band").factorise(chain(40))),
        ("eigh", lambda: modes(chain(12), np.ones(12), 3)),
        ("eig", lambda: _coupled(np.array([1.0, 2.0]), np.full((2, 2), 0.1), np.zeros((2, 2)))),
        ("eigh", lambda: lowest(chain(12), chain(12) @ chain(12), 3)),
    ],
    ids=["band", "modes", "damped modes", "modes of two matrices"],
)
def test_factorisations_and_modes_take_one(name: str, call: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    seen, computed = list[set[int]](), getattr(scipy.linalg, name)

    def watched(*arguments: Any, **more: Any) -> Any:
        seen.append(threads())
        return computed(*arguments, **more)

    monkeypatch.setattr(scipy.linalg, name, watched)
    call()
    assert seen
    assert all(each == {1} for each in seen)
    assert threads() == {2}
