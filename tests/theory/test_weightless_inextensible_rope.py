"""Weightless inextensible rope under one load: "Walking the Line", sec. 3, Figs. 2 and 3, with numbers derived here.

Span 20 m, length 22 m, load 1 N unless said.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from closed_forms import pulley, slow_loads
from ropewalk.theory import friction, locus, rope

CASE = {"span": 20.0, "length": 22.0}
DOWN = (0.0, -1.0)
every_route = pytest.mark.parametrize("closed", [True, False])


@every_route
@pytest.mark.parametrize(
    ("x", "z", "tension", "hold"),
    [
        (5.0, -4.08180805829885, 1.11736182440039, -0.212594169703065),
        (18.0, -3.14524434400113, 0.984277308381305, 0.441437802666825),
        (20.0, -21.0 / 11.0, 0.913223140495868, 10.0 / 11.0),
        (20.5, -1.3659072001197, 0.994487151038526, 1.33414191639599),
    ],
)
def test_pulley_stands_on_the_ellipse_and_beyond_the_support(
    closed: bool, x: float, z: float, tension: float, hold: float
) -> None:
    state = locus.ellipse(**CASE, load=1.0, x=x) if closed else slow_loads.frictionless(**CASE, force=DOWN, x=x)
    # 15 digits are given, 14 for the last z
    assert state.z == pytest.approx(z, abs=5e-14)
    assert [state.tension_behind, state.tension_ahead] == pytest.approx([tension] * 2, abs=1e-14)
    assert state.hold == pytest.approx(hold, abs=1e-14)


@pytest.mark.parametrize(
    ("xi", "place", "tensions"),
    [
        (15.0, (14.4, -4.2), (1.0, 1.2)),
        (19.0, (18.8, -2.7495454169735), (0.41461399144839, 1.0256240841092)),
        (20.5, (20.0, -1.5), (0.0, 1.0)),
    ],
)
def test_clamped_load_stands_where_two_circles_meet_or_hangs(xi: float, place: tuple, tensions: tuple) -> None:
    state = slow_loads.clamped(**CASE, force=DOWN, xi=xi)
    assert [state.x, state.z] == pytest.approx(place, abs=6e-14)  # 14 digits are given
    assert [state.tension_behind, state.tension_ahead] == pytest.approx(tensions, abs=6e-14)
    assert state.hold == 0.0


@pytest.mark.parametrize(("xi", "capstan"), [(15.0, 0.19661651786242), (19.0, 0.69429438018249)])
def test_friction_that_a_vertical_load_needs(xi: float, capstan: float) -> None:
    state = slow_loads.clamped(**CASE, force=DOWN, xi=xi)
    sides = {"tension_behind": state.tension_behind, "tension_ahead": state.tension_ahead, "angle": state.turning_angle}
    assert friction.capstan_coefficient(**sides) == pytest.approx(capstan, abs=1e-13)  # 14 digits are given
    # the block needs the slope of the pulley's path in the same place, its hold force by the load
    restrained = locus.ellipse(**CASE, load=1.0, x=state.x)
    assert friction.point_block_coefficient(**sides) == pytest.approx(restrained.hold, rel=1e-13)
    assert state.slope == pytest.approx(restrained.slope, rel=1e-13)
    if xi == 19.0:
        assert restrained.hold == pytest.approx(0.55546372060071, abs=1e-13)


def test_clamped_load_hangs_below_the_support_from_the_vertical_segment_on() -> None:
    edge = (22.0**2 - 20.0**2) / (2 * 22.0)
    taut = slow_loads.clamped(**CASE, force=DOWN, xi=22.0 - edge - 1e-9)
    assert 0.0 < taut.tension_behind < 1e-7
    assert taut.x < 20.0
    xi = 22.0 - edge * np.linspace(0.999999, 0.0, 7)
    hanging = slow_loads.clamped(**CASE, force=DOWN, xi=xi)
    assert hanging.x == pytest.approx(20.0, abs=0.0)
    assert hanging.z == pytest.approx(xi - 22.0, abs=1e-14)
    assert hanging.tension_behind == pytest.approx(0.0, abs=0.0)
    assert hanging.turning_angle == pytest.approx(0.0, abs=0.0)
    mirrored = slow_loads.clamped(**CASE, force=DOWN, xi=22.0 - xi)
    assert mirrored.x == pytest.approx(0.0, abs=0.0)
    assert mirrored.tension_behind == pytest.approx(1.0, abs=1e-15)


def test_only_a_held_load_runs_backwards() -> None:
    """v > X: the clamped load under its weight alone never passes the support, the pulley does, as does the pushed."""
    clamped = slow_loads.clamped(**CASE, force=DOWN, xi=np.linspace(0.0, 22.0, 89))
    assert clamped.x.min() >= 0.0
    assert clamped.x.max() <= 20.0
    restrained = locus.ellipse(**CASE, load=1.0, x=20.9)
    assert restrained.hold > 3.0
    pushed = slow_loads.clamped(**CASE, force=(float(restrained.hold), -1.0), xi=restrained.xi)
    assert [float(pushed.x), float(pushed.z)] == pytest.approx([float(restrained.x), float(restrained.z)], abs=1e-13)
    assert pushed.tension_behind == pytest.approx(pushed.tension_ahead, rel=1e-12)


heights = st.floats(-12.0, 12.0)
excesses = st.floats(-6.0, 1.0).map(lambda power: 10.0**power)


def width(span: float, height: float, length: float) -> float:
    return 0.5 * math.sqrt(span**2 + length**2 - span**2 - height**2)


@settings(deadline=None, max_examples=60)
@given(heights, excesses, st.floats(-0.999, 0.999))
def test_hold_force_is_the_load_times_the_slope_of_its_path(height: float, excess: float, share: float) -> None:
    length = math.hypot(20.0, height) * (1.0 + excess)
    case = {"span": 20.0, "height": height, "length": length, "load": 700.0}
    x = 10.0 + share * width(20.0, height, length)
    here = locus.ellipse(**case, x=x)
    # both pieces together are the rope, and the forces balance: the definition, without the closed form
    behind, ahead = np.array([x, here.z]), np.array([20.0 - x, height - here.z])
    assert np.hypot(*behind) + np.hypot(*ahead) == pytest.approx(length, rel=1e-14)
    pull = here.tension_behind * (behind / np.hypot(*behind) - ahead / np.hypot(*ahead))
    size = float(here.tension_behind)
    assert pull == pytest.approx([here.hold, -700.0], abs=1e-9 * size + 1e-12 * size / excess)
    assert here.slope == pytest.approx(here.hold / 700.0, rel=1e-14)
    # the path by its own differences
    half = 0.5 * length * 1e-5 * min(1.0, (1.0 - abs(share)) * excess**0.5)
    z = locus.ellipse(**case, x=[x - half, x + half]).z
    assert (z[1] - z[0]) / (2 * half) == pytest.approx(here.slope, rel=1e-3, abs=1e-6 + 1e-14 / half)


@settings(deadline=None, max_examples=20)
@given(heights, excesses, st.floats(0.01, 0.99))
def test_clamped_load_held_by_the_pulleys_force_stays_on_the_ellipse(
    height: float, excess: float, share: float
) -> None:
    case = {"span": 20.0, "height": height, "length": math.hypot(20.0, height) * (1.0 + excess)}
    restrained = locus.ellipse(**case, load=700.0, x=20.0 * share)
    state = slow_loads.clamped(**case, force=(float(restrained.hold), -700.0), xi=restrained.xi)
    # roundings of the lengths through a taut triangle
    allowed = 1e-14 / excess
    moved = math.hypot(float(state.x - restrained.x), float(state.z - restrained.z))
    assert moved <= 1e-13 * case["length"] + 20.0 * allowed
    assert state.tension_behind == pytest.approx(restrained.tension_ahead, rel=1e-10 + 10.0 * allowed)
    assert state.tension_ahead == pytest.approx(restrained.tension_ahead, rel=1e-10 + 10.0 * allowed)
    by_xi = slow_loads.frictionless(**case, force=(0.0, -700.0), xi=restrained.xi)
    assert by_xi.hold == pytest.approx(restrained.hold, rel=1e-9 + 1e3 * allowed, abs=1e-9 + 1e3 * allowed)


@settings(deadline=None, max_examples=40)
@given(heights, st.floats(1.001, 3.0), st.floats(0.02, 0.98), st.floats(-3.1, 3.1))
def test_force_of_any_direction_is_the_turned_rope(height: float, ratio: float, share: float, turn: float) -> None:
    """Turning supports and force together turns the rope; the start is kept, the end must stay ahead of it."""
    length = math.hypot(20.0, height) * ratio
    force = np.array([math.sin(turn), -math.cos(turn)])
    end = complex(20.0, height)
    angle = 0.5 if np.angle(end) < 0.5 else -0.5
    turned_end, turned_force = end * np.exp(1j * angle), complex(*force) * np.exp(1j * angle)
    case = {"length": length, "loads": [(share * length, tuple(force))]}
    state = rope.weightless_inextensible(span=20.0, height=height, **case)
    case["loads"] = [(share * length, (turned_force.real, turned_force.imag))]
    turned = rope.weightless_inextensible(span=turned_end.real, height=turned_end.imag, **case)
    place = complex(*state.load_positions[0]) * np.exp(1j * angle)
    assert turned.load_tensions == pytest.approx(state.load_tensions, abs=1e-9)  # taut within 1e-3
    assert complex(*turned.load_positions[0]) == pytest.approx(place, abs=1e-9)


def test_many_loads_hang_as_the_stiff_elastic_rope() -> None:
    loads = [(4.0, (30.0, -300.0)), (9.0, (0.0, -50.0)), (9.0, (0.0, -20.0)), (17.0, (-10.0, -200.0))]
    rigid = rope.weightless_inextensible(**CASE, height=2.0, loads=loads)
    assert np.hypot(*np.diff(rigid.nodes, axis=0).T) == pytest.approx(np.diff(rigid.breaks), abs=1e-13)
    assert rigid.load_forces == pytest.approx(np.array([force for _, force in loads]), abs=1e-11)
    errors = []
    for stiffness in (1e7, 1e8):
        stiff = rope.weightless_elastic(**CASE, height=2.0, axial_stiffness=stiffness, loads=loads)
        errors.append(float(np.abs(stiff.force - rigid.force).max()))
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=1e-2)  # first order in the compliance


def test_one_load_by_circles_is_the_general_solution() -> None:
    for xi in (0.0, 1.0, 7.0, 20.0, 21.0, 22.0):
        one = rope.weightless_inextensible(**CASE, height=-3.0, loads=[(xi, (40.0, -700.0))])
        general = rope.resting(**CASE, height=-3.0, loads=[(xi, (40.0, -700.0))])
        assert one.force == pytest.approx(general.force, abs=1e-10)  # 1e-13 of the forces
        assert one.nodes == pytest.approx(general.nodes, abs=1e-12)


def test_a_load_between_two_slack_pieces_hangs_where_the_others_leave_it() -> None:
    state = rope.weightless_inextensible(**CASE, loads=[(0.5, (0.0, -5.0)), (21.5, (0.0, -7.0))])
    assert state.load_positions == pytest.approx(np.array([[0.0, -0.5], [20.0, -0.5]]), abs=1e-14)
    assert state.load_tensions == pytest.approx(np.array([[5.0, 0.0], [0.0, 7.0]]), abs=0.0)


@pytest.mark.parametrize("length", [20.0, 19.0])
def test_rope_not_longer_than_the_distance_is_refused(length: float) -> None:
    for solve in (
        lambda: rope.weightless_inextensible(span=20.0, length=length, loads=[(5.0, DOWN)]),
        lambda: locus.ellipse(span=20.0, length=length, load=1.0, x=5.0),
        lambda: pulley.resting(span=20.0, length=length, loads=[(5.0, DOWN)]),
    ):
        with pytest.raises(ValueError, match="does not hang"):
            solve()


def test_places_off_the_ellipse_and_loads_without_weight_are_refused() -> None:
    for x in (-1.1, 21.1, math.nan):
        with pytest.raises(ValueError, match=r"^x must lie inside"):
            locus.ellipse(**CASE, load=1.0, x=x)
    for load in (0.0, -1.0, math.inf):
        with pytest.raises(ValueError, match=r"^load must"):
            locus.ellipse(**CASE, load=load, x=5.0)
    with pytest.raises(ValueError, match="no definite shape"):
        rope.weightless_inextensible(**CASE, loads=[(5.0, (0.0, 0.0))])
    with pytest.raises(ValueError, match="reach"):
        slow_loads.frictionless(**CASE, force=DOWN, x=21.1)
    for given_places in ({}, {"x": 5.0, "xi": 5.0}):
        with pytest.raises(ValueError, match="one of x and xi"):
            slow_loads.frictionless(**CASE, force=DOWN, **given_places)


def test_ellipse_broadcasts() -> None:
    state = locus.ellipse(**CASE, load=np.array([[1.0], [700.0]]), x=np.linspace(0.0, 20.0, 5))
    for values in vars(state).values():
        assert values.shape == (2, 5) or values.shape == (5,)
    assert state.hold[1] == pytest.approx(700.0 * state.hold[0], rel=1e-14)
