"""Forces and bodies that travel along runs of the core, against exact solutions; problems and norms are those of
docs/notes/gate-of-contacts.md, and so are the errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, ContactProperties, RunProperties, SpringProperties
from ropewalk.engine.equilibrium import find_equilibrium
from ropewalk.theory import string
from ropewalk.theory.moving_oscillator import moving_oscillator

Array = NDArray[np.float64]
EA = 1e4
STRETCH = 1.0 + 1.0 / EA
LENGTH, WAVE, TENSION = 1.0 / STRETCH, 1.0 / np.sqrt(STRETCH), 1.0 / STRETCH  # in the coordinate of the material
WEIGHT = 1e-5  # N/kg: motion is linear
MOST = 0.5  # of the stable step for waves along a straight run


def string_of(links: int, joint: int = 0) -> Builder:
    """A taut string of 1 kg under 1 N over 1 m; in two runs that are joined at a node, if there is one."""
    builder, points = Builder(gravity=0.0), np.array([np.linspace(0.0, 1.0, links + 1), np.zeros(links + 1)])
    run = RunProperties(LENGTH / links, 1.0, EA)
    first, end = builder.add_run(points[:, : (joint or links) + 1], replace(run, continues=joint > 0))
    if joint:
        again, last = builder.add_run(points[:, joint:], run)
        builder.join(again, end)
        end = last
    builder.fix(first, end)
    return builder


def steps_within(time: float, links: int) -> int:
    return int(np.ceil(time / (MOST * LENGTH / links / np.sqrt(EA))))


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def orders_of(errors: list[float]) -> Array:
    found = np.log2(np.array(errors[:-1]) / errors[1:])
    print(errors, found)
    return np.asarray(found)


# -- Forces ------------------------------------------------------------------------------------------------------------


def error_of_force(part: float, links: int) -> float:
    """rms of the field over F L/P at quarters of the passage of three quarters of the string."""
    speed = part * WAVE
    time, builder, off = 0.1875 * LENGTH / speed, string_of(links), []
    builder.add_force(0, [0.0, -1e-6], 0.0, speed)
    bound, steps = Bound(*builder.build()), steps_within(time, links)
    for k in range(1, 5):
        bound.advance(steps, time / steps)
        exact = string.moving_force(np.linspace(0.0, LENGTH, links + 1), k * time, force=1.0, speed=speed,
                                    length=LENGTH, tension=TENSION, mass=1.0)  # fmt: skip
        off.append(bound.state.position[1] / -1e-6 - exact)
    return rms(np.array(off))


@pytest.mark.parametrize(("part", "largest"), [(0.5, 3.8e-4), (0.9, 2.0e-3), (1.3, 6.8e-4)])
def test_string_under_a_travelling_force_of_fryba(part: float, largest: float) -> None:
    """Slower than waves, nearly as fast, faster. Of the first order, as the corner at the front is."""
    errors = [error_of_force(part, links) for links in (50, 100)]
    assert errors[1] < largest
    assert abs(orders_of(errors)[0] - 1.06) < 0.12


# -- Masses ------------------------------------------------------------------------------------------------------------


def course_of_mass(part: float, links: int, joint: int = 0) -> tuple[float, float]:
    """Largest error of the deflection in m g L/P, rms of that of the contact force in m g; a mass of the string."""
    speed, count = part * WAVE, 90
    times = np.linspace(0.0, 0.9 * LENGTH / speed, count + 1)
    builder, steps = string_of(links, joint), steps_within(times[1], links)
    mass = builder.add_node([0.0, 0.0], 1.0)
    builder.push(mass, [0.0, -WEIGHT])
    builder.add_contact(0, mass, 0.0, speed)
    model, state = builder.build(step=times[1] / steps)
    state.velocity[0, mass] = speed * STRETCH
    bound, found = Bound(model, state), []
    for _ in range(count):
        bound.advance(steps, times[1] / steps)
        at = bound.contacts()
        found.append((at.point[1, 0], at.force[1, 0]))
    exact = string.moving_mass(times, load_mass=1.0, speed=speed, length=LENGTH, tension=TENSION, mass=1.0,
                               gravity=WEIGHT)  # fmt: skip
    z, force = -np.array(found).T / WEIGHT
    off = z - exact.deflection[1:] / WEIGHT
    return float(np.abs(off).max()), rms(force - exact.contact_force[1:] / WEIGHT)


@pytest.mark.parametrize(
    ("part", "deflection", "force", "order"),
    [(0.2, 2.3e-5, 0.033, (1.9, 2.6)), (0.5, 6.2e-5, 0.034, (1.2, 1.7)), (0.8, 1.7e-4, 0.1, (1.7, 2.2))],
)
def test_string_under_a_travelling_mass_of_smith(
    part: float, deflection: float, force: float, order: tuple[float, float]
) -> None:
    """Delay equation; errors at 100 links. The force jumps as waves come back: half of the first order and less."""
    errors = [course_of_mass(part, links) for links in (50, 100)]
    orders = orders_of([error for error, _ in errors])
    assert errors[1][0] < deflection
    assert errors[1][1] < force
    assert order[0] < orders[0] < order[1]


def test_mass_passes_a_joint_as_if_there_were_none() -> None:
    for joint in (50, 37):
        assert course_of_mass(0.5, 100, joint)[0] < 8e-5  # 6.0e-5 on one run; a joint is a hinge of links


# -- Oscillators -------------------------------------------------------------------------------------------------------


def error_of_oscillator(stiffness: float, wheel: float, links: int) -> float:
    """rms of the contact force over the weight, at half of the wave speed; bodies are led along the string."""
    speed, count, sprung = 0.5 * WAVE, 90, 0.5
    times = np.linspace(0.0, 0.9 * LENGTH / speed, count + 1)
    builder, steps, axle = string_of(links), steps_within(times[1], links), -1
    body = builder.add_node([0.0, 1.0 if wheel else 0.0], sprung)
    contact = ContactProperties(slides=True)
    if wheel:
        axle = builder.add_node([0.0, 0.0], wheel)
        builder.add_spring(body, axle, SpringProperties(stiffness, 1.0))
        builder.push(axle, [0.0, -wheel * WEIGHT])
    else:
        contact = ContactProperties(stiffness, slides=True)
    builder.push(body, [0.0, -sprung * WEIGHT])
    builder.fix(*{body, axle if wheel else body}, axes=[0])
    builder.add_contact(0, axle if wheel else body, 0.0, speed, contact)
    model, state = builder.build(step=times[1] / steps)
    state.velocity[0, body:] = speed * STRETCH
    state.position[1, body] -= sprung * WEIGHT / stiffness  # in equilibrium on rigid ground
    bound, found = Bound(model, state), []
    for _ in range(count):
        bound.advance(steps, times[1] / steps)
        found.append(-bound.contacts().force[1, 0])
    exact = moving_oscillator(times, sprung_mass=sprung, contact_mass=wheel, stiffness=stiffness, speed=speed,
                              length=LENGTH, tension=TENSION, mass=1.0, gravity=WEIGHT)  # fmt: skip
    return rms(np.array(found) - exact.contact_force[1:]) / ((sprung + wheel) * WEIGHT)


@pytest.mark.parametrize(
    ("stiffness", "wheel", "largest"), [(5.0, 0.0, 1.5e-3), (50.0, 0.0, 1.6e-2), (50.0, 0.1, 0.22)]
)
def test_string_under_an_oscillator(stiffness: float, wheel: float, largest: float) -> None:
    """Without a mass at its wheel the spring is the stiffness of the contact."""
    errors = [error_of_oscillator(stiffness, wheel, links) for links in (50, 100)]
    assert errors[1] < largest
    assert orders_of(errors)[0] > 0.4


# -- Energy ------------------------------------------------------------------------------------------------------------


def audited(kind: str, steps: int) -> tuple[float, float]:
    """Energy that is missing within half a second, and the kinetic energy; loads on a slack rope of 40 links.

    They begin in equilibrium, and then move with their prescribed speeds.
    """
    builder, x = Builder(), np.linspace(0.0, 20.0, 41)
    run = RunProperties(20.4 / 40, 1.0, 1e5, bending_stiffness=3e3 if kind == "stiff" else 0.0)
    points = np.array([x, x / 20.0 - 0.3 * x * (1.0 - x / 20.0)])
    builder.fix(*builder.add_run(points, run))
    mass = builder.add_node(points[:, 5], 20.0)
    builder.add_contact(0, mass, 5.0 * run.link_length, 5.0)
    if kind == "force":
        builder.add_force(0, [0.0, -200.0], 20.0 * run.link_length, -4.0)
    model, state = builder.build(step=1.0 / steps)
    bound, speeds = Bound(model, state), state.contact_speed.copy()
    state.contact_speed[:] = 0.0  # what makes a moving kink softer has no potential
    assert find_equilibrium(bound).outcome == "found"
    state.contact_speed[:] = speeds
    ahead = state.position[:, 6] - state.position[:, 4]
    state.velocity[:, mass] = 5.0 * ahead / np.hypot(*ahead)
    missing, largest, begin = 0.0, 0.0, bound.kinetic_energy() + sum(bound.potentials())
    for _ in range(5):
        bound.advance(steps // 10, 1.0 / steps)
        last_kick = state.lag[0] * float(bound.contacts().driving @ state.contact_speed)
        worked, kinetic = float(state.contact_work.sum()) + last_kick, bound.kinetic_energy()
        missing = max(missing, abs(kinetic + sum(bound.potentials()) - begin - worked))
        largest = max(largest, kinetic)
    assert abs(worked) > 1.0
    return missing, largest


@pytest.mark.parametrize("kind", ["mass", "stiff", "force"])
def test_work_of_what_moves_contacts_is_the_gain_of_energy(kind: str) -> None:
    missing, kinetic = zip(*(audited(kind, steps) for steps in (3200, 6400)), strict=True)
    print("audit", kind, np.array(missing) / kinetic)
    assert missing[1] < 1e-6 * kinetic[1]
    assert missing[0] / missing[1] > 1.8


def test_body_above_a_line_can_leave_it() -> None:
    """Thrown up from the line it flies as a stone, and comes back; a body that is held has the same force before."""
    heights = []
    for leaves in (None, "above"):
        builder = string_of(40)
        stone = builder.add_node([0.5, 0.0], 0.01)
        builder.push(stone, [0.0, -0.01])  # 1 m/s^2
        builder.fix(stone, axes=[0])
        builder.add_contact(0, stone, 0.5 * LENGTH, 0.0, ContactProperties(leaves=leaves, slides=True))
        model, state = builder.build(step=1e-4)
        state.velocity[1, stone] = 0.1
        bound = Bound(model, state)
        bound.advance(1000, 1e-4)
        heights.append(bound.state.position[1, stone])
        if leaves:
            assert not np.any(bound.contacts().force)
            assert heights[1] == pytest.approx(0.1 * 0.1 - 0.5 * 0.1**2, abs=1e-6)
            bound.advance(1100, 1e-4)
            assert bound.contacts().force[1, 0] < 0.0
    assert heights[0] < heights[1] - 1e-3
