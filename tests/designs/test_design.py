"""Designs against closed forms and exhaustive searches; kept, gone on with, and honest about where they have ended."""

from __future__ import annotations

import json

import numpy as np
import pytest

import design_cases as cases
import ropewalk
import sweep_cases
from ropewalk.designs.certificate import left_over
from ropewalk.designs.search import by_models, by_optuna
from ropewalk.errors import ScenarioError
from ropewalk.sweeps import sweeping

STRAIN = "max strain < 2 %"


@pytest.fixture
def counted(monkeypatch):
    """The keys of the cases that are computed."""
    return sweep_cases.counted(monkeypatch, sweeping)


def pretension(**more):
    given = {"maximise": cases.TENSION, "subject_to": STRAIN, "workers": 0} | more
    return ropewalk.design(given.pop("scenario", None) or cases.scenario(), {cases.TENSION: "0.5:4 kN"}, **given)


def test_the_largest_pretension_for_a_strain_is_that_of_two_straight_halves(counted):
    """Two straight halves in closed form; the search stops at a ten thousandth of the limit, 1e-4 of 2 kN."""
    found = pretension()
    assert found.outcome == "completed"
    exact = cases.tension_before(0.02)
    assert exact * (1.0 - 1.1e-4) < found.value <= exact * (1.0 + 1e-9)
    assert found.limits_reached == [STRAIN]
    assert {n.verdict for n in found.neighbours} == {"worse", "breaks a limit"}  # it is bracketed
    assert found.left == pytest.approx(0.0, abs=1e-12)
    assert found.unit == "N"
    assert found.course["best_so_far"].values[-1] == found.value
    with ropewalk.simulate(found.scenario) as result:
        assert ropewalk.summary(result)["largest_strain"]["value"] <= 0.02
    assert len(counted) == len(set(counted)) == len(found.task.runs.course)


def test_a_limit_that_nothing_keeps_is_told():
    found = pretension(subject_to="max strain < 0.1 %", most=6)
    assert found.outcome == "no design keeps the limits"
    assert found.best is None
    assert np.isnan(found.value)


def test_a_search_that_ends_too_early_says_so():
    found = pretension(maximise="largest_sag", subject_to=(), first=0, most=1)
    assert found.outcome == "not at an optimum"
    assert "a neighbour is better" in found.doubts[0]


def test_a_design_that_was_stopped_goes_on_where_it_was(monkeypatch, tmp_path, counted):
    store = tmp_path / "s.jsonl"
    counting = sweeping.computed

    def stopping(case):
        if len(counted) == 7:
            raise KeyboardInterrupt
        return counting(case)

    monkeypatch.setattr(sweeping, "computed", stopping)
    assert pretension(store=store).outcome == "interrupted"
    monkeypatch.setattr(sweeping, "computed", counting)
    found = pretension(store=store)
    assert len(counted) == len(set(counted))
    assert found.value == pretension().value


def test_limits_and_values_that_follow_are_felt():
    """The force grows with the tension: the sag of straight halves hardly depends on it, the strain does."""
    derived = {"loads.man.force.1": "-tension / 10"}
    found = pretension(subject_to=["max strain < 2 %", "max contact_force < 150 N"], derived=derived)
    assert found.limits_reached == ["max contact_force < 150 N"]
    assert found.value == pytest.approx(1500.0, rel=2e-4)


@pytest.mark.parametrize("method", ["models", "optuna"])
def test_two_variables_come_to_the_optimum_of_an_exhaustive_search(method):
    """min (x - 0.3)^2 + (x + y - 0.9)^2 with x + y <= 0.7: on the line, at x = 0.3, of a grid and by Lagrange."""
    seen = []

    def judge(point):
        x, y = point
        seen.append(((x - 0.3) ** 2 + (x + y - 0.9) ** 2, x + y - 0.7, x, y))
        return seen[-1][0], np.array([seen[-1][1]])

    start = np.array([0.9, 0.9])
    if method == "models":
        by_models(judge, start, 1.0, 1, 1e-4, 200)
    else:
        pytest.importorskip("optuna")
        by_optuna(lambda points: [judge(point) for point in points], start, 1, 96, 0)
    value, _, x, y = min(one for one in seen if one[1] <= 1e-7)
    grid = np.linspace(0.0, 1.0, 101)
    gx, gy = np.meshgrid(grid, grid)
    fine = gx + gy <= 0.7 + 1e-9
    least = float(((gx - 0.3) ** 2 + (gx + gy - 0.9) ** 2)[fine].min())
    # Models come to 1e-4 of the variables; 96 draws of a random search to some hundredths.
    assert value == pytest.approx(least, abs=1e-4 if method == "models" else 0.02)
    assert np.hypot(x - 0.3, y - 0.4) < (1e-3 if method == "models" else 0.2)


def test_what_limits_leave_of_a_gradient():
    """f = x + 2 y above the line x + 2 y >= 1 is balanced, above x >= 0.5 only its part along x: 2 / sqrt 5 is left."""
    best = np.array([0.5, 0.25])

    def left(limit):
        neighbours = []
        for k, sign in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
            point = best + 0.01 * sign * np.eye(2)[k]
            neighbours.append(ropewalk.designs.certificate.Neighbour(k, point, point @ [1.0, 2.0], limit(point), ""))
        return left_over(best, 1.0, limit(best), neighbours, [0])

    assert left(lambda p: np.array([1.0 - p @ [1.0, 2.0]])) == pytest.approx(0.0, abs=1e-12)
    assert left(lambda p: np.array([0.5 - p[0]])) == pytest.approx(2.0 / np.sqrt(5.0))
    assert left(lambda p: np.array([p @ [1.0, 2.0] - 1.0])) == pytest.approx(1.0)  # a limit on the other side


@pytest.mark.parametrize(
    ("vary", "more", "wrong"),
    [
        ({}, {}, "nothing varies"),
        ({cases.TENSION: "4:1 kN"}, {}, "upper bound is not above"),
        ({cases.TENSION: "1 kN:2 m"}, {}, "need the same unit"),
        ({cases.TENSION: "1"}, {}, "no two bounds"),
        ({cases.TENSION: "1:2 m"}, {}, "expected a force"),
        ({"lines.string.tensoin": "1:2 kN"}, {}, "did you mean tension"),
        ({cases.TENSION: "1:2 kN"}, {"subject_to": "strain 2 %"}, "this is no limit"),
        ({cases.TENSION: "1:2 kN"}, {"subject_to": "max strain < 2 m"}, "strain < 2 m"),
        ({cases.TENSION: "1:2 kN"}, {"subject_to": "max stran < 2 %"}, "did you mean max strain"),
        ({cases.TENSION: "1:2 kN"}, {"minimise": "largest_sag"}, "exactly one quantity must be minimised"),
        ({cases.TENSION: "1:2 kN"}, {"subject_to": ()}, "nothing is computed"),
        ({cases.TENSION: "1:2 kN"}, {"method": "modles"}, "did you mean models"),
        ({cases.TENSION: "1:2 kN"}, {"tolerance": 2.0}, "fraction of the range"),
    ],
)
def test_mistakes_are_told(vary, more, wrong):
    given = {"maximise": cases.TENSION, "subject_to": STRAIN, "workers": 0, "first": 0, "most": 2} | more
    with pytest.raises(ScenarioError, match=wrong):
        ropewalk.design(cases.scenario(), vary, **given)


def test_the_answer_is_plain_json():
    message = json.loads(json.dumps(pretension(most=4).as_dict()))
    assert message["values"][cases.TENSION].endswith(" kN")
    assert message["goal"] == "maximise"
