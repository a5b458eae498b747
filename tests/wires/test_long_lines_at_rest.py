"""Long lines are solved for piece by piece, which changes nothing.

Source: the same line in one piece.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from overhead_cases import SIMPLE_AC, long_line
from ropewalk.model import Scenario
from ropewalk.wires import rest
from ropewalk.wires.task import ready
from ropewalk.wiring import task_of

RUN = {"geometry": "linearised"}
STIFF = {key: SIMPLE_AC[key] for key in ("contact_wire", "messenger_wire")}


@pytest.mark.parametrize("changed", [{}, STIFF])
@pytest.mark.parametrize("beside", [1500, 600])
def test_a_line_at_rest_is_that_of_one_piece(
    changed: dict[str, Any], beside: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: Scenario = long_line(30, None, run=RUN, **changed)
    whole, used, solve = task_of(asked), list[Any](), rest.solve_by_stretches
    one = ready(whole)[1]
    monkeypatch.setattr(rest, "AT_ONCE", 100)
    monkeypatch.setattr(rest, "_PIECE", 2000)
    monkeypatch.setattr(rest, "_BESIDE", beside)  # 13 and 5 spans with links of 0.5 m

    def noted(*given: Any, **more: Any) -> Any:
        used.append(solve(*given, **more))
        return used[-1]

    monkeypatch.setattr(rest, "solve_by_stretches", noted)
    parts = task_of(asked)
    other = ready(parts)[1]
    assert len(used) > 3
    assert all(each is not None for each in used)
    lengths = [np.array([tie.length for tie in task.plan.ties]) for task in (whole, parts)]
    np.testing.assert_allclose(*lengths, rtol=0.0, atol=1e-11)  # m; rounding of heights of 6 m, many times
    np.testing.assert_allclose(one.position, other.position, rtol=0.0, atol=1e-11)
    assert one.rest is not None
    assert other.rest is not None
    np.testing.assert_allclose(one.rest.tie_force, other.rest.tie_force, rtol=0.0, atol=2e-6)  # N, of 100 kN/m
    np.testing.assert_allclose(one.rest.hold_force, other.rest.hold_force, rtol=0.0, atol=2e-6)


def test_what_far_away_is_felt_is_solved_for_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wire that hangs from its ends alone: pieces know nothing of each other, and say so."""
    nodes = 4001
    K = rest.sparse.diags([-np.ones(nodes - 1), 2.0 * np.ones(nodes), -np.ones(nodes - 1)], [-1, 0, 1], format="csr")
    free, x, load = np.ones(nodes, dtype=np.bool_), np.arange(float(nodes)), -np.ones(nodes)
    free[[0, -1]] = False
    given = (K, rest.sparse.csr_matrix((0, nodes)), np.zeros(0), free, load, np.zeros(0), x)
    monkeypatch.setattr(rest, "_PIECE", 500)
    monkeypatch.setattr(rest, "_BESIDE", 100)
    assert rest.solve_by_stretches(*given) is None
    monkeypatch.setattr(rest, "AT_ONCE", 100)
    z = rest._solve(*given)[0]
    np.testing.assert_allclose(z, -0.5 * x * (x[-1] - x), rtol=1e-9, atol=1e-6)
