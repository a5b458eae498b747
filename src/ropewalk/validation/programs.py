"""Vehicles that other programs compute, on our lines."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.scenario import loads
from ropewalk.scenario.examples import examples
from ropewalk.theory import beam
from ropewalk.theory.beam_vehicle import Vehicle
from ropewalk.validation.known_case import KnownCase, answered
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.measured import deepest
from ropewalk.validation.publication import Publication

G = 9.81


def coach() -> Vehicle:
    """That of uvec-on-bridge.yaml: ten coordinates downwards, and the far ends of the four contact springs.

    They have the stiffness of the Hertzian contacts at rest: F = (y/C)^p, dF/dy = p F^(1 - 1/p)/C.
    """
    static = G * (1.6e3 + 0.5 * (5.6e3 + 0.5 * 44e3))
    contact = 1.5 * static ** (1.0 / 3.0) / 9e-7
    mass = np.diag([44e3, 1.9e6, *(2 * [5.6e3, 7.5e3, 1.6e3, 1.6e3]), 0.0, 0.0, 0.0, 0.0])
    damping, stiffness, axles = np.zeros((14, 14)), np.zeros((14, 14)), []
    for b, far in enumerate((8.75, -8.75)):
        bogie = 2 + 4 * b
        joints: list[tuple[list[int], list[float], float, float]] = [
            ([0, 1, bogie], [1.0, far, -1.0], 0.86e6, 40e3)
        ]  # fmt: skip
        for w, near in enumerate((1.25, -1.25)):
            wheel = bogie + 2 + w
            joints.append(([bogie, bogie + 1, wheel], [1.0, near, -1.0], 2.4e6, 48e3))
            joints.append(([wheel, 10 + 2 * b + w], [1.0, -1.0], contact, 0.0))
            axles.append(10.0 - far - near)
        for coordinates, signs, k, c in joints:
            apart = np.zeros(14)
            apart[coordinates] = signs
            stiffness += k * np.outer(apart, apart)
            damping += c * np.outer(apart, apart)
    return Vehicle(mass, damping, stiffness, np.array(axles), np.full(4, static))


def bridge_under_the_coach() -> float:
    """Largest deflection at midspan by 12 modes, m."""
    crossing = beam.moving_vehicle(
        np.linspace(0.0, 1.2, 601), vehicle=coach(), speed=50.0, length=30.0, bending_stiffness=52.5e9, mass=10e3,
        damping=10e3, modes=12, tolerance=1e-3,
    )  # fmt: skip
    return float(crossing.beam_deflection(15.0).max())


OWN = """
lines:
  rope:
    {start: [0, 0], end: [30, 0], tension: 400 kN, mass: 5, axial_stiffness: 50 MN, axial_damping: 2 kN*s, drag: 0.5,
     elements: 120}
loads:
  trolley:
    kind: vehicle
    on: rope
    lift_off: true
    bodies: {body: {mass: 300, inertia: 250}}
    wheels:
      front: {at: 1, mass: 20, contact_stiffness: 200.0e+3}
      rear: {at: -0.8, mass: 20, contact_stiffness: 200.0e+3}
    springs:
      front: {between: [body, front], stiffness: 40.0e+3, damping: 1000}
      rear: {between: [body, rear], stiffness: 40.0e+3, damping: 1000}
    travel: {speed: 15, from: 5}
run: {kind: dynamic, until: 1 s, every: 10 ms}
"""


def largest_force(result: Any) -> float:
    """Of a wheel, N."""
    return float(np.nanmax(-result.contact_force.sel(axis="z").to_numpy()))


def lowest(result: Any) -> float:
    """Depth of the deepest node, m."""
    return -float(result.position.sel(axis="z").min())


def by_exudyn(measure: Any) -> float:
    """A number of the run of exudyn-vehicle.yaml."""
    return float(measure(answered(loads(examples()["exudyn-vehicle"]))))


CASES = (
    KnownCase(
        "program-uvec", "A coach computed by UVEC crosses a railway bridge of 30 m",
        Publication("UVEC 1.1, a package of Deltares for vehicles on tracks; the number by 12 modes with linear "
                    "contacts",
               "its entry in the package index"),
        lambda: examples()["uvec-on-bridge"],
        (
            KnownNumber("deflection", "largest deflection at midspan", "m", "series", bridge_under_the_coach,
                lambda r: deepest(r, 15.0), "48 links and steps of 1 ms: 1e-5", absolute=2e-7),
        ),
        fault=("lines.bridge.bending_stiffness=54 GN*m^2",), needs="UVEC",
    ),
    KnownCase(
        "program-exudyn", "A trolley on a track rope: kind vehicle against Exudyn",
        Publication("J. Gerstmayr, Exudyn - a C++-based Python package for flexible multibody systems, Multibody "
                    "Syst. Dyn. "
               "(2023); run as well", "author, year and the repository jgerstmayr/EXUDYN; the title from memory"),
        OWN,
        (
            KnownNumber("force", "largest force of a "
                         "wheel", "N", "other program", lambda: by_exudyn(largest_force), largest_force,
                "exchange every 0.5 ms; 2.4e-3 of the forces seen", relative=5e-3),
            KnownNumber("depth", "deepest place of the rope", "m", "other program", lambda: by_exudyn(lowest), lowest,
                "exchange every 0.5 ms; 6e-4 of the depth seen", relative=2e-3),
        ),
        fault=("loads.trolley.bodies.body.mass=310",), needs="exudyn",
    ),
)  # fmt: skip
