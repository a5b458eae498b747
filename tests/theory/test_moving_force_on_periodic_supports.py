"""Constant moving force on an endless line with periodic supports, against routes that share nothing with it.

Finite elements in time (beam), delayed waves in time (string), the difference equation of the supports (at rest),
the closed form on a continuous foundation (dense supports; numbers from the equations of Fryba, Vibration of
Solids and Structures under Moving Loads, chapter 13), and the balance of energy over a span.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ropewalk.theory import _floquet_integral, periodic
from ropewalk.theory._spans import SpanLayout

FloatArray = NDArray[np.float64]
BEAM = {"force": 1.0, "spacing": 1.0, "mass": 1.0, "bending_stiffness": 1.0, "support_stiffness": 50.0}
STRING = {"force": 1.0, "spacing": 1.0, "mass": 1.0, "tension": 1.0, "support_stiffness": 4.0}


def beam_elements(
    spans: int, per_span: int, tension: float, supports: dict[str, float], damping: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mass, damping and stiffness matrices of Hermite elements of the unit beam, free at both ends."""
    h, n = 1.0 / per_span, spans * per_span + 1
    bending = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                        [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]) / h**3  # fmt: skip
    pull = np.array([[36, 3 * h, -36, 3 * h], [3 * h, 4 * h * h, -3 * h, -h * h],
                     [-36, -3 * h, 36, -3 * h], [3 * h, -h * h, -3 * h, 4 * h * h]]) / (30 * h)  # fmt: skip
    inert = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h],
                      [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]]) * h / 420  # fmt: skip
    m, k = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 2 * n))
    for e in range(n - 1):
        at = slice(2 * e, 2 * e + 4)
        m[at, at] += inert
        k[at, at] += bending + tension * pull
    c = damping * m
    rests = np.arange(spans + 1) * 2 * per_span
    k[rests, rests] += supports["support_stiffness"]
    m[rests, rests] += supports.get("support_mass", 0.0)
    c[rests, rests] += supports.get("support_damping", 0.0)
    return m, c, k


def hermite(place: float, per_span: int, size: int) -> FloatArray:
    """Weights of the nodes' deflections and slopes in the deflection at a place."""
    h = 1.0 / per_span
    e = min(int(place / h), size // 2 - 2)
    s = place / h - e
    weights = np.zeros(size)
    weights[2 * e : 2 * e + 4] = [
        1 - 3 * s**2 + 2 * s**3,
        h * s * (1 - s) ** 2,
        3 * s**2 - 2 * s**3,
        h * s**2 * (s - 1),
    ]
    return weights


@pytest.mark.parametrize(
    ("speed", "tension", "supports", "damping"),
    [
        (1.5, 0.0, {"support_stiffness": 50.0}, 2.0),
        (2.5, 6.0, {"support_stiffness": 20.0, "support_mass": 0.3, "support_damping": 3.0}, 1.0),
    ],
)
def test_beam_agrees_with_finite_elements_in_time(
    speed: float, tension: float, supports: dict[str, float], damping: float
) -> None:
    spans, per_span, steps_per_span = 28, 6, 160
    m, c, k = beam_elements(spans, per_span, tension, supports, damping)
    dt = 1.0 / speed / steps_per_span
    inverse = np.linalg.inv(m + 0.5 * dt * c + 0.25 * dt**2 * k)
    first = 6.0
    w = np.linalg.solve(k, hermite(first, per_span, len(m)))
    v, a = np.zeros_like(w), np.zeros_like(w)
    under, behind = [], []
    for step in range(1, 15 * steps_per_span + 1):  # Newmark's method, average acceleration
        place = first + step / steps_per_span
        load = hermite(place, per_span, len(m))
        guess_w, guess_v = w + dt * v + 0.25 * dt**2 * a, v + 0.5 * dt * a
        a = inverse @ (load - c @ guess_v - k @ guess_w)
        w, v = guess_w + 0.25 * dt**2 * a, guess_v + 0.5 * dt * a
        if step > 14 * steps_per_span and step % 16 == 0:
            under.append(load @ w)
            behind.append(hermite(place - 1.3, per_span, len(m)) @ w)
    y = np.arange(1, 11) / 10
    line = {"force": 1.0, "spacing": 1.0, "mass": 1.0, "bending_stiffness": 1.0, "tension": tension}
    full = line | {"speed": speed, "damping": damping} | supports
    scale = max(under)
    # time step: (omega dt)^2/12 of waves with omega = 10 to 30; the start has died down by e^-7 or more
    assert periodic.moving_force(y, y, **full) == pytest.approx(under, abs=2e-3 * scale)
    assert periodic.moving_force(y - 1.3, y, **full) == pytest.approx(behind, abs=2e-3 * scale)


@pytest.mark.parametrize(
    ("speed", "support_mass", "support_damping"), [(0.5, 0.0, 1.5), (0.5, 0.2, 1.5), (1.6, 0.0, 2.0)]
)
def test_string_agrees_with_delayed_waves_in_time(speed: float, support_mass: float, support_damping: float) -> None:
    """Exact waves between the supports: only the supports' own equations are stepped.

    Their reactions and the load, switched on between the supports, send waves both ways, F/(2 rho c) high.
    """
    steps, count, start = 60, 45, 5.5
    dt, stop = 1.0 / steps, (30.0 - start) / speed
    place = np.arange(count) - start  # of the supports, seen from where the load starts
    stiffness, drag = STRING["support_stiffness"], 2.0 + support_damping  # the string itself resists with 2 rho c
    w, v, a = np.zeros(count), np.zeros(count), np.zeros(count)
    to_right, to_left = np.zeros((count, steps)), np.zeros((count, steps))  # on their way to the support
    by_load, by_wave = place / speed, np.abs(place)  # when they arrive

    def since(t: float, event: FloatArray) -> FloatArray:  # a step of the mean of 0 and 1 keeps the second order
        return np.clip((t - event) / dt + 0.5, 0.0, 1.0)

    times, history = [], []
    for step in range(1, int(stop / dt) + 1):
        t = step * dt
        behind = 0.5 * since(t, np.where(place > 0.0, by_load, by_wave)) / (1.0 + speed)
        between = since(t, np.minimum(by_load, by_wave)) - since(t, np.maximum(by_load, by_wave))
        ahead = 0.5 * np.where(place > 0.0, between, 0.0) / abs(1.0 - speed)
        from_left, from_right = to_right[:, -1].copy(), to_left[:, -1].copy()
        push = 2.0 * (behind + ahead + from_left + from_right)
        if support_mass == 0.0:  # drag v + k w = push, trapezoidal rule
            w = (w + 0.5 * dt * (v + push / drag)) / (1.0 + 0.5 * dt * stiffness / drag)
            v = (push - stiffness * w) / drag
        else:
            top = v + 0.5 * dt * (a + (push - stiffness * (w + 0.5 * dt * v)) / support_mass)
            old, v = v, top / (1.0 + 0.5 * dt * (drag + 0.5 * dt * stiffness) / support_mass)
            w = w + 0.5 * dt * (old + v)
            a = (push - drag * v - stiffness * w) / support_mass
        scattered = v - 0.5 * push
        to_right, to_left = np.roll(to_right, 1, axis=1), np.roll(to_left, 1, axis=1)
        to_right[:, 0] = np.append(0.0, (from_left + scattered)[:-1])
        to_left[:, 0] = np.append((from_right + scattered)[1:], 0.0)
        times.append(t)
        history.append(w[25])
    y = np.array([-1.5, -0.4, 0.3, 1.1, 2.4, 4.2])  # away from the arrival of kinks, which a step smears
    expected = np.interp((y + 25.0 - start) / speed, times, history)
    line = STRING | {"speed": speed, "support_mass": support_mass, "support_damping": support_damping}
    found = periodic.moving_force(0.0, y, **line)
    assert found == pytest.approx(expected, abs=3e-3 * np.max(np.abs(expected)))  # 60 steps of time per span


def test_string_at_rest_obeys_the_difference_equation_of_its_supports() -> None:
    """k w_j = T/d (w_j+1 - 2 w_j + w_j-1) + F_j has the solution F r^|j| / sqrt(k^2 + 4 k T/d)."""
    line = {"force": 3.0, "spacing": 0.5, "mass": 2.0, "tension": 7.0, "support_stiffness": 4.0}
    whole = np.sqrt(4.0**2 + 4 * 4.0 * 7.0 / 0.5)
    ratio = 1.0 + (4.0 - whole) / (2 * 7.0 / 0.5)
    j = np.arange(-4, 5)
    found = periodic.moving_force(0.5 * j, 0.0, speed=0.0, **line)
    assert found == pytest.approx(3.0 / whole * ratio ** np.abs(j), rel=1e-10)  # equal steps converge fast
    between = periodic.moving_force(0.5 * j + 0.2, 0.0, speed=0.0, **line)
    w = 3.0 / whole * ratio ** np.abs(np.arange(-4, 6))
    assert between == pytest.approx(0.6 * w[:-1] + 0.4 * w[1:], rel=1e-10)


@pytest.mark.parametrize("tension", [0.0, 5.0])
def test_beam_at_rest_agrees_with_finite_elements(tension: float) -> None:
    """Exact at the nodes without tension, to the fourth order with it."""
    _, _, k = beam_elements(30, 10, tension, {"support_stiffness": 50.0}, 0.0)
    place = 15.3
    w = np.linalg.solve(k, hermite(place, 10, len(k)))
    x = np.arange(-20, 21) / 10
    found = periodic.moving_force(x, 0.3, speed=0.0, tension=tension, **BEAM)
    assert found == pytest.approx(w[2 * (150 - 20) : 2 * (150 + 21) : 2], abs=1e-6 * np.max(w))


@settings(deadline=None, max_examples=20)
@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(0.0, 3.0), st.floats(0.0, 4.0))
def test_deflection_at_rest_is_reciprocal(x: float, y: float, stiffness: float, tension: float) -> None:
    line = BEAM | {"support_stiffness": 10.0**stiffness, "tension": tension, "speed": 0.0, "spacing": 0.8}
    there = periodic.moving_force(x, y, **line)
    assert there == pytest.approx(periodic.moving_force(y, x, **line), rel=1e-7, abs=1e-12)  # 1% of the tolerance


@settings(deadline=None, max_examples=4)
@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.2, 3.0), st.integers(-3, 3))
def test_field_repeats_span_by_span(x: float, y: float, speed: float, spans: int) -> None:
    line = BEAM | {"speed": speed, "damping": 1.0, "spacing": 0.9, "force": 2.0}
    first, second = periodic.moving_force([x, x + 0.9 * spans], [y, y + 0.9 * spans], **line)
    assert first == pytest.approx(second, abs=1e-9)  # rounding of the phase


def test_slow_load_deflects_as_if_at_rest() -> None:
    x = np.array([-1.2, 0.0, 0.3, 0.9])
    for line in (BEAM | {"damping": 1.0}, BEAM | {"tension": 3.0, "support_damping": 1.0}):
        still = periodic.moving_force(x, 0.3, speed=0.0, **line)
        slow = periodic.moving_force(x, 0.3, speed=1e-4, **line)
        assert slow == pytest.approx(still, abs=2e-4 * np.max(still))  # tolerance, and speed times damping


def test_dense_supports_are_a_foundation_under_a_string() -> None:
    dense = {"force": 1.0, "mass": 1.0, "tension": 1.0, "spacing": 0.02, "support_stiffness": 0.02}
    for speed, damping, x, expected in (
        (0.5, 0.2, [-1.0, 0.0, 0.7], [0.193800342758584, 0.576390417704235, 0.244809942891419]),
        (0.9, 0.5, [0.0], [1.01929438287525]),
        (1.5, 0.4, [-1.0], [0.554276425113688]),
    ):
        found = periodic.moving_force(np.array(x), 0.0, speed=speed, damping=damping, tolerance=1e-6, **dense)
        assert found == pytest.approx(expected, abs=2e-3)  # the kinks at the supports, d/2 wide
        # damping in the supports is damping of the foundation
        shared = periodic.moving_force(np.array(x), 0.0, speed=speed, support_damping=0.02 * damping, **dense)
        assert shared == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize(
    ("speed", "expected"),
    [
        (100.0, [0.00293954083002522, 0.00384051376213498, 0.00196277915149926]),
        (600.0, [0.0023386429623503, 0.00126648821481855, -0.000672091852796937]),
    ],
)
def test_dense_supports_are_a_foundation_under_a_rail(speed: float, expected: list[float]) -> None:
    rail = {"force": 1e5, "mass": 60.21, "bending_stiffness": 6.4155e6, "spacing": 0.1}
    found = periodic.moving_force(
        [-1.0, 0.0, 1.0], 0.0, speed=speed, damping=4.9e4, support_stiffness=1e6, tolerance=1e-7, **rail
    )
    assert found == pytest.approx(expected, rel=3e-6)  # (d (k/EI)^(1/4))^4 = 2e-4, by 720, and more at the sides
    halves = {"support_stiffness": 1e6, "support_mass": 3.0, "support_damping": 2.45e3}
    shared = periodic.moving_force(
        [-1.0, 0.0, 1.0], 0.0, speed=speed, damping=2.45e4, **halves, **(rail | {"mass": 30.21})
    )
    assert shared == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    "line",
    [
        BEAM | {"speed": 1.5, "damping": 1.0, "support_damping": 4.0},
        BEAM | {"speed": 2.0, "tension": 5.0, "support_damping": 6.0, "support_mass": 0.2},
    ],
)
def test_work_of_the_force_is_dissipated_in_line_and_supports(line: dict[str, float]) -> None:
    drag = periodic.moving_force_drag(**line)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    x = np.append(0.0, 0.5 + 0.5 * nodes if "damping" in line else [])
    y = np.linspace(-7.0, 11.0, 217)  # the load passes by at x
    w = periodic.moving_force(x[:, None], y, tolerance=1e-3, **line)
    rate = line["speed"] * CubicSpline(y, w, axis=1)(np.linspace(-7.0, 11.0, 7201), 1)
    power = np.sum(rate**2, axis=1) * 0.0025 / line["speed"]
    lost = line.get("support_damping", 0.0) * power[0]
    if "damping" in line:
        lost += line["damping"] * 0.5 * weights @ power[1:]
    assert drag == pytest.approx(lost, rel=1e-3)  # tolerance of the field


def test_work_on_a_string_is_dissipated_wave_by_wave() -> None:
    """Its velocity jumps, which steps in time blur; by Parseval the loss is V/pi times the integral of q^2 |W|^2."""
    line = {"spacing": 1.0, "mass": 1.0, "tension": 1.0, "bending_stiffness": 0.0, "support_stiffness": 4.0}
    full = line | {"support_mass": 0.0, "damping": 1.0, "support_damping": 1.0}
    drag = periodic.moving_force_drag(force=1.0, speed=0.6, **full)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    field = _floquet_integral._field(SpanLayout(**full), np.append(0.0, 0.5 + 0.5 * nodes), 0.6, 0.0)
    lost = []
    for low, high in ((0.0, 200.0), (200.0, 400.0)):
        q = np.arange(low + 0.01, high, 0.02)
        power = q[:, None] ** 2 * np.abs(field(q)) ** 2
        lost.append(0.6 / np.pi * 0.02 * np.sum(power[:, 0] + 0.5 * power[:, 1:] @ weights))
    # the rest falls as 1/q: as much again as the last octave
    assert drag == pytest.approx(lost[0] + 2.0 * lost[1], rel=2e-3)


def test_drag_is_the_mean_slope_under_the_load() -> None:
    y = (np.arange(16) + 0.5) / 16
    line = BEAM | {"speed": 2.0, "damping": 1.0, "tension": 2.0}
    step = 1e-3
    slopes = periodic.moving_force(y + step, y, **line) - periodic.moving_force(y - step, y, **line)
    drag = periodic.moving_force_drag(**line)
    assert drag == pytest.approx(-np.mean(slopes) / (2 * step), rel=1e-3)  # tolerance over the step
    assert periodic.moving_force_drag(**(line | {"force": -3.0})) == pytest.approx(9 * drag)
    assert periodic.moving_force_drag(**(line | {"speed": 0.0})) == 0.0


def test_undamped_line_is_the_limit_of_little_damping() -> None:
    x = np.array([-2.7, -1.0, 0.0, 0.4, 1.9])
    free = periodic.moving_force(x, 0.2, speed=2.0, **BEAM)
    little = [periodic.moving_force(x, 0.2, speed=2.0, damping=c, **BEAM) for c in (2e-2, 1e-2)]
    limit = 2 * little[1] - little[0]
    assert free == pytest.approx(limit, abs=3e-4 * np.max(free))  # tolerances and the next term
    # it loses what it radiates
    assert periodic.moving_force_drag(speed=2.0, **BEAM) == pytest.approx(
        2 * periodic.moving_force_drag(speed=2.0, damping=1e-2, **BEAM)
        - periodic.moving_force_drag(speed=2.0, damping=2e-2, **BEAM),
        rel=1e-2,
    )


def test_rigid_supports_hold_and_are_the_limit_of_hard_ones() -> None:
    rigid = BEAM | {"support_stiffness": np.inf, "damping": 1.0}
    hard = BEAM | {"support_stiffness": 1e9, "damping": 1.0}
    x = np.array([-1.5, -0.3, 0.0, 0.5, 1.0])
    for speed in (0.0, 1.5):
        found = periodic.moving_force(x, 0.4, speed=speed, **rigid)
        assert found[[2, 4]] == pytest.approx(0.0, abs=1e-5 * np.max(found))
        assert found == pytest.approx(periodic.moving_force(x, 0.4, speed=speed, **hard), abs=1e-4 * np.max(found))
    # three moments: the neighbours are turning springs c = 2 sqrt(3) EI/d, end moments F d/8 c/(c + 2 EI/d)
    turning = 2 * np.sqrt(3.0)
    middle = periodic.moving_force(0.5, 0.5, speed=0.0, **rigid)
    assert middle == pytest.approx(1 / 48 - turning / (turning + 2) / 64, rel=1e-6)


def test_error_estimate_bounds_the_error() -> None:
    line = BEAM | {"speed": 2.0, "support_damping": 2.0}
    x = np.linspace(-1.0, 1.0, 5)
    rough, error = periodic.moving_force_error(x, 0.3, tolerance=1e-2, **line)
    fine, smaller = periodic.moving_force_error(x, 0.3, tolerance=1e-8, **line)
    assert np.max(np.abs(rough - fine)) <= error
    assert smaller < 1e-8 * np.max(fine)


def test_unreachable_tolerance_is_an_error_and_no_force_is_no_deflection() -> None:
    with pytest.raises(ArithmeticError, match="tolerance"):
        periodic.moving_force(0.0, 0.0, tolerance=1e-18, **(BEAM | {"speed": 1.5, "damping": 1.0}))
    assert periodic.moving_force(0.3, 0.0, speed=1.0, damping=1.0, **(BEAM | {"force": 0.0})) == 0.0
    assert periodic.moving_force_drag(speed=1.0, damping=1.0, **(BEAM | {"force": 0.0})) == 0.0


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"speed": -1.0}, "^speed must"),
        ({"speed": 1.0}, "wave speed"),
        ({"support_stiffness": 0.0}, "^support_stiffness must"),
        ({"damping": -1.0}, "^damping must"),
        ({"support_damping": np.nan}, "^support_damping must"),
        ({"force": np.inf}, "^force must"),
        ({"tolerance": 0.0}, "^tolerance must"),
        ({"spacing": 0.0}, "^spacing must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        periodic.moving_force(0.0, 0.0, **(STRING | {"speed": 0.5} | changed))
    with pytest.raises(ValueError, match=said):
        periodic.moving_force_drag(**(STRING | {"speed": 0.5} | changed))


def test_places_must_be_finite() -> None:
    for x, y in ((np.nan, 0.0), (0.0, np.inf)):
        with pytest.raises(ValueError, match="must be finite"):
            periodic.moving_force(x, y, speed=0.5, **BEAM)


def test_nothing_moves_ahead_of_a_force_that_outruns_its_waves():
    """It did not end: the tolerance was relative to the answer, which is zero."""
    line = {"spacing": 2.0, "mass": 5.0, "support_stiffness": 1.0, "tension": 2.0}  # waves: 0.63 m/s
    ahead = periodic.moving_force([1.0, 2.0], 0.5, force=1.0, speed=1.0, **line)
    behind = periodic.moving_force([-1.0, 0.4], 0.5, force=1.0, speed=1.0, **line, tolerance=1e-3)
    assert np.abs(ahead).max() < 1e-6 * np.abs(behind).max()
