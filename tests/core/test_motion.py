"""Motions of the core against exact solutions, conserved quantities and orders of convergence."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from core_structures import bridge, net, rope, tripod
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties, SpringProperties

Array = NDArray[np.float64]


SMOOTH: list[Callable[[], Bound]] = [
    rope, lambda: bridge(ties=False), lambda: tripod(ties=False), lambda: rope(axes=3),
    lambda: net(pull=200.0),
    lambda: bridge(3, 30.0, ties=False), lambda: tripod(3, 5.0, ties=False),
]  # fmt: skip
"""Structures without kinks of forces; the last two are damped."""


def pendulum(spring: SpringProperties, at: tuple[float, float], mass: float = 2.0) -> Bound:
    """A mass on a spring that hangs at the origin."""
    builder = Builder()
    top, bob = builder.add_node([0.0, 0.0], 0.0), builder.add_node(at, mass)
    builder.fix(top)
    builder.add_spring(top, bob, spring)
    return Bound(*builder.build())


def taut_string(links: int, EI: float = 0.0, curved: bool = True, EA: float = 1e9) -> Bound:
    """A string of 10 m, 0.5 kg/m, under 1000 N, without weight."""
    length, stretch = 10.0, 1.0 + 1000.0 / EA
    run = RunProperties(length / links / stretch, 0.5 * stretch, EA, 0.0, EI, curved=curved)
    builder = Builder(gravity=0.0)
    builder.fix(*builder.add_run(np.array([np.linspace(0.0, length, links + 1), np.zeros(links + 1)]), run))
    return Bound(*builder.build())


def frequencies(bound: Bound) -> Array:
    """Frequencies of small transverse motion of a straight line, rad/s, ascending."""
    inside = np.arange(bound.model.sizes["NODES"] + 1, bound.model.mobility.size - 1)
    root = np.sqrt(bound.model.mobility.ravel()[inside])
    stiffness = bound.linearise().stiffness[inside][:, inside].toarray()
    return np.sqrt(scipy.linalg.eigvalsh(root[:, None] * stiffness * root))


def after(make: Callable[[], Bound], time: float, steps: int) -> Bound:
    bound = make()
    bound.advance(steps, time / steps)
    return bound


def observed_order(make: Callable[[], Bound], time: float, steps: int) -> float:
    """Order of positions in the step, from three steps."""
    x = [after(make, time, steps * factor).state.position for factor in (1, 2, 4)]
    return float(np.log2(np.linalg.norm(x[0] - x[1]) / np.linalg.norm(x[1] - x[2])))


def test_mass_on_a_spring_moves_as_verlets_method_solves_it_exactly() -> None:
    """x = A cos(w' t) about the sag with sin(w' dt/2) = w dt/2."""
    k, m, g, dt, count = 200.0, 2.0, 9.81, 0.01, 1000
    sag, amplitude = 1.0 + m * g / k, 0.3
    bound = pendulum(SpringProperties(k, 1.0), (0.0, -sag - amplitude))
    bound.advance(count, dt)
    w = 2.0 / dt * np.arcsin(0.5 * dt * np.sqrt(k / m))
    # rounding adds up over 1000 steps
    assert bound.state.position[1, 1] == pytest.approx(-sag - amplitude * np.cos(w * count * dt), abs=1e-11)


def test_spring_pendulum_follows_its_equations_to_the_second_order() -> None:
    k, m, length = 200.0, 2.0, 1.0

    def rates(_: float, y: Array) -> Array:
        r, v = y[:2], y[2:]
        size = np.hypot(*r)
        return np.concatenate([v, -k / m * (size - length) * r / size - [0.0, 9.81]])

    exact = solve_ivp(rates, (0.0, 2.0), [0.9, -0.7, 0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-12).y[:2, -1]
    errors = [
        float(
            np.linalg.norm(
                after(lambda: pendulum(SpringProperties(k, length), (0.9, -0.7)), 2.0, n).state.position[:, 1] - exact
            )
        )
        for n in (400, 800, 1600)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    print("spring pendulum", errors, orders)
    assert np.all(np.abs(orders - 2.0) < 0.03)
    assert errors[-1] < 1e-4


def test_damped_spring_decays_as_exact_to_the_second_order() -> None:
    k, m, c, sag = 200.0, 2.0, 4.0, 2.0 * 9.81 / 200.0
    a, w = c / (2.0 * m), np.sqrt(k / m - (c / (2.0 * m)) ** 2)
    exact = -1.0 - sag - 0.3 * np.exp(-a * 2.0) * (np.cos(w * 2.0) + a / w * np.sin(w * 2.0))
    errors = [
        abs(
            after(lambda: pendulum(SpringProperties(k, 1.0, c), (0.0, -1.3 - sag)), 2.0, n).state.position[1, 1] - exact
        )
        for n in (400, 800, 1600)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    print("damped spring", errors, orders)
    assert np.all(np.abs(orders - 2.0) < 0.05)
    assert errors[-1] < 1e-5


@pytest.mark.parametrize(("curved", "order"), [(True, 4.0), (False, 2.0)])
def test_frequencies_of_a_taut_string_converge(curved: bool, order: float) -> None:
    exact = 3.0 * np.pi / 10.0 * np.sqrt(1000.0 / 0.5)
    errors = [abs(frequencies(taut_string(n, curved=curved))[2] / exact - 1.0) for n in (40, 80, 160)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    print("taut string", errors, orders)
    assert np.all(np.abs(orders - order) < 0.05)
    assert errors[-1] < (3e-6 if curved else 1e-3)


def test_frequencies_of_a_stiff_string_converge_to_the_fourth_order() -> None:
    wave, EI = 3.0 * np.pi / 10.0, 400.0
    # curvature counts on unstrained length, which is shorter by 1e-6
    exact = wave * np.sqrt((1000.0 + EI * (1.0 + 1e-6) ** 3 * wave**2) / 0.5)
    errors = [abs(frequencies(taut_string(n, EI))[2] / exact - 1.0) for n in (40, 80, 160)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    print("stiff string", errors, orders)
    assert np.all(np.abs(orders - 4.0) < 0.05)


def test_taut_string_swings_with_its_frequency() -> None:
    bound = taut_string(40, EA=1e5)
    w, dt, count = np.pi / 10.0 * np.sqrt(1000.0 / 0.5), 1e-4, 4500
    shape = 1e-5 * np.sin(np.pi * bound.state.position[0] / 10.0)
    bound.state.position[1] = shape
    bound.advance(count, dt)
    part = float(bound.state.position[1] @ shape / (shape @ shape))
    assert part == pytest.approx(
        np.cos(w * count * dt), abs=1e-4
    )  # two periods; 1e-6 of the frequency is mesh and step


@pytest.mark.parametrize("make", SMOOTH)
def test_positions_are_of_the_second_order_in_the_step(make: Callable[[], Bound]) -> None:
    order = observed_order(make, 0.05, 160)
    print("order in the step", order)
    assert abs(order - 2.0) < 0.02


def test_velocities_are_at_the_instant_of_the_positions() -> None:
    """Of the second order; half a step behind they would be of the first."""
    v = [after(SMOOTH[1], 0.05, n).velocities() for n in (160, 320, 640)]
    order = np.log2(np.linalg.norm(v[0] - v[1]) / np.linalg.norm(v[1] - v[2]))
    assert abs(order - 2.0) < 0.05


@pytest.mark.parametrize("make", SMOOTH[:5])
def test_energy_is_kept_to_the_second_order_without_drift(make: Callable[[], Bound]) -> None:
    largest = []
    for factor in (1, 2):
        bound = make()
        begin, missing, scale = sum(bound.potentials()), 0.0, 0.0
        for _ in range(60):
            bound.advance(5 * factor, 4e-4 / factor)
            kinetic = bound.kinetic_energy()
            missing, scale = max(missing, abs(kinetic + sum(bound.potentials()) - begin)), max(scale, kinetic)
        largest.append(missing / scale)
    print("energy", largest)
    assert largest[0] / largest[1] == pytest.approx(4.0, rel=0.1)
    assert largest[1] < 2e-3


def test_verlets_energy_of_a_spring_is_kept_to_rounding() -> None:
    """m v^2/2 + k x(t) x(t + dt)/2, v in between, x from the sag."""
    k, m, dt, sag = 200.0, 2.0, 0.02, 1.0 + 2.0 * 9.81 / 200.0
    bound = pendulum(SpringProperties(k, 1.0), (0.0, -sag - 0.3))
    found = []
    for _ in range(500):
        before = bound.state.position[1, 1] + sag
        bound.advance(1, dt)
        found.append(0.5 * m * bound.state.velocity[1, 1] ** 2 + 0.5 * k * before * (bound.state.position[1, 1] + sag))
    assert np.ptp(found) < 1e-13 * 500


@pytest.mark.parametrize("axes", [2, 3])
def test_momentum_of_a_free_line_is_kept_to_rounding(axes: int) -> None:
    """Linear and angular momentum of two joined stiff damped lines and springs in free flight."""
    builder, draw = Builder(axes, gravity=0.0), np.random.default_rng(4)
    lines = [
        builder.add_run(draw.normal(size=(axes, n + 1)), RunProperties(0.3, 1.0, 300.0, 0.1, 2.0)) for n in (9, 140)
    ]
    builder.join(lines[1][0], lines[0][1])
    builder.add_spring(2, 33, SpringProperties(50.0, 0.5, 0.2))
    bound = Bound(*builder.build())
    moves = bound.model.mobility[0] > 0.0
    masses = 1.0 / bound.model.mobility[0, moves]

    def momenta(position: Array, velocity: Array) -> Array:
        x, p = position[:, moves], velocity[:, moves] * masses
        turn = x[:, None] * p[None] - p[:, None] * x[None]
        return np.concatenate([p.sum(axis=1), turn.sum(axis=2).ravel()])

    bound.advance(1, 1e-3)
    begin = momenta(bound.state.position, bound.state.velocity)
    bound.advance(2000, 1e-3)
    end = momenta(bound.state.position, bound.state.velocity)
    size = np.abs(bound.state.velocity[:, moves] * masses).sum()
    np.testing.assert_allclose(end, begin, rtol=0, atol=1e-12 * size)


def test_joints_and_springs_are_the_links_of_one_line() -> None:
    """Straight links as one run, as runs joined at any node, and as springs."""
    points = np.array([np.linspace(0.0, 9.9, 21), np.zeros(21)])
    run = RunProperties(0.5, 1.0, 1e4, 20.0, tension_only=True, curved=False)
    found = []
    for cuts in ((0, 20), (0, 1, 7, 20), tuple(range(21))):
        builder, ends = Builder(), list[int]()
        pieces = [builder.add_run(points[:, a : b + 1], run) for a, b in itertools.pairwise(cuts)]
        for before, behind in itertools.pairwise(pieces):
            builder.join(behind[0], before[1])
            ends.append(behind[0])
        builder.fix(pieces[0][0], pieces[-1][1])
        bound = Bound(*builder.build())
        bound.advance(800, 1e-3)
        found.append(np.delete(bound.state.position, ends, axis=1))
    builder = Builder()
    nodes = [builder.add_node(point, 0.5) for point in points.T]
    builder.fix(nodes[0], nodes[-1])
    for a, b in itertools.pairwise(nodes):
        builder.add_spring(a, b, SpringProperties(1e4 / 0.5, 0.5, 20.0 / 0.5, tension_only=True))
    bound = Bound(*builder.build())
    bound.advance(800, 1e-3)
    assert bound.state.position[1].min() < -0.5
    for each in (*found[1:], bound.state.position):
        np.testing.assert_allclose(each, found[0], rtol=0, atol=1e-10)  # rounding differs where sums do


def test_held_node_moves_with_its_prescribed_velocity() -> None:
    bound = rope()
    bound.state.velocity[0, -1] = 0.25
    begin = bound.state.position[0, -1]
    bound.advance(64, 2.0**-10)
    assert bound.state.position[0, -1] == begin + 0.25 / 16.0
    assert bound.state.velocity[0, -1] == 0.25


def test_step_may_change_on_the_way() -> None:
    """Of the second order, as with one step: velocities are kicked from where they are."""

    def changing(factor: int) -> Array:
        bound = SMOOTH[1]()
        for part in range(8):
            steps = 10 * factor * (1 + part % 2)
            bound.advance(steps, 0.006 / steps)
        return bound.state.position

    x = [changing(factor) for factor in (1, 2, 4)]
    assert abs(np.log2(np.linalg.norm(x[0] - x[1]) / np.linalg.norm(x[1] - x[2])) - 2.0) < 0.05
