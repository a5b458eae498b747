"""Membranes and nets against independent routes: Rayleigh's modes, double series, energies, matrices, quadrature."""

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from closed_forms import membranes
from ropewalk.theory import membrane

RECTANGLE: dict[str, Any] = {"sides": (3.0, 2.0), "tension": (500.0, 800.0)}
MOVING: dict[str, Any] = RECTANGLE | {"mass": 1.5, "force": 40.0, "speed": 12.0, "track": 0.7}


def test_frequencies_of_a_rectangle_solve_its_equation_in_rayleighs_manner() -> None:
    """Square of the frequency: work of the tensions by that of the inertia, integrated by quadrature."""
    (a, b), (nx, ny) = RECTANGLE["sides"], RECTANGLE["tension"]
    for m, n in ((1, 1), (2, 3)):
        sine, cosine = (
            quad(lambda s, k=k, f=f: f(k * np.pi * s) ** 2, 0.0, 1.0)[0] for k, f in ((m, np.sin), (n, np.cos))
        )
        strain = (m * np.pi / a) ** 2 * nx * sine * cosine + (n * np.pi / b) ** 2 * ny * sine * cosine
        square = strain / (1.5 * sine * cosine)
        assert membrane.rectangle_frequency(m, n, mass=1.5, **RECTANGLE) ** 2 == pytest.approx(square, rel=1e-12)
    # Square: pi sqrt(2) c/a, and sqrt(5/2) of it for the next two
    square = membrane.rectangle_frequency([1, 1, 2], [1, 2, 1], sides=(1.0, 1.0), tension=4.0, mass=1.0)
    assert square == pytest.approx(np.pi * np.sqrt([8.0, 20.0, 20.0]), rel=1e-14)


def double_series(x: float, y: float, at: tuple[float, float], terms: int) -> float:
    (a, b), (nx, ny) = RECTANGLE["sides"], RECTANGLE["tension"]
    m, n = np.arange(1, terms + 1)[:, np.newaxis], np.arange(1, terms + 1)
    stiff = np.pi**2 * (nx * (m / a) ** 2 + ny * (n / b) ** 2)
    shape = np.sin(m * np.pi * x / a) * np.sin(n * np.pi * y / b)
    load = np.sin(m * np.pi * at[0] / a) * np.sin(n * np.pi * at[1] / b)
    # Fejer's weights: the series converges too slowly without.
    weight = (1.0 - m / (terms + 1)) * (1.0 - n / (terms + 1))
    return float(np.sum(weight * shape * load / stiff) * 4.0 / (a * b))


def single_series(x: float, y: float, at: tuple[float, float], along: int) -> float:
    """Sines along one side, products of sinh along the other."""
    sides, tensions, place = RECTANGLE["sides"], RECTANGLE["tension"], (x, y)
    a, b = sides[along], sides[1 - along]
    m = np.arange(1, 400)
    k = m * np.pi / a * np.sqrt(tensions[along] / tensions[1 - along])
    low, high = sorted((place[1 - along], at[1 - along]))
    with np.errstate(under="ignore"):
        # sinh(k low) sinh(k (b - high)) / sinh(k b) without overflow
        green = 0.5 * np.exp(-k * (high - low)) * np.expm1(-2 * k * low) * np.expm1(-2 * k * (b - high))
    green /= -np.expm1(-2 * k * b) * k
    terms = np.sin(m * np.pi * place[along] / a) * np.sin(m * np.pi * at[along] / a) * green
    return float(2.0 / (a * tensions[1 - along]) * np.sum(terms))


@pytest.mark.parametrize(("x", "y"), [(1.0, 1.6), (2.9, 0.1), (0.5, 0.2), (2.0, 1.0)])
def test_deflection_under_a_point_load_is_that_of_both_single_series_and_of_the_double_one(x: float, y: float) -> None:
    at = (0.8, 0.6)
    w = membranes.point_load(x, y, at=at, force=7.0, **RECTANGLE)
    for along in (0, 1):
        # 400 terms leave exp(-400 pi distance/side); nearest 0.3 of 3 m, 0.4 of 2 m: round-off
        assert w == pytest.approx(7.0 * single_series(x, y, at, along), rel=1e-12)
    assert w == pytest.approx(7.0 * double_series(x, y, at, 800), rel=5e-3)  # Fejer sums: errors of first order


@settings(deadline=None, max_examples=40)
@given(st.floats(0.05, 0.95), st.floats(0.05, 0.95), st.floats(0.05, 0.95), st.floats(0.05, 0.95), st.floats(0.1, 10.0))
def test_point_loads_obey_maxwell_and_mirrors(x: float, y: float, x0: float, y0: float, aspect: float) -> None:
    given_: dict[str, Any] = {"force": 1.0, "sides": (aspect, 1.0), "tension": (2.0, 3.0)}
    one = membranes.point_load(aspect * x, y, at=(aspect * x0, y0), **given_)
    two = membranes.point_load(aspect * x0, y0, at=(aspect * x, y), **given_)
    turned = membranes.point_load(
        y, aspect * x, at=(y0, aspect * x0), force=1.0, sides=(1.0, aspect), tension=(3.0, 2.0)
    )
    mirrored = membranes.point_load(aspect * (1.0 - x), y, at=(aspect * (1.0 - x0), y0), **given_)
    assume(np.hypot(x - x0, y - y0) > 1e-3)  # infinite at the load
    # the difference of places and of the terms of distant images, both rounded
    assert [float(w) for w in (two, turned, mirrored)] == pytest.approx(3 * [float(one)], rel=1e-11, abs=1e-14)


def test_point_load_vanishes_at_the_rim_and_grows_as_a_logarithm_at_the_load() -> None:
    rim = membranes.point_load([0.0, 3.0, 1.0, 1.0], [1.0, 1.0, 0.0, 2.0], at=(0.8, 0.6), force=7.0, **RECTANGLE)
    assert rim == pytest.approx(0.0, abs=1e-17)
    near = membranes.point_load([0.8 + 1e-6, 0.8 + 1e-8], 0.6, at=(0.8, 0.6), force=7.0, **RECTANGLE)
    growth = 7.0 * np.log(100.0) / (2.0 * np.pi * np.sqrt(500.0 * 800.0))
    assert near[1] - near[0] == pytest.approx(growth, rel=1e-5)  # the rest is regular: 1e-6 of the side
    assert membranes.point_load(0.8, 0.6, at=(0.8, 0.6), force=7.0, **RECTANGLE) == np.inf


def test_force_of_the_rim_is_that_of_the_load() -> None:
    """Equilibrium: the slopes at the rim times the tensions, integrated along it."""
    h, at = 1e-6, (0.8, 0.6)

    def slope(x: float, y: float) -> float:
        return float(membranes.point_load(x, y, at=at, force=7.0, **RECTANGLE)) / h

    ends = [quad(lambda y, x=x: slope(x, y), 0.0, 2.0, epsrel=1e-8)[0] for x in (h, 3.0 - h)]
    sides = [quad(lambda x, y=y: slope(x, y), 0.0, 3.0, epsrel=1e-8)[0] for y in (h, 2.0 - h)]
    # differences of 1e-6 m, of second order but at the corners
    assert 500.0 * sum(ends) + 800.0 * sum(sides) == pytest.approx(7.0, rel=1e-5)


def test_net_is_its_own_matrix() -> None:
    cells, (tx, ty), (hx, hy) = (5, 7), (30.0, 40.0), (0.2, 0.3)
    chains = [T / h * (2 * np.eye(c - 1) - np.eye(c - 1, k=1) - np.eye(c - 1, k=-1))
              for T, h, c in zip((tx, ty), (hx, hy), cells, strict=True)]  # fmt: skip
    K = np.kron(chains[0], np.eye(6)) + np.kron(np.eye(4), chains[1])
    given_: dict[str, Any] = {"cells": cells, "spacing": (hx, hy), "tension": (tx, ty)}
    frequencies = membranes.net_frequencies(mass=0.1, **given_)
    assert frequencies.shape == (4, 6)
    expected = np.sqrt(np.linalg.eigvalsh(K / 0.1))
    assert np.sort(frequencies.ravel()) == pytest.approx(expected, rel=1e-12)  # accuracy of the eigenvalue solver
    assert frequencies[1, 0] ** 2 > frequencies[0, 0] ** 2
    load = np.zeros((4, 6))
    load[1, 4] = 9.0
    w = membrane.net_deflection(at=(2, 5), force=9.0, **given_)
    assert w.shape == (6, 8)
    assert w[1:-1, 1:-1].ravel() == pytest.approx(np.linalg.solve(K, load.ravel()), rel=1e-12)
    assert np.all(w[[0, -1]] == 0.0)
    assert np.all(w[:, [0, -1]] == 0.0)


def test_fine_nets_become_the_membrane() -> None:
    for cells in (30, 60):
        h = 1.0 / cells
        given_: dict[str, Any] = {"cells": (2 * cells, cells), "spacing": (h, h), "tension": (4.0 * h, 4.0 * h)}
        frequencies = membranes.net_frequencies(mass=0.5 * h**2, **given_)[:2, :2]
        exact = membrane.rectangle_frequency([[1], [2]], [1, 2], sides=(2.0, 1.0), tension=4.0, mass=0.5)
        assert frequencies == pytest.approx(exact, rel=(2 * np.pi * h) ** 2 / 24)  # the next term of the sine
        away = membrane.net_deflection(at=(cells // 2, cells // 2), force=1.0, **given_)[cells, cells // 3]
        point = membranes.point_load(1.0, 1 / 3, at=(0.5, 0.5), force=1.0, sides=(2.0, 1.0), tension=4.0)
        assert away == pytest.approx(point, rel=3.0 * h**2)  # second order


def test_frequencies_of_a_circle_are_bessels_zeros() -> None:
    given_: dict[str, Any] = {"radius": 2.0, "tension": 9.0, "mass": 0.25}
    # Abramowitz and Stegun, table 9.5: ten decimals; five for the first order
    assert membranes.circle_frequencies(count=3, **given_) / 3.0 == pytest.approx(
        [2.4048255577, 5.5200781103, 8.6537279129], abs=5e-11
    )
    assert membranes.circle_frequencies(diameters=1, count=2, **given_) / 3.0 == pytest.approx(
        [3.83170597, 7.01558667], abs=5e-9
    )
    assert membranes.circle_frequencies(diameters=2, **given_) / 3.0 == pytest.approx([5.1356223], abs=5e-8)


def motion(m: int, n: int, times: list[float], case: dict[str, Any]) -> np.ndarray:
    (a, b), (nx, ny) = case["sides"], case["tension"]
    square = np.pi**2 * (nx * (m / a) ** 2 + ny * (n / b) ** 2) / case["mass"]
    scale = 4.0 * case["force"] / (a * b * case["mass"]) * np.sin(n * np.pi * case["track"] / b)

    def rate(t: float, state: np.ndarray) -> list[float]:
        place = case["speed"] * t
        return [state[1], scale * np.sin(m * np.pi * place / a) * (place < a) - square * state[0]]

    until = a / case["speed"]
    on, off = [t for t in times if t < until], [t for t in times if t >= until]
    tight: dict[str, Any] = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-15}
    first = solve_ivp(rate, (0.0, until), [0.0, 0.0], t_eval=[*on, until], **tight)
    then = solve_ivp(rate, (until, max(times)), first.y[:, -1], t_eval=off, **tight)
    return np.concatenate([first.y[0, : len(on)], then.y[0]])


@pytest.mark.parametrize("kind", ["slow", "fast", "resonant", "nearly resonant"])
def test_modes_under_a_moving_force_are_those_of_numerical_integration(kind: str) -> None:
    m, n = 2, 3
    resonance = (
        float(membrane.rectangle_frequency(m, n, sides=(3.0, 2.0), tension=(500.0, 800.0), mass=1.5))
        * 3.0
        / (m * np.pi)
    )
    speed = {"slow": 5.0, "fast": 150.0, "resonant": resonance, "nearly resonant": resonance * (1.0 + 1e-9)}[kind]
    case = MOVING | {"speed": speed}
    times = [0.2 * 3.0 / speed, 0.9 * 3.0 / speed, 3.0 / speed, 3.3 / speed, 5.0 / speed]
    amplitudes = membranes.moving_force_mode(m, n, times, **case)
    integrated = motion(m, n, times, case)
    assert amplitudes == pytest.approx(integrated, abs=1e-9 * np.abs(integrated).max())  # tolerance of the integration


def test_moving_force_is_the_sum_of_its_modes_and_rests_before_it_comes() -> None:
    x, y, t = np.array([[0.4], [2.0]]), 1.1, np.array([-0.1, 0.0, 0.1, 0.4])
    w = membranes.moving_force(x, y, t, modes=(3, 2), **MOVING)
    assert w.shape == (2, 4)
    assert np.all(w[:, :2] == 0.0)
    total = sum(
        membranes.moving_force_mode(m, n, t, **MOVING) * np.sin(m * np.pi * x / 3.0) * np.sin(n * np.pi * y / 2.0)
        for m in (1, 2, 3)
        for n in (1, 2)
    )
    assert w == pytest.approx(total, rel=1e-12, abs=1e-18)


def test_slowly_moving_force_deflects_as_a_standing_one() -> None:
    speed = 0.02  # waves: 18 m/s
    w = membranes.moving_force(2.2, 1.4, 1.2 / speed, modes=(150, 150), **(MOVING | {"speed": speed}))
    still = membranes.point_load(2.2, 1.4, at=(1.2, 0.7), force=40.0, **RECTANGLE)
    # free vibration of the order of speed/wave speed, 1e-3, and the modes beyond 150
    assert w == pytest.approx(still, rel=5e-3)


def test_energy_after_the_passage_is_the_work_of_the_force() -> None:
    """Work: the force times the path of the deflection under it in time, mode by mode."""
    m, n, a, b = 2, 1, 3.0, 2.0
    until = a / 12.0
    w = float(membrane.rectangle_frequency(m, n, mass=1.5, **RECTANGLE))
    h = 1e-6

    def power(t: float) -> float:
        rate = np.diff(membranes.moving_force_mode(m, n, [t - h, t + h], **MOVING))[0] / (2.0 * h)
        return 40.0 * float(rate) * np.sin(m * np.pi * 12.0 * t / a) * np.sin(n * np.pi * 0.7 / b)

    work = quad(power, 0.0, until, epsrel=1e-9)[0]
    t = until + np.linspace(0.1, 0.1 + np.pi / w, 401)
    largest = np.abs(membranes.moving_force_mode(m, n, t, **MOVING)).max()
    # half the modal mass times square of the largest velocity; 400 samples of half a period
    assert work == pytest.approx(0.5 * (1.5 * a * b / 4.0) * (w * largest) ** 2, rel=1e-4)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: membrane.rectangle_frequency(0, 1, mass=1.0, **RECTANGLE), "^m and n"),
        (lambda: membrane.rectangle_frequency(1, 1, mass=0.0, **RECTANGLE), "^mass"),
        (lambda: membrane.rectangle_frequency(1, 1, mass=1.0, sides=(1.0, 0.0), tension=1.0), "^side_along_y"),
        (lambda: membrane.rectangle_frequency(1, 1, mass=1.0, sides=(1.0, 1.0), tension=(-1.0, 1.0)), "^tension_a"),
        (lambda: membranes.point_load(4.0, 1.0, at=(1.0, 1.0), force=1.0, **RECTANGLE), "^x must"),
        (lambda: membranes.point_load(1.0, 1.0, at=(3.0, 1.0), force=1.0, **RECTANGLE), "load must stand inside"),
        (lambda: membranes.point_load(1.0, 1.0, at=(2.0, 1.0), force=np.nan, **RECTANGLE), "^force must"),
        (lambda: membranes.net_frequencies(cells=(1, 4), spacing=(1.0, 1.0), tension=1.0, mass=1.0), "at least 2"),
        (
            lambda: membrane.net_deflection(cells=(4, 4), at=(0, 2), force=1.0, spacing=(1.0, 1.0), tension=1.0),
            "a node inside",
        ),
        (lambda: membranes.circle_frequencies(radius=1.0, tension=1.0, mass=1.0, count=0), "^diameters must"),
        (lambda: membranes.moving_force(1.0, 1.0, 0.1, **(MOVING | {"speed": 0.0})), "^speed must"),
        (lambda: membranes.moving_force(1.0, 1.0, 0.1, **(MOVING | {"track": 2.5})), "^track must"),
        (lambda: membranes.moving_force(1.0, 1.0, 0.1, modes=(0, 5), **MOVING), "^modes must"),
        (lambda: membranes.moving_force(1.0, 1.0, np.inf, **MOVING), "^t must"),
    ],
)
def test_nonsense_is_refused(call: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        call()


def test_sides_that_are_no_pair_are_refused():
    with pytest.raises(ValueError, match=r"sides must have 2 numbers along its last axis, not the shape \(1,\)"):
        membranes.point_load(0.5, 0.5, at=(0.5, 0.5), force=1.0, sides=(1.0,), tension=1.0)
    with pytest.raises(ValueError, match="diameters must be a whole number"):
        membranes.circle_frequencies(radius=1.0, tension=1.0, mass=1.0, diameters=float("inf"))
