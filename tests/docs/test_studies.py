"""The studies of docs/studies show what closed forms give."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from studies import linear_limits, soft_ends  # of docs/: see conftest.py

from ropewalk.model import Equilibrium, Line, MovingForce, Scenario, Travel
from ropewalk.paper import slow_walk
from ropewalk.simulate import simulate
from ropewalk.theory.rope import elastic_catenary


@pytest.mark.parametrize("study", [linear_limits, soft_ends])
def test_a_study_draws_its_figure(study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slow_walk, "POSITIONS", 9)
    monkeypatch.setattr(slow_walk, "TURN", 0.5)
    monkeypatch.setattr(linear_limits, "PLACES", np.array([0.02, 0.5]))
    study.draw().savefig(tmp_path / "study.png")
    assert (tmp_path / "study.png").stat().st_size > 50_000


@pytest.mark.parametrize("tension", soft_ends.TENSIONS)
def test_pre_stress_leaves_a_path_that_ends_with_the_slope_of_load_over_tension(tension: float) -> None:
    """Between load and support the short piece carries the whole load, and the tension of the rest along x."""
    rope = replace(soft_ends.ROPE, length=20.0 / (1.0 + tension / 1e5))
    _, slope = slow_walk.way(rope, "clamped", half=True).path_slope()
    assert slope[-1] == pytest.approx(700.0 / tension, rel=0.05)  # half a step from the end


@pytest.mark.parametrize("weight", soft_ends.WEIGHTS)
def test_so_does_weight_with_what_the_support_carries_anyhow(weight: float) -> None:
    bare = elastic_catenary(span=20.0, length=20.0, weight=weight, axial_stiffness=1e5)
    rope = replace(soft_ends.ROPE, weight=weight)
    _, slope = slow_walk.way(rope, "clamped", half=True).path_slope()
    exact = (700.0 + bare.end_reaction[1]) / bare.end_reaction[0]
    assert slope[-1] == pytest.approx(exact, rel=0.05)


def test_a_support_that_yields_downwards_takes_the_upright_end_away() -> None:
    cases = soft_ends.family(
        {"fixed": soft_ends.ROPE}
        | {f"{k}": replace(soft_ends.ROPE, support=soft_ends.slider(k)) for k in (700.0, 200.0)}
    )
    fixed, stiff, soft = (case.clamped.path_slope()[1][-1] for case in cases)
    assert fixed > 20.0
    assert 3.0 < stiff < fixed
    assert soft < 0.25


@pytest.mark.parametrize(("place", "load", "prestrain"), [(0.5, 0.04, 2e-3), (0.1, 0.3, 1e-2), (0.02, 1.0, 1e-3)])
def test_the_linear_limits_are_those_of_the_chain(place: float, load: float, prestrain: float) -> None:
    EA = 1e6
    length, W = 20.0 / (1.0 + prestrain), load * prestrain * EA
    line = Line(start=(0.0, 0.0), end=(20.0, 0.0), length=length, mass=1.0, axial_stiffness=EA, elements=7)
    on = MovingForce(on="line", force=(0.0, -W), travel=Travel(speed=1.0, start=place * length))
    result = simulate(Scenario(gravity=0.0, lines={"line": line}, loads={"load": on}, run=Equilibrium()))
    deflection = -float(result.contact_position[0, 0, 1])
    excess = W * 20.0 * place * (1.0 - place) / (prestrain * EA) / deflection - 1.0
    assert linear_limits.linear_excess(place=place, load=load, prestrain=prestrain) == pytest.approx(excess, rel=1e-8)


@pytest.mark.parametrize("error", linear_limits.ERRORS)
@pytest.mark.parametrize("place", [0.02, 0.3, 0.5])
def test_a_limit_is_where_the_linear_string_is_off_by_that_much(place: float, error: float) -> None:
    load = linear_limits.limit(place=place, prestrain=1e-2, error=error)
    found = linear_limits.linear_excess(place=place, load=load, prestrain=1e-2)
    assert found == pytest.approx(
        error, rel=1e-3
    )  # the root is found to 1e-4 of the load, the error goes as its square


def test_small_slopes_have_a_limit_in_closed_form() -> None:
    for place, error in ((0.5, 0.05), (0.1, 0.2), (0.3, 0.01)):
        exact = [linear_limits.limit(place=place, prestrain=p, error=error) for p in (1e-4, 1e-5)]
        rule = [linear_limits.small_slope_limit(place, p, error) for p in (1e-4, 1e-5)]
        # 0.66 sqrt(P/EA) in the middle for 5 %; slopes of 1e-2 change it by their squares, and the root by 1e-4
        assert exact == pytest.approx(rule, rel=2e-3)
    assert linear_limits.small_slope_limit(0.5, 1.0, 0.05) == pytest.approx(0.664, abs=5e-4)
