"""Kirchhoff and Carrier's taut line at large amplitude, Q. Appl. Math. 3 (1945), and the skipping rope."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from closed_forms import whirls
from ropewalk.theory import whirl

LINE = {"length": 1.0, "tension": 1.0, "mass": 1.0, "axial_stiffness": 100.0}


@pytest.mark.parametrize(
    ("amplitude", "planar", "circular"),
    [(0.05, 1.20686467611556, 1.27155427531352), (0.2, 2.85025696892026, 3.29690830947562)],
)
def test_frequencies_are_those_of_the_catalogue(amplitude: float, planar: float, circular: float) -> None:
    # 15 digits are given
    assert whirls.planar_frequency(amplitude, **LINE) / np.pi == pytest.approx(planar, abs=6e-15)
    assert whirl.whirl_frequency(amplitude, **LINE) / np.pi == pytest.approx(circular, abs=6e-15)


@settings(deadline=None, max_examples=15)
@given(st.floats(0.01, 0.5), st.floats(0.2, 5.0), st.integers(1, 3))
def test_planar_motion_solves_carriers_equation(amplitude: float, scale: float, half_waves: int) -> None:
    line = {"length": 2.0 * scale, "tension": 3.0, "mass": 0.7, "axial_stiffness": 200.0, "half_waves": half_waves}
    k = half_waves * np.pi / (2.0 * scale)
    square, cubic = 3.0 / 0.7 * k**2, 200.0 / (4 * 0.7) * k**4
    period = 2 * np.pi / whirls.planar_frequency(amplitude, **line)
    t = np.linspace(0.0, period, 7)
    ode = solve_ivp(
        lambda _, s: [s[1], -square * s[0] - cubic * s[0] ** 3],
        (0.0, period),
        [amplitude, 0.0],
        t_eval=t,
        rtol=1e-10,
        atol=1e-12 * amplitude,
        method="DOP853",
    )
    motion = whirls.planar_motion(t, amplitude=amplitude, **line)
    assert motion == pytest.approx(ode.y[0], abs=1e-8 * amplitude)  # tolerance of the integration
    assert motion[-1] == pytest.approx(amplitude, rel=1e-12)


def test_small_swings_and_slack_stiffness_are_linear() -> None:
    for frequency in (whirls.planar_frequency, whirl.whirl_frequency):
        assert frequency(0.0, **LINE) == pytest.approx(np.pi, rel=1e-15)
        assert frequency(0.3, **(LINE | {"axial_stiffness": 0.0})) == pytest.approx(np.pi, rel=1e-15)
        assert frequency(0.0, half_waves=3, **LINE) == pytest.approx(3 * np.pi, rel=1e-15)
        assert np.all(np.diff(frequency(np.linspace(0.0, 1.0, 5), **LINE)) > 0.0)
    # Lindstedt: omega_0 (1 + 3/8 gamma a^2/omega_0^2)
    small = 1e-3
    gain = 0.375 * 25.0 * np.pi**2 * small**2
    assert whirls.planar_frequency(small, **LINE) / np.pi - 1.0 == pytest.approx(gain, rel=1e-3)  # next term
    assert np.all(whirls.planar_motion([0.0, 1.0], amplitude=0.0, **LINE) == 0.0)


def test_skipping_rope_is_that_of_the_catalogue() -> None:
    rope = whirls.skipping_rope(span=1.0, length=1.2, mass=1.0, angular_speed=2 * np.pi)
    assert rope.radius == pytest.approx(0.301974384951906, abs=6e-16)  # 15 digits are given, for all three
    assert rope.horizontal_tension == pytest.approx(4.39523597823103, abs=6e-15)
    assert rope.largest_tension == pytest.approx(6.19522539582363, abs=6e-15)
    assert rope.shape(0.5) == pytest.approx(rope.radius, rel=1e-14)


@settings(deadline=None, max_examples=15)
@given(st.floats(1.001, 4.0), st.floats(0.5, 20.0), st.integers(1, 3))
def test_skipping_rope_is_in_equilibrium_and_as_long_as_it_should_be(
    ratio: float, angular_speed: float, half_waves: int
) -> None:
    given_ = {"span": 1.5, "length": 1.5 * ratio, "mass": 0.4, "angular_speed": angular_speed}
    rope = whirls.skipping_rope(half_waves=half_waves, **given_)
    slope = np.sqrt((rope.largest_tension / rope.horizontal_tension) ** 2 - 1.0)

    def along(s: float, state: list[float]) -> list[float]:  # x, y, vertical force over the arc
        tension = np.hypot(rope.horizontal_tension, state[2])
        return [rope.horizontal_tension / tension, state[2] / tension, -0.4 * angular_speed**2 * state[1]]

    ode = solve_ivp(
        along,
        (0.0, 1.5 * ratio),
        [0.0, 0.0, slope * rope.horizontal_tension],
        t_eval=np.linspace(0.0, 1.5 * ratio, 12),
        rtol=1e-11,
        atol=1e-12,
        method="DOP853",
    )
    x, y, vertical = ode.y
    assert (x[-1], y[-1]) == pytest.approx((1.5, 0.0), abs=1e-8)  # tolerance of the integration, steep ends
    inside = np.clip(x, 0.0, 1.5)
    assert rope.shape(inside) == pytest.approx(y, abs=1e-8)
    tension = np.hypot(rope.horizontal_tension, vertical)
    assert rope.tension(inside) == pytest.approx(tension, rel=1e-7)


def test_rope_as_long_as_the_span_whirls_as_a_taut_string() -> None:
    for half_waves in (1, 2):
        rope = whirls.skipping_rope(span=2.0, length=2.0, mass=3.0, angular_speed=5.0, half_waves=half_waves)
        assert rope.radius == 0.0
        assert rope.horizontal_tension == pytest.approx(3.0 * (5.0 * 2.0 / (half_waves * np.pi)) ** 2)
        assert np.all(rope.shape([0.0, 0.7, 2.0]) == 0.0)
    # slack delta: shape y0 sin, length excess (pi y0/2)^2
    near = whirls.skipping_rope(span=1.0, length=1.0 + 1e-8, mass=1.0, angular_speed=1.0)
    assert near.radius == pytest.approx(2e-4 / np.pi, rel=1e-6)  # slack left after rounding of the length


def test_endless_rope_forms_two_parallel_strands() -> None:
    rope = whirls.skipping_rope(span=1.0, length=1e9, mass=1.0, angular_speed=1.0)
    assert 2.0 * rope.radius == pytest.approx(1e9, rel=1e-6)
    assert np.isfinite(rope.largest_tension)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"length": 0.9}, "^length must"),
        ({"length": np.inf}, "^length must"),
        ({"span": 0.0}, "^span must"),
        ({"mass": np.nan}, "^mass must"),
        ({"angular_speed": 0.0}, "^angular_speed must"),
        ({"half_waves": 0}, "^half_waves must"),
    ],
)
def test_impossible_ropes_are_refused(changed: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        whirls.skipping_rope(**({"span": 1.0, "length": 1.2, "mass": 1.0, "angular_speed": 1.0} | changed))


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"amplitude": -0.1}, "^amplitude must"),
        ({"amplitude": np.nan}, "^amplitude must"),
        ({"tension": 0.0}, "^tension must"),
        ({"axial_stiffness": -1.0}, "^axial_stiffness must"),
        ({"half_waves": 0}, "^half_waves must"),
    ],
)
def test_impossible_swings_are_refused(changed: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        whirls.planar_frequency(**({"amplitude": 0.1} | LINE | changed))
