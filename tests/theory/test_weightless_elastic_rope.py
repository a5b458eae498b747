"""Weightless elastic rope with one load: the two models of "Walking the Line", eq. 8 and eqs. 6-7.

Span and length 20 m, axial stiffness 10 kN, load 700 N unless said. Reference numbers are derived in
docs/notes.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ropewalk.theory import rope

PAPER = {"span": 20.0, "length": 20.0, "axial_stiffness": 1e4}
WEIGHT = (0.0, -700.0)


@pytest.mark.parametrize(
    ("length", "xi", "place", "tensions"),
    [
        (20.0, 10.0, (10.0, -4.30123479814642), (885.799042274557, 885.799042274557)),
        (20.0, 15.0, (15.7181740559642, -3.36402343342115), (716.086543431259, 890.488891803585)),
        (20.0, 18.0, (18.7543837994964, -1.76548028808644), (465.166092398723, 803.333243238956)),
        (22.0, 16.0, (15.9813342631604, -5.01938211235652), None),
    ],
)
def test_clamped_load_by_hookes_law(length: float, xi: float, place: tuple, tensions: tuple | None) -> None:
    state = rope.weightless_elastic(**{**PAPER, "length": length}, loads=[(xi, WEIGHT)])
    # 15 digits are given; the rest is the condition of the problem, sag by strain
    assert state.load_positions[0] == pytest.approx(place, abs=6e-14)
    if tensions is not None:
        assert state.load_tensions[0] == pytest.approx(tensions, abs=2e-12)


@pytest.mark.parametrize(
    ("xi", "place", "tension"),
    [(10.0, (10.0, -4.17804102444912), 907.889508), (15.0, (15.6921645731122, -3.28573423327046), None)],
)
def test_clamped_load_by_the_printed_law(xi: float, place: tuple, tension: float | None) -> None:
    state = rope.weightless_elastic(**PAPER, loads=[(xi, WEIGHT)], law="second_piola_kirchhoff")
    assert state.load_positions[0] == pytest.approx(place, abs=6e-14)  # 15 digits are given
    if tension is not None:
        assert state.load_tensions[0] == pytest.approx([tension] * 2, abs=5e-7)  # 9 digits are given


def test_pulley_is_the_clamped_load_with_the_hold_force_at_equal_tensions() -> None:
    """Frictionless load at x = 15: its hold force, applied to the material point there, keeps it in place."""
    place, tension, hold = np.array([15.0, -3.7070901273379]), 837.821869567776, 140.331412274603
    behind, ahead = np.hypot(*place), np.hypot(20.0 - place[0], place[1])
    xi = 20.0 * behind / (behind + ahead)  # one tension, one strain
    state = rope.weightless_elastic(**PAPER, loads=[(xi, (hold, -700.0))])
    assert state.load_positions[0] == pytest.approx(place, abs=1e-13)  # 14 digits are given
    assert state.load_tensions[0] == pytest.approx([tension] * 2, abs=2e-12)


def test_small_load_follows_the_cubic_law() -> None:
    for small in (1e-3, 1e-6, 1e-9):
        state = rope.weightless_elastic(**PAPER, loads=[(10.0, (0.0, -small))])
        z = state.load_positions[0, 1]
        # W = k (2z/X)^3 (1 + O((2z/X)^2)); the strain, the square of the slope, is down to 1e-8 of the length
        assert 1e4 * (-2.0 * z / 20.0) ** 3 == pytest.approx(small, rel=2.0 * (z / 10.0) ** 2 + 1e-7)


laws = st.sampled_from(["hooke", "second_piola_kirchhoff"])


@settings(deadline=None, max_examples=200)
@given(
    laws,
    st.floats(-15.0, 15.0),
    st.floats(5.0, 60.0),
    st.floats(0.0, 1.0),
    st.tuples(st.floats(-900.0, 900.0), st.floats(-900.0, -1e-3)),
    st.floats(2.0, 9.0),
)
def test_forces_balance_and_pieces_have_the_length_of_their_tension(
    law: rope.AxialLaw, height: float, length: float, fraction: float, force: tuple, decades: float
) -> None:
    stiffness = 10.0**decades
    load = (fraction * length, force)
    state = rope.weightless_elastic(
        span=20.0, height=height, length=length, axial_stiffness=stiffness, loads=[load], law=law
    )
    size = float(np.max(np.abs(state.force))) + 1.0
    assert state.start_reaction + state.end_reaction + np.array(force) == pytest.approx(0.0, abs=1e-13 * size)
    steps = np.diff(state.nodes, axis=0)
    for step, pull, unstrained in zip(steps, state.force, np.diff(state.breaks), strict=True):
        tension, reach = float(np.hypot(*pull)), float(np.hypot(*step))
        assert step[0] * pull[1] - step[1] * pull[0] == pytest.approx(0.0, abs=1e-9 * (1 + tension) * length)
        if tension == 0.0:
            assert reach <= unstrained * (1.0 + 1e-15)
        elif unstrained > 0.0:
            strain = tension / stiffness
            stretch = 1.0 + strain if law == "hooke" else 0.5 + math.sqrt(0.25 + strain)
            # the position is that of the load; the second piece closes up to roundings
            assert reach == pytest.approx(unstrained * stretch, abs=1e-12 * (length + reach))


@settings(deadline=None)
@given(laws, st.floats(-10.0, 10.0), st.floats(15.0, 40.0), st.floats(0.01, 0.99), st.floats(-300.0, 300.0))
def test_mirrored_rope_is_the_mirror_image(
    law: rope.AxialLaw, height: float, length: float, fraction: float, f_x: float
) -> None:
    case = {"span": 20.0, "length": length, "axial_stiffness": 1e4, "law": law}
    state = rope.weightless_elastic(**case, height=height, loads=[(fraction * length, (f_x, -500.0))])
    mirror = rope.weightless_elastic(**case, height=-height, loads=[(length - fraction * length, (-f_x, -500.0))])
    expected = np.array([20.0, height]) + mirror.load_positions[0] * [-1, 1]
    # small load on a straight rope is where roundings weigh most
    assert state.load_positions[0] == pytest.approx(expected, abs=1e-10)


def test_load_near_a_support_leaves_the_long_piece_slack() -> None:
    """Inextensible limit: beyond L - s = (L^2 - X^2)/(2 L) the load hangs below the support."""
    case = {"span": 20.0, "length": 22.0, "axial_stiffness": 1e10}
    hanging = rope.weightless_elastic(**case, loads=[(20.5, WEIGHT)])
    assert hanging.load_positions[0] == pytest.approx([20.0, -1.5], abs=2e-7)  # strain 7e-8
    assert hanging.load_tensions[0] == pytest.approx([0.0, 700.0])
    assert hanging.start_reaction == pytest.approx([0.0, 0.0], abs=0.0)
    assert hanging.tension([5.0, 21.0]) == pytest.approx([0.0, 700.0])
    assert np.all(np.isfinite(hanging.position(np.linspace(0.0, 22.0, 9))))
    edge = (484.0 - 400.0) / 44.0
    taut = rope.weightless_elastic(**case, loads=[(22.0 - edge - 1e-4, WEIGHT)])
    assert taut.load_tensions[0, 0] > 0.0
    mirrored = rope.weightless_elastic(**case, loads=[(1.5, WEIGHT)])
    assert mirrored.load_positions[0] == pytest.approx([0.0, -1.5], abs=2e-7)
    assert mirrored.load_tensions[0] == pytest.approx([700.0, 0.0])


@pytest.mark.parametrize("stiffness", [1e5, 1e8, 1e11, math.inf])
@pytest.mark.parametrize("mirrored", [False, True])
def test_load_next_to_where_a_piece_becomes_slack_finds_its_place(stiffness: float, mirrored: bool) -> None:
    """Where the tension of the long piece is as small as one likes, the energy is all but a cone about it."""
    for length in np.linspace(20.5, 29.5, 10):
        slack_from = length - (length**2 - 400.0) / (2.0 * length)
        for before in np.logspace(-12, 0, 13):
            xi = slack_from - before
            xi = length - xi if mirrored else xi
            state = rope.resting(span=20.0, length=length, axial_stiffness=stiffness, loads=[(xi, WEIGHT)])
            tension = np.hypot(*state.force.T)
            segments = np.diff(state.breaks) * (1.0 + tension / stiffness)
            taut = tension > 0.0  # stiff ropes, as long as they are strained, may leave the long piece slack
            apart = np.array([20.0, 0.0]) - (segments[taut] / tension[taut]) @ state.force[taut]
            slack = float(segments[~taut].sum())
            assert np.hypot(*apart) <= slack + 1e-14 * length  # roundings of 50 m
            assert state.start_reaction + state.end_reaction == pytest.approx([0.0, 700.0], abs=1e-12)


@pytest.mark.parametrize("law", ["hooke", "second_piola_kirchhoff"])
def test_load_on_a_support_leaves_a_prestressed_rope_straight(law: rope.AxialLaw) -> None:
    case = {"span": 20.0, "length": 16.0, "axial_stiffness": 1e4, "law": law}
    prestress = 1e4 * 0.25 * (1.0 if law == "hooke" else 1.25)
    for xi, loaded, free in (
        (0.0, "start_reaction", "end_reaction"),
        (16.0, "end_reaction", "start_reaction"),
    ):
        state = rope.weightless_elastic(**case, loads=[(xi, WEIGHT)])
        side = 1.0 if free == "end_reaction" else -1.0
        assert getattr(state, free) == pytest.approx([side * prestress, 0.0], abs=1e-10)  # roundings
        assert getattr(state, loaded) == pytest.approx([-side * prestress, 700.0], abs=1e-10)
        assert state.position(8.0) == pytest.approx([10.0, 0.0], abs=1e-13)
        assert state.sag == pytest.approx(0.0, abs=1e-13)


def test_no_load_on_a_prestressed_rope_leaves_the_prestress() -> None:
    state = rope.weightless_elastic(span=20.0, length=16.0, axial_stiffness=1e4, loads=[(4.0, (0.0, 0.0))])
    assert state.load_tensions[0] == pytest.approx([2500.0, 2500.0], rel=1e-14)


def test_light_rope_with_weight_tends_to_the_weightless_one() -> None:
    light = rope.elastic_catenary(**PAPER, weight=1e-9, height=2.0, loads=[(15.0, WEIGHT)])
    none = rope.weightless_elastic(**PAPER, height=2.0, loads=[(15.0, WEIGHT)])
    xi = np.linspace(0.0, 20.0, 9)
    assert light.position(xi) == pytest.approx(none.position(xi), abs=1e-10)  # weight by load 3e-11
    assert light.tension(xi) == pytest.approx(none.tension(xi), rel=1e-10)


@pytest.mark.parametrize("stiffness", 10.0 ** np.arange(2, 11))
@pytest.mark.parametrize("law", ["hooke", "second_piola_kirchhoff"])
def test_energy_has_its_minimum_at_the_solution(stiffness: float, law: rope.AxialLaw) -> None:
    """The stored energy less the load's work, k(lam-1)^2/2 or k(2 lam^3 - 3 lam^2 + 1)/6, by trial."""
    state = rope.weightless_elastic(span=20.0, length=20.0, axial_stiffness=stiffness, loads=[(15.0, WEIGHT)], law=law)

    def tension(lam: float) -> float:
        return stiffness * (lam - 1.0) * (1.0 if law == "hooke" else lam)

    place = state.load_positions[0]
    legs = np.array([place, place - [20.0, 0.0]])
    reach = np.hypot(*legs.T)
    slope = sum(tension(r / unstrained) * leg / r for leg, r, unstrained in zip(legs, reach, (15.0, 5.0), strict=True))
    # roundings of the position, 1e-15 of 20 m, through the stiffness of the rope
    assert slope == pytest.approx(WEIGHT, abs=1e-9 + 5e-15 * stiffness)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"span": -1.0}, "^span must"),
        ({"length": 0.0}, "^length must"),
        ({"axial_stiffness": math.nan}, "^axial_stiffness must"),
        ({"height": math.nan}, "^height must"),
        ({"loads": [(21.0, WEIGHT)]}, "loads must stand"),
        ({"loads": [(5.0, (math.inf, 0.0))]}, "forces"),
        ({"loads": [(5.0, (0.0, 0.0))]}, "no definite shape"),
        ({"law": "linear"}, "^law must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        rope.weightless_elastic(**({"loads": [(5.0, WEIGHT)]} | PAPER | changed))


def test_a_load_on_the_support_leaves_the_barely_taut_rope_alone() -> None:
    """214 N beside a tension of 1 mN: the support takes the load, the rope keeps what its length gives it."""
    shape = {
        "span": 20.0,
        "height": 0.34375,
        "length": float(np.hypot(20.0, 0.34375)) * 0.99999,
        "axial_stiffness": 100.0,
    }
    loaded = rope.resting(**shape, loads=[(0.0, (0.0, -214.0))])
    tension = 100.0 * (1.0 / 0.99999 - 1.0)
    assert float(loaded.tension(10.0)) == pytest.approx(tension, rel=1e-9)  # 1e-16 of 214 N, and of the stretch
    assert loaded.start_reaction[1] == pytest.approx(214.0, rel=1e-5)
