"""Capstan (Euler, Eytelwein) and point block: the coefficient that a load needs."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ropewalk.theory import friction

MODELS = (friction.capstan_coefficient, friction.point_block_coefficient)
tensions = st.floats(1e-3, 1e6)
angles = st.floats(1e-3, 3.0)


@given(tensions, tensions, angles)
def test_formulas(behind: float, ahead: float, angle: float) -> None:
    sides = {"tension_behind": behind, "tension_ahead": ahead, "angle": angle}
    capstan, block = friction.capstan_coefficient(**sides), friction.point_block_coefficient(**sides)
    assert capstan == pytest.approx(abs(math.log(ahead / behind)) / angle, rel=1e-9, abs=1e-15 / angle)
    assert block == pytest.approx(math.tanh(0.5 * capstan * angle) / math.tan(0.5 * angle), rel=1e-12)


@given(tensions, tensions, st.floats(0.01, 3.1), st.floats(-3.0, 3.0))
def test_block_needs_the_tangential_by_the_normal_force(
    behind: float, ahead: float, angle: float, direction: float
) -> None:
    """From the forces: along the bisector of the tangents, and across."""
    t_0 = np.array([math.cos(direction - angle / 2), math.sin(direction - angle / 2)])
    t_1 = np.array([math.cos(direction + angle / 2), math.sin(direction + angle / 2)])
    pull = ahead * t_1 - behind * t_0
    along = (t_0 + t_1) / np.hypot(*(t_0 + t_1))
    across = np.array([-along[1], along[0]])
    expected = abs(pull @ along) / abs(pull @ across)
    found = friction.point_block_coefficient(
        tension_behind=behind, tension_ahead=ahead, angle=friction.turning_angle(behind * t_0, ahead * t_1)
    )
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-12 / angle)


def test_turning_angle_counts_either_way_round_and_up_to_the_half_turn() -> None:
    behind = np.array([[2.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 0.0]])
    ahead = np.array([[0.0, 3.0], [0.0, -1.0], [2.0, 2.0], [-5.0, 0.0]])
    assert friction.turning_angle(behind, ahead) == pytest.approx([math.pi / 2, math.pi / 2, 0.0, math.pi])
    for bad in ([0.0, 0.0], [math.nan, 1.0]):
        with pytest.raises(ValueError, match="tangent_ahead"):
            friction.turning_angle([1.0, 0.0], bad)


def test_limits() -> None:
    slack = {"tension_behind": 0.0, "tension_ahead": 5.0}
    assert friction.capstan_coefficient(**slack, angle=1.0) == math.inf
    assert friction.point_block_coefficient(**slack, angle=1.0) == pytest.approx(1.0 / math.tan(0.5))
    even, parted = {"tension_behind": 5.0, "tension_ahead": 5.0}, {"tension_behind": 5.0, "tension_ahead": 6.0}
    for needed in MODELS:
        assert needed(**even, angle=0.0) == 0.0
        assert needed(tension_behind=0.0, tension_ahead=0.0, angle=0.0) == 0.0
        assert needed(**parted, angle=0.0) == math.inf


def test_arrays_broadcast() -> None:
    for needed in MODELS:
        grid = {"tension_behind": np.ones((3, 1)), "tension_ahead": np.full(4, 2.0), "angle": 0.5}
        assert needed(**grid).shape == (3, 4)


@pytest.mark.parametrize("needed", MODELS)
def test_nonsense_is_refused(needed) -> None:
    sides = {"tension_behind": 1.0, "tension_ahead": 1.0, "angle": 1.0}
    for name, value in (("tension_behind", -1.0), ("tension_ahead", math.nan), ("angle", -0.1), ("angle", math.inf)):
        with pytest.raises(ValueError, match=f"^{name} must"):
            needed(**(sides | {name: value}))


def test_block_turns_by_half_a_turn_at_most() -> None:
    with pytest.raises(ValueError, match=r"^angle must"):
        friction.point_block_coefficient(tension_behind=1.0, tension_ahead=2.0, angle=3.2)
    assert friction.capstan_coefficient(tension_behind=1.0, tension_ahead=math.e, angle=10.0) == pytest.approx(0.1)


def test_directions_that_are_no_vectors_are_refused():
    with pytest.raises(ValueError, match="tangent_ahead must have 2 numbers along its last axis"):
        friction.turning_angle([1.0, 2.0], 1.0)
