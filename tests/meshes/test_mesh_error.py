"""The estimated error of a mesh beside the true one, on problems with known answers."""

from __future__ import annotations

import pytest

from mesh_cases import PROBLEMS


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_estimate_is_within_a_factor_of_three_of_the_error(name: str) -> None:
    problem = PROBLEMS[name]
    result = problem.estimated()
    message, true = problem.message(result), problem.miss(result)
    print(f"{name}: {message:.3g} of {true:.3g} m, order {result.attrs['mesh_order']:.2f}")
    assert 0.5 * true < message < 3.0 * true
