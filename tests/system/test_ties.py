"""Ties between points of lines, and between lines and the ground.

Sources: modes of a string with a spring at a station a, sin kL + (s / T k) sin ka sin k(L - a) = 0 (Meirovitch,
Fundamentals of Vibrations, 2001, by the same steps as a string with a point mass); two equal strings coupled by a
spring move together as if there were none, and against each other as if each had one of twice the stiffness.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.optimize import brentq

from ropewalk.model import Scenario
from ropewalk.system.elements.structure import Structure
from ropewalk.system.elements.ties import Point, Tie, ties_of
from ropewalk.system.equilibrium.rest import settle
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import LoadedStructure

Array = NDArray[np.float64]
T, RHO, L, EA = 1e4, 1.0, 20.0, 1e8
AT = 7.3  # m: no node is there on any of the meshes
SPRING = 4e3  # N/m: as stiff as 5 m of the string on both sides
UP, WITHOUT = np.array([0.0, 1.0]), (0.0, 0.0)


def strings(elements: int, count: int = 1) -> tuple[Structure, Array]:
    """Strings of 20 m one above the other, 1 m apart, without weight."""
    string = {"tension": T, "mass": RHO, "axial_stiffness": EA, "elements": elements}
    lines = {f"s{i}": {"start": [0.0, float(i)], "end": [L, float(i)], **string} for i in range(count)}
    run = {"kind": "dynamic", "until": 1.0}
    found = structure_of(Scenario.model_validate({"gravity": 0.0, "lines": lines, "run": run}), 0.0)
    return found.structure, found.near


def point(structure: Structure, line: int, at: float) -> Point:
    runs = structure.runs
    links = int(runs.links[line])
    return Point(int(runs.first[line]), links, float(runs.h[line]), at / L * links, T, float(runs.bending[line]))


def tied(structure: Structure, *ties: Tie) -> Structure:
    return structure._replace(ties=ties_of(ties, 2))


def spring(structure: Structure, stiffness: float = SPRING, **more: Any) -> Tie:
    """Between the first string and the ground, upright."""
    both = (stiffness, stiffness)
    return Tie(point(structure, 0, AT), np.array([AT, 0.0]), stiffness=both, way=UP, **more)


def potential_of(structure: Structure, r: Array) -> SystemPotential:
    return SystemPotential(structure, LoadedStructure(structure, r), L)


def frequencies(structure: Structure, r: Array, count: int) -> Array:
    """Of motion across, rad/s: waves along are a hundred times faster."""
    potential = potential_of(structure, r)
    K, M = potential.stiffness(r.ravel()).toarray(), potential.masses().toarray()
    return np.sqrt(eigh(0.5 * (K + K.T), M, eigvals_only=True, subset_by_index=[0, count - 1]))


def exact(stiffness: float, count: int) -> Array:
    """Of a string with a spring at its station, rad/s."""
    rho = RHO / (1.0 + T / EA)  # its mass is told per unstrained metre
    c = np.sqrt(T / rho)

    def miss(k: float) -> float:
        return float(np.sin(k * L) + stiffness / (T * k) * np.sin(k * AT) * np.sin(k * (L - AT)))

    grid = np.linspace(1e-3, (count + 1) * np.pi / L, 4001)
    values = np.array([miss(k) for k in grid])
    found = [brentq(miss, grid[i], grid[i + 1], xtol=1e-15) for i in np.flatnonzero(values[1:] * values[:-1] < 0.0)]
    return c * np.array(found[:count])


def orders(errors: list[float]) -> Array:
    found = np.log2(np.divide(errors[:-1], errors[1:]))
    print("errors", errors, "orders", found)
    return np.asarray(found)


@pytest.mark.parametrize("count", [1, 2])
def test_modes_of_strings_with_a_spring_are_exact_to_the_third_order(count: int) -> None:
    """The kink lies within a link, whose inertia it does not know."""
    errors = []
    for elements in (40, 80, 160):
        structure, r = strings(elements, count)
        if count == 1:
            wanted, tie = exact(SPRING, 4), spring(structure)
        else:
            tie = Tie(point(structure, 0, AT), point(structure, 1, AT), stiffness=(SPRING, SPRING), way=UP, length=1.0)
            wanted = np.sort(np.concatenate([exact(2.0 * SPRING, 4), exact(0.0, 4)]))[:6]
        found = frequencies(tied(structure, tie), r, wanted.size)
        errors.append(float(np.abs(found / wanted - 1.0).max()))
    assert errors[-1] < 1e-5
    assert orders(errors) == pytest.approx([3.0, 3.0], abs=0.5)


def turned() -> tuple[Structure, Array]:
    """Two strings with a dropper that leans, one that is slack, a damped spring and a constant force, out of rest."""
    structure, r = strings(24, 2)
    low, high = point(structure, 0, AT), point(structure, 1, AT + 0.6)
    tie = tied(
        structure,
        Tie(low, high, 1.0, (SPRING, 0.0), (30.0, 0.0)),
        Tie(point(structure, 0, 15.0), point(structure, 1, 15.0), 2.0, (SPRING, 0.0), (30.0, 0.0)),
        spring(structure, damping=(7.0, 7.0), preload=-20.0),
    )
    rng = np.random.default_rng(1)
    return tie, r + 1e-3 * rng.standard_normal(r.shape)


def test_forces_are_gradients_of_the_energy_and_stiffness_is_that_of_forces() -> None:
    """Those of ties: of all less those of the strings alone, which are ten thousand times stiffer."""
    structure, r = turned()
    both, step = (potential_of(structure, r), potential_of(structure._replace(ties=None), r)), 1e-4
    way = np.random.default_rng(2).standard_normal(both[0].free.shape[1])

    def of(what: str, far: float) -> Any:
        shape = r.ravel() + far * (both[0].free @ way)
        whole, alone = (getattr(potential, what)(shape) for potential in both)
        return whole - alone

    slope = (of("energy", step) - of("energy", -step)) / (2.0 * step)
    change = (of("out_of_balance", step) - of("out_of_balance", -step)) / (2.0 * step)
    K, F = of("stiffness", 0.0), of("out_of_balance", 0.0)
    # Differences are right to the square of the step over the length of a tie, 1e-8, and rounding of the strings.
    assert slope == pytest.approx(-float(F @ way), rel=1e-4)
    np.testing.assert_allclose(change, -(K @ way), rtol=0.0, atol=1e-4 * np.abs(K @ way).max())


def test_only_what_pulls_is_felt() -> None:
    """A slack dropper neither pulls nor damps; but where it would be felt is in the pattern of the stiffness."""
    structure, r = turned()
    ties = structure.ties
    assert ties is not None
    v = np.random.default_rng(3).standard_normal(r.shape)
    assert ties.forces(r, v)[1] == 0.0
    assert np.abs(ties.forces(r)[[0, 2]]).min() > 0.0
    loose = ties._replace(k=ties.k * [[1.0], [0.0], [1.0]], c=ties.c * [[1.0], [0.0], [1.0]])
    assert abs(ties.stiffness(r) - loose.stiffness(r)).max() == 0.0
    assert abs(ties.damping(r) - loose.damping(r)).max() == 0.0
    x = 15.0 / L * 24
    felt = int(structure.runs.first[0] + x), int(structure.runs.first[1] + x)
    n = structure.nodes.mass.size
    assert ties.neighbours(n)[n + felt[0], n + felt[1]] > 0.0
    assert ties.stiffness(r)[n + felt[0], n + felt[1]] == 0.0


def test_a_spring_bears_what_a_string_does_not_and_a_slack_one_nothing() -> None:
    """A force P elsewhere lifts the station by P G(a, b), and by P G(a, b) - N G(a, a) where a spring bears N."""
    P, b = 1.0, 12.0
    G, own = AT * (L - b) / (L * T), AT * (L - AT) / (L * T)
    for lifted in (1.0, -1.0):  # a dropper from above is shorter once the string is up
        structure, r = strings(50)
        force = structure.nodes.force.copy()
        force[1, int(structure.runs.first[0]) + 30] = lifted * P
        dropper = Tie(point(structure, 0, AT), np.array([AT, 10.0]), 10.0, (SPRING, 0.0))
        whole = tied(structure._replace(nodes=structure.nodes._replace(force=force)), dropper)
        assert whole.ties is not None
        pull = float(whole.ties.forces(settle(whole, r))[0])
        # The string stretches by a part of 1e-5 of its tension; what a node bears reaches a few links.
        assert pull == pytest.approx(0.0 if lifted > 0.0 else SPRING * P * G / (1.0 + SPRING * own), rel=1e-3)


def test_bounds_of_frequencies_hold() -> None:
    structure, r = turned()
    ties = structure.ties
    assert ties is not None
    bound, rate = (float(found.max()) for found in ties.bounds(structure.nodes.mass))
    mass = np.tile(structure.nodes.mass, 2)
    K, C = ((matrix.toarray() / np.sqrt(np.outer(mass, mass))) for matrix in (ties.stiffness(r), ties.damping(r)))
    largest, fastest = float(np.linalg.eigvalsh(K).max()), float(np.linalg.eigvalsh(C).max())
    assert largest <= bound < 4.0 * largest
    assert fastest <= rate < 4.0 * fastest
