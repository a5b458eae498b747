"""The figures of slow walks show what closed forms give, and name what they are drawn for."""

from __future__ import annotations

from functools import cache
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from closed_forms import slow_loads
from ropewalk.model.load import Contact
from ropewalk.paper import (
    AVAILABLE,
    figure2,
    figure3,
    figure4,
    figures,
    slow_walk,
    walk_figure,
)
from ropewalk.paper.slow_walk import LoadPath, Rope


@cache
def way(rope: Rope, contact: Contact) -> LoadPath:
    return slow_walk.way(rope, contact)


@pytest.mark.parametrize("name", [2, 3, 4])
def test_a_figure_is_written(name: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(walk_figure, "way", way)
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
    route = slow_loads.clamped if contact == "clamped" else slow_loads.frictionless
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
