"""Catenary and elastic catenary with point loads: Irvine, Cable Structures.

Reference numbers are derived in docs/notes; MoorPy 1.3.0 gives those without point loads to 12 digits.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from ropewalk.theory import rope

HEAVY = {"span": 20.0, "length": 22.0, "weight": 19.62, "axial_stiffness": 1e5}

heights = st.floats(-15.0, 15.0)
lengths = st.floats(5.0, 100.0)
stiffnesses = st.floats(2.0, 9.0).map(lambda power: 10.0**power)
components = st.floats(-500.0, 500.0)
loads = st.lists(st.tuples(st.floats(0.0, 1.0), st.tuples(components, components)), max_size=3)


def at_length(loads: list, length: float) -> list:
    return [(fraction * length, force) for fraction, force in loads]


def test_inextensible_catenary() -> None:
    level = rope.catenary(span=20.0, length=22.0, weight=1.0)
    # 20 digits are given, doubles hold 16
    assert level.horizontal_tension == pytest.approx(13.099278952737124, abs=4e-15)
    assert level.sag == pytest.approx(4.0060158147207523, abs=4e-15)
    assert level.tension(22.0) == pytest.approx(17.105294767457876, abs=4e-15)
    raised = rope.catenary(span=20.0, height=3.0, length=22.0, weight=1.0)
    assert raised.horizontal_tension == pytest.approx(13.808883017127064, abs=4e-15)
    assert raised.position(22.0) == pytest.approx([20.0, 3.0], abs=1e-14)  # roundings


def test_catenary_has_the_shape_of_the_hyperbolic_cosine() -> None:
    state = rope.catenary(span=20.0, height=3.0, length=22.0, weight=2.0)
    x, z = state.position(np.linspace(0.0, 22.0, 30)).T
    a = state.horizontal_tension / 2.0
    lowest = -a * math.asinh(state.force[0, 1] / state.horizontal_tension)
    expected = a * (np.cosh((x - lowest) / a) - math.cosh(lowest / a))
    assert z == pytest.approx(expected, abs=1e-13)  # roundings at lengths of 20


def test_elastic_catenary_that_sags() -> None:
    state = rope.elastic_catenary(**HEAVY)
    # half a unit of the last digit given, and 4e-13 that the condition of the problem allows
    assert state.horizontal_tension == pytest.approx(252.56404091137, abs=5.4e-12)
    assert state.sag == pytest.approx(4.07155668516987, abs=6e-15)
    assert state.tension(0.0) == pytest.approx(332.215091712402, abs=1.5e-12)


def test_elastic_catenary_as_long_as_the_span() -> None:
    state = rope.elastic_catenary(**{**HEAVY, "length": 20.0})
    # One rounding of the span is 3.6e-15 m, and the rope gives 5.9e-4 m/N: 6e-12 N; the sag changes by sag/H of that.
    assert state.horizontal_tension == pytest.approx(855.834877884037, abs=7e-12)
    assert state.sag == pytest.approx(1.14138194321133, abs=1.5e-14)


def test_elastic_catenary_between_different_heights() -> None:
    """The larger vertical reaction, 257.75 N, is that of the upper support."""
    falling = rope.elastic_catenary(**{**HEAVY, "axial_stiffness": 1e4}, height=-3.0)
    assert falling.horizontal_tension == pytest.approx(230.5058362994, abs=5.1e-11)  # 13 digits are given
    assert falling.start_reaction[1] == pytest.approx(257.752781840927, abs=1.5e-12)
    rising = rope.elastic_catenary(**{**HEAVY, "axial_stiffness": 1e4}, height=3.0)
    assert rising.end_reaction[1] == pytest.approx(257.752781840927, abs=1.5e-12)


@pytest.mark.parametrize(
    ("xi", "horizontal", "vertical", "place", "tensions"),
    [
        (5.5, 742.247459584949, 786.645427945291, (3.95586524491478, -3.90148493918959), None),
        (11.0, 947.152146966831, None, (10.0, -4.81791524851864), (1009.75105323, 1009.75105323)),
        (20.0, 378.751221624917, None, (19.1988730391743, -1.85333337473086), (409.890185831, 936.697132823)),
    ],
)
def test_elastic_catenary_with_a_point_load(
    xi: float, horizontal: float, vertical: float | None, place: tuple, tensions: tuple | None
) -> None:
    state = rope.elastic_catenary(**HEAVY, loads=[(xi, (0.0, -700.0))])
    assert state.horizontal_tension == pytest.approx(horizontal, abs=2e-12)  # last digit, roundings
    assert state.load_positions[0] == pytest.approx(place, abs=6e-14)  # 15 digits are given
    if vertical is not None:
        assert state.start_reaction[1] == pytest.approx(vertical, abs=2e-12)
    if tensions is not None:
        assert state.load_tensions[0] == pytest.approx(tensions, abs=5.1e-9 if xi == 11.0 else 5.1e-10)


@settings(deadline=None)
@given(heights, lengths, stiffnesses, loads)
def test_reactions_balance_weight_and_loads_and_the_rope_reaches_its_end(
    height: float, length: float, stiffness: float, loads: list
) -> None:
    given_loads = at_length(loads, length)
    case = {**HEAVY, "length": length, "axial_stiffness": stiffness, "height": height}
    state = rope.elastic_catenary(**case, loads=given_loads)
    total = np.array([0.0, -19.62 * length]) + sum((np.array(force) for _, force in given_loads), np.zeros(2))
    size = np.max(np.abs(state.force)) + 19.62 * length
    assert state.start_reaction + state.end_reaction + total == pytest.approx(0.0, abs=1e-14 * size)
    # roundings of the pieces, and of forces through the compliance of the rope
    allowed = 1e-13 * length * (1.0 + size / stiffness)
    assert state.position(length) == pytest.approx([20.0, height], abs=allowed)
    assert np.all(np.isfinite(state.tension(np.linspace(0.0, length, 9))))
    assert state.sag >= 0.0


@settings(deadline=None, max_examples=30)
@given(heights, lengths, stiffnesses, loads)
def test_mirrored_rope_is_the_mirror_image(height: float, length: float, stiffness: float, loads: list) -> None:
    case = {**HEAVY, "length": length, "axial_stiffness": stiffness}
    state = rope.elastic_catenary(**case, height=height, loads=at_length(loads, length))
    mirrored_loads = [(length - xi, (-f_x, f_z)) for xi, (f_x, f_z) in at_length(loads, length)]
    mirror = rope.elastic_catenary(**case, height=-height, loads=mirrored_loads)
    size = np.max(np.abs(state.force))
    taut = 1.0 + 1e-3 * stiffness / size  # a taut rope turns roundings of its length into forces
    assert mirror.end_reaction * [-1, 1] == pytest.approx(state.start_reaction, abs=1e-12 * size * taut)
    xi = np.linspace(0.0, length, 7)
    expected = np.array([20.0, height]) + mirror.position(length - xi) * [-1, 1]
    # a piece that hangs almost free of tension moves far for small forces
    assert state.position(xi) == pytest.approx(expected, abs=1e-9 * length)


@settings(deadline=None, max_examples=30)
@given(heights, lengths, stiffnesses, loads, st.integers(-20, 20), st.integers(-20, 20))
def test_solution_scales_with_the_units(
    height: float, length: float, stiffness: float, loads: list, metres: int, newtons: int
) -> None:
    """Powers of two, so that scaling makes no rounding."""
    m, n = 2.0**metres, 2.0**newtons
    small = rope.elastic_catenary(
        **{**HEAVY, "length": length, "axial_stiffness": stiffness},
        height=height,
        loads=at_length(loads, length),
    )
    large = rope.elastic_catenary(
        span=20.0 * m,
        height=height * m,
        length=length * m,
        weight=19.62 * n / m,
        axial_stiffness=stiffness * n,
        loads=[(xi * m, (f_x * n, f_z * n)) for xi, (f_x, f_z) in at_length(loads, length)],
    )
    size = np.max(np.abs(small.force))
    # one Newton step more or less at the same point
    taut = 1.0 + 1e-3 * stiffness / size
    assert large.force / n == pytest.approx(small.force, abs=1e-12 * size * taut)


def test_position_is_the_integral_of_stretch_times_tangent() -> None:
    loads = [(4.0, (120.0, -300.0)), (15.0, (-40.0, 90.0))]
    state = rope.elastic_catenary(**{**HEAVY, "axial_stiffness": 3e3}, height=2.0, loads=loads)

    def gradient(xi: float, axis: int) -> float:
        passed = sum((np.array(force) for place, force in loads if place < xi), np.zeros(2))
        force = -state.start_reaction + np.array([0.0, 19.62 * xi]) - passed
        tension = float(np.hypot(*force))
        return (1.0 + tension / 3e3) * force[axis] / tension

    for xi in (3.0, 10.0, 22.0):
        for axis in (0, 1):
            integral = quad(gradient, 0.0, xi, args=(axis,), points=[4.0, 15.0], epsabs=1e-12)[0]
            assert state.position(xi)[axis] == pytest.approx(integral, abs=1e-11)  # quadrature


def test_very_stiff_rope_hangs_in_the_catenary() -> None:
    stiff = rope.elastic_catenary(**{**HEAVY, "axial_stiffness": 1e13}, height=3.0)
    hard = rope.catenary(span=20.0, height=3.0, length=22.0, weight=19.62)
    xi = np.linspace(0.0, 22.0, 12)
    # strain of 3e-11, ten times that in the sag
    assert stiff.position(xi) == pytest.approx(hard.position(xi), abs=1e-8)
    assert stiff.tension(xi) == pytest.approx(hard.tension(xi), rel=1e-9)


@pytest.mark.parametrize("stiffness", 10.0 ** np.arange(2, 11))
@pytest.mark.parametrize("length", [19.0, 20.0, 22.0, 220.0])
def test_stiffness_over_eight_decades(stiffness: float, length: float) -> None:
    state = rope.elastic_catenary(
        **{**HEAVY, "axial_stiffness": stiffness, "length": length}, loads=[(length / 3, (0.0, -700.0))]
    )
    assert state.position(length) == pytest.approx([20.0, 0.0], abs=1e-12 * length)  # roundings
    stretched, _ = quad(lambda xi: 1.0 + float(state.tension(xi)) / stiffness, 0.0, length, points=[length / 3])
    assert stretched >= 20.0
    assert state.sag > 0.0


def test_extreme_sag() -> None:
    deep = rope.catenary(span=1.0, length=40.0, weight=2.0)
    assert deep.sag == pytest.approx(20.0, abs=0.2)  # two hanging halves joined by a small arc
    elastic = rope.elastic_catenary(span=1.0, length=40.0, weight=2.0, axial_stiffness=1e12)
    assert elastic.sag == pytest.approx(deep.sag, abs=1e-8)  # strain of 4e-11
    absurd = rope.catenary(span=1.0, length=1e9, weight=2.0)
    assert absurd.tension(0.0) == pytest.approx(1e9, rel=1e-6)
    assert absurd.position(1e9) == pytest.approx([1.0, 0.0], abs=1e-6)  # rounding of 1e9 m


@pytest.mark.parametrize(("height", "length"), [(30.0, 22.0), (-30.0, 22.0), (5.0, 22.0), (0.0, 22.0)])
def test_nearly_vertical_rope_hangs_from_its_upper_support(height: float, length: float) -> None:
    case = {"span": 1e-9, "length": length, "weight": 19.62, "axial_stiffness": 1e4}
    state = rope.elastic_catenary(**case, height=height)
    assert state.position(length) == pytest.approx([1e-9, height], abs=1e-12)  # roundings
    if abs(height) > length:  # stretched along the vertical: mean strain gives the mean tension
        mean = float(state.tension(length / 2))
        assert mean == pytest.approx(1e4 * (abs(height) / length - 1.0), rel=1e-9)
    else:  # a free loop: hardly any horizontal tension
        assert 0.0 < state.horizontal_tension < 1e-6


def test_nearly_straight_catenary_keeps_its_digits() -> None:
    excess = 2.0**-40
    taut = rope.catenary(span=1.0, length=1.0 + excess, weight=1.0)
    # L/X = sinh(u)/u, u = w X/(2 H): H = w X / sqrt(24 (L/X - 1)) (1 + O(excess))
    assert taut.horizontal_tension == pytest.approx(1.0 / math.sqrt(24.0 * excess), rel=1e-11)


def test_load_on_a_support_goes_into_that_support() -> None:
    bare = rope.elastic_catenary(**HEAVY)
    for xi, reaction in ((0.0, "start_reaction"), (22.0, "end_reaction")):
        loaded = rope.elastic_catenary(**HEAVY, loads=[(xi, (50.0, -700.0))])
        places = np.linspace(0.0, 22.0, 9)
        assert loaded.position(places) == pytest.approx(bare.position(places), abs=1e-12)  # roundings
        taken = getattr(loaded, reaction) - getattr(bare, reaction)
        assert taken == pytest.approx([-50.0, 700.0], abs=1e-10)


def test_two_loads_at_one_place_add_up() -> None:
    apart = rope.elastic_catenary(**HEAVY, loads=[(7.0, (10.0, -300.0)), (7.0, (-30.0, -400.0))])
    joint = rope.elastic_catenary(**HEAVY, loads=[(7.0, (-20.0, -700.0))])
    assert apart.start_reaction == pytest.approx(joint.start_reaction, rel=1e-13)  # roundings
    assert apart.position(7.0) == pytest.approx(joint.position(7.0), rel=1e-13)


def test_tension_jumps_at_a_load_that_stands_aside() -> None:
    state = rope.elastic_catenary(**HEAVY, loads=[(20.0, (0.0, -700.0)), (5.0, (0.0, -1.0))])
    assert state.load_tensions.shape == (2, 2)
    behind, ahead = state.load_tensions[1]
    assert state.tension(20.0 - 1e-9) == pytest.approx(behind, rel=1e-9)  # 1e-9 m away
    assert state.tension(20.0) == pytest.approx(ahead, rel=1e-15)  # rounding of a sum
    assert state.position(20.0) == pytest.approx(state.load_positions[1], rel=1e-15)


def test_a_piece_that_hangs_almost_without_weight_reaches_from_load_to_support() -> None:
    """It carries 1e-10 N beside loads of 80 N, of which the roundings are 1e-14 N."""
    loads = [(1.9, (-2e-3, 2e-3)), (6.9, (84.5, -5.4)), (10.7, (1.6, -2.6)), (23.2, (-6e-3, -7e-4))]
    state = rope.elastic_catenary(span=20.0, length=27.9, weight=3.4e-12, axial_stiffness=3e3, loads=loads)
    assert np.hypot(*state.force[3]) < 1e-9
    assert state.nodes[-1] == pytest.approx([20.0, 0.0], abs=1e-13)


def test_sag_is_measured_from_the_line_through_the_supports() -> None:
    state = rope.elastic_catenary(**HEAVY, height=6.0, loads=[(8.0, (0.0, -100.0))])
    x, z = state.position(np.linspace(0.0, 22.0, 20001)).T
    assert state.sag == pytest.approx(np.max(0.3 * x - z), abs=1e-6)  # sampling: curvature h^2/8
    lifted = rope.elastic_catenary(**HEAVY, loads=[(xi, (0.0, 60.0)) for xi in np.arange(0.5, 22.0)])
    assert lifted.sag < 0.1


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"span": 0.0}, "^span must"),
        ({"span": -1.0}, "^span must"),
        ({"length": math.nan}, "^length must"),
        ({"weight": 0.0}, "^weight must"),
        ({"axial_stiffness": -1e5}, "^axial_stiffness must"),
        ({"height": math.inf}, "^height must"),
        ({"loads": [(23.0, (0.0, 1.0))]}, "loads must stand"),
        ({"loads": [(math.nan, (0.0, 1.0))]}, "loads must stand"),
        ({"loads": [(3.0, (0.0, math.nan))]}, "forces"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        rope.elastic_catenary(**(HEAVY | changed))


def test_places_off_the_rope_are_refused() -> None:
    state = rope.elastic_catenary(**HEAVY)
    for xi in (-0.1, 22.1, math.nan):
        with pytest.raises(ValueError, match="xi must lie"):
            state.position(xi)
        with pytest.raises(ValueError, match="xi must lie"):
            state.tension(xi)


@pytest.mark.parametrize(("length", "height"), [(20.0, 0.0), (19.0, 0.0), (20.0, 5.0)])
def test_inextensible_rope_that_is_too_short_is_refused(length: float, height: float) -> None:
    with pytest.raises(ValueError, match="does not hang"):
        rope.catenary(span=20.0, height=height, length=length, weight=1.0)
