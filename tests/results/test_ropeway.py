"""What is told of ropeways: turns over saddles, against arcs that are known."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.results.ropeway import deflection


def over_a_saddle(left: float, right: float, radius: float, link: float) -> np.ndarray:
    """A rope that comes with one slope and goes with another, over an arc of a circle between: (1, node, 2) m."""
    turn = left - right
    lies = turn * radius
    count = int(40.0 / link)
    s = np.linspace(-20.0, 20.0, count + 1)
    slope = np.clip(0.5 * (left + right) - s / radius, right, left)
    assert lies < 20.0
    x, z = (
        np.concatenate([[0.0], np.cumsum(np.diff(s) * 0.5 * (f(slope)[1:] + f(slope)[:-1]))]) for f in (np.cos, np.sin)
    )
    middle = count // 2
    return np.array([np.column_stack([x - x[middle], z - z[middle]])])


@pytest.mark.parametrize(("left", "right"), [(0.12, -0.08), (0.3, 0.22), (-0.02, -0.3)])
def test_deflection_is_the_turn_of_the_rope_over_its_saddle(left: float, right: float) -> None:
    place = over_a_saddle(left, right, 12.0, 0.25)
    # The links beside the arc are partly on it: each turns by at most half a link over the radius.
    assert deflection(place, 0.0, 12.0)[0] == pytest.approx(left - right, abs=0.25 / 12.0)
    assert deflection(place, 0.0, 12.0)[0] > 0.9 * (left - right)


def test_a_rope_that_has_lifted_is_not_deflected() -> None:
    hangs = np.array([[[x, 0.001 * x * x] for x in np.linspace(-20.0, 20.0, 81)]])
    assert deflection(hangs, 0.0, 12.0)[0] == 0.0
