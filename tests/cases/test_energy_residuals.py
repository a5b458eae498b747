"""The energy residual: what raises a warning or a doubt, and whether the remedy that it names helps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.results import summary, text
from ropewalk.results.audit import AUDIT, turnover
from ropewalk.results.energy_balance import amount, late_growth
from ropewalk.scenario import load
from ropewalk.simulate import simulate

HERE = Path(__file__).parent
EXAMPLES = HERE.parent.parent / "examples"
STRING = {"start": [0, 0], "end": [10, 0], "tension": 1000.0, "mass": 0.1, "axial_stiffness": 1e5, "elements": 20}


def run(load: dict[str, Any], until: float, start: dict[str, Any] | None = None, **line: Any) -> xr.Dataset:
    """A load on a string of 10 m with waves of 100 m/s."""
    string = {key: value for key, value in (STRING | line).items() if value is not None}
    motion = {"kind": "dynamic", "until": until, "every": 2e-3, "start": start or {"kind": "rest"}}
    tree = {"lines": {"string": string}, "loads": {"w": {"on": "string", **load}}, "run": motion}
    return simulate(Scenario.model_validate(tree))


def mass(speed: float, start: float = 0.5, **more: Any) -> dict[str, Any]:
    return {"kind": "mass", "mass": 1.0, "travel": {"speed": speed, "from": start}} | more


def share(result: xr.Dataset) -> float:
    return float(np.abs(result["energy"].sel(form=AUDIT)).max() / turnover(result["energy"].values).max())


def reported(result: xr.Dataset) -> str:
    """The warning or doubt of the energy residual."""
    texts = f"{result.attrs['doubts']}\n{result.attrs['warnings']}".splitlines()
    (found,) = [each for each in texts if each.startswith("Energy residual")] or [""]
    return found


@pytest.mark.parametrize("case", ["ring-on-joint-at-rest", "spring-without-gravity"])
def test_a_residual_of_rounding_size_raises_nothing(case: str) -> None:
    result = simulate(load(HERE / f"{case}.yaml"))
    assert (result.attrs["outcome"], result.attrs["doubts"], reported(result)) == ("completed", "", "")
    assert summary(result)["energy"]["largest_imbalance"]["relative"] is None
    assert "% of" not in text(summary(result))


def test_a_mass_next_to_the_end_of_its_line_is_named_and_a_larger_margin_helps() -> None:
    case = HERE / "mass-next-to-an-end.yaml"
    near, earlier = simulate(load(case)), simulate(load(case, ["loads.mass.travel.margin=0.5 m"]))
    assert near.attrs["outcome"] == "doubtful"
    assert "the contact force of load mass grows next to an end of string" in reported(near)
    assert "write a larger travel.margin, such as 0.5 m, or end the run before t = 0.19" in reported(near)
    assert earlier.attrs["outcome"] == "completed"
    assert share(earlier) < 0.2 * share(near)
    assert share(simulate(load(case, ["run.until=0.19 s"]))) < 0.2 * share(near)


def test_a_mass_as_fast_as_waves_is_named_and_less_speed_or_more_tension_helps() -> None:
    fast = run(mass(110.0), 0.07)
    assert "load w moves at 1.1 times the speed of transverse waves" in reported(fast)
    assert "(loads.w.travel.speed); write a lower speed, or more tension" in reported(fast)
    for other in (run(mass(50.0), 0.07), run(mass(110.0), 0.07, tension=4000.0)):
        assert share(other) < 0.2 * share(fast)


def test_a_mass_on_a_slack_line_is_named_and_a_lower_speed_helps() -> None:
    slack: dict[str, Any] = {"tension": None, "length": 10.8, "mass": 1.0, "elements": 40, "axial_stiffness": 1e6}
    fast = run(mass(8.0, 1.0, mass=5.0), 1.0, **slack)
    assert "the line is slack at load w" in reported(fast)
    assert reported(fast).endswith("(loads.w.travel.speed); write a lower speed")
    assert share(run(mass(2.0, 1.0, mass=5.0), 1.0, **slack)) < 0.1 * share(fast)


def test_a_mass_that_slides_by_itself_on_a_slack_line_has_no_speed_to_lower() -> None:
    slack: dict[str, Any] = {"tension": None, "length": 10.8, "mass": 1.0, "elements": 40, "axial_stiffness": 1e6}
    free = {"kind": "mass", "mass": 5.0, "travel": {"kind": "free", "from": 1.0, "speed": 8.0}}
    fast = run(free, 1.0, **slack)
    assert "the line is slack at load w" in reported(fast)
    end = float(reported(fast).partition("(loads.w.travel); end the run before t = ")[2].removesuffix(" s"))
    assert share(run(free, end, **slack)) < 0.1 * share(fast)


def test_a_line_in_compression_is_named_and_damping_or_elements_help() -> None:
    force = {"kind": "force", "force": [0.0, -100.0], "travel": {"speed": 20.0, "from": 3.0}}
    plain, damped, fine = (
        run(force, 0.25, tension=20.0, **more) for more in ({}, {"axial_damping": 10.0}, {"elements": 80})
    )
    assert "line string is in compression" in reported(plain)
    assert "write more axial_damping (now 0 N*s), or more elements" in reported(plain)
    assert max(share(damped), share(fine)) < 0.7 * share(plain)


def test_a_residual_of_the_mesh_falls_with_more_elements_as_the_first_remedy_says() -> None:
    start = {"with_loads": True}
    coarse, fine = (run(mass(10.0, 5.0), 0.05, start, elements=n) for n in (20, 80))
    assert "not identified, the residual grows between t = " in reported(coarse)
    assert "write more elements; if the residual does not fall, write a smaller run.step" in reported(coarse)
    assert coarse.attrs["outcome"] == "completed"
    assert share(fine) < 0.3 * share(coarse)
    assert not reported(fine)


def test_a_residual_of_a_given_step_falls_with_half_of_it_as_the_first_remedy_says() -> None:
    case, changes = EXAMPLES / "en50318-2002-300.yaml", ["run.until=3 s"]
    coarse, fine = (simulate(load(case, [*changes, *more])) for more in ([], ["run.step=0.5 ms"]))
    assert "write a smaller run.step: 0.0005 s (half of its value)" in reported(coarse)
    assert share(fine) < 0.3 * share(coarse)
    assert not reported(fine)


def test_a_foot_that_steps_does_not_leave_its_line() -> None:
    found = simulate(load(EXAMPLES / "highline-walker.yaml", ["run.until=4 s"]))
    assert "leaves its line" not in reported(found)
    assert found.attrs["outcome"] == "completed"


def test_late_growth_is_that_of_a_residual_that_goes_on_growing() -> None:
    t = np.linspace(0.0, 1.0, 100)
    steady = np.full(100, 1.0)
    assert late_growth(t, steady, 0.01) == pytest.approx(1.0 / 3.0 / 33.0, rel=0.05)
    assert late_growth(0.5 + 0.5 * np.sin(40.0 * t), steady, 0.01) == 0.0  # it is bounded
    assert late_growth(np.minimum(t, 0.2), steady, 0.01) == 0.0  # it comes from one event
    # After a throughput at the start that is large, little energy is exchanged: the growth is most of it.
    assert late_growth(t, np.where(t < 0.1, 10.0, 0.02), 0.01) > 0.2


@pytest.mark.parametrize(
    ("energy", "says"), [(9.192e-7, "0.919 µJ"), (8e-7, "800 nJ"), (74.5, "74.5 J"), (3740.0, "3.74 kJ"), (0.0, "0 J")]
)
def test_energies_have_two_or_three_digits_and_a_unit(energy: float, says: str) -> None:
    assert amount(energy) == says
