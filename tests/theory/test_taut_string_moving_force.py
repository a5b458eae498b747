"""Constant force on a taut string: Fryba's problem, with the data of "Walking the Line", Fig. 5.

Reference numbers, in units of F L / P and L / c, are derived in docs/notes.
"""

import math
import time

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ropewalk.theory import string

UNIT = {"force": 1.0, "length": 1.0, "tension": 1.0, "mass": 1.0}
STRING = {"force": 3.0, "length": 1.7, "tension": 8.0, "mass": 2.0}  # wave speed 2

speed_ratios = st.floats(0.02, 5.0)
fractions = st.floats(0.0, 1.0)


def other_than_wave_speed(alpha: float) -> bool:
    return abs(alpha - 1.0) > 1e-3


@pytest.mark.parametrize(
    ("alpha", "path", "x", "deflection"),
    [
        (0.5, 0.75, 0.6, 1 / 3),
        (0.9, 0.75, 0.6, 0.315789473684211),
        (0.9999, 0.75, 0.6, 0.300015000750038),
        (1.3, 0.75, 0.6, 0.217391304347826),
        (2.0, 0.75, 0.6, 0.05),
        (0.5, 1.6, 0.3, 0.133333333333333),
        (1.0, 0.8, 0.5, 0.25),
    ],
)
def test_deflection_is_that_of_the_catalogue(alpha: float, path: float, x: float, deflection: float) -> None:
    computed = string.moving_force(x, path / alpha, speed=alpha, **UNIT)
    assert computed == pytest.approx(deflection, abs=6e-16)  # 15 digits are given


FIG_5 = [  # place of the load, exact, 49 modes, 149 modes
    (0.5, 0.250012500625, 0.124306, 0.125606),
    (0.9, 0.450022501125, 0.220613, 0.226243),
    (0.99, 0.495024751238, 0.291842, 0.267187),
    (0.999, 0.499524976249, 0.048757, 0.142382),
    (0.9999, 0.499974998750, None, None),
    (0.99995, 0.499974998749, None, None),
    (0.99999, 0.099994999750, None, None),
]


@pytest.mark.parametrize(("place", "exact", "modes_49", "modes_149"), FIG_5)
def test_path_of_the_load_in_fig_5_and_its_truncated_series(
    place: float, exact: float, modes_49: float | None, modes_149: float | None
) -> None:
    t = place / 0.9999
    # 12 digits are given; the end of the path is as steep as 5000, which multiplies the rounding of t
    assert string.moving_force_path(t, speed=0.9999, **UNIT) == pytest.approx(exact, abs=1.1e-12)
    for modes, value in ((49, modes_49), (149, modes_149)):
        if value is not None:
            series = string.moving_force(place, t, speed=0.9999, modes=modes, **UNIT)
            assert series == pytest.approx(value, abs=5.1e-7)  # 6 digits are given


def test_last_point_of_fig_5_to_the_four_digits_given() -> None:
    for modes, value in ((49, 0.0049), (149, 0.0149)):
        series = string.moving_force(0.9999, 0.9999 / 0.9999, speed=0.9999, modes=modes, **UNIT)
        assert series == pytest.approx(value, abs=5e-5)


@settings(deadline=None)
@given(speed_ratios, fractions, fractions)
def test_closed_form_by_greens_function(alpha: float, progress: float, x: float) -> None:
    """w = [g(x; V t) - alpha G(x, c t)]/(1 - alpha^2), the form that cancels near alpha = 1."""
    assume(other_than_wave_speed(alpha))

    def green(s: float) -> float:
        s = math.fmod(s, 2.0)
        low, high, sign = (min(x, s), max(x, s), 1.0) if s <= 1.0 else (min(x, 2 - s), max(x, 2 - s), -1.0)
        return sign * low * (1.0 - high)

    t = 2.0 * progress / alpha
    if alpha * t <= 1.0:
        expected = (green(alpha * t) - alpha * green(t)) / (1.0 - alpha**2)
    else:
        expected = -alpha / (1.0 - alpha**2) * (green(t) - green(t - 1.0 / alpha + 1.0))
    # rounding of phases up to 100 L, magnified by 1/(1 - alpha) in the expected value
    tolerance = 1e-14 * (1.0 + t) / abs(1.0 - alpha)
    assert string.moving_force(x, t, speed=alpha, **UNIT) == pytest.approx(expected, abs=tolerance)


def time_in_diamond(alpha: float, x: float, t: float, half: float) -> float:
    """Time that the load spends where |V t' - x| + |t' - t| < half."""
    low, high = 0.0, 1.0 / alpha
    for side in (-1.0, 1.0):
        for when in (-1.0, 1.0):  # side (alpha t' - x) + when (t' - t) < half
            factor, bound = side * alpha + when, half + side * x + when * t
            if factor > 0.0:
                high = min(high, bound / factor)
            elif factor < 0.0:
                low = max(low, bound / factor)
    return max(high - low, 0.0)


@settings(deadline=None)
@given(speed_ratios, fractions, fractions, fractions)
def test_wave_equation_holds_on_every_characteristic_diamond(
    alpha: float, x: float, progress: float, size: float
) -> None:
    """d'Alembert: w at the tips in time less w at the tips in space is F/(2 rho c) times the load's stay."""
    assume(other_than_wave_speed(alpha))
    t = 2.5 * progress / alpha
    half = size * min(x, 1.0 - x, t)

    def w(x_tip: float, t_tip: float) -> float:
        return float(string.moving_force(min(max(x_tip, 0.0), 1.0), t_tip, speed=alpha, **UNIT))

    balance = w(x, t + half) + w(x, max(t - half, 0.0)) - w(x + half, t) - w(x - half, t)
    # rounding of phases, magnified by the slope ~ 1/|1 - alpha| between load and wave front
    tolerance = 2e-14 * (1.0 + t) / abs(1.0 - alpha)
    assert balance == pytest.approx(0.5 * time_in_diamond(alpha, x, t, half), abs=tolerance)


@pytest.mark.parametrize("alpha", [0.03, 0.5, 0.98, 1.0, 1.02, 3.0])
def test_series_converges_to_the_closed_form(alpha: float) -> None:
    x, t = np.linspace(0.0, 1.0, 41), np.linspace(0.0, 2.5 / alpha, 31)[:, np.newaxis]
    exact = string.moving_force(x, t, speed=alpha, **UNIT)
    error = [
        np.sqrt(np.mean((string.moving_force(x, t, speed=alpha, modes=modes, **UNIT) - exact) ** 2))
        for modes in (50, 800)
    ]
    # coefficients fall as 1/n^2 (kinks) or, at alpha = 1 where the deflection jumps, as 1/n
    assert error[1] < error[0] * (1 / 3 if alpha == 1.0 else 1 / 15)
    assert error[1] < (0.02 if alpha == 1.0 else 1e-3)


def test_single_mode_is_frybas_formula() -> None:
    alpha, t, x = 0.6, 1.1, 0.37
    q = 2 / np.pi**2 * (np.sin(np.pi * alpha * t) - alpha * np.sin(np.pi * t)) / (1 - alpha**2)
    one = string.moving_force(x, t, speed=alpha, modes=1, **UNIT)
    assert one == pytest.approx(q * np.sin(np.pi * x), rel=1e-14)  # a few roundings


def test_mode_at_the_wave_speed_is_the_resonant_limit() -> None:
    theta = np.pi * 0.7
    q = (np.sin(theta) - theta * np.cos(theta)) / np.pi**2
    one = string.moving_force(0.5, 0.7, speed=1.0, modes=1, **UNIT)
    assert one == pytest.approx(q, rel=1e-14)  # a few roundings
    near = string.moving_force(0.5, 0.7, speed=1.0 - 1e-9, modes=1, **UNIT)
    assert near == pytest.approx(q, rel=1e-8)  # differs by O(1 - alpha), without cancellation


def test_path_before_and_after_the_first_reflected_wave() -> None:
    alpha, meeting = 0.5, 2 / 1.5
    path = string.moving_force_path(np.array([0.5 * meeting, 1.2 * meeting, 5.0]), speed=alpha, **UNIT)
    expected = [alpha * 0.5 * meeting / 1.5, 2 * alpha * (1 - alpha * 1.2 * meeting) / 0.75, 0.0]
    assert path == pytest.approx(expected, abs=1e-15)  # roundings


@settings(deadline=None)
@given(speed_ratios, fractions, st.floats(1.0, 4.0))
def test_free_motion_mirrors_itself_after_half_a_period(alpha: float, x: float, progress: float) -> None:
    assume(other_than_wave_speed(alpha))
    t = progress / alpha + 1e-9
    now = string.moving_force(x, t, speed=alpha, **UNIT)
    later = string.moving_force(1.0 - x, t + 1.0, speed=alpha, **UNIT)
    # rounding of phases up to 200, magnified by the slope
    assert later == pytest.approx(-now, abs=1e-14 * (1.0 + t) / abs(1.0 - alpha))


@settings(deadline=None)
@given(
    st.floats(-1e3, 1e3),
    st.floats(0.1, 1e3),
    st.floats(0.1, 1e3),
    st.floats(0.1, 1e3),
    speed_ratios,
    fractions,
)
def test_result_scales_with_the_units_and_is_linear_in_the_force(
    force: float, length: float, tension: float, mass: float, alpha: float, x: float
) -> None:
    assume(other_than_wave_speed(alpha))
    c, t = math.sqrt(tension / mass), 0.7 / alpha
    physical = string.moving_force(
        x * length, t * length / c, force=force, speed=alpha * c, length=length, tension=tension, mass=mass
    )
    unit = force * length / tension
    # roundings of the scaled arguments, magnified by the slope
    tolerance = 1e-14 * abs(unit) * (1.0 + t) / abs(1.0 - alpha) + 1e-300
    assert physical == pytest.approx(unit * string.moving_force(x, t, speed=alpha, **UNIT), abs=tolerance)


def test_near_the_wave_speed_no_digits_are_lost() -> None:
    x, t = 0.3, 0.6
    for gap in (1e-4, 1e-8, 1e-12, 0.0, -1e-12, -1e-8, -1e-4):
        alpha = 1.0 - gap
        computed = string.moving_force(x, t, speed=alpha, **UNIT)
        assert computed == pytest.approx(x / (1.0 + alpha), rel=3e-16)  # one rounding


def test_at_the_wave_speed_the_deflection_jumps_at_the_load() -> None:
    behind, at, ahead = string.moving_force(np.array([0.5 - 1e-9, 0.5, 0.5 + 1e-9]), 0.5, speed=1.0, **UNIT)
    assert behind == pytest.approx(0.25, abs=1e-9)  # the point is 1e-9 away
    assert at == pytest.approx(0.125, rel=1e-15)
    assert ahead == 0.0
    assert string.moving_force_path(0.5, speed=1.0, **UNIT) == pytest.approx(0.125, rel=1e-15)


def test_faster_than_waves_the_load_meets_the_string_at_rest() -> None:
    t = np.linspace(0.0, 0.5, 11)
    assert np.max(np.abs(string.moving_force_path(t, speed=2.0, **UNIT))) <= 1e-16  # rounding of place
    assert string.moving_force(0.9, 0.4, speed=2.0, **UNIT) == 0.0


@pytest.mark.parametrize("modes", [None, 1, 30])
def test_force_resting_on_the_support_does_nothing(modes: int | None) -> None:
    x, t = np.linspace(0.0, 1.7, 7), np.array([[-1.0], [0.0], [1.0], [1e6]])
    still = string.moving_force(x, t, speed=0.0, modes=modes, **STRING)
    assert still.shape == (4, 7)
    assert np.all(still == 0.0)


def test_string_is_at_rest_before_the_entry_and_held_at_its_ends() -> None:
    x = np.linspace(0.0, 1.7, 9)
    assert np.all(string.moving_force(x, -0.3, speed=1.0, **STRING) == 0.0)
    ends = string.moving_force(np.array([0.0, 1.7]), np.linspace(0, 9, 50)[:, np.newaxis], speed=1.0, **STRING)
    assert np.max(np.abs(ends)) < 1e-15  # rounding of the phases


@pytest.mark.parametrize("speed", [1e-12, 1e-3, 2.0 * (1 - 2**-52), 2.0, 2.0 * (1 + 2**-52), 1e3, 1e12])
def test_extreme_speeds_stay_finite_and_bounded(speed: float) -> None:
    x, t = np.linspace(0.0, 1.7, 23), np.array([[0.0], [1e-12], [0.1], [1.0], [10.0], [1e3]])
    w = string.moving_force(x, t, speed=speed, **STRING)
    assert np.all(np.abs(w) <= 3.0 * 1.7 / 8.0)  # |min(x, y) - y phi| <= L


def test_slow_force_gives_the_static_deflection() -> None:
    x, place = 0.4, 1.1
    slow = string.moving_force(x, place / 1e-6, speed=1e-6, **STRING)
    static = 3.0 / 8.0 * x * (1.7 - place) / 1.7
    assert slow == pytest.approx(static, abs=1e-6)  # speed by wave speed is 5e-7


def test_million_points_take_well_under_a_second() -> None:
    x, t = np.linspace(0.0, 1.7, 1000), np.linspace(0.0, 3.0, 1000)[:, np.newaxis]
    spent = []
    for _ in range(3):
        start = time.process_time()
        string.moving_force(x, t, speed=1.9, **STRING)
        spent.append(time.process_time() - start)
    assert min(spent) < 0.5  # 0.05 s when written


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"length": 0.0}, "^length must"),
        ({"tension": -1.0}, "^tension must"),
        ({"mass": math.nan}, "^mass must"),
        ({"speed": -1.0}, "^speed must"),
        ({"speed": math.inf}, "^speed must"),
        ({"modes": 0}, "^modes must"),
        ({"x": 1.8}, "x must lie"),
        ({"x": math.nan}, "x must lie"),
        ({"t": math.nan}, "t must be finite"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    arguments = {"x": 0.5, "t": 0.5, "speed": 1.0, "modes": None} | STRING | changed
    x, t = arguments.pop("x"), arguments.pop("t")
    with pytest.raises(ValueError, match=said):
        string.moving_force(x, t, **arguments)


def test_wave_speed() -> None:
    assert string.wave_speed(tension=8.0, mass=2.0) == 2.0
