"""Nets of the core: bands of equal springs between threads against exact solutions, other meshes and single springs."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray

from core_structures import net
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties, SpringProperties

Array = NDArray[np.float64]
SIDE, PULL, MASS = 10.0, 200.0, 0.5  # m; N/m and kg/m^2 of a membrane


def taut_net(cells: int, stretch: float = 1.001) -> Bound:
    """A flat square net that stands for a membrane, without weight, its rim held."""
    h = SIDE / cells
    EA = PULL * h / (stretch - 1.0)
    builder, link = Builder(3, gravity=0.0), SpringProperties(EA / h * stretch, h / stretch, tension_only=True)
    thread = RunProperties(h / stretch, 0.5 * MASS * h * stretch, EA, curved=False, tension_only=True)
    at, before = np.linspace(0.0, SIDE, cells + 1), -1
    for row in range(cells + 1):
        first, last = builder.add_run(np.array([at, np.full(cells + 1, at[row]), 0.0 * at]), thread)
        builder.fix(*(range(first, last + 1) if row in (0, cells) else (first, last)))
        for node in range(first + 1, last):  # threads across
            builder.add_mass(node, 0.5 * MASS * h * h)
        if row:
            builder.add_band(before + 1, first + 1, cells - 1, link)
        before = first
    return Bound(*builder.build())


def frequencies(bound: Bound) -> Array:
    """Frequencies of small motion across the plane of a net, rad/s, ascending."""
    free = np.flatnonzero(bound.model.mobility[2]) + 2 * bound.model.mobility.shape[1]
    root = np.sqrt(bound.model.mobility.ravel()[free])
    stiffness = bound.linearise().stiffness[free][:, free].toarray()
    return np.sqrt(scipy.linalg.eigvalsh(root[:, None] * stiffness * root))


def test_frequencies_of_a_taut_net_are_those_of_a_membrane_to_the_second_order() -> None:
    """Fletcher and Rossing, The Physics of Musical Instruments, 1998, eq. 3.9: modes (1,1), (1,2), (2,1), (2,2)."""
    modes = np.sqrt(np.array([2.0, 5.0, 5.0, 8.0]))
    exact, errors = np.pi / SIDE * np.sqrt(PULL / MASS) * modes, list[Array]()
    for cells in (8, 16, 32):
        found = frequencies(taut_net(cells))[:4]
        errors.append(np.abs(found / exact - 1.0))
        # of the net itself, exactly: a sine of each thread
        part = np.sin(0.5 * np.pi * np.array([[1, 1], [1, 2], [2, 1], [2, 2]]) / cells) ** 2
        np.testing.assert_allclose(found, 2.0 * np.sqrt(PULL / MASS) * cells / SIDE * np.sqrt(part.sum(axis=1)), 1e-10)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    print("membrane", errors[-1], orders)
    assert np.all(np.abs(orders - 2.0) < 0.02)
    assert errors[-1].max() < 2e-3


def test_taut_net_swings_in_its_mode() -> None:
    bound, cells, dt, count = taut_net(24, 1.05), 24, 1e-3, 1400
    w = 2.0 * np.sqrt(2.0 * PULL / MASS) * cells / SIDE * np.sin(0.5 * np.pi / cells)
    x, y, _ = bound.state.position
    shape = 1e-4 * np.sin(np.pi * x / SIDE) * np.sin(np.pi * y / SIDE)
    bound.state.position[2] = shape
    bound.advance(count, dt)
    part = float(bound.state.position[2] @ shape / (shape @ shape))
    # nearly two periods; the step changes the frequency by (w dt)^2/24
    assert part == pytest.approx(np.cos(w * count * dt), abs=1e-4)


def test_momentum_of_a_free_damped_net_is_kept_to_rounding() -> None:
    bound, draw = net((9, 6), damping=3.0, free=True), np.random.default_rng(1)
    bound.state.velocity[:] = draw.normal(size=bound.state.velocity.shape)
    bound.state.predicted[:] = bound.state.velocity
    masses = 1.0 / bound.model.mobility[0]

    def momenta() -> Array:
        x, p = bound.state.position, bound.state.velocity * masses
        return np.concatenate([p.sum(axis=1), np.cross(x.T, p.T).sum(axis=0)])

    bound.advance(1, 1e-3)
    begin, kinetic = momenta(), bound.kinetic_energy()
    bound.advance(2000, 1e-3)
    size = np.abs(bound.state.velocity * masses).sum()
    np.testing.assert_allclose(momenta(), begin, rtol=0, atol=1e-11 * size)  # 10 m from the origin
    assert bound.kinetic_energy() < 0.7 * kinetic


def test_threads_across_are_as_those_along() -> None:
    """A net with its rows along x, and the same net with its rows along y, from a bent state without symmetry."""
    bent, found = 0.05 * np.random.default_rng(2).normal(size=(3, 9, 9)), list[Array]()
    bent[:, [0, -1]] = bent[:, :, [0, -1]] = 0.0

    def turned(of: Array) -> Array:
        return of[[1, 0, 2]].transpose(0, 2, 1)

    for view in (np.copy, turned):
        bound = net((8, 8), damping=2.0)
        positions = bound.state.position.reshape(3, 9, 9)
        positions += view(bent)
        bound.advance(500, 1e-3)
        found.append(view(positions))
    assert np.abs(found[0] - turned(found[0])).max() > 0.05
    np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-10)  # rounding differs where sums do


def test_a_band_is_so_many_springs() -> None:
    found = []
    for by_bands in (True, False):
        builder = Builder(3)
        ends = list[tuple[int, int]]()
        for y, curved in ((0.0, True), (1.0, False)):
            points = np.array([np.arange(8.0), np.full(8, y), 0.1 * np.arange(8.0)])
            ends.append(builder.add_run(points, RunProperties(1.0, 0.3, 900.0, 2.0, curved=curved)))
        a, b = ends
        builder.fix(*a)
        spring = SpringProperties(300.0, 0.9, 2.0, tension_only=True)
        if by_bands:
            builder.add_band(b[0], a[0] + 1, 7, spring)
        else:
            for k in range(7):
                builder.add_spring(b[0] + k, a[0] + 1 + k, spring)
        bound = Bound(*builder.build())
        bound.advance(600, 1e-3)
        found.append((bound.state.position.copy(), sum(bound.potentials()), bound.forces()))
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-10 * np.abs(other).max())
