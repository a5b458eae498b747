"""String and beam on an elastic, viscous bed under a moving load: closed forms, quadrature, radiation condition."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ropewalk.theory import foundation

STRING = {"bending_stiffness": 0.0, "foundation": 1.0, "mass": 1.0, "tension": 1.0}
ROUNDED = STRING | {"tension": 0.3, "mass": 0.7}  # its wave speed is no round number
RAIL = {"bending_stiffness": 6.4155e6, "mass": 60.21, "foundation": 1e7}
CRITICAL = foundation.critical_speed(**RAIL)
UNIT = {"bending_stiffness": 1.0, "foundation": 1.0, "mass": 1.0}

ratios = st.floats(0.0, 3.0)
pulls = st.floats(-1.8, 20.0)
losses = st.floats(0.05, 5.0)


@pytest.mark.parametrize(
    ("speed", "damping", "x", "deflection"),
    [
        (0.5, 0.2, -1.0, 0.193800342758584),
        (0.5, 0.2, 0.0, 0.576390417704235),
        (0.5, 0.2, 0.7, 0.244809942891419),
        (0.9, 0.5, 0.0, 1.01929438287525),
        (1.5, 0.4, -1.0, 0.554276425113688),
        (1.5, 0.4, 1.0, 0.0),
    ],
)
def test_string_with_damping(speed: float, damping: float, x: float, deflection: float) -> None:
    w = foundation.steady_state(x, force=1.0, speed=speed, damping=damping, **STRING)
    assert w == pytest.approx(deflection, abs=6e-15)  # digits given


def test_string_without_damping_on_both_sides_of_its_wave_speed() -> None:
    x = np.array([-3.0, -0.4, 0.0, 0.4])
    slow = np.exp(-np.abs(x) / math.sqrt(0.75)) / (2.0 * math.sqrt(0.75))
    assert foundation.steady_state(x, force=1.0, speed=0.5, **STRING) == pytest.approx(slow, abs=1e-15)
    root = math.sqrt(1.25)
    fast = np.where(x < 0.0, np.sin(np.abs(x) / root) / root, 0.0)
    assert foundation.steady_state(x, force=1.0, speed=1.5, **STRING) == pytest.approx(fast, abs=1e-15)


def test_damped_string_at_exactly_its_wave_speed_takes_the_limit() -> None:
    x = np.array([-1.0, -0.1, 0.0, 0.3])
    at = foundation.steady_state(x, force=1.0, speed=1.0, damping=0.3, **STRING)
    assert at == pytest.approx(np.where(x <= 0.0, np.exp(x / 0.3) / 0.3, 0.0), abs=1e-14)
    below = foundation.steady_state(x, force=1.0, speed=1.0 - 1e-8, damping=0.3, **STRING)
    assert at == pytest.approx(below, abs=1e-5)  # 1e-8 by the drop of 0.3^3


def test_rail_critical_speed() -> None:
    assert pytest.approx(515.808282609, abs=5e-10) == CRITICAL
    assert foundation.critical_speed(tension=5e5, **RAIL) == pytest.approx(523.796193956, abs=5e-10)
    assert foundation.critical_speed(**STRING) == 1.0
    assert foundation.critical_speed(bending_stiffness=1.0, foundation=0.0, mass=1.0) == 0.0


@pytest.mark.parametrize(
    ("ratio", "deflection"),
    [(0.0, 0.003950457365974828), (0.5, 0.004561595247335413), (0.9, 0.009062970757394819)],
)
def test_rail_without_damping(ratio: float, deflection: float) -> None:
    w = foundation.steady_state(0.0, force=1e5, speed=ratio * CRITICAL, **RAIL)
    assert w == pytest.approx(deflection, rel=3e-15)  # digits given


@pytest.mark.parametrize(
    ("speed", "deflections"),
    [
        (100.0, [0.00293954083002522, 0.00384051376213498, 0.00196277915149926]),
        (600.0, [0.0023386429623503, 0.00126648821481855, -0.000672091852796937]),
    ],
)
def test_rail_with_damping(speed: float, deflections: list[float]) -> None:
    w = foundation.steady_state([-1.0, 0.0, 1.0], force=1e5, speed=speed, damping=4.9e4, **RAIL)
    assert w == pytest.approx(deflections, abs=6e-18)  # digits given


@settings(deadline=None, max_examples=25)
@given(ratios, pulls, st.floats(0.3, 5.0), st.floats(-3.0, 3.0))
def test_roots_agree_with_the_fourier_integral(ratio: float, pull: float, damping: float, x: float) -> None:
    """Quadrature over the wavenumber up to 60."""
    speed = ratio * foundation.critical_speed(tension=pull, **UNIT)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    edges = np.linspace(-60.0, 60.0, 2401)
    q = (edges[:-1, np.newaxis] + 0.025 * (1 + nodes)).ravel()
    weights = np.tile(0.025 * weights, 2400)
    moving = -q * speed
    below = q**4 + pull * q**2 + 1.0 + 1j * damping * moving - moving**2
    integral = np.sum(weights * np.exp(1j * q * x) / below) / (2.0 * np.pi)
    w = foundation.steady_state(x, force=1.0, speed=speed, tension=pull, damping=damping, **UNIT)
    assert w == pytest.approx(integral, abs=1e-6)  # tail 1/(3 pi 60^3) = 5e-7, and its corrections


@settings(deadline=None, max_examples=60)
@given(st.floats(0.0, 0.999), pulls, st.floats(-6.0, 6.0))
def test_undamped_slow_load_is_the_closed_form(ratio: float, pull: float, x: float) -> None:
    speed = ratio * foundation.critical_speed(tension=pull, **UNIT)
    a = math.sqrt(0.5 + (pull - speed**2) / 4.0)
    b = np.sqrt(0.5 - (pull - speed**2) / 4.0 + 0j)
    assume(abs(b) > 1e-3)
    wave = np.cos(b * x) + a * np.sin(b * abs(x)) / b
    expected = (np.exp(-a * abs(x)) * wave).real / (4.0 * a)  # a^2 + b^2 = 1
    w = foundation.steady_state(x, force=1.0, speed=speed, tension=pull, **UNIT)
    # rounding, magnified near the critical speed and where b multiplies out
    assert w == pytest.approx(expected, abs=1e-14 / min(a**3, abs(b) ** 2))


def test_pair_of_roots_may_meet() -> None:
    x = np.array([0.0, 0.5, 3.0])  # tension 2 sqrt(k EI): b = 0, a = 1
    w = foundation.steady_state(x, force=1.0, speed=0.0, tension=2.0, **UNIT)
    assert w == pytest.approx(np.exp(-x) * (1.0 + x) / 4.0, abs=1e-15)


@settings(deadline=None, max_examples=60)
@given(ratios, pulls, st.floats(-5.0, 5.0))
def test_without_damping_means_the_limit_of_little_damping(ratio: float, pull: float, x: float) -> None:
    """The radiation condition."""
    speed = ratio * foundation.critical_speed(tension=pull, **UNIT)
    line = UNIT | {"force": 1.0, "speed": speed, "tension": pull}
    try:
        bare = foundation.steady_state(x, **line)
    except ValueError:
        return  # at a critical state
    little, less = (foundation.steady_state(x, damping=c, **line) for c in (2e-7, 1e-7))
    assume(abs(little - less) < 2e-6 * (1.0 + abs(less)))  # far enough from a critical state to be linear in c
    assert bare == pytest.approx(2.0 * less - little, abs=1e-2 * abs(little - less) + 1e-9 * (1.0 + abs(less)))


def test_undamped_fast_load_sends_a_wave_to_each_side() -> None:
    speed = 1.2 * math.sqrt(2.0)
    behind, ahead = np.sqrt(0.5 * (speed**2 + np.array([-1.0, 1.0]) * math.sqrt(speed**4 - 4.0)))
    x = np.array([-2.0, 1.3])
    waves = np.array([np.sin(behind * 2.0) / behind, -np.sin(ahead * 1.3) / ahead]) / (ahead**2 - behind**2)
    assert foundation.steady_state(x, force=1.0, speed=speed, **UNIT) == pytest.approx(waves, abs=1e-14)


@settings(deadline=None, max_examples=30)
@given(ratios, losses, st.integers(1, 3))
def test_derivatives_are_those_of_the_deflection(ratio: float, damping: float, derivative: int) -> None:
    line = UNIT | {"force": 1.0, "speed": ratio * math.sqrt(2.0), "damping": damping}
    for low, high in ((-2.0, -1.5), (1.0, 1.5)):
        lower = np.polynomial.Chebyshev.interpolate(
            lambda x: foundation.steady_state(x, derivative=derivative - 1, **line), 30, domain=[low, high]
        )
        x = np.linspace(low + 0.1, high - 0.1, 5)
        w = foundation.steady_state(x, derivative=derivative, **line)
        assert w == pytest.approx(lower.deriv()(x), abs=1e-10)  # derivative of an interpolant


def test_balance_at_the_load() -> None:
    x = np.array([-1e-9, 1e-9])
    line = RAIL | {"force": 1e5, "speed": 130.0, "damping": 4.9e4}
    shear = 6.4155e6 * foundation.steady_state(x, derivative=3, **line)
    assert shear[1] - shear[0] == pytest.approx(1e5, rel=1e-7)  # x is not quite at the load
    for derivative in (0, 1, 2):
        before, after = foundation.steady_state(x, derivative=derivative, **line)
        assert before == pytest.approx(after, rel=1e-6)


def test_several_loads_are_the_sum() -> None:
    x, line = np.linspace(-5.0, 5.0, 11), RAIL | {"speed": 60.0, "damping": 4.9e4}
    several = foundation.several_loads(x, forces=[1e5, 5e4], places=[0.0, -2.5], **line)
    one, other = (foundation.steady_state(x - p, force=f, **line) for f, p in ((1e5, 0.0), (5e4, -2.5)))
    assert several == pytest.approx(one + other, rel=1e-14)


@pytest.mark.parametrize(
    ("line", "speed"), [(STRING, 1.0), (ROUNDED, math.sqrt(0.3 / 0.7)), (UNIT, math.sqrt(2.0)), (RAIL, CRITICAL)]
)
def test_undamped_load_at_the_critical_speed_is_refused(line: dict[str, float], speed: float) -> None:
    with pytest.raises(ValueError, match="exactly the critical speed"):
        foundation.steady_state(1.0, force=1.0, speed=speed, **line)
    assert math.isfinite(foundation.steady_state(1.0, force=1.0, speed=speed, damping=1e-6, **line))


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"foundation": 0.0}, "^foundation must"),
        ({"mass": 0.0}, "^mass must"),
        ({"bending_stiffness": -1.0}, "^bending_stiffness must"),
        ({"damping": -1.0}, "^damping must"),
        ({"speed": -1.0}, "^speed must"),
        ({"speed": math.nan}, "^speed must"),
        ({"x": math.nan}, "^x must"),
        ({"force": math.inf}, "^force must"),
        ({"tension": -2.0}, "buckles: tension must be above -2 N"),
        ({"bending_stiffness": 0.0}, "^tension must be positive"),
        ({"derivative": 4}, "^derivative must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    arguments = {"x": 0.0, "force": 1.0, "speed": 0.1} | UNIT | changed
    with pytest.raises(ValueError, match=said):
        foundation.steady_state(**arguments)


def test_lists_of_two_lengths_are_refused() -> None:
    with pytest.raises(ValueError, match="one length"):
        foundation.several_loads(0.0, forces=[1.0], places=[0.0, 1.0], speed=0.0, **UNIT)
