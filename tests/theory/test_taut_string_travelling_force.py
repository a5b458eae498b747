"""A force of any course on a taut string: the image sum against closed forms, modes and reference numbers."""

import time

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from ropewalk.theory import string

UNIT = {"length": 1.0, "tension": 1.0, "mass": 1.0}
STRING = {"length": 1.7, "tension": 8.0, "mass": 2.0}  # wave speed 2

fractions = st.floats(0.0, 1.0)


@pytest.mark.parametrize(
    ("acceleration", "t", "x", "deflection"),
    [
        (0.5, 1.2, 0.2, 0.134979776110),
        (0.5, 1.8, 0.6, 0.318481819901),
        (1.0, 1.2, 0.5, 0.274212178929),
        (2.0, 0.9, 0.3, 0.141102506075),
    ],
)
def test_accelerated_force_through_the_wave_speed(acceleration: float, t: float, x: float, deflection: float) -> None:
    computed = string.travelling_force(x, t, path=lambda s: 0.5 * acceleration * s**2, force=1.0, **UNIT)
    assert computed == pytest.approx(deflection, abs=5.1e-13)  # 12 digits are given


def test_waves_from_just_before_and_after_passing_the_wave_speed() -> None:
    """Path s^2/2: waves sent back and ahead at s = 1 -+ r reach x together, r small."""
    t, x = 1.3, 0.8001
    r = np.sqrt(1.0 - 2.0 * (t - x))
    direct = (1.0 - r) + (np.sqrt(1.0 + 2.0 * (t + x)) - 1.0) - (1.0 + r)
    images = (np.sqrt(1.0 + 2.0 * (t - x)) - 1.0) + (1.0 - np.sqrt(1.0 - 2.0 * (t - 2.0 + x)))
    images -= np.sqrt(1.0 + 2.0 * (t - 2.0 + x)) - 1.0  # seen from x: mirrored at both ends
    computed = string.travelling_force(x, t, path=lambda s: 0.5 * s**2, force=1.0, **UNIT)
    assert computed == pytest.approx(0.5 * (direct - images), abs=1e-13)  # roundings over r = 0.014


def test_braking_force() -> None:
    computed = string.travelling_force(0.3, 0.8, path=lambda s: s - 0.25 * s**2, force=1.0, **UNIT)
    assert computed == pytest.approx(0.167890056794, abs=5.1e-13)  # 12 digits are given


@pytest.mark.parametrize("speed", [0.02, 0.6, 1.98, 2.0, 2.6, 7.0])
@pytest.mark.parametrize("table", [False, True])
def test_constant_speed_and_free_motion_are_those_of_the_closed_form(speed: float, table: bool) -> None:
    random = np.random.default_rng(3)  # at V = c points on the jump would be decided by rounding
    x, t = random.uniform(0.0, 1.7, 300), random.uniform(-0.2, 2.5 * 1.7 / speed, 300)
    exact = string.moving_force(x, t, force=3.0, speed=speed, **STRING)
    last = 3.0 * 1.7 / speed
    path = ([0.0, last], [0.0, speed * last]) if table else lambda s: speed * s
    force = ([0.0, last], [3.0, 3.0]) if table else 3.0
    computed = string.travelling_force(x, t, path=path, force=force, **STRING)
    # rounding of phases up to c t, magnified by the slope between load and wave front
    assert np.max(np.abs(computed - exact)) < 1e-14 * (1.0 + 2.0 * np.max(t)) / max(abs(1.0 - speed / 2.0), 0.1)


@pytest.mark.parametrize("speed", [0.9, 1.75, 6.0])
def test_path_that_touches_the_supports(speed: float) -> None:
    def path(s: np.ndarray) -> np.ndarray:
        return 0.5 - 0.5 * np.cos(speed * s)

    x, t = 0.4, 4.0
    s = (np.arange(200_000) + 0.5) * t / 200_000
    sampled = 0.5 * t * np.mean(green(path(s), x, t - s))
    assert string.travelling_force(x, t, path=path, force=1.0, **UNIT) == pytest.approx(sampled, abs=5e-5)  # samples


def test_value_at_the_jump_is_the_mean() -> None:
    assert string.travelling_force(0.5, 0.5, path=lambda s: s, force=1.0, **UNIT) == pytest.approx(0.125, rel=1e-12)
    assert string.travelling_force(0.5 - 1e-9, 0.5, path=lambda s: s, force=1.0, **UNIT) == pytest.approx(
        0.25, abs=1e-8
    )
    assert string.travelling_force(0.5 + 1e-9, 0.5, path=lambda s: s, force=1.0, **UNIT) == pytest.approx(
        0.0, abs=1e-15
    )


def modal(x: float, t: float, path, force, modes: int) -> float:  # type: ignore[no-untyped-def]
    """Duhamel's integral of each mode on the unit string, by Gauss's rule on many pieces."""
    points, weights = np.polynomial.legendre.leggauss(10)
    edges = np.linspace(0.0, t, 401)
    s = (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (points + 1)).ravel()
    w = (0.5 * np.diff(edges)[:, None] * weights).ravel()
    k = np.pi * np.arange(1, modes + 1)[:, None]
    q = (2.0 / k * np.sin(k * (t - s)) * np.sin(k * path(s)) * force(s)) @ w
    return float(q @ np.sin(k[:, 0] * x))


def green(y: np.ndarray, x: float, s: np.ndarray) -> np.ndarray:
    """Waves and images that have come after the time s, unit string; none from beyond the ends."""
    shift = 2.0 * np.arange(-4, 5)[:, np.newaxis]
    waves = np.sum((s >= np.abs(x - y - shift)).astype(float) - (s >= np.abs(x + y - shift)), axis=0)
    return waves * ((y >= 0.0) & (y <= 1.0))


def test_varying_force_that_turns_round_is_the_sum_of_600_modes() -> None:
    def path(s: np.ndarray) -> np.ndarray:
        return 0.5 - 0.45 * np.cos(2.5 * s)

    def force(s: np.ndarray) -> np.ndarray:
        return 1.0 + 0.7 * np.sin(9.0 * s)

    for x, t in ((0.2, 0.7), (0.55, 1.9), (0.8, 3.3)):
        exact = string.travelling_force(x, t, path=path, force=force, **UNIT)
        # coefficients of a kink of 1 fall as 2/(pi n)^2, and the path is faster than waves at times
        assert exact == pytest.approx(modal(x, t, path, force, 600), abs=5e-4)
        s = (np.arange(200_000) + 0.5) * t / 200_000
        sampled = 0.5 * t * np.mean(force(s) * green(path(s), x, t - s))
        assert exact == pytest.approx(sampled, abs=1e-5)  # 2e5 samples, some ten jumps of size 2


def test_force_that_leaves_and_comes_back_acts_only_on_the_string() -> None:
    """A parabola that is beyond the end between its two crossings, against quadrature of Green's function."""

    def path(s: np.ndarray) -> np.ndarray:
        return 2.0 * s - 0.7 * s**2

    for x, t in ((0.4, 1.5), (0.7, 2.6)):
        s = (np.arange(200_000) + 0.5) * t / 200_000
        sampled = 0.5 * t * np.mean(green(path(s), x, t - s))
        computed = string.travelling_force(x, t, path=path, force=1.0, **UNIT)
        assert computed == pytest.approx(sampled, abs=3e-5)  # 2e5 samples, some ten jumps


def test_standing_force_swings_about_its_static_deflection() -> None:
    """The mean over a period 2L/c of a force switched on at y is the static deflection."""
    x, y = 0.4, 1.1
    t = (np.arange(4000) + 0.5) * 1.7 / 4000
    w = string.travelling_force(x, t, path=y, force=3.0, **STRING)
    assert np.mean(w) == pytest.approx(3.0 / 8.0 * x * (1.7 - y) / 1.7, rel=1e-6)  # midpoint rule on straight pieces


@settings(deadline=None, max_examples=40)
@given(fractions, fractions, st.floats(0.05, 5.0), st.floats(0.1, 9.0))
def test_reciprocity(x: float, y: float, t: float, rate: float) -> None:
    """The deflection at x under a force that stands at y is that at y under the same force at x."""

    def force(s: np.ndarray) -> np.ndarray:
        return np.cos(rate * s)

    here = string.travelling_force(x, t, path=y, force=force, **UNIT)
    there = string.travelling_force(y, t, path=x, force=force, **UNIT)
    assert here == pytest.approx(float(there), abs=1e-13)  # roundings


@settings(deadline=None, max_examples=12)
@given(fractions, st.floats(0.05, 4.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(0.1, 2.0))
def test_linear_in_the_force(x: float, t: float, first: float, second: float, speed: float) -> None:
    def w(force) -> float:  # type: ignore[no-untyped-def]
        return float(string.travelling_force(x, t, path=lambda s: 0.5 + 0.5 * np.sin(speed * s), force=force, **UNIT))

    both = w(lambda s: first * np.sin(3.0 * s) + second)
    assert both == pytest.approx(first * w(lambda s: np.sin(3.0 * s)) + second * w(1.0), abs=1e-11)  # fits of the force


@settings(deadline=None, max_examples=12)
@given(st.floats(0.1, 3.0), st.floats(0.1, 0.9), fractions, fractions)
def test_dalembert_on_diamonds(acceleration: float, x: float, progress: float, size: float) -> None:
    """w at the tips in time less w at the tips in space is 1/(2 rho c) times the stay in the diamond between."""
    t = 0.2 + 2.0 * progress
    half = 0.9 * size * min(x, 1.0 - x, t) + 1e-3 * min(x, 1.0 - x, t)

    def path(s: np.ndarray | float) -> np.ndarray | float:
        return 0.5 * acceleration * np.asarray(s) ** 2

    def w(at: float, when: float) -> float:
        return float(string.travelling_force(at, when, path=path, force=1.0, **UNIT))

    balance = w(x, t + half) + w(x, t - half) - w(x + half, t) - w(x - half, t)
    # Edges of the stay: roots of the four parabolas' quadratics.
    roots = [0.0, t + half]
    for side in (-1.0, 1.0):
        for when in (-1.0, 1.0):  # side (a s^2/2 - x) + when (s - t) = half
            roots += [r.real for r in np.roots([side * 0.5 * acceleration, when, -side * x - when * t - half])]
    exit_time = np.sqrt(2.0 / acceleration)
    edges = np.unique(np.clip([*roots, exit_time], 0.0, min(t + half, exit_time)))
    middle = 0.5 * (edges[1:] + edges[:-1])
    inside = np.abs(path(middle) - x) + np.abs(middle - t) < half
    stay = float(np.sum(np.diff(edges)[inside]))
    assume(np.min(np.abs(np.gradient(np.sort(roots)))) > 1e-9)  # a touch makes roots as bad as sqrt(1e-16)
    assert balance == pytest.approx(0.5 * stay, abs=1e-12)  # roots to rounding


def test_shape_scaling_and_rest_before_the_start() -> None:
    x, t = np.linspace(0.0, 1.7, 5), np.array([[-1.0], [0.0], [0.3], [2.0]])
    w = string.travelling_force(x, t, path=lambda s: 0.3 + s, force=lambda s: 3.0 * np.cos(s), **STRING)
    assert w.shape == (4, 5)
    assert np.all(w[:2] == 0.0)
    assert np.max(np.abs(w[:, [0, -1]])) < 1e-15  # roundings
    unit = string.travelling_force(
        x / 1.7, t * 2 / 1.7, path=lambda s: (0.3 + 0.85 * s) / 1.7, force=lambda s: np.cos(0.85 * s), **UNIT
    )
    assert np.max(np.abs(w - 3.0 * 1.7 / 8.0 * unit)) < 1e-13  # the force is fitted to 1e-12 of its integral


def test_jump_of_the_force_is_found() -> None:
    def step(s: np.ndarray) -> np.ndarray:
        return np.where(s < 0.377, 0.0, 1.0)

    def late(s: np.ndarray) -> np.ndarray:
        return 0.2 + 0.3 * (s + 0.377)

    switched = string.travelling_force(0.3, 1.5, path=lambda s: 0.2 + 0.3 * s, force=step, **UNIT)
    shifted = string.travelling_force(0.3, 1.5 - 0.377, path=late, force=1.0, **UNIT)
    assert switched == pytest.approx(float(shifted), abs=1e-11)  # panels around the jump


def test_kink_between_two_samples_is_seen() -> None:
    """A kink just before the end of one of the first panels, which no Gauss point sees."""
    kink = 1.6 * 5 / 16 - 1e-3 * 0.1

    def force(s: np.ndarray) -> np.ndarray:
        return 1.0 + 5.0 * np.maximum(s - kink, 0.0)

    whole = string.travelling_force(0.4, 1.6, path=0.7, force=force, **UNIT)
    images = ((1.0, 0.3), (-1.0, 1.1), (-1.0, 0.9), (1.0, 1.7))
    total = sum(sign * quad(force, 0.0, 1.6 - away, points=[kink])[0] for sign, away in images if away < 1.6)
    assert whole == pytest.approx(0.5 * total, abs=1e-11)


def test_large_field_in_reasonable_time() -> None:
    x, t = np.linspace(0.0, 1.0, 200), np.linspace(0.0, 3.0, 200)[:, np.newaxis]
    start = time.process_time()
    string.travelling_force(x, t, path=lambda s: 0.25 * s**2, force=1.0, **UNIT)
    assert time.process_time() - start < 4.0  # 0.4 s when written


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"length": 0.0}, "^length must"),
        ({"tension": -1.0}, "^tension must"),
        ({"mass": 0.0}, "^mass must"),
        ({"x": 1.1}, "^x must lie"),
        ({"t": np.nan}, "^t must be finite"),
        ({"path": lambda s: np.sqrt(0.5 - s)}, "^path must be finite"),
        ({"path": np.inf}, "^path must be finite"),
        ({"force": np.nan}, "^force must be finite"),
        ({"force": ([0.0, 1.0], [1.0])}, "^force as a table"),
        ({"path": ([0.0, 0.0], [1.0, 0.0])}, "^path as a table"),
        ({"path": ([0.0, 1.0], [1.0, np.nan])}, "^path must be finite"),
        ({"path": lambda s: 0.5 + 0.1 * np.random.default_rng(1).random(s.shape)}, "too many features"),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_nonsense_is_refused(changed: dict[str, object], said: str) -> None:
    arguments = {"x": 0.5, "t": 1.0, "path": lambda s: s, "force": 1.0} | UNIT | changed
    with pytest.raises(ValueError, match=said):
        string.travelling_force(arguments.pop("x"), arguments.pop("t"), **arguments)
