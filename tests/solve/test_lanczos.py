"""Modes by iteration: a second attempt, and an error with its cause where neither converges."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import ArpackNoConvergence, eigsh

from ropewalk.errors import RopewalkError
from ropewalk.solve import lanczos

MATRIX = sparse.diags(np.arange(1.0, 201.0)).tocsc()


def failing(times: int) -> Any:
    calls = []

    def solve(*arguments: Any, **options: Any) -> Any:
        calls.append(options)
        if len(calls) <= times:
            raise ArpackNoConvergence("No convergence (%s/%s eigenvectors converged)", np.zeros(0), np.zeros((0, 0)))
        return eigsh(*arguments, **options)

    return solve


def test_a_second_attempt_takes_more_vectors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lanczos, "eigsh", failing(1))
    values, _ = lanczos.eigenpairs(MATRIX, 3, which="LA")
    assert np.sort(values) == pytest.approx([198.0, 199.0, 200.0])


def test_modes_that_do_not_converge_are_an_error_with_cause_and_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lanczos, "eigsh", failing(2))
    with pytest.raises(RopewalkError, match=r"3 modes of 200 unknowns do not converge .*many are alike.*fewer modes"):
        lanczos.eigenpairs(MATRIX, 3, which="LA")


def test_many_alike_structures_start_in_their_mode(monkeypatch: pytest.MonkeyPatch) -> None:
    """61 equal beams side by side have each frequency 61 times; a failure of the iteration is no fault of ropewalk."""
    from ropewalk.model import Scenario
    from ropewalk.simulate import simulate

    beam = {"start": [0, 0], "end": [60, 0], "length": 60, "mass": 900, "bending_stiffness": 5.72e9,
            "axial_stiffness": 1e9, "elements": 12}  # fmt: skip
    start = {"kind": "mode", "amplitude": 5e-3, "direction": [0, 1, 0]}
    run = {"kind": "dynamic", "geometry": "linearised", "until": 0.04, "every": 0.02, "start": start}
    crowd = {"kind": "crowd", "on": "d0", "number": 20, "balance": {"height": 1.17}}
    tree = {"lines": {f"d{number}": beam for number in range(61)}, "loads": {"p": crowd}, "run": run}
    assert simulate(Scenario.model_validate(tree)).attrs["outcome"] in ("completed", "doubtful")
    monkeypatch.setattr(lanczos, "eigsh", failing(2))
    with pytest.raises(RopewalkError, match="do not converge"):
        simulate(Scenario.model_validate(tree))
