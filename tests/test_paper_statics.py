"""The figures of slow walks show what closed forms give, and name what they are drawn for."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from ropewalk.model import Equilibrium, Line, MovingForce, Scenario, Travel
from ropewalk.model.load import Contact
from ropewalk.paper import (
    AVAILABLE,
    figure2,
    figure3,
    figure4,
    figure_linear_limits,
    figure_softness,
    figures,
    slow_walk,
    walk_figure,
)
from ropewalk.paper.slow_walk import LoadPath, Rope
from ropewalk.simulate import simulate
from ropewalk.theory import locus
from ropewalk.theory.rope import elastic_catenary


@cache
def way(rope: Rope, contact: Contact) -> LoadPath:
    return slow_walk.way(rope, contact)


@pytest.mark.parametrize("name", [2, 3, 4, "softness", "linear-limits"])
def test_a_figure_is_written(name: int | str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(walk_figure, "way", way)
    if name == "softness":
        monkeypatch.setattr(slow_walk, "POSITIONS", 9)
        monkeypatch.setattr(slow_walk, "TURN", 0.5)
    monkeypatch.setattr(figure_linear_limits, "PLACES", np.array([0.02, 0.5]))
    (written,) = figures(tmp_path, only=[name])
    assert written.name == f"figure-{name}.png"
    assert written.stat().st_size > 50_000
    assert name in AVAILABLE


def test_a_rope_says_all_that_it_was_computed_with() -> None:
    assert figure2.ROPE.label() == "X = 20 m, L = 20 m, no weight, EA = 10 kN, W = 700 N"
    assert figure3.ROPE.label() == "X = 20 m, L = 22 m, no weight, inextensible, W = 700 N"
    assert figure4.ROPE.label() == "X = 20 m, L = 22 m, weight 19.62 N/m, EA = 100 kN, W = 700 N"


@pytest.mark.parametrize("rope", [figure2.ROPE, figure3.ELASTIC, figure4.ROPE])
@pytest.mark.parametrize("contact", ["clamped", "frictionless"])
def test_the_walks_of_figures_2_to_4_are_those_of_the_closed_forms(rope: Rope, contact: Contact) -> None:
    found = way(rope, contact)
    chosen = np.linspace(12, found.xi.size - 13, 9).astype(int)  # not where the path turns back
    route = locus.clamped if contact == "clamped" else locus.frictionless
    exact = route(
        span=rope.span, length=rope.length, weight=rope.weight, axial_stiffness=rope.axial_stiffness,
        force=(0.0, -rope.load), xi=found.xi[chosen],
    )  # fmt: skip
    # A chain without weight is exact; 160 heavy links are so to the second order, w h^2/(8 H) = 2e-4 m and less.
    near, forces = (1e-8, 1e-5) if not rope.weight else (2e-4, 0.5)
    for name, tolerance in (("x", near), ("z", near), ("behind", forces), ("ahead", forces), ("hold", forces)):
        key = {"behind": "tension_behind", "ahead": "tension_ahead"}.get(name, name)
        # Held beyond the support, hold forces and tensions answer to differences of places a thousand times larger.
        size = np.maximum(1.0, np.abs(getattr(exact, key)) / rope.load) if tolerance == forces else 1.0
        gap = np.abs(getattr(found, name)[chosen] - getattr(exact, key)) / size
        assert gap.max() < tolerance, (name, gap)


def test_figure_3_runs_on_the_ellipse_and_its_slope_is_the_hold_force() -> None:
    found, b = way(figure3.ROPE, "frictionless"), 0.5 * sqrt(22.0**2 - 20.0**2)
    assert ((found.x - 10.0) / 11.0) ** 2 + (found.z / b) ** 2 == pytest.approx(1.0, abs=1e-11)
    assert found.x[0] < -0.98 < 20.98 < found.x[-1]  # far beyond both supports, to hold forces of 20 W
    x, slope = found.path_slope()
    fine = np.abs(x - 10.0) < 10.0
    hold = np.interp(x[fine], found.x, found.hold / 700.0)
    assert slope[fine] == pytest.approx(hold, abs=2e-3)  # chords between places that turn by 0.03 rad


def test_figure_3_leaves_the_ellipse_upright_when_clamped() -> None:
    found, hanging = way(figure3.ROPE, "clamped"), (22.0**2 - 20.0**2) / 44.0
    upright = found.xi > 22.0 - hanging + 1e-6
    assert upright.sum() > 5
    assert found.x[upright] == pytest.approx(20.0, abs=1e-8)
    assert found.z[upright] == pytest.approx(found.xi[upright] - 22.0, abs=1e-8)
    assert found.behind[upright] == pytest.approx(0.0, abs=1e-5)
    _, slope = found.path_slope()
    assert slope[-1] == np.inf
    assert slope[0] == -np.inf


def test_the_elastic_path_of_figure_3_lies_outside_the_ellipse() -> None:
    b = 0.5 * sqrt(22.0**2 - 20.0**2)
    for contact in ("frictionless", "clamped"):
        found = way(figure3.ELASTIC, contact)
        taut = np.minimum(found.behind, found.ahead) > 1.0  # not where it hangs upright
        assert np.all(((found.x - 10.0) / 11.0)[taut] ** 2 + (found.z[taut] / b) ** 2 > 1.02)


@pytest.mark.parametrize("rope", [figure2.ROPE, figure3.ROPE])
def test_the_linear_string_meets_a_rope_without_weight_in_the_middle(rope: Rope) -> None:
    found = way(rope, "clamped")
    z, slope = slow_walk.linear_string(rope, found.middle_pull, np.array([0.0, 5.0, 10.0]))
    assert z[2] == pytest.approx(found.z.min(), rel=1e-9)
    assert z == pytest.approx(-rope.load / found.middle_pull * np.array([0.0, 3.75, 5.0]), rel=1e-12)
    assert slope == pytest.approx(rope.load / found.middle_pull * np.array([-1.0, -0.5, 0.0]), rel=1e-12)


def test_the_linear_string_of_figure_4_sags_under_its_own_weight_too() -> None:
    z, _ = slow_walk.linear_string(figure4.ROPE, 1000.0, np.array([10.0]))
    assert z == pytest.approx(-700.0 * 20.0 / 4000.0 - 19.62 * 22.0 * 20.0 / 8000.0, rel=1e-12)


@pytest.mark.parametrize("tension", figure_softness.TENSIONS)
def test_pre_stress_leaves_a_path_that_ends_with_the_slope_of_load_over_tension(tension: float) -> None:
    """Between load and support the short piece carries the whole load, and the tension of the rest along x."""
    rope = replace(figure_softness.ROPE, length=20.0 / (1.0 + tension / 1e5))
    _, slope = slow_walk.way(rope, "clamped", half=True).path_slope()
    assert slope[-1] == pytest.approx(700.0 / tension, rel=0.05)  # half a step from the end


@pytest.mark.parametrize("weight", figure_softness.WEIGHTS)
def test_so_does_weight_with_what_the_support_carries_anyhow(weight: float) -> None:
    bare = elastic_catenary(span=20.0, length=20.0, weight=weight, axial_stiffness=1e5)
    rope = replace(figure_softness.ROPE, weight=weight)
    _, slope = slow_walk.way(rope, "clamped", half=True).path_slope()
    exact = (700.0 + bare.end_reaction[1]) / bare.end_reaction[0]
    assert slope[-1] == pytest.approx(exact, rel=0.05)


def test_a_support_that_yields_downwards_takes_the_upright_end_away() -> None:
    cases = figure_softness.family(
        {"fixed": figure_softness.ROPE}
        | {f"{k}": replace(figure_softness.ROPE, support=figure_softness.slider(k)) for k in (700.0, 200.0)}
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
    assert figure_linear_limits.linear_excess(place=place, load=load, prestrain=prestrain) == pytest.approx(
        excess, rel=1e-8
    )


@pytest.mark.parametrize("error", figure_linear_limits.ERRORS)
@pytest.mark.parametrize("place", [0.02, 0.3, 0.5])
def test_a_limit_is_where_the_linear_string_is_off_by_that_much(place: float, error: float) -> None:
    load = figure_linear_limits.limit(place=place, prestrain=1e-2, error=error)
    found = figure_linear_limits.linear_excess(place=place, load=load, prestrain=1e-2)
    assert found == pytest.approx(
        error, rel=1e-3
    )  # the root is found to 1e-4 of the load, the error goes as its square


def test_small_slopes_have_a_limit_in_closed_form() -> None:
    for place, error in ((0.5, 0.05), (0.1, 0.2), (0.3, 0.01)):
        exact = [figure_linear_limits.limit(place=place, prestrain=p, error=error) for p in (1e-4, 1e-5)]
        rule = [figure_linear_limits.small_slope_limit(place, p, error) for p in (1e-4, 1e-5)]
        # 0.66 sqrt(P/EA) in the middle for 5 %; slopes of 1e-2 change it by their squares, and the root by 1e-4
        assert exact == pytest.approx(rule, rel=2e-3)
    assert figure_linear_limits.small_slope_limit(0.5, 1.0, 0.05) == pytest.approx(0.664, abs=5e-4)
