"""Frictionless loads: the hold force that "Walking the Line" has to introduce, on every rope, derived here."""

import math
from math import inf
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from closed_forms import pulley, slow_loads
from ropewalk.theory import friction, rope

DOWN = (0.0, -700.0)
PAPER = {"span": 20.0, "length": 20.0, "axial_stiffness": 1e4}
ROPES: list[dict[str, Any]] = [
    PAPER,
    {**PAPER, "law": "second_piola_kirchhoff"},
    {"span": 20.0, "length": 22.0, "height": 3.0},
    {"span": 20.0, "length": 22.0, "weight": 19.62, "axial_stiffness": 1e5},
    {"span": 20.0, "length": 19.0, "weight": 19.62, "axial_stiffness": 3e3, "height": -4.0},
    {"span": 20.0, "length": 22.0, "weight": 200.0, "height": 2.0},
]
every_rope = pytest.mark.parametrize("case", ROPES, ids=range(len(ROPES)))


@pytest.mark.parametrize("restrained", ["x", "xi"])
def test_pulley_on_the_weightless_elastic_rope(restrained: str) -> None:
    z, tension, hold = -3.7070901273379, 837.821869567776, 140.331412274603
    behind, ahead = math.hypot(15.0, z), math.hypot(5.0, z)
    place = {"x": 15.0} if restrained == "x" else {"xi": 20.0 * behind / (behind + ahead)}
    state = slow_loads.frictionless(**PAPER, force=DOWN, **place)
    # 14 and 15 digits are given
    assert [float(state.x), float(state.z)] == pytest.approx([15.0, z], abs=1e-13)
    assert [float(state.tension_behind), float(state.tension_ahead)] == pytest.approx([tension] * 2, abs=3e-12)
    assert state.hold == pytest.approx(hold, abs=3e-12)


@every_rope
def test_hold_force_is_the_load_times_the_slope_of_the_mean_tangent(case: dict) -> None:
    state = slow_loads.frictionless(**case, force=DOWN, x=np.linspace(0.5, 19.0, 9))
    assert state.tension_ahead == pytest.approx(state.tension_behind, rel=1e-13)
    assert state.hold == pytest.approx(700.0 * state.slope, rel=1e-12, abs=1e-10)
    clamped = slow_loads.clamped(**case, force=DOWN, xi=state.xi)
    needed = friction.point_block_coefficient(
        tension_behind=clamped.tension_behind, tension_ahead=clamped.tension_ahead, angle=clamped.turning_angle
    )
    assert needed == pytest.approx(np.abs(clamped.slope), rel=1e-9)


def energy(state: rope.RestingRope, stiffness: float, law: str) -> float:
    """Elastic energy and weight times height, by Gauss's quadrature over every piece."""
    points, weights = np.polynomial.legendre.leggauss(30)
    total = 0.0
    for a, b in zip(state.breaks[:-1], state.breaks[1:], strict=True):
        xi = 0.5 * (a + b) + 0.5 * (b - a) * points
        xi[-1] = min(xi[-1], b * (1 - 1e-15))
        ratio = state.tension(xi) / stiffness
        eps = ratio if law == "hooke" else ratio / (0.5 + np.sqrt(0.25 + ratio))
        stored = eps**2 / 2 if law == "hooke" else eps**2 / 2 + eps**3 / 3
        elastic = np.where(eps > 0.0, stored * (stiffness if math.isfinite(stiffness) else 0.0), 0.0)
        total += 0.5 * (b - a) * float(weights @ (elastic + state.weight * state.position(xi)[:, 1]))
    return total


@every_rope
def test_hold_force_and_load_feed_the_rope_along_the_path(case: dict) -> None:
    """hold dx = W dz + d(energy): the slope of the path alone gives the hold force where the energy is constant."""
    for x in (3.0, 12.0, 18.0):
        half = 1e-3
        states = [pulley.resting(**case, loads=[(place, DOWN)]) for place in (x - half, x, x + half)]
        (z_0, z_1), hold = (states[i].load_positions[0, 1] for i in (0, 2)), states[1].load_forces[0, 0]
        stored = [energy(state, case.get("axial_stiffness", inf), case.get("law", "hooke")) for state in states]
        slope, gain = (z_1 - z_0) / (2 * half), (stored[2] - stored[0]) / (2 * half)
        # differences over 2 mm: third derivatives, and roundings of energies of some 1e4 J
        assert hold == pytest.approx(700.0 * slope + gain, abs=1e-4)
        if "weight" not in case and "axial_stiffness" not in case:
            assert hold == pytest.approx(700.0 * slope, abs=1e-4)
        elif x != 12.0:
            assert abs(gain) > 1.0


heights = st.floats(-8.0, 8.0)
weights = st.one_of(st.just(0.0), st.floats(-3.0, 2.5).map(lambda power: 10.0**power))
stiffnesses = st.one_of(st.just(inf), st.floats(3.0, 10.0).map(lambda power: 10.0**power))
fractions = st.lists(st.floats(0.05, 0.95), min_size=1, max_size=3, unique_by=lambda value: round(20 * value))


@settings(deadline=None, max_examples=40)
@given(heights, st.floats(1.001, 3.0), weights, stiffnesses, fractions, st.floats(50.0, 900.0))
def test_the_clamped_rope_under_the_hold_forces_is_the_same_rope(
    height: float, ratio: float, weight: float, stiffness: float, places: list, load: float
) -> None:
    case = {"span": 20.0, "height": height, "length": math.hypot(20.0, height) * ratio, "weight": weight,
            "axial_stiffness": stiffness}  # fmt: skip
    xs = [20.0 * place for place in sorted(places)]
    restrained = pulley.resting(**case, loads=[(x, (0.0, -load * (1 + i))) for i, x in enumerate(xs)])
    assert restrained.load_positions[:, 0] == pytest.approx(xs, abs=1e-9)
    assert restrained.nodes[-1] == pytest.approx([20.0, height], abs=1e-9)
    assert restrained.load_tensions[:, 0] == pytest.approx(restrained.load_tensions[:, 1], rel=1e-9)
    clamped = rope.resting(
        **case,
        loads=[(xi, tuple(force)) for xi, force in zip(restrained.breaks[1:-1], restrained.load_forces, strict=True)],
    )
    size = float(np.abs(restrained.force).max())
    noise = min(stiffness / size, 1.0 / (ratio - 1.0))  # taut and stiff ropes turn roundings into forces
    assert clamped.force == pytest.approx(restrained.force, abs=(1e-10 + 1e-13 * noise) * size)


@pytest.mark.parametrize("weight", [0.0, 19.62])
@pytest.mark.parametrize("stiffness", [*(10.0 ** np.arange(3, 12, 2)), inf])
@pytest.mark.parametrize("ratio", [1.0 + 1e-9, 1.05, 1000.0])
def test_extremes(weight: float, stiffness: float, ratio: float) -> None:
    case = {"span": 20.0, "length": 20.0 * ratio, "weight": weight, "axial_stiffness": float(stiffness)}
    state = slow_loads.frictionless(**case, force=DOWN, x=[6.0, 14.0])
    size = float(state.tension_behind.max())
    assert state.tension_behind == pytest.approx(state.tension_ahead, rel=1e-9)
    # mirror images: roundings of the length by the stiffness, or by the root of the spare length
    noise = min(stiffness / size, 1.0 / abs(ratio - 1.0))
    assert state.hold[0] == pytest.approx(-state.hold[1], abs=(1e-10 + 1e-14 * noise) * size)
    assert state.z[0] == pytest.approx(state.z[1], rel=1e-6 if ratio < 1.01 else 1e-9)


def test_zero_weight_is_the_limit_of_small_weight() -> None:
    for stiffness in (1e4, inf):
        case = {"span": 20.0, "length": 22.0, "height": 2.0, "axial_stiffness": stiffness, "x": [4.0, 15.0, 19.9]}
        none = slow_loads.frictionless(**case, force=DOWN)
        for weight in (1e-2, 1e-5, 1e-8):
            light = slow_loads.frictionless(**case, force=DOWN, weight=weight)
            assert light.hold == pytest.approx(none.hold, abs=1e2 * weight + 1e-9)  # first order


def test_rope_far_heavier_than_its_load_hardly_feels_it() -> None:
    bare = rope.catenary(span=20.0, length=22.0, weight=20.0)
    state = slow_loads.frictionless(span=20.0, length=22.0, weight=20.0, force=(0.0, -1e-6), x=[4.0, 15.0])
    assert np.stack([state.x, state.z], axis=-1) == pytest.approx(bare.position(state.xi), abs=1e-7)
    assert state.hold == pytest.approx(1e-6 * state.slope, rel=1e-6)


def test_elastic_rope_holds_no_load_too_near_to_a_support() -> None:
    """Held at a material point: tension by the circles is bounded, so near the support no hold force is enough."""
    near = slow_loads.frictionless(**PAPER, force=DOWN, xi=[16.0, 4.0])
    assert near.hold[0] == pytest.approx(-near.hold[1], rel=1e-12)
    for weight in (0.0, 20.0):
        with pytest.raises(ValueError, match="no hold force"):
            slow_loads.frictionless(**PAPER, weight=weight, force=DOWN, xi=19.9)
    # at a given x there always is one, beyond the support, too
    beyond = slow_loads.frictionless(**PAPER, force=DOWN, x=[19.9, 20.0, 21.0])
    assert np.all(np.diff(beyond.hold) > 0.0)


def test_of_two_hold_forces_at_a_material_point_the_smaller_is_found() -> None:
    """The second one drags the load far out along the straight line through the supports."""
    case = {"span": 20.0, "length": 200.0, "axial_stiffness": 1e4}
    heavy = pulley.resting(**case, weight=1e-6, loads=[(96.0, DOWN)], restrained="material")
    light = pulley.resting(**case, loads=[(96.0, DOWN)], restrained="material")
    assert abs(light.load_forces[0, 0]) < 1e3
    assert heavy.force == pytest.approx(light.force, abs=1e-3)


def test_several_loads_held_at_x_are_found_again_at_their_material_points() -> None:
    """Soft or stiff and long ropes tempt Newton's method to the second hold forces, 10 to 100000 times larger."""
    loads = [(5.0, DOWN), (9.0, (0.0, -200.0)), (17.0, DOWN)]
    for stiffness in (1e4, 1e8):
        for weight in (1e-6, 1.0, 19.62):
            case = {"span": 20.0, "height": 2.0, "length": 200.0, "weight": weight, "axial_stiffness": stiffness}
            at_x = pulley.resting(**case, loads=loads)
            again = [(xi, force) for xi, (_, force) in zip(at_x.breaks[1:-1], loads, strict=True)]
            at_xi = pulley.resting(**case, loads=again, restrained="material")
            assert at_xi.force == pytest.approx(at_x.force, abs=1e-9)


def test_hold_force_makes_up_for_a_given_force_along_x() -> None:
    case = {"span": 20.0, "length": 22.0, "weight": 20.0, "axial_stiffness": 1e5}
    plain, pushed = (slow_loads.frictionless(**case, force=(push, -700.0), x=15.0) for push in (0.0, 100.0))
    assert pushed.hold == pytest.approx(plain.hold - 100.0, abs=1e-9)
    by_xi = slow_loads.frictionless(**case, force=(100.0, -700.0), xi=plain.xi)
    assert by_xi.hold == pytest.approx(pushed.hold, abs=1e-9)


@pytest.mark.parametrize("compliance", [0.0, 1e-3])
def test_newtons_matrix_is_the_derivative_of_the_equations(compliance: float) -> None:
    system = pulley._Rope(20.0, 2.0, 22.0, 20.0, compliance, "hooke")
    forces, free = np.array([[0.0, -700.0], [30.0, -200.0], [0.0, -50.0]]), np.array([True, False, True])
    y = np.array([600.0, -500.0, 4.0, 11.0, 15.0, 20.0, -10.0, 40.0])

    def values(y: np.ndarray) -> np.ndarray:
        residual, _, (x, _) = system.equations(y, forces, 20.0, free)
        return np.concatenate([residual, x])

    _, jacobian, (_, slope) = system.equations(y, forces, 20.0, free)
    for column, step in enumerate(1e-5 * np.maximum(np.abs(y), 1.0)):
        change = np.zeros_like(y)
        change[column] = step
        difference = (values(y + change) - values(y - change)) / (2 * step)
        assert np.concatenate([jacobian[:, column], slope[:, column]]) == pytest.approx(difference, rel=1e-6, abs=1e-9)


def test_chosen_loads_are_free_and_the_others_clamped() -> None:
    case = {"span": 20.0, "length": 22.0, "weight": 20.0, "axial_stiffness": 1e5}
    loads = [(6.0, DOWN), (10.0, (30.0, -300.0)), (15.0, DOWN)]
    state = pulley.resting(**case, loads=loads, restrained="material", frictionless=[True, False, True])
    hold = state.load_forces - np.array([force for _, force in loads])
    assert hold[1] == pytest.approx([0.0, 0.0], abs=1e-10)
    assert state.load_tensions[[0, 2], 0] == pytest.approx(state.load_tensions[[0, 2], 1], rel=1e-12)
    assert abs(float(np.diff(state.load_tensions[1])[0])) > 1.0
    assert state.breaks[1:-1] == pytest.approx([6.0, 10.0, 15.0], abs=1e-13)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"restrained": "arc"}, "^restrained must"),
        ({"loads": []}, "^loads must be given"),
        ({"frictionless": [True, False]}, "^loads must be given"),
        ({"restrained": "horizontal", "frictionless": [False]}, "^loads must be given"),
        ({"loads": [(math.nan, DOWN)]}, "must be finite"),
        ({"loads": [(5.0, (0.0, inf))]}, "must be finite"),
        ({"loads": [(21.0, DOWN)], "restrained": "material"}, "must stand on the rope"),
        ({"loads": [(7.0, DOWN), (5.0, DOWN)], "restrained": "material"}, "ascending"),
        ({"loads": [(5.0, (0.0, 0.0))], "length": 22.0}, "no definite shape"),
    ],
)
def test_nonsense_is_refused(changed: dict, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        pulley.resting(**({"loads": [(5.0, DOWN)]} | PAPER | changed))
