"""Supports at rest: springs in series with the line, rails, counterweights, supports that move."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from ropewalk.errors import EquilibriumError
from ropewalk.model import (
    DisplacementTable,
    Elastic,
    Equilibrium,
    Guided,
    Line,
    Moving,
    MovingForce,
    Quasistatic,
    Scenario,
    Travel,
)
from ropewalk.simulate import simulate
from ropewalk.theory.rope import elastic_catenary


def rope(**changed: Any) -> Line:
    given: dict[str, Any] = {"start": (0.0, 0.0), "end": (20.0, 0.0), "length": 20.0, "mass": 2.0,
                             "axial_stiffness": 1e5, "elements": 40}  # fmt: skip
    return Line(**(given | changed))


def load(xi: float, contact: str = "clamped") -> MovingForce:
    return MovingForce(on="rope", force=(0.0, -700.0), contact=contact, travel=Travel(speed=1.0, start=xi))


def at_rest(line: Line, *loads: MovingForce, gravity: float = 9.81) -> xr.Dataset:
    on = {f"load {k}": one for k, one in enumerate(loads)}
    return simulate(Scenario(gravity=gravity, lines={"rope": line}, loads=on, run=Equilibrium())).isel(load_path=0)


def test_a_stretched_line_and_its_springs_pull_in_series() -> None:
    """T = missing length / (1/k1 + 1/k2 + L/EA)."""
    line = rope(length=19.0, start_support=Elastic(stiffness=2e3), end_support=Elastic(stiffness=5e3))
    result = at_rest(line, gravity=0.0)
    tension = 1.0 / (1.0 / 2e3 + 1.0 / 5e3 + 19.0 / 1e5)
    assert result.tension.to_numpy() == pytest.approx(np.full(40, tension), rel=1e-11)
    ends = result.position.to_numpy()[[0, -1]]
    assert ends == pytest.approx(np.array([[tension / 2e3, 0.0], [20.0 - tension / 5e3, 0.0]]), abs=1e-10)


@settings(max_examples=30, deadline=None)
@given(stiffness=st.floats(1e2, 1e8), other=st.floats(1e2, 1e8), xi=st.floats(0.5, 17.5), length=st.floats(18.0, 24.0))
def test_springs_pull_as_the_line_does(stiffness: float, other: float, xi: float, length: float) -> None:
    """Each spring carries the reaction of its support; the shape between the moved ends is that of a fixed line."""
    soft = rope(
        length=length, start_support=Elastic(stiffness=(stiffness, other)), end_support=Elastic(stiffness=other)
    )
    result = at_rest(soft, load(xi))
    ends, reaction = result.position.to_numpy()[[0, -1]], result.reaction.to_numpy()
    moved = ends - np.array([[0.0, 0.0], [20.0, 0.0]])
    springs = -moved * np.array([[stiffness, other], [other, other]])
    size = float(np.abs(reaction).max())
    # positions carry rounding errors of 1e-14 m, times the stiffness
    assert springs == pytest.approx(reaction, rel=1e-8, abs=1e-9 * size + 1e-13 * max(stiffness, other) * 20.0)
    fixed = at_rest(rope(length=length, start=tuple(ends[0]), end=tuple(ends[1])), load(xi))
    assert fixed.position.to_numpy() == pytest.approx(result.position.to_numpy(), abs=1e-8)


def test_a_stiff_spring_is_a_fixed_support_in_the_limit() -> None:
    fixed = at_rest(rope(), load(7.0)).position.to_numpy()
    gaps = [
        np.abs(at_rest(rope(end_support=Elastic(stiffness=k)), load(7.0)).position.to_numpy() - fixed).max()
        for k in (1e7, 1e8)
    ]
    assert gaps[0] / gaps[1] == pytest.approx(10.0, rel=0.01)


@pytest.mark.parametrize("along", [(1.0, 0.0), (-3.0, 0.0)])
def test_a_counterweight_keeps_the_horizontal_tension(along: tuple[float, float]) -> None:
    force = 2000.0 * np.sign(along[0])  # along the rail, so that it always pulls towards +x
    support = Guided(along=along, force=float(force))
    for loads in ((), (load(5.0),), (load(5.0), load(14.0))):
        result = at_rest(rope(end_support=support), *loads)
        assert result.reaction.to_numpy()[:, 0] == pytest.approx([-2000.0, 2000.0], rel=1e-9)
        assert float(result.position[-1, 1]) == 0.0
    assert float(result.position[-1, 0]) < float(at_rest(rope(end_support=support)).position[-1, 0])


def test_a_slider_on_an_inclined_rail_rests_where_the_line_is_square_to_it() -> None:
    """Without weight, spring or force nothing pulls along the rail: the last link meets it at a right angle."""
    line = rope(end=(15.0, 0.0), length=10.0, mass=1e-9, end_support=Guided(along=(1.0, 1.0)))
    result = at_rest(line, gravity=0.0)
    end = result.position.to_numpy()[-1]
    assert end == pytest.approx([7.5, -7.5], abs=1e-7)


def test_a_slider_that_nothing_holds_is_refused() -> None:
    line = rope(start_support=Guided(along=(1.0, 0.0)), end_support=Guided(along=(1.0, 0.0), force=10.0))
    with pytest.raises(EquilibriumError, match=r"slides away.*give it a stiffness"):
        at_rest(line)


def test_mass_at_a_support_hangs_in_its_spring() -> None:
    light = at_rest(rope(end_support=Elastic(stiffness=1e4)))
    heavy = at_rest(rope(end_support=Elastic(stiffness=1e4, mass=50.0)))
    down = float(light.position[-1, 1] - heavy.position[-1, 1])
    assert down == pytest.approx(50.0 * 9.81 / 1e4, rel=0.02)  # the line carries a little of it


def test_a_support_that_moves_takes_the_line_along() -> None:
    """Half-way through the path the end has moved by half of its displacement: the rope of that span."""
    move = Moving(displacement=DisplacementTable(time=(0.0, 20.0), value=((0.0, 0.0), (2.0, 1.0))))
    scenario = Scenario(
        lines={"rope": rope(length=24.0, end_support=move)}, run=Quasistatic(positions=3),
        loads={"feather": MovingForce(on="rope", force=(0.0, 0.0), travel=Travel(speed=1.2))},
    )  # fmt: skip
    result = simulate(scenario)
    assert result.position.to_numpy()[:, -1] == pytest.approx(np.array([[20.0, 0.0], [21.0, 0.5], [22.0, 1.0]]))
    exact = elastic_catenary(span=21.0, height=0.5, length=24.0, weight=19.62, axial_stiffness=1e5)
    assert -float(result.position[1, :, 1].min()) == pytest.approx(exact.sag, rel=0.05)
    middle = result.position.to_numpy()[1, 20]
    assert middle == pytest.approx(exact.position(12.0), abs=4e-3)  # second order in the links


def test_a_frictionless_load_rolls_on_a_rope_with_a_counterweight() -> None:
    support = Guided(along=(1.0, 0.0), force=3000.0)
    result = at_rest(rope(end_support=support), load(6.0, "frictionless"))
    behind, ahead = result.contact_tension.to_numpy()[0]
    assert behind == pytest.approx(ahead, rel=1e-9)
    assert float(result.reaction[1, 0]) == pytest.approx(3000.0, rel=1e-9)


def test_the_steep_end_of_a_path_fades_with_a_soft_support() -> None:
    """Taut line on vertical sliders with springs k: the path ends with the slope F/P / (1 + 2 P/(k L)), not F/P.

    Superposition of the sagging string and of its tilt, against which springs k and the tension work, k + 2 P/L.
    """

    def steepness(**support: Any) -> float:
        line = rope(length=19.0, mass=1e-9, axial_stiffness=1e7, **support)  # P = 526 kN
        run = Quasistatic(positions=3)  # of the last thousandth of the line
        result = simulate(Scenario(gravity=0.0, lines={"rope": line}, loads={"load": load(18.999)}, run=run))
        x, z = result.contact_position.to_numpy()[-2:, 0].T
        return float((z[1] - z[0]) / (x[1] - x[0]) * 526315.8 / 700.0)

    found = [steepness()]
    for k in (1e6, 2e5, 526315.8 * 2.0 / 20.0):
        slider = Guided(along=(0.0, 1.0), stiffness=k)
        found.append(steepness(start_support=slider, end_support=slider))
    exact = [1.0, *(1.0 / (1.0 + 2.0 * 526315.8 / (k * 20.0)) for k in (1e6, 2e5, 52631.58))]
    assert found == pytest.approx(exact, abs=1e-3)  # slopes of 1e-3, steps of 1/2000
