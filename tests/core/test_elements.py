"""Elements of the core: derivatives, potentials, and the same forces in steps as in sums."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from core_structures import STRUCTURES, rope
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import RunProperties

Array = NDArray[np.float64]
KINDS = pytest.mark.parametrize("kind", STRUCTURES)
APART = pytest.mark.parametrize("kind", [k for k in STRUCTURES if "share" not in k and "collector" not in k])
"""Contacts that share links have exact forces; in K each sees the kinks of the others as constant, and collectors stay
at their places."""


def shaken(kind: str) -> tuple[Bound, Array]:
    """A structure with positions and velocities at random; copies are where their originals are."""
    bound, draw = STRUCTURES[kind](), np.random.default_rng(1)
    bound.state.position[:] += 0.02 * draw.normal(size=bound.state.position.shape)
    velocities = draw.normal(size=bound.state.position.shape)
    for each in (bound.state.position, velocities):
        each[:, bound.model.joint_copy] = each[:, bound.model.joint_original]
    return bound, velocities


@APART
def test_stiffness_and_damping_are_difference_quotients_of_forces(kind: str) -> None:
    bound, velocities = shaken(kind)
    at, position = bound.linearise(velocities), bound.state.position
    np.testing.assert_allclose(at.forces, bound.forces(velocities), rtol=0, atol=1e-12 * np.abs(at.forces).max())
    draw, step = np.random.default_rng(2), 1e-6
    for array, matrix in ((position, at.stiffness), (velocities, at.damping)):
        kept, way = array.copy(), draw.normal(size=array.shape)
        sides = []
        for sign in (1.0, -1.0):
            array[:] = kept + sign * step * way
            sides.append(bound.forces(velocities))
        array[:] = kept
        quotient = -(sides[0] - sides[1]).ravel() / (2.0 * step)
        expected = matrix @ way.ravel()  # differences of forces of 1e4 N leave 1e-6 of them
        np.testing.assert_allclose(quotient, expected, rtol=0, atol=2e-8 * abs(at.stiffness).max())


@pytest.mark.parametrize("kind", [k for k in STRUCTURES if "collector" not in k])
def test_forces_are_the_gradient_of_the_energy(kind: str) -> None:
    bound, _ = shaken(kind)
    bound.state.contact_speed[:] = 0.0
    forces, position, step = bound.forces(), bound.state.position, 1e-6
    way = np.random.default_rng(3).normal(size=position.shape)
    kept, sides = position.copy(), []
    for sign in (1.0, -1.0):
        position[:] = kept + sign * step * way
        sides.append(sum(bound.potentials()))
    assert (sides[1] - sides[0]) / (2.0 * step) == pytest.approx(float(np.sum(forces * way)), rel=1e-7)


@APART
def test_matrices_are_symmetric_and_damping_takes_energy(kind: str) -> None:
    bound, velocities = shaken(kind)
    bound.state.contact_speed[:] = 0.0  # what makes a moving kink softer has no potential
    at = bound.linearise()
    assert abs(at.stiffness - at.stiffness.T).max() <= 1e-12 * abs(at.stiffness).max()
    assert abs(at.damping - at.damping.T).max() <= 1e-12 * abs(at.damping).max()
    power = velocities.ravel() @ (at.damping @ velocities.ravel())
    assert power > 0.0 if bound.model.sizes["VISCOUS"] else power == 0.0


def assert_step_feels_forces(bound: Bound, velocities: Array) -> None:
    """Compare the kick of a first step with the forces of all elements at the same positions and velocities."""
    state, model, dt = bound.state, bound.model, 1e-3
    state.velocity[:] = velocities * (model.mobility > 0.0)
    state.velocity[:, model.joint_copy] = state.velocity[:, model.joint_original]
    before = state.velocity.copy()
    state.predicted[:] = before[:, : state.predicted.shape[1]]
    forces = bound.forces(before)
    np.add.at(forces, (slice(None), model.joint_original), forces[:, model.joint_copy])
    bound.advance(1, dt)
    gain = 0.5 * dt * model.mobility * forces
    gain[:, model.joint_copy] = gain[:, model.joint_original]
    np.testing.assert_allclose(state.velocity - before, gain, rtol=0, atol=1e-11 * np.abs(gain).max())
    if model.sizes["VISCOUS"]:
        kept = np.full(model.mobility.shape[1], True)  # nothing reads it inside of runs without dampers
        for first, links, damped in zip(state.run_first, state.run_links, bound.work.run_damped, strict=True):
            kept[first + 1 : first + links] = damped
        gain, ahead = gain[:, kept], (state.predicted - before)[:, kept]
        np.testing.assert_allclose(ahead, 2.0 * gain, rtol=0, atol=1e-11 * np.abs(gain).max())


@KINDS
def test_a_step_feels_the_forces_of_the_elements(kind: str) -> None:
    assert_step_feels_forces(*shaken(kind))


@pytest.mark.parametrize("links", [1, 2, 3, 5, 7, 8, 9, 126, 127, 128, 129, 130, 131, 255, 256, 257, 258])
@pytest.mark.parametrize(("curved", "taut"), [(True, False), (False, False), (False, True)])
@pytest.mark.parametrize("EI", [0.0, 2.0])
def test_runs_end_anywhere_in_a_block(links: int, curved: bool, taut: bool, EI: float) -> None:
    damping = 0.0 if taut else 20.0
    run = RunProperties(0.5, 1.0, 1e4, damping, EI, curved=curved, tension=300.0, taut=taut)
    bound, draw = rope(links, run=run), np.random.default_rng(links)
    bound.state.position[:] += 0.02 * draw.normal(size=bound.state.position.shape)
    bound.work.memory.flags.writeable = True
    bound.work._views()["scratch"][:] = np.nan  # nothing of it is used that has not been computed
    assert_step_feels_forces(bound, draw.normal(size=bound.state.position.shape))


def test_links_that_do_not_push_are_without_force_when_slack() -> None:
    for curved in (False, True):
        bound = rope(run=RunProperties(0.5, 1.0, 1e4, 20.0, tension_only=True, curved=curved))
        bound.state.position[:] *= 0.5
        assert not np.any(bound.forces(np.ones(bound.state.position.shape)) - bound.model.weight)
        assert bound.potentials().elastic == 0.0


def test_energy_of_a_bent_run_is_that_of_a_beam() -> None:
    """A circle of radius R: EI L/(2 R^2), but for what the ends, which are hinged, do not bend."""
    found = []
    for links in (50, 100):
        angle = np.linspace(0.0, 1.0, links + 1)
        chord = 2.0 * 10.0 * np.sin(0.5 / links)
        bound = rope(links, run=RunProperties(chord, 1.0, 0.0, 0.0, 5e3))
        bound.state.position[:] = 10.0 * np.array([np.sin(angle), np.cos(angle)])
        found.append(bound.potentials().elastic / (5e3 * 10.0 / (2.0 * 10.0**2)) - 1.0)
    assert found[0] / found[1] == pytest.approx(2.0, rel=0.05)  # the share of the ends halves with the mesh
    assert abs(found[1]) < 2.0 / 100


def test_length_of_a_curved_link_is_that_of_its_arc() -> None:
    """On a circle the unstrained arc has no tension to the fourth order of the mesh."""
    strains = []
    for links in (8, 16):
        angle = np.linspace(0.0, 1.0, links + 1)
        bound = rope(links, run=RunProperties(10.0 / links, 1.0, 1.0))
        bound.state.position[:] = 10.0 * np.array([np.sin(angle), np.cos(angle)])
        tension = (bound.forces() - bound.model.weight)[:, links // 2 + 1 :].sum(
            axis=1
        )  # on one half: of the link in the middle
        strains.append(float(np.hypot(*tension)))
    assert strains[0] / strains[1] == pytest.approx(16.0, rel=0.05)
