"""Energy, shooting and force balance give the same rope: random ropes, and the extremes."""

import math
from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ropewalk.theory import balance, rope, shooting

ROUTES = [shooting.resting, balance.resting]
every_route = pytest.mark.parametrize("route", ROUTES, ids=["shooting", "balance"])
Route = Callable[..., rope.RestingRope]


def agree(route: Route, **case: Any) -> None:
    """Same places, same forces: to roundings, times what the rope makes of them."""
    energy, other = rope.resting(**case), route(**case)
    size = float(np.abs(energy.force).max())
    length, distance = case["length"], math.hypot(case["span"], case.get("height", 0.0))
    # an error of 1e-16 of the length is one of 1e-16 EA in the force of an elastic piece as long; the force of a taut
    # inextensible rope goes with the root of its spare length, which is known to 1e-16 of the length
    stiff, taut = case.get("axial_stiffness", inf), abs(length / distance - 1.0)
    segments = np.diff(energy.breaks)
    noise = stiff / size * length / segments[segments > 0.0].min() if math.isfinite(stiff) else 1.0 / taut
    assert other.force == pytest.approx(energy.force, abs=(1e-11 + 2e-15 * noise) * size)
    stretched = length * (1.0 + size / stiff)
    turned = 1e-15 * noise * length * min(1.0, taut**0.5)
    assert other.nodes == pytest.approx(energy.nodes, abs=1e-11 * stretched + turned)
    assert other.load_forces == pytest.approx(energy.load_forces, abs=(1e-12 + 1e-14 * noise) * size)


heights = st.floats(-15.0, 15.0)
components = st.tuples(st.floats(-500.0, 500.0), st.floats(-900.0, -50.0))
fractions = st.integers(0, 50).map(lambda value: value / 50.0)
loads = st.lists(st.tuples(fractions, components), min_size=1, max_size=3)
ratios = st.one_of(st.floats(1.0001, 4.0), st.sampled_from([1.0 + 1e-9, 1.0 + 1e-6, 1000.0]))
weights = st.floats(-2.0, 3.0).map(lambda power: 10.0**power)
stiffnesses = st.floats(2.0, 10.0).map(lambda power: 10.0**power)


def placed(given_loads: list, length: float) -> list:
    return [(fraction * length, force) for fraction, force in given_loads]


@every_route
@settings(deadline=None, max_examples=25)
@given(height=heights, ratio=st.one_of(st.floats(0.5, 3.0), ratios), weight=weights, stiffness=stiffnesses, loads=loads)
@example(height=0.0, ratio=1.0, weight=20.0, stiffness=1e5, loads=[(0.5, (0.0, -700.0))])
def test_heavy_elastic_rope(
    route: Route, height: float, ratio: float, weight: float, stiffness: float, loads: list
) -> None:
    length = math.hypot(20.0, height) * ratio
    agree(
        route, span=20.0, height=height, length=length, weight=weight, axial_stiffness=stiffness,
        loads=placed(loads, length),
    )  # fmt: skip


@every_route
@settings(deadline=None, max_examples=25)
@given(height=heights, ratio=ratios, weight=weights, loads=loads)
@example(height=0.0, ratio=1.0 + 1e-9, weight=20.0, loads=[(0.5, (0.0, -700.0))])
@example(height=-3.0, ratio=1000.0, weight=20.0, loads=[(0.5, (0.0, -700.0)), (0.9, (0.0, -70.0))])
def test_heavy_inextensible_rope(route: Route, height: float, ratio: float, weight: float, loads: list) -> None:
    length = math.hypot(20.0, height) * ratio
    agree(route, span=20.0, height=height, length=length, weight=weight, loads=placed(loads, length))


@every_route
@settings(deadline=None, max_examples=25)
@given(
    height=heights,
    ratio=st.floats(0.5, 1.2),
    stiffness=stiffnesses,
    law=st.sampled_from(["hooke", "second_piola_kirchhoff"]),
    loads=loads,
)
def test_weightless_elastic_rope(
    route: Route, height: float, ratio: float, stiffness: float, law: rope.AxialLaw, loads: list
) -> None:
    length = math.hypot(20.0, height) * ratio
    case = {"span": 20.0, "height": height, "length": length, "axial_stiffness": stiffness, "law": law}
    placed_loads = placed(loads, length)
    tension = np.hypot(*rope.resting(**case, loads=placed_loads).force.T)
    if np.any(tension < 1e-3):  # slack, or about to be: the next test
        return
    agree(route, **case, loads=placed_loads)


def test_slack_pieces_are_found_by_the_balance_and_refused_by_shooting() -> None:
    case = {"span": 20.0, "length": 22.0, "loads": [(3.0, (0.0, -700.0)), (21.5, (0.0, -200.0))]}
    for stiffness in (1e4, 1e8, inf):
        energy = rope.resting(**case, axial_stiffness=stiffness)
        taut = np.any(energy.force != 0.0, axis=1)
        state = balance.resting(**case, axial_stiffness=stiffness)
        if stiffness == 1e4:
            assert np.all(taut)
        assert state.force == pytest.approx(energy.force, abs=1e-6 if stiffness == 1e8 else 1e-9)  # 1e-15 EA
        assert state.nodes == pytest.approx(energy.nodes, abs=1e-11)
    hanging = {"span": 20.0, "length": 22.0, "loads": [(21.5, (0.0, -200.0))]}
    for stiffness in (1e4, inf):
        agree(balance.resting, **hanging, axial_stiffness=stiffness)
        with pytest.raises(ValueError, match="slack"):
            shooting.resting(**hanging, axial_stiffness=stiffness)


@every_route
def test_weightless_inextensible_polygon(route: Route) -> None:
    for height, length in ((0.0, 22.0), (4.0, 21.0), (-5.0, 20.7)):
        agree(route, span=20.0, height=height, length=length,
              loads=[(8.0, (0.0, -700.0)), (11.0, (20.0, -100.0)), (13.0, (0.0, -400.0))])  # fmt: skip
        agree(route, span=20.0, height=height, length=length, loads=[(9.0, (0.0, -700.0))])


@every_route
@pytest.mark.parametrize("stiffness", 10.0 ** np.arange(2, 11))
@pytest.mark.parametrize("ratio", [0.9, 1.0, 1.0 + 1e-9, 1.1, 1000.0])
def test_stiffness_over_eight_decades(route: Route, stiffness: float, ratio: float) -> None:
    length = 20.0 * ratio
    loads = [(0.3 * length, (0.0, -700.0)), (0.7 * length, (50.0, -200.0))]
    agree(route, span=20.0, length=length, weight=20.0, axial_stiffness=float(stiffness), loads=loads)


@every_route
def test_vanishing_weight_gives_the_weightless_rope(route: Route) -> None:
    case = {"span": 20.0, "height": 2.0, "length": 22.0, "loads": [(8.0, (0.0, -700.0)), (15.0, (0.0, -200.0))]}
    for stiffness in (1e4, inf):
        none = route(**case, axial_stiffness=stiffness)
        for weight in (1e-3, 1e-6, 1e-9):
            light = route(**case, axial_stiffness=stiffness, weight=weight)
            # of the first order in weight by load
            assert light.force == pytest.approx(none.force, abs=100.0 * weight + 1e-9)
            assert light.nodes == pytest.approx(none.nodes, abs=0.1 * weight + 1e-11)


@every_route
def test_loads_on_supports_and_in_one_place(route: Route) -> None:
    case = {"span": 20.0, "length": 22.0, "weight": 20.0, "height": 1.0}
    loads = [(0.0, (5.0, -100.0)), (9.0, (0.0, -70.0)), (9.0, (3.0, -50.0)), (22.0, (0.0, -30.0))]
    for stiffness in (1e4, inf):
        agree(route, **case, axial_stiffness=stiffness, loads=loads)
        agree(route, **case, axial_stiffness=stiffness, loads=loads[::3])
        agree(route, **case, axial_stiffness=stiffness)


def test_catenary_in_closed_form_by_every_route() -> None:
    case = {"span": 20.0, "length": 22.0, "weight": 1.0}
    for route in (rope.resting, shooting.resting, balance.resting):
        level, raised = route(**case), route(**case, height=3.0)
        assert level.horizontal_tension == pytest.approx(13.099278952737124, rel=1e-13)  # 1e-15 by 0.1 of spare length
        assert level.sag == pytest.approx(4.0060158147207523, rel=1e-13)
        assert level.tension(22.0) == pytest.approx(17.105294767457876, rel=1e-13)
        assert raised.horizontal_tension == pytest.approx(13.808883017127064, rel=1e-13)


@pytest.mark.parametrize(
    ("length", "height", "stiffness", "horizontal"),
    [
        (22.0, 0.0, 1e5, 252.56404091137),
        (20.0, 0.0, 1e5, 855.834877884037),
        (22.0, 3.0, 1e4, 230.5058362994),
    ],
)
@every_route
def test_irvines_catenaries(route: Route, length: float, height: float, stiffness: float, horizontal: float) -> None:
    state = route(span=20.0, height=height, length=length, weight=19.62, axial_stiffness=stiffness)
    assert state.horizontal_tension == pytest.approx(horizontal, rel=5e-13)  # 13 to 15 digits are given


@pytest.mark.parametrize(
    ("xi", "horizontal", "place"),
    [
        (5.5, 742.247459584949, (3.95586524491478, -3.90148493918959)),
        (11.0, 947.152146966831, (10.0, -4.81791524851864)),
        (20.0, 378.751221624917, (19.1988730391743, -1.85333337473086)),
    ],
)
@every_route
def test_heavy_rope_with_a_point_load(route: Route, xi: float, horizontal: float, place: tuple) -> None:
    state = route(span=20.0, length=22.0, weight=19.62, axial_stiffness=1e5, loads=[(xi, (0.0, -700.0))])
    assert state.horizontal_tension == pytest.approx(horizontal, rel=1e-12)
    assert state.load_positions[0] == pytest.approx(place, abs=1e-12)


@settings(deadline=None, max_examples=60)
@given(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0), weights, stiffnesses, st.floats(1.0, 40.0))
@example(0.0, 5.0, 20.0, 1e4, 10.0)
@example(0.0, 30.0, 20.0, 1e4, 10.0)
@example(0.0, -30.0, 20.0, 1e4, 10.0)
@example(-4.0, 3.0, 20.0, 1e4, 10.0)
def test_piece_between_known_ends_reaches_them(
    dx: float, dz: float, weight: float, stiffness: float, length: float
) -> None:
    """The one equation of the balance against the quadrature of the shot."""
    dx = dx if dx == 0.0 or abs(dx) > 1e-3 else 1e-3
    force = balance.heavy_piece(np.array([dx, dz]), length, weight, 1.0 / stiffness)
    bare = np.array([0.0, length]), np.zeros((1, 2))
    nodes, _ = shooting.shot(force, *bare, weight, 1.0 / stiffness, "hooke")
    strain = 1.0 + float(np.max(np.abs(force))) / stiffness
    # roundings of 1e-15 in the force by a piece that turns where its tension is small
    assert nodes[-1] == pytest.approx([dx, dz], abs=1e-10 * length * strain)


@every_route
def test_nonsense_is_refused(route: Route) -> None:
    case = {"span": 20.0, "length": 22.0, "weight": 20.0, "axial_stiffness": 1e4, "loads": [(5.0, (0.0, -700.0))]}
    for changed, said in (
        ({"span": 0.0}, "^span must"),
        ({"height": math.nan}, "^height must"),
        ({"weight": -1.0}, "^weight must"),
        ({"axial_stiffness": math.nan}, "^axial_stiffness must"),
        ({"axial_stiffness": 0.0}, "^axial_stiffness must"),
        ({"axial_stiffness": inf, "length": 20.0}, "does not hang"),
        ({"law": "linear"}, "^law must"),
        ({"law": "second_piola_kirchhoff"}, "^law must be 'hooke' for a rope with weight"),
        ({"loads": [(23.0, (0.0, -1.0))]}, "loads must stand"),
        ({"weight": 0.0, "loads": []}, "no definite shape"),
    ):
        for solve in (route, rope.resting):
            with pytest.raises(ValueError, match=said):
                solve(**(case | changed))
