"""Springs with free play: equilibrium, frequencies, motion and implicit steps, all from their force alone."""

from __future__ import annotations

import numpy as np
import pytest

from core_structures import loose
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, FreePlayProperties
from ropewalk.engine.equilibrium import find_equilibrium
from ropewalk.engine.implicit import advance_implicitly
from ropewalk.engine.spectrum import find_modes
from ropewalk.errors import RopewalkError

STIFFNESS, MASS, SHORTEST, WIDTH = 200.0, 2.0, 1.0, 0.2
PLAY = FreePlayProperties(STIFFNESS, SHORTEST, WIDTH)


def bob(height: float, gravity: float = 9.81, play: FreePlayProperties = PLAY, axes: tuple[int, ...] = ()) -> Bound:
    """A mass on a spring with free play from a held node in the origin; some axes of the mass may be held, too."""
    builder = Builder(gravity=gravity)
    top, mass = builder.add_node([0.0, 0.0], 0.0), builder.add_node([0.0, height], MASS)
    builder.fix(top)
    builder.fix(mass, axes=axes)
    builder.add_free_play(top, mass, play)
    return Bound(*builder.build())


@pytest.mark.parametrize(("begin", "exact"), [(-1.5, -1.2), (-1.1, -1.2), (0.8, 1.0)])
def test_mass_comes_to_equilibrium_at_an_end_of_the_free_play(begin: float, exact: float) -> None:
    bound = bob(begin, axes=(0,))
    found = find_equilibrium(bound)
    assert found.outcome == "found"
    assert bound.state.position[1, 1] == pytest.approx(exact - MASS * 9.81 / STIFFNESS, abs=1e-12)


def test_preloaded_spring_has_the_frequencies_of_a_pendulum_on_a_spring() -> None:
    bound = bob(-1.5)
    find_equilibrium(bound)
    length = SHORTEST + WIDTH + MASS * 9.81 / STIFFNESS
    np.testing.assert_allclose(find_modes(bound, 2).squares, [9.81 / length, STIFFNESS / MASS], rtol=1e-10)


def test_mass_inside_the_free_play_has_no_stiffness() -> None:
    assert not find_modes(bob(-1.1), 2).squares.any()
    assert not bob(0.0, 0.0, FreePlayProperties(STIFFNESS, 0.0, WIDTH)).forces().any()  # both nodes in one point


def crossings(speed: float, time: float) -> float:
    """Height of a mass that moves freely inside the play and as on a spring beyond it, exactly."""
    w = np.sqrt(STIFFNESS / MASS)
    flight, contact = WIDTH / speed, np.pi / w
    halves, rest = divmod(time, flight + contact)
    depth = speed * rest if rest < flight else WIDTH + speed / w * np.sin(w * (rest - flight))
    return float(-SHORTEST - (depth if halves % 2 == 0 else WIDTH - depth))


def test_mass_bounces_between_both_ends_as_exact() -> None:
    """Of the first order at least: where a step meets an end, its force has a kink."""
    errors = []
    for steps in (4000, 16000):
        bound = bob(-SHORTEST, gravity=0.0)
        bound.state.velocity[1, 1] = -1.0
        bound.advance(steps, 4.0 / steps)
        errors.append(abs(bound.state.position[1, 1] - crossings(1.0, 4.0)))
        assert bound.kinetic_energy() + bound.potentials().elastic == pytest.approx(0.5 * MASS, rel=1e-3)
    print("bounces", errors)
    assert errors[1] < 0.25 * errors[0]
    assert errors[1] < 1e-6  # m; the mass moves over 0.4 m


def test_implicit_steps_follow_small_explicit_ones() -> None:
    """From the drawing, where one of three springs is taut, one is free and one pushes."""
    explicit = loose(damping=20.0)
    explicit.advance(8000, 2.5e-5)
    errors = []
    for steps in (100, 400):
        implicit = loose(damping=20.0)
        assert advance_implicitly(implicit, steps, 0.2 / steps) == (steps, "done")
        errors.append(float(np.abs(implicit.state.position - explicit.state.position).max()))
    print("implicit", errors)
    assert errors[1] < 0.2 * errors[0]
    assert errors[1] < 4e-5  # m; the masses fall by 0.1 m


def test_spring_from_a_node_to_itself_is_refused() -> None:
    bound = bob(-1.1)
    model = bound.model.copy()
    model.play_end[0] = 0
    with pytest.raises(RopewalkError, match=r"play_end\[0\] is node 0, which is the first node of the spring, too"):
        Bound(model, bound.state.copy())
