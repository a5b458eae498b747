"""Every explicit method converges at its order in time, also while loads travel and change their seats."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion_cases import order, slack_rope
from ropewalk.chains.spectrum import state_at
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

HALF_PASSAGE = 0.5 * 19.1 / 40 / 10.0  # s; seats change at odd multiples of it, so that its fractions are kept as steps
UNTIL = 25 * HALF_PASSAGE


def end_state(scenario: Scenario, method: str, step: float) -> np.ndarray:
    run = scenario.run.model_copy(update={"method": method, "step": step})
    return state_at(scenario.model_copy(update={"run": run}), scenario.run.until)[1].r


def taut_rope(damping: float = 0.0, **changes: Any) -> Scenario:
    """A rope with a prestrain of 2 %, which a heavy force crosses: large slopes, but no compression."""
    line = {"length": 19.1, "axial_stiffness": 2e4, **changes.pop("line", {})}
    return slack_rope(40, damping, line=line, run={"until": UNTIL, "every": UNTIL}, **changes)


@pytest.mark.parametrize(
    ("method", "steps", "wanted"),
    [("verlet", [1 / 24, 1 / 48, 1 / 96], 2.0), ("rkn6", [1 / 8, 1 / 10, 1 / 14], 6.0)],
)
def test_undamped_methods_have_their_order_with_a_riding_load(method: str, steps: list[float], wanted: float) -> None:
    scenario = taut_rope()
    reference = end_state(scenario, "rkn6", HALF_PASSAGE / 40)
    errors = [float(np.abs(end_state(scenario, method, h * HALF_PASSAGE) - reference).max()) for h in steps]
    assert order(steps, errors) == pytest.approx(wanted, abs=0.15 if wanted == 2.0 else 0.3)


def test_verlet_keeps_order_two_with_line_damping() -> None:
    scenario, steps = taut_rope(damping=20.0), [1 / 48, 1 / 96, 1 / 192]
    reference = end_state(scenario, "verlet", HALF_PASSAGE / 1536)
    errors = [float(np.abs(end_state(scenario, "verlet", h * HALF_PASSAGE) - reference).max()) for h in steps]
    assert order(steps, errors) == pytest.approx(2.0, abs=0.1)


def test_verlet_keeps_order_two_with_drag() -> None:
    scenario, steps = taut_rope(line={"drag": 2.0}), [1 / 24, 1 / 48, 1 / 96]
    reference = end_state(scenario, "rkn6", HALF_PASSAGE / 40)
    errors = [float(np.abs(end_state(scenario, "verlet", h * HALF_PASSAGE) - reference).max()) for h in steps]
    assert order(steps, errors) == pytest.approx(2.0, abs=0.15)


def test_rkn6_stays_accurate_with_drag() -> None:
    """Drag acts in the drifts; at a riding node it meets the flux of momentum, which costs the high order."""
    scenario = taut_rope(line={"drag": 2.0})
    reference = end_state(scenario, "rkn6", HALF_PASSAGE / 40)
    errors = [float(np.abs(end_state(scenario, "rkn6", HALF_PASSAGE / k) - reference).max()) for k in (8, 14)]
    # Measured 1.6e-7 m and 4e-8 m on a rope of 19.5 m: four orders below Verlet at the same step.
    assert errors[0] < 4e-7
    assert errors[1] < 0.4 * errors[0]


@pytest.mark.parametrize("measured", ["slip", "arc", "horizontal"])
def test_other_measures_of_speed_converge_in_time(measured: str) -> None:
    # Their speed depends on the velocities of the line, which a composition knows half a step off: first order for
    # arc and horizontal, nearly second for slip, which looks at the strains only.
    scenario, steps = taut_rope(travel={"measured": measured}), [1e-3, 5e-4, 2.5e-4]
    reference = end_state(scenario, "verlet", 2e-5)
    errors = [float(np.abs(end_state(scenario, "verlet", h) - reference).max()) for h in steps]
    assert order(steps, errors) == pytest.approx(1.8 if measured == "slip" else 1.05, abs=0.25)


def test_output_comes_at_exactly_the_asked_times() -> None:
    scenario = slack_rope(20, run={"until": 0.35, "every": 0.03})
    time = simulate(scenario).time.values
    np.testing.assert_array_equal(time, [*(0.03 * np.arange(12)), 0.35])


def test_the_answer_does_not_depend_on_how_often_it_is_asked_for() -> None:
    few, many = (simulate(slack_rope(40, run={"until": 0.5, "every": every})) for every in (0.5, 0.005))
    # Outputs cut steps short, so the results differ by the error in time: 7e-6 m here, of 1e-3 m asked.
    np.testing.assert_allclose(few.position.values[-1], many.position.values[-1], atol=2e-5)
