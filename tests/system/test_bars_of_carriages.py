"""Forces of bars, their dampers and the power that these take: kernels beside matrices, energy and rigid motions.

Sources: forces are derivatives of the energy; `Carriages.forces` and `.damping`, matrices that rest and step sizes are
found from; what turns as a whole is damped by nothing (rigid-body mechanics).
"""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.mechanics.compiled import filled_records
from ropewalk.system.loads import carriages as kernels
from ropewalk.system.loads.carriages import BAR, Carriages

WHEELS = ("mean", "_share", "_apart")  # what the two kernels call


@pytest.fixture(autouse=True)
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels as plain Python: a compiler would take longer than all that is asked of them here."""
    for name in WHEELS:
        function = getattr(kernels, name)
        monkeypatch.setattr(kernels, name, getattr(function, "py_func", function))


def plainly(name: str, *arguments: object) -> float:
    function = getattr(kernels, name)
    return getattr(function, "py_func", function)(*arguments)  # type: ignore[no-any-return]


def four_wheels_and_a_cabin(dim: int) -> tuple[Carriages, np.ndarray]:
    """Two rockers, the main one between their middles, and a hanger from that, whose damper acts against it.

    Wheels are particles 0 to 3, the cabin is particle 4; none is where it would be at rest.
    """
    bar = {"stiffness": 3e4, "damping": 70.0, "frame": -1}
    bars = filled_records(
        BAR,
        [
            {**bar, "upper": 0, "uppers": 1, "lower": 1, "lowers": 1, "length": 0.8},
            {**bar, "upper": 2, "uppers": 1, "lower": 3, "lowers": 1, "length": 0.7, "damping": 30.0},
            {**bar, "upper": 0, "uppers": 2, "lower": 2, "lowers": 2, "length": 2.1, "stiffness": 5e4},
            {**bar, "upper": 0, "uppers": 4, "lower": 4, "lowers": 1, "length": 4.0, "frame": 2, "turning": 600.0},
        ],
    )
    places = np.array([[0.0, 0.1, 0.0], [0.75, -0.1, 0.1], [1.9, 0.2, 0.3], [2.7, 0.0, 0.2], [1.9, 0.7, -3.8]])
    u = places[:, [0, 2]] if dim == 2 else places
    return Carriages.nothing()._replace(bars=bars.view(np.recarray), points=np.arange(5) * dim), u.ravel()


def kernel_forces(carriages: Carriages, u: np.ndarray, w: np.ndarray, dim: int) -> np.ndarray:
    f = np.zeros(u.size)
    plainly("add_bar_forces", carriages, u, w, f, dim)
    return f


@pytest.mark.parametrize("dim", [2, 3])
def test_bars_pull_by_the_derivatives_of_their_energy(dim: int) -> None:
    carriages, u = four_wheels_and_a_cabin(dim)
    found, e = kernel_forces(carriages, u, np.zeros(u.size), dim), 1e-6
    for way, unit in enumerate(np.eye(u.size)):
        slope = (carriages.energy(u + e * unit, dim) - carriages.energy(u - e * unit, dim)) / (2.0 * e)
        # Central differences of 1e4 N/m: 1e-6 N, and of rounding 1e-3 J 1e-16 / 1e-6 m.
        assert found[way] == pytest.approx(-slope, abs=1e-4)
        change = carriages.forces(u + e * unit, dim) - carriages.forces(u - e * unit, dim)
        assert carriages.stiffness(u, dim)[:, way] == pytest.approx(-change / (2.0 * e), abs=1e-3)
    assert np.abs(found).max() > 1e3


@pytest.mark.parametrize("dim", [2, 3])
def test_dampers_press_with_their_matrix_and_take_its_power(dim: int) -> None:
    carriages, u = four_wheels_and_a_cabin(dim)
    w, before = np.random.default_rng(1).normal(size=(2, u.size))
    damped = kernel_forces(carriages, u, w, dim) - kernel_forces(carriages, u, np.zeros(u.size), dim)
    matrix = carriages.damping(u, dim)
    assert damped == pytest.approx(-matrix @ w, rel=1e-12, abs=1e-9)
    kernel_forces(carriages, u, w, dim)
    assert plainly("taken_by_bars", carriages, w, w, dim) == pytest.approx(w @ matrix @ w, rel=1e-12)
    # Their force is that of the velocity behind a kick, their way that of the mean of both.
    assert plainly("taken_by_bars", carriages, w, before, dim) == pytest.approx(
        0.5 * (w + before) @ matrix @ w, rel=1e-12
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_what_moves_as_a_whole_is_damped_by_nothing_and_dampers_push_nothing_away(dim: int) -> None:
    """In space of turns that about the axis which both spans of the damper stand across: they know no spin."""
    carriages, u = four_wheels_and_a_cabin(dim)
    places, still = u.reshape(-1, dim), kernel_forces(carriages, u, np.zeros(u.size), dim)
    if dim == 3:
        rows = [carriages.row(bar, u.size, dim) @ u for bar in carriages.bars[2:]]
        turned = np.cross(np.cross(*rows), places)
    else:
        turned = np.stack([-places[:, 1], places[:, 0]], axis=1)
    damped = kernel_forces(carriages, u, np.random.default_rng(2).normal(size=u.size), dim) - still
    for motion in (turned, *(np.broadcast_to(axis, places.shape) for axis in np.eye(dim))):
        assert kernel_forces(carriages, u, motion.ravel(), dim) - still == pytest.approx(0.0, abs=1e-9)
        assert float(damped @ motion.ravel()) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("only", ["damping", "turning"])
def test_bounds_of_steps_hold(only: str) -> None:
    """The largest eigenvalues of M^-1 K and M^-1 C are no larger than what steps are chosen by."""
    carriages, u = four_wheels_and_a_cabin(2)
    carriages.bars["turning" if only == "damping" else "damping"] = 0.0
    inverse = np.diag(np.repeat(1.0 / np.array([40.0, 60.0, 50.0, 45.0, 900.0]), 2))
    bounds = carriages.bounds(inverse, 2)
    for bound, matrix in zip(bounds, (carriages.stiffness(u, 2), carriages.damping(u, 2)), strict=True):
        largest = float(np.linalg.eigvals(inverse @ matrix).real.max())
        # Not much more, either, which would cost steps: bars are bounded one by one.
        assert largest <= bound * (1.0 + 1e-12)
        assert bound < 4.0 * largest
