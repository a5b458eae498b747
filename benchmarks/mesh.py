"""The error of the mesh beside what is told of it, over CPU seconds, and the mesh that an accuracy takes.

A force and a mass on a taut string against exact solutions, a force on the slack rope of the overview against a fine
mesh: the largest error of the path, the estimate of it, and what both take; and ten problems with known answers.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import xarray as xr
from tests.mesh_cases import PROBLEMS

from ropewalk.model import Dynamic, Line, MovingForce, MovingMass, Scenario, Travel
from ropewalk.simulate import simulate
from ropewalk.theory import string

from .continuum import slack_rope

Array = np.ndarray

STIFFNESS, WEIGHT, ALPHA, FINEST = 1e4, 1e-5, 0.5, 1600
LENGTH = 1.0 / (1.0 + 1.0 / STIFFNESS)
TAUT = {"length": LENGTH, "tension": LENGTH, "mass": 1.0}
SPEED = ALPHA * float(np.sqrt(LENGTH))


def taut_string(load: MovingForce | MovingMass) -> Callable[[int], Scenario]:
    """A load on a string of 1 N, 1 kg/m and 1 m, until it has passed 0.9 of it."""

    def on(elements: int) -> Scenario:
        line = Line(start=(0, 0), end=(1, 0), length=LENGTH, mass=1.0, axial_stiffness=STIFFNESS, elements=elements)
        until = 0.9 * LENGTH / SPEED
        return Scenario(gravity=0.0, lines={"string": line}, loads={"load": load}, run=Dynamic(until=until))

    return on


def rope(elements: int) -> Scenario:
    """The slack rope with outputs every 10 ms."""
    given = slack_rope(elements)
    return given.model_copy(update={"run": given.run.model_copy(update={"every": 0.01, "accuracy": 1e-3})})


def seconds(scenario: Scenario) -> tuple[xr.Dataset, float]:
    """A result, and the CPU seconds that it takes."""
    begin = time.process_time()
    result = simulate(scenario)
    return result, time.process_time() - begin


def path(result: xr.Dataset) -> Array:
    """Of the contact (time, axis), m."""
    return np.asarray(result.contact_position.values[:, 0])


def table(name: str, on: Callable[[int], Scenario], exact: Callable[[xr.Dataset], Array], unit: float) -> None:
    """Print the errors of a path on finer and finer meshes."""
    simulate(on(8))  # compile, or load from the cache
    print(f"\n{name}, largest error of the path in {unit:g} m")
    print(f"{'links':>6}{'error':>10}{'CPU s':>9}{'estimate':>11}{'of it':>8}{'CPU s':>9}")
    for elements in (48, 100, 200, 400):
        given = on(elements)
        result, alone = seconds(given)
        message, both = seconds(given.model_copy(update={"run": given.run.model_copy(update={"mesh_error": True})}))
        error = float(np.nanmax(np.linalg.norm(path(result) - exact(result), axis=1))) / unit
        estimate = float(message.attrs["mesh_error_of_contacts"]) / unit
        print(f"{elements:6}{error:10.3g}{alone:9.3f}{estimate:11.3g}{estimate / error:8.2f}{both:9.3f}", flush=True)


def chosen() -> None:
    """Print what accuracies take on the slack rope."""
    reference = path(simulate(rope(FINEST)))
    print(f"\nSlack rope, elements: auto; error of the path against {FINEST} links, all in mm")
    print(f"{'accuracy':>9}{'links':>7}{'estimate':>10}{'of path':>9}{'error':>8}{'CPU s':>8}")
    for accuracy in (0.1, 0.03, 0.01):
        tree = rope(100).model_dump(mode="json", by_alias=True, exclude_none=True)
        tree["lines"]["rope"]["elements"], tree["run"]["accuracy"] = "auto", accuracy
        result, took = seconds(Scenario.model_validate(tree))
        error = 1e3 * float(np.nanmax(np.linalg.norm(path(result) - reference, axis=1)))
        message = [1e3 * float(result.attrs[key]) for key in ("mesh_error", "mesh_error_of_contacts")]
        links = result.sizes["link"]
        print(f"{1e3 * accuracy:9g}{links:7}{message[0]:10.1f}{message[1]:9.1f}{error:8.1f}{took:8.2f}", flush=True)


def known() -> None:
    """Print what is told of the error of ten problems with known answers, over what it is, on two meshes each."""
    print("\nEstimated over true error of problems with known answers; promised is 0.5 to 3")
    print(f"{'':40}{'elements':>8}{'of it':>8}{'twice':>8}{'of it':>8}")
    for name, problem in PROBLEMS.items():
        row = f"{name:40}"
        for elements in (problem.elements, 2 * problem.elements):
            result = problem.estimated(elements)
            row += f"{elements:8}{problem.message(result) / problem.miss(result):8.2f}"
        print(row, flush=True)


def main() -> None:
    """Print all tables."""
    travel = Travel(speed=SPEED)

    def of_force(result: xr.Dataset) -> Array:
        z = -string.moving_force_path(result.time.values, force=WEIGHT, speed=SPEED, **TAUT)
        return np.stack([path(result)[:, 0], z], axis=1)

    def of_mass(result: xr.Dataset) -> Array:
        exact = string.moving_mass(result.time.values, load_mass=1.0, speed=SPEED, gravity=WEIGHT, **TAUT)
        return np.stack([path(result)[:, 0], -exact.deflection], axis=1)

    table(
        "Force on a taut string",
        taut_string(MovingForce(on="string", force=(0, -WEIGHT), travel=travel)),
        of_force,
        1e-9,
    )
    mass = MovingMass(on="string", mass=1.0, force=(0, -WEIGHT), travel=travel)
    table("Mass on a taut string", taut_string(mass), of_mass, 1e-9)
    reference = path(simulate(rope(FINEST)))
    table(f"Force on the slack rope, against {FINEST} links", rope, lambda _: reference, 1e-3)
    chosen()
    known()
