"""Implicit motion and spectra against exact solutions, orders of convergence and each other."""

from __future__ import annotations

import numpy as np
import pytest

from core_structures import bridge, rope
from ropewalk.engine import spectrum
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, SpringProperties
from ropewalk.engine.equilibrium import find_equilibrium
from ropewalk.engine.implicit import advance_implicitly
from ropewalk.errors import RopewalkError


def damped_spring(stiffness: float = 200.0) -> Bound:
    """A mass of 2 kg that begins 0.3 m below its equilibrium."""
    builder = Builder()
    top, bob = builder.add_node([0.0, 0.0], 0.0), builder.add_node([0.0, -1.3 - 2.0 * 9.81 / stiffness], 2.0)
    builder.fix(top)
    builder.add_spring(top, bob, SpringProperties(stiffness, 1.0, 4.0))
    return Bound(*builder.build())


def test_damped_spring_decays_as_exact_to_the_third_order() -> None:
    k, m, c, sag = 200.0, 2.0, 4.0, 2.0 * 9.81 / 200.0
    a, w = c / (2.0 * m), np.sqrt(k / m - (c / (2.0 * m)) ** 2)
    exact = -1.0 - sag - 0.3 * np.exp(-a * 2.0) * (np.cos(w * 2.0) + a / w * np.sin(w * 2.0))
    errors = []
    for steps in (200, 400, 800):
        bound = damped_spring()
        advance_implicitly(bound, steps, 2.0 / steps)
        errors.append(abs(bound.state.position[1, 1] - exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    print("implicit damped spring", errors, orders)
    assert np.all(np.abs(orders - 3.0) < 0.15)
    assert errors[-1] < 1e-7


def test_steps_that_resolve_nothing_lead_to_equilibrium() -> None:
    """100 s per step, where explicit steps may last 0.2 ms."""
    bound = damped_spring(1e8)
    assert advance_implicitly(bound, 5, 100.0).outcome == "done"
    assert bound.state.position[1, 1] == pytest.approx(-1.0 - 2.0 * 9.81 / 1e8, abs=1e-12)
    assert bound.state.time[0] == 500.0


def test_joined_structure_moves_as_in_small_explicit_steps() -> None:
    explicit = bridge(damping=30.0, ties=False)
    explicit.advance(4000, 1.25e-5)
    errors = []
    for steps in (20, 40):
        bound = bridge(damping=30.0, ties=False)
        bound.advance(10, 1.25e-4)  # velocities are behind positions then
        assert advance_implicitly(bound, steps, 0.04875 / steps).outcome == "done"
        np.testing.assert_array_equal(bound.state.position[:, 38], bound.state.position[:, 37])
        errors.append(float(np.abs(bound.state.position - explicit.state.position).max()))
    print("implicit bridge", errors)
    assert errors[1] < errors[0] / 4.0
    assert errors[1] < 2e-4  # m; hangers lengthen by 0.2 m


def test_held_node_moves_with_its_prescribed_velocity() -> None:
    bound = rope(6)
    bound.state.velocity[0, -1] = 0.25
    begin = bound.state.position[0, -1]
    advance_implicitly(bound, 4, 2.0**-6)
    assert bound.state.position[0, -1] == begin + 0.25 / 16.0


def test_loads_are_refused() -> None:
    with pytest.raises(RopewalkError, match="implicit steps do not move loads"):
        advance_implicitly(bridge(force=-5.0), 1, 0.1)


def test_lowest_modes_are_those_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    bound = bridge()
    find_equilibrium(bound)
    dense = spectrum.find_modes(bound, 5)
    monkeypatch.setattr(spectrum, "_DENSE", 10)
    np.testing.assert_allclose(spectrum.find_modes(bound, 5).squares, dense.squares, rtol=1e-8)
    K, M = bound.linearise().stiffness, np.zeros(bound.model.mobility.size)
    moves = bound.model.mobility.ravel() > 0.0
    M[moves] = 1.0 / bound.model.mobility.ravel()[moves]
    shapes = dense.shapes.reshape(5, -1)
    np.testing.assert_allclose(shapes @ (M[:, None] * shapes.T), np.eye(5), atol=1e-12)
    np.testing.assert_allclose(np.diag(shapes @ K @ shapes.T), dense.squares, rtol=1e-8)


def test_state_without_stability_has_a_negative_square() -> None:
    builder = Builder()
    foot, top = builder.add_node([0.0, 0.0], 0.0), builder.add_node([0.0, 0.9], 1.0)
    builder.fix(foot)
    builder.add_spring(foot, top, SpringProperties(98.1, 1.0))
    modes = spectrum.find_modes(Bound(*builder.build()), 2)
    assert modes.squares[0] == pytest.approx(-9.81 / 0.9)
    assert np.isnan(modes.frequencies[0])
