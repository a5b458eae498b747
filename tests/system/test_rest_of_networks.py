"""Rest without loads of lines that only the system computes, and lengths found for a tension.

Source of the exact values: the elastic catenary, `ropewalk.theory.rope`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq

from motion_cases import order
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.theory import rope

CALM = {"direction": [0.0, 1.0], "speed": 0.0}
AIRY: dict[str, Any] = {
    "start": [0, 0], "end": [20, 0], "length": 20.3, "mass": 1.0, "axial_stiffness": 1e4, "wind_drag": 1e-30,
}  # fmt: skip


def run_of(lines: dict[str, Any], run: dict[str, Any] | None = None, **more: Any) -> xr.Dataset:
    return simulate(Scenario.model_validate({"lines": lines, "run": run or {"kind": "equilibrium"}, **more}))


def exact_rope(length: float) -> rope.RestingRope:
    """The elastic catenary."""
    return rope.elastic_catenary(span=20.0, length=length, weight=9.81, axial_stiffness=1e4)


def test_one_line_at_rest_is_the_elastic_catenary() -> None:
    links, missed = [20, 40, 80], []
    for n in links:
        result = run_of({"rope": {**AIRY, "elements": n}}, wind=CALM)
        exact = exact_rope(20.3)
        missed.append(float(np.abs(result.position.values[0] - exact.position(result.xi.values)).max()))
        off = np.abs(result.tension.values[0] - exact.tension(result.link_xi.values))
        assert np.median(off) < 0.02 * (20 / n) ** 2  # N
        assert off.max() < 0.53 * 20 / n  # of the last link, beyond which no line goes on
        assert result.reaction.values[0, 0] == pytest.approx(exact.start_reaction, abs=1e-3 * (20 / n) ** 1.5)
    print(missed)
    assert missed[-1] < 4e-6  # a polygon misses 1.4e-4 m and, with 20 links, 0.17 N
    assert order([1.0 / n for n in links], missed) > 1.8


def test_a_line_of_given_tension_is_as_long_as_the_elastic_catenary_of_that_mean_tension() -> None:
    def mean(length: float) -> float:
        exact = exact_rope(length)
        return float(np.mean(exact.tension(length * (np.arange(4000) + 0.5) / 4000)))

    length = brentq(lambda s: mean(s) - 500.0, 18.0, 20.2, xtol=1e-12)
    links, missed = [20, 40], []
    for n in links:
        line = {**AIRY, "length": None, "tension": 500.0, "elements": n}
        result = run_of({"rope": line}, wind=CALM)
        assert float(result.tension.values[0].mean()) == pytest.approx(500.0, rel=1e-9)
        missed.append(abs(float(result.xi[-1]) - length))
    print(missed)
    assert missed[-1] < 1e-5
