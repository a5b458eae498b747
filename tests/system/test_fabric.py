"""Fabrics: energy, forces and stiffness belong together, taut, wrinkled and slack; they pull and never push."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from net_cases import membrane, net, scenario
from ropewalk.mechanics.chain import Array
from ropewalk.system.elements.cells import SHEET, Cells
from ropewalk.system.elements.membrane_elements import tensions_of
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import LoadedStructure

NU, ET, EA = 0.3, 1e5, 1e4
SIZE = 0.75  # m, of the cells
STATES = {  # principal stretches in the plan
    "taut": (1.03, 1.02),
    "wrinkled": (1.03, 0.97),
    "slack": (0.98, 0.96),
}


class Loose:
    """A fabric that nothing holds; places and forces are (node, 3)."""

    def __init__(self, structure: Structure) -> None:
        restrained = structure.restraints
        free = np.tile(np.eye(3), (restrained.mass.size, 1, 1))
        structure = structure._replace(restraints=restrained._replace(free=free, stiffness=0.0 * free))
        assert structure.surfaces is not None
        self.cells: Cells = structure.surfaces.cells
        self.nodes = structure.nodes.mass.size
        self._potential = SystemPotential(structure, LoadedStructure(structure, np.zeros((3, self.nodes))), 1.0)

    def stored(self, r: Array) -> float:
        return self._potential.stored(r.T.ravel())

    def pull(self, r: Array) -> Array:
        return np.asarray(self._potential.forces(r.T.ravel())).reshape(3, -1).T

    def stiffness(self, r: Array) -> Array:
        """(place, place), axis by axis."""
        free = self._potential.free
        return np.asarray((free @ self._potential.stiffness(r.T.ravel()) @ free.T).todense())


def loose(kind: str) -> Loose:
    """Four cells of a fabric that nothing holds, without tension as laid out."""
    if kind == "sheet":
        sides = [[2.0 * SIZE, 0.0, 0.0], [0.3, SIZE, 0.0]]
        sheet = membrane([2, 1], sides=sides, tension=None, poisson=NU, stiffness=ET)
    else:
        sheet = net([2, 1], sides=[[2.0 * SIZE, 0.0, 0.0], [0.0, SIZE, 0.0]], tension=None, axial_stiffness=EA)
    return Loose(structure_of(scenario(sheet), 0.0).structure)


def plan_of(network: Loose) -> Array:
    """Places of all nodes as laid out, (node, 2) m: three along x, twice."""
    skew = 0.3 if network.cells.fabrics[0, 0] == SHEET else 0.0
    i, j = np.tile(np.arange(3), 2), np.repeat(np.arange(2), 3)
    return np.stack([SIZE * i + skew * j, SIZE * j], axis=1)


def places(
    network: Loose, stretches: tuple[float, float], angle: float, turn: Array, disturbed: Array | float = 0.0
) -> Array:
    """All nodes after a stretch along two axes at an angle, a turn in space, and small changes of each."""
    c, s = np.cos(angle), np.sin(angle)
    axes = np.array([[c, s], [-s, c]])
    plan = plan_of(network) @ (axes.T @ np.diag(stretches) @ axes)
    flat = np.column_stack([plan, np.zeros(network.nodes)]) + disturbed
    away = np.array([1.0, -2.0, 3.0])
    return np.asarray(Rotation.from_rotvec(turn).apply(flat) + away)


def turns():
    return st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(np.array)


def states():
    """A kind of fabric, principal stretches and the angle of the first; threads are stretched along themselves."""
    membranes = st.tuples(st.just("sheet"), st.sampled_from(list(STATES.values())), st.floats(0.0, 3.1))
    return st.one_of(membranes, st.tuples(st.just("threads"), st.sampled_from(list(STATES.values())), st.just(0.0)))


def noise(network: Loose, seed: int, size: float) -> Array:
    return size * np.random.default_rng(seed).standard_normal((network.nodes, 3))


@given(states(), turns(), st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_forces_are_the_slope_of_the_energy_and_the_stiffness_is_theirs(state, turn, seed) -> None:
    kind, stretches, angle = state
    network = loose(kind)
    r = places(network, stretches, angle, turn, noise(network, seed, 5e-4 * SIZE))
    potential, way = network, noise(network, seed + 1, 1.0)
    h = 1e-6
    rise = (potential.stored(r + h * way) - potential.stored(r - h * way)) / (2.0 * h)
    # Forces are up to 3e3 N; the energies of 1e2 J leave 1e-14/1e-6 of themselves in the difference.
    assert rise == pytest.approx(-(potential.pull(r) * way).sum(), abs=1e-4)
    change = -(potential.pull(r + h * way) - potential.pull(r - h * way)).T.ravel() / (2.0 * h)
    K = potential.stiffness(r)
    # Curvature: stresses of 3e3 N/m leave third derivatives of some 1e6/h^2 times the square of the difference.
    assert change == pytest.approx(K @ way.T.ravel(), abs=3e-3)
    assert abs(K - K.T).max() <= 1e-9 * ET  # roundings of sums of a dozen terms


@given(states(), turns(), st.integers(0, 1000))
@settings(max_examples=10, deadline=None)
def test_what_turns_as_a_whole_stores_the_same_and_pulls_along(state, turn, seed) -> None:
    kind, stretches, angle = state
    network = loose(kind)
    potential, disturbed = network, noise(network, seed, 2e-3 * SIZE)
    r = places(network, stretches, angle, np.zeros(3), disturbed)
    turned = places(network, stretches, angle, turn, disturbed)
    assert potential.stored(turned) == pytest.approx(potential.stored(r), rel=1e-9, abs=1e-12)
    # Roundings of places of 3 m over cells of 0.75 m, times stiffnesses of 1e5 N/m.
    assert potential.pull(turned) == pytest.approx(Rotation.from_rotvec(turn).apply(potential.pull(r)), abs=1e-8)


def test_a_slack_fabric_pulls_nowhere() -> None:
    for kind in ("sheet", "threads"):
        network = loose(kind)
        r = places(network, STATES["slack"], 0.0, np.zeros(3))
        assert network.stored(r) == 0.0
        assert not network.pull(r).any()


def sheet_tensions(F: Array) -> Array:
    network = loose("sheet")
    r = np.column_stack([plan_of(network) @ F.T, np.zeros(network.nodes)])
    found = tensions_of(network.cells, network.cells.area.size, r.T[None])[0]
    # Every cell is deformed alike.
    assert found == pytest.approx(np.broadcast_to(found[0], found.shape), abs=1e-8)
    return np.asarray(found[0])


def test_threads_have_the_tension_of_their_own_stretch() -> None:
    network = loose("threads")
    r = places(network, (1.02, 0.99), 0.0, np.zeros(3))
    # Each of the three threads across stands for a width of SIZE, as does each of the two along.
    assert tensions_of(network.cells, network.cells.area.size, r.T[None])[0] == pytest.approx(
        np.tile([EA * 0.02 / SIZE, 0.0], (network.cells.area.size, 1)), abs=1e-8
    )


def test_a_prestressed_sheet_wrinkles_at_the_shear_that_takes_all_its_tension_in_one_direction() -> None:
    stretch = 1.01
    e0 = 0.5 * (stretch**2 - 1.0)
    # Green strains e0 +- half the shear; the second is -nu times the first at this shear.
    limit = 2.0 * e0 * (1.0 + NU) / (1.0 - NU)

    def sheared(gamma: float) -> Array:
        C = np.array([[1.0 + 2.0 * e0, gamma], [gamma, 1.0 + 2.0 * e0]])
        values, axes = np.linalg.eigh(C)
        return sheet_tensions(axes @ np.diag(np.sqrt(values)) @ axes.T)

    below, at, beyond = (sheared(gamma * limit) for gamma in (0.999, 1.0 + 1e-12, 1.3))
    assert below[1] > 0.0
    assert at[1] == beyond[1] == 0.0
    assert sheared((1.0 - 1e-6) * limit) == pytest.approx(at, abs=1e-5 * ET * e0)  # no jump
    e1 = e0 + 0.65 * limit
    # The tension field, per width of a sheet that is free to narrow.
    assert beyond[0] == pytest.approx(ET * e1 * np.sqrt((1.0 + 2.0 * e1) / (1.0 - 2.0 * NU * e1)), rel=1e-12)


def test_a_strip_that_is_pulled_narrows_by_poissons_ratio_and_is_not_pushed_below() -> None:
    along = 1.02
    e = 0.5 * (along**2 - 1.0)
    natural = np.sqrt(1.0 - 2.0 * NU * e)
    for width, pulls in ((1.0, True), (natural + 1e-6, True), (natural - 1e-9, False), (0.5, False)):
        first, second = sheet_tensions(np.diag([along, width]))
        assert (second > 0.0) == pulls
        assert second >= 0.0
        if not pulls:
            assert first == pytest.approx(ET * e * along / natural, rel=1e-9)  # uniaxial, whatever the width


def test_a_sheet_pulled_evenly_has_the_biaxial_stiffness() -> None:
    stretch = 1.015
    e = 0.5 * (stretch**2 - 1.0)
    assert sheet_tensions(stretch * np.eye(2)) == pytest.approx(np.full(2, ET / (1.0 - NU) * e), rel=1e-12)
