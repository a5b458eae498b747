"""Energy and shooting give the same rope: random ropes, and the extremes."""

import math
from math import inf
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ropewalk.theory import rope, shooting


def agree(**case: Any) -> None:
    """Same places, same forces: to roundings, times what the rope makes of them."""
    energy, other = rope.resting(**case), shooting.resting(**case)
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


@settings(deadline=None, max_examples=25)
@given(height=heights, ratio=st.one_of(st.floats(0.5, 3.0), ratios), weight=weights, stiffness=stiffnesses, loads=loads)
@example(height=0.0, ratio=1.0, weight=20.0, stiffness=1e5, loads=[(0.5, (0.0, -700.0))])
def test_heavy_elastic_rope(height: float, ratio: float, weight: float, stiffness: float, loads: list) -> None:
    length = math.hypot(20.0, height) * ratio
    agree(
        span=20.0, height=height, length=length, weight=weight, axial_stiffness=stiffness,
        loads=placed(loads, length),
    )  # fmt: skip


@settings(deadline=None, max_examples=25)
@given(height=heights, ratio=ratios, weight=weights, loads=loads)
@example(height=0.0, ratio=1.0 + 1e-9, weight=20.0, loads=[(0.5, (0.0, -700.0))])
@example(height=-3.0, ratio=1000.0, weight=20.0, loads=[(0.5, (0.0, -700.0)), (0.9, (0.0, -70.0))])
def test_heavy_inextensible_rope(height: float, ratio: float, weight: float, loads: list) -> None:
    length = math.hypot(20.0, height) * ratio
    agree(span=20.0, height=height, length=length, weight=weight, loads=placed(loads, length))


@settings(deadline=None, max_examples=25)
@given(
    height=heights,
    ratio=st.floats(0.5, 1.2),
    stiffness=stiffnesses,
    law=st.sampled_from(["hooke", "second_piola_kirchhoff"]),
    loads=loads,
)
def test_weightless_elastic_rope(
    height: float, ratio: float, stiffness: float, law: rope.AxialLaw, loads: list
) -> None:
    length = math.hypot(20.0, height) * ratio
    case = {"span": 20.0, "height": height, "length": length, "axial_stiffness": stiffness, "law": law}
    placed_loads = placed(loads, length)
    tension = np.hypot(*rope.resting(**case, loads=placed_loads).force.T)
    if np.any(tension < 1e-3):  # slack, or about to be: the next test
        return
    agree(**case, loads=placed_loads)


def test_slack_pieces_are_refused_by_shooting() -> None:
    hanging = {"span": 20.0, "length": 22.0, "loads": [(21.5, (0.0, -200.0))]}
    for stiffness in (1e4, inf):
        with pytest.raises(ValueError, match="slack"):
            shooting.resting(**hanging, axial_stiffness=stiffness)


def test_weightless_inextensible_polygon() -> None:
    for height, length in ((0.0, 22.0), (4.0, 21.0), (-5.0, 20.7)):
        agree(span=20.0, height=height, length=length,
              loads=[(8.0, (0.0, -700.0)), (11.0, (20.0, -100.0)), (13.0, (0.0, -400.0))])  # fmt: skip
        agree(span=20.0, height=height, length=length, loads=[(9.0, (0.0, -700.0))])


@pytest.mark.parametrize("stiffness", 10.0 ** np.arange(2, 11))
@pytest.mark.parametrize("ratio", [0.9, 1.0, 1.0 + 1e-9, 1.1, 1000.0])
def test_stiffness_over_eight_decades(stiffness: float, ratio: float) -> None:
    length = 20.0 * ratio
    loads = [(0.3 * length, (0.0, -700.0)), (0.7 * length, (50.0, -200.0))]
    agree(span=20.0, length=length, weight=20.0, axial_stiffness=float(stiffness), loads=loads)


def test_vanishing_weight_gives_the_weightless_rope() -> None:
    case = {"span": 20.0, "height": 2.0, "length": 22.0, "loads": [(8.0, (0.0, -700.0)), (15.0, (0.0, -200.0))]}
    for stiffness in (1e4, inf):
        none = shooting.resting(**case, axial_stiffness=stiffness)
        for weight in (1e-3, 1e-6, 1e-9):
            light = shooting.resting(**case, axial_stiffness=stiffness, weight=weight)
            # of the first order in weight by load
            assert light.force == pytest.approx(none.force, abs=100.0 * weight + 1e-9)
            assert light.nodes == pytest.approx(none.nodes, abs=0.1 * weight + 1e-11)


def test_loads_on_supports_and_in_one_place() -> None:
    case = {"span": 20.0, "length": 22.0, "weight": 20.0, "height": 1.0}
    loads = [(0.0, (5.0, -100.0)), (9.0, (0.0, -70.0)), (9.0, (3.0, -50.0)), (22.0, (0.0, -30.0))]
    for stiffness in (1e4, inf):
        agree(**case, axial_stiffness=stiffness, loads=loads)
        agree(**case, axial_stiffness=stiffness, loads=loads[::3])
        agree(**case, axial_stiffness=stiffness)


def test_catenary_in_closed_form_by_every_route() -> None:
    case = {"span": 20.0, "length": 22.0, "weight": 1.0}
    for route in (rope.resting, shooting.resting):
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
def test_irvines_catenaries(length: float, height: float, stiffness: float, horizontal: float) -> None:
    state = shooting.resting(span=20.0, height=height, length=length, weight=19.62, axial_stiffness=stiffness)
    assert state.horizontal_tension == pytest.approx(horizontal, rel=5e-13)  # 13 to 15 digits are given


@pytest.mark.parametrize(
    ("xi", "horizontal", "place"),
    [
        (5.5, 742.247459584949, (3.95586524491478, -3.90148493918959)),
        (11.0, 947.152146966831, (10.0, -4.81791524851864)),
        (20.0, 378.751221624917, (19.1988730391743, -1.85333337473086)),
    ],
)
def test_heavy_rope_with_a_point_load(xi: float, horizontal: float, place: tuple) -> None:
    state = shooting.resting(span=20.0, length=22.0, weight=19.62, axial_stiffness=1e5, loads=[(xi, (0.0, -700.0))])
    assert state.horizontal_tension == pytest.approx(horizontal, rel=1e-12)
    assert state.load_positions[0] == pytest.approx(place, abs=1e-12)


def test_nonsense_is_refused() -> None:
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
        for solve in (shooting.resting, rope.resting):
            with pytest.raises(ValueError, match=said):
                solve(**(case | changed))
