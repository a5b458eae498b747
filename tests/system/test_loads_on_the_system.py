"""Loads on lines by the engine of the whole system, against exact solutions.

Sources: L. Fryba's moving force and the mass and the oscillator on a string (`ropewalk.theory.string`), the force that
starts to move on a nonlinear string (`ropewalk.theory.selfsimilar`), the force on a beam (`ropewalk.theory.beam`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion_cases import long_string, order, taut_string
from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.system.dynamics.motion import LOOK
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.theory import beam, selfsimilar, string
from ropewalk.theory.moving_oscillator import moving_oscillator
from system_cases import frames_of, imbalance, line, scenario

STIFFNESS = 1e4  # N
STRETCH = 1.0 + 1.0 / STIFFNESS
LENGTH = 1.0 / STRETCH
WAVE = np.sqrt(1.0 / STRETCH)
WEIGHT = 1e-5  # N/kg, so small beside the tension of 1 N that the motion is linear


def moving(alpha: float) -> dict[str, Any]:
    return {"speed": float(alpha * WAVE), "at_end": "leave"}


def on_string(load: dict[str, Any], elements: int, alpha: float, part: float = 0.9) -> list[Any]:
    until = float(part * LENGTH / (alpha * WAVE))
    lines = {"s": line(elements=elements, tension=None, length=LENGTH)}
    loads = {"p": load | {"on": "s", "travel": moving(alpha)}}
    return frames_of(scenario(lines, loads, until, until / 100.0), np.linspace(0.0, until, 101))


@pytest.mark.parametrize(("alpha", "largest"), [(0.2, 6e-6), (0.5, 1.2e-5), (0.8, 8e-5)])
def test_a_mass_on_a_string(alpha: float, largest: float) -> None:
    """Largest error of the deflection in m g L / P: twice what was seen with 200 links; ropes have 2.6e-5 to 4.3e-5."""

    def errors(elements: int) -> tuple[float, float]:
        frames = on_string({"kind": "mass", "mass": 1.0, "force": [0, -WEIGHT]}, elements, alpha)
        t = np.array([frame.path for frame in frames])
        exact = string.moving_mass(
            t, load_mass=1.0, speed=alpha * WAVE, length=LENGTH, tension=1.0 / STRETCH, mass=1.0, gravity=WEIGHT
        )
        deflection = np.array([-frame.contact_position[0, 1] for frame in frames]) - exact.deflection
        force = np.array([-frame.contact_force[0, 1] for frame in frames]) - exact.contact_force
        return float(np.abs(deflection).max()) / WEIGHT, float(np.sqrt(np.mean(force[1:] ** 2))) / WEIGHT

    (coarse, rough), (fine, smooth) = errors(100), errors(200)
    assert fine < largest
    assert smooth < 0.06
    assert smooth < 0.75 * rough  # it follows the reflected front within a few links
    assert np.log2(coarse / fine) > 1.3


@pytest.mark.parametrize("stiffness", [5.0, 50.0])
def test_an_oscillator_without_wheel_mass_on_a_string(stiffness: float) -> None:
    def error(elements: int) -> float:
        until = float(0.9 * LENGTH / (0.5 * WAVE))
        lines = {"s": line(elements=elements, tension=None, length=LENGTH, mass=1.0)}
        # No gravity (the weight of the line would bend it as much as the load does).
        matrices = {
            "kind": "matrices", "on": "s", "mass": [[0.5, 0], [0, 0]],
            "stiffness": [[stiffness, -stiffness], [-stiffness, stiffness]], "coordinates": ["body", "wheel"],
            "wheels": {"w": {"coordinate": "wheel"}}, "weight": [0.5 * WEIGHT, 0.0], "travel": moving(0.5),
        }  # fmt: skip
        given = scenario(lines, {"p": matrices}, until, until / 100.0)
        frames = frames_of(given, np.linspace(0.0, until, 101))
        t = np.array([frame.path for frame in frames])
        exact = moving_oscillator(
            t, sprung_mass=0.5, stiffness=stiffness, speed=0.5 * WAVE, length=LENGTH,
            tension=1.0 / STRETCH, mass=1.0, gravity=WEIGHT,
        )  # fmt: skip
        force = np.array([-frame.contact_force[0, 1] for frame in frames]) - exact.contact_force
        return float(np.sqrt(np.mean(force[1:] ** 2))) / (0.5 * WEIGHT)

    errors = [error(n) for n in (50, 100, 200)]
    assert errors[-1] < {5.0: 1.2e-3, 50.0: 1.2e-2}[stiffness]  # twice what was seen
    # The force of a front that is reflected comes as it does after some links: first order.
    assert 0.7 < order([1.0 / n for n in (50, 100, 200)], errors) < 1.3


@pytest.mark.parametrize(("alpha", "largest"), [(0.5, 1.6e-4), (0.9, 8e-4), (1.3, 1.3e-3)])
def test_a_force_on_a_string_whether_it_is_slower_or_faster_than_the_waves(alpha: float, largest: float) -> None:
    """Root mean square of the deflection in F L / P with 400 links; twice what was seen."""

    def error(elements: int) -> float:
        given = taut_string(elements, alpha, 0.75)
        own, speed = given.lines["string"], given.loads["force"].travel.speed
        xi = np.arange(elements + 1) * own.length / elements
        misses = [
            -frame.position[:, 1]
            - string.moving_force(
                xi, frame.path, force=1e-6, speed=speed, length=own.length, tension=own.length, mass=own.mass
            )
            for frame in frames_of(given)[1:]
        ]
        return float(np.sqrt(np.mean(np.square(misses)))) / 1e-6

    errors = [error(n) for n in (100, 200, 400)]
    assert errors[-1] < largest
    assert 0.85 < order([0.01, 0.005, 0.0025], errors) < 1.3  # the kink is rounded within a link


@pytest.mark.parametrize(("alpha", "largest"), [(0.23, 2.5e-3), (0.46, 1e-3), (0.69, 2e-3), (0.85, 7e-3)])
def test_a_force_that_starts_to_move_on_a_soft_string(alpha: float, largest: float) -> None:
    """Error of what the nonlinearity adds to the horizontal velocity, with 1536 links: ropes have 2e-4 to 2e-3."""
    speed = float(alpha * np.sqrt(0.05 / 1.05))
    times = np.array([0.0, 0.35, 0.95])
    frames = frames_of(long_string(1536, speed, "clamped", 0.95), times)
    velocity = (frames[2].contact_position[0] - frames[1].contact_position[0]) / 0.6
    wave = selfsimilar.moving_force(
        force=0.01, speed=speed, axial_stiffness=1.0, mass=1.0, prestrain=0.05, contact="clamped"
    )
    drift = wave.contact_velocity[0] - 1.05 * speed
    assert abs(velocity[0] - wave.contact_velocity[0]) < largest * abs(drift)
    assert abs(abs(velocity[1]) - abs(wave.contact_velocity[1])) < 4e-4 * abs(wave.contact_velocity[1])


def test_a_force_on_a_hinged_beam_converges_to_the_fourth_order_away_from_it() -> None:
    keys = {"tension": 1.0, "bending_stiffness": 0.5, "axial_stiffness": 1e6}  # so that it stretches by nothing
    until = 0.5  # s, while the force is on the beam

    def error(elements: int) -> float:
        lines = {"b": line(elements=elements, **keys)}
        loads = {"p": {"kind": "force", "on": "b", "force": [0, -1e-5], "travel": {"speed": 1.0, "from": 0.0}}}
        frame = frames_of(scenario(lines, loads, until, until))[-1]
        x = np.linspace(0.0, 1.0, elements + 1)
        exact = beam.moving_force(
            x, until, force=1e-5, speed=1.0, length=1.0, bending_stiffness=0.5, mass=1.0, tension=1.0
        )
        return float(np.abs(-frame.position[:, 1] - exact).max() / np.abs(exact).max())

    errors = [error(n) for n in (12, 24, 48)]
    assert errors[-1] < 2e-4
    assert order([1 / 12, 1 / 24, 1 / 48], errors) > 1.7


@pytest.mark.parametrize("kind", ["force", "mass", "oscillator"])
def test_energy_is_kept_on_a_rope_that_sags(kind: str) -> None:
    own = {
        "force": {"force": [0, -300.0]}, "mass": {"mass": 30.0},
        "oscillator": {"mass": 30.0, "stiffness": 2e4, "damping": 100.0},
    }[kind]  # fmt: skip
    rope = {"start": [0, 0], "end": [20, 1], "length": 20.04, "mass": 1.0, "axial_stiffness": 1e6, "elements": 80}
    loads = {"p": {"kind": kind, "on": "r", "travel": {"speed": 8.0, "from": 5.0}} | own}
    frames = frames_of(scenario({"r": rope}, loads, 1.0, 0.1, gravity=9.81))
    assert imbalance(frames) < 2e-3  # Verlet's method: a quarter with half the step


@pytest.mark.parametrize("stiffness", [1e6, 1e12])
def test_the_line_bears_what_a_spring_without_a_wheel_gives_however_stiff_it_is(stiffness: float) -> None:
    """50 N. A kink found to 1e-9 of itself made 1e-12 EA of noise, 0.5 N; rounding of places leaves 2e-16 of EA/0.3."""
    load = {"on": "rope", "kind": "oscillator", "mass": 5.0, "stiffness": 2e3, "travel": {"speed": 5.0, "from": 2.0}}
    line = {"start": [0, 0], "end": [10, 3], "length": 11.0, "mass": 1.0, "elements": 6, "axial_stiffness": stiffness}
    run = {"kind": "dynamic", "until": 0.1, "every": 0.1, "start": {"with_loads": True}}
    scenario = Scenario.model_validate({"lines": {"rope": line}, "loads": {"bob": load}, "run": run})
    moving, missing = SystemMotion(scenario, RunInfo(), np.array([0.0, 0.1])), list[float]()
    bodies, at = moving.bodies, moving.bodies.at[0, : moving.bodies.size[0]]
    wheel = bodies.contact[at] == 0
    step = 1.28 / np.sqrt(stiffness)
    for _ in range(4):
        moving._advance(step, 1)
        moving._advance(0.0, LOOK)
        pressed = bodies.force[at] - bodies.K[0][: at.size, : at.size] @ moving.state.u[at]
        N = moving.contacts["N"][0][bodies.axis[at]]
        missing.append(float(np.abs(pressed - N)[wheel].max()))
    print(missing)
    assert max(missing) < 1e-7 + 3e-15 * stiffness
