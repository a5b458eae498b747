"""What is told of a run before it: steps by the step that its engine has chosen, and what is remarked as it begins."""

from __future__ import annotations

import pytest

from ropewalk.effort import about, effort_of, foreseen
from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.scenario import loads, template
from ropewalk.scenario.examples import examples
from ropewalk.simulate import run_of

SHORT = ("run.until=50 ms", "run.every=10 ms")
COARSE = ("lines.track.elements=60", "loads.car.rockers=[3 m]")  # its rest is found sooner


def scenario(name: str, *settings: str) -> Scenario:
    text = template("rope") if name == "rope" else examples()[name]
    return loads(text, overrides=(*SHORT, *settings))


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("rope", ()), ("rope", ("lines.rope.axial_damping=0 N*s",)), ("leash-fall", ()), ("zip-line", ()),
        ("overhead-line-limits", ()),
    ],
)  # fmt: skip
def test_the_steps_that_are_told_are_those_that_are_taken_within_a_factor_of_three(
    name: str, settings: tuple[str, ...]
) -> None:
    """Chains, damped or not, with a payload; the system; overhead lines. Most take exactly as many as are told."""
    asked, run_info = scenario(name, *settings), RunInfo()
    run = run_of(asked, run_info)
    effort = effort_of(asked, run, run_info)
    assert effort is not None
    assert effort.steps is not None
    for _ in run.blocks():
        pass
    assert run_info.steps / 3.0 < effort.steps < 3.0 * run_info.steps
    assert effort.seconds > 0.0


def test_runs_without_a_motion_have_equilibria_instead_of_steps() -> None:
    assert foreseen(loads(template("rope"), overrides=("run={kind: equilibrium}",))) == ("one equilibrium", [])
    slow = foreseen(loads(template("rope"), overrides=("run={kind: quasistatic, positions: 7}",)))
    assert slow == ("7 equilibria", [])


def test_a_hauling_rope_that_is_slack_where_its_carriage_begins_is_told_before_the_run() -> None:
    """With the drive below, where the track rope rises away from it, and a counter rope of next to nothing."""
    below = (*COARSE, "loads.car.haul.to=start", "loads.car.haul.counter={tension: 1 kN}")
    held, slack = (foreseen(scenario("ropeway-tower-brake", *keys))[1] for keys in (COARSE, below))
    assert not [text for text in held if "slack" in text]
    (told,) = [text for text in slack if "slack" in text]
    assert told.startswith("the hauling rope of car is slack at t = 0 s: there the track rope falls towards its drive")


def test_axial_damping_that_makes_a_long_run_longer_is_told() -> None:
    """The stable step is z + sqrt(1 + z^2) times shorter, with z = c/(h sqrt(EA m)) = 11.0 here."""
    many = (*COARSE, "run.until=20 s", "run.every=1 s", "lines.track.axial_damping=5.6 MN*s")
    (told,) = [text for text in foreseen(scenario("ropeway-tower-brake", *many))[1] if "axial_damping" in text]
    assert told.startswith("lines.track.axial_damping reduces the stable step by a factor of 22")


def test_what_damping_costs_is_told_of_lines_that_hang_slack_as_if_they_were_taut() -> None:
    """Loops of a backup have no stiffness where they hang: nothing is shorter than that without bound."""
    said = foreseen(scenario("highline-backup-cut", "run.until=60 s", "run.every=1 s"))[1]
    assert not [text for text in said if "inf" in text], said


def test_links_that_are_too_long_for_the_wheels_of_a_carriage_over_a_saddle_are_told() -> None:
    (told,) = [text for text in foreseen(scenario("ropeway-tower-brake"))[1] if "rocker" in text]
    assert told.startswith("links of track are 2.5 times as long as the smallest rocker of car")
    assert "elements: 754 or more" in told
    assert not [text for text in foreseen(scenario("ropeway-tramway"))[1] if "rocker" in text]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.2, "less than a second"), (1.2, "about a second"), (44.6, "about 45 s"), (130.0, "about 2 min"),
     (864.0, "about 14 min"), (7000.0, "about 2 h"), (None, "for an unknown time")],
)  # fmt: skip
def test_times_are_told_no_finer_than_they_are_known(seconds: float | None, text: str) -> None:
    assert about(seconds) == text
