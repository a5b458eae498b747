"""Ropes that are held between their ends, at rest and as they swing: each span is a rope by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.capabilities import SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate, spectrum_of

ROPE = {"start": [0, 0], "end": [20, 0], "mass": 1.0, "axial_stiffness": 1e6, "elements": 80}
REST = {"kind": "equilibrium"}


def scenario(lines: dict[str, Any], gravity: float = 9.81, **more: Any) -> Scenario:
    return Scenario.model_validate({"gravity": gravity, "lines": lines, "run": REST, **more})


def test_a_rope_of_given_tension_is_held_where_its_straight_line_has_that_point() -> None:
    """However long the rope must be for that tension."""
    rope = ROPE | {"tension": 500.0, "supports": {"saddle": {"at": 7.0, "kind": "fixed"}}}
    asked = scenario({"rope": rope})
    assert engine_of(asked) is SYSTEM
    found = simulate(asked)
    length, node = float(found.xi[-1]), int(np.abs(found.xi.values - 7.0).argmin())
    assert length > 20.005
    np.testing.assert_allclose(found.position.values[0, node], [20.0 * 7.0 / length, 0.0], atol=1e-9)
    h = np.diff(found.xi.values)
    assert float((found.tension.values[0] * h).sum() / h.sum()) == pytest.approx(500.0, rel=1e-8)


def test_a_held_rope_rests_as_two_ropes_that_end_there() -> None:
    at, place = 8.2, [8.0, 0.3]
    saddle = {"at": at, "kind": "fixed", "position": place}
    one = simulate(scenario({"rope": ROPE | {"length": 20.5, "supports": {"saddle": saddle}}}))
    feels = ROPE | {"wind_drag": 1e-30}  # calm air, so that the system computes them, too
    near = feels | {"end": place, "length": at, "elements": 32}
    far = feels | {"start": place, "length": 20.5 - at, "elements": 48}
    two = simulate(scenario({"near": near, "far": far}, wind={"direction": [0.0, 1.0], "speed": 0.0}))
    np.testing.assert_allclose(one.reaction.values[0, 0], two.reaction.values[0, 0], rtol=1e-6)
    np.testing.assert_allclose(one.reaction.values[0, 1], two.reaction.values[0, 3], rtol=1e-6)
    at_saddle = two.reaction.values[0, 1] + two.reaction.values[0, 2]
    np.testing.assert_allclose(one.reaction.values[0, 2], at_saddle, rtol=1e-6)


def test_each_span_of_a_held_string_swings_by_itself() -> None:
    """n pi c / l; links make it lower, by (pi n h / l)^2 / 24: 4e-5."""
    rope = ROPE | {"length": 19.8, "supports": {"saddle": {"at": 0.4 * 19.8, "kind": "fixed"}}}
    modes = spectrum_of(scenario({"rope": rope}, gravity=0.0), how_many=4).modes
    assert modes is not None
    strain = 20.0 / 19.8 - 1.0
    c = np.sqrt(1e6 * strain * (1.0 + strain))
    exact = np.sort([np.pi * c / 12.0, np.pi * c / 12.0, np.pi * c / 8.0, np.pi * c / 8.0])
    np.testing.assert_allclose(modes.frequency, exact, rtol=6e-4)
