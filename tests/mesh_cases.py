"""Problems with known answers: a scenario on any mesh, and how far its result is from the continuum."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.theory import beam, beam_crossing, membrane, rope, selfsimilar, string

Array = np.ndarray

EA = 1e4  # N, of strings of 1 N and 1 kg/m over 1 m: straight on and off to 1e-4
LENGTH = 1.0 / (1.0 + 1.0 / EA)
TAUT = {"length": LENGTH, "tension": 1.0 / (1.0 + 1.0 / EA), "mass": 1.0}
WAVE = np.sqrt(TAUT["tension"])
WEIGHT = 1e-5  # N, so small that strings move as linear ones


@dataclass(frozen=True)
class Problem:
    """A scenario with a known answer.

    Args:
        on: the scenario, by the number of elements.
        miss: largest distance of a result from the answer at nodes and contacts, m.
        elements: on which it is tested.
        of_contacts: whether the answer is known at contacts only.
    """

    on: Callable[[int], Scenario]
    miss: Callable[[xr.Dataset], float]
    elements: int
    of_contacts: bool = False

    def estimated(self, elements: int | None = None) -> xr.Dataset:
        """The result with the error of its mesh."""
        given = self.on(elements or self.elements)
        return simulate(given.model_copy(update={"run": given.run.model_copy(update={"mesh_error": True})}))

    def message(self, result: xr.Dataset) -> float:
        """What a result says of the error where the answer is known, m."""
        return float(result.attrs["mesh_error_of_contacts" if self.of_contacts else "mesh_error"])


def largest(*distances: Array) -> float:
    return float(max(np.nanmax(np.abs(each)) for each in distances if each.size))


def taut(elements: int, **line: object) -> dict[str, object]:
    return {"start": [0, 0], "end": [1, 0], "length": LENGTH, "mass": 1.0, "axial_stiffness": EA,
            "elements": elements} | line  # fmt: skip


def scenario(lines: object, loads: object, run: object, **more: object) -> Scenario:
    return Scenario.model_validate({"gravity": 0.0, "lines": lines, "loads": loads, "run": run} | more)


def motion(until: float, outputs: int = 60, **more: object) -> dict[str, object]:
    return {"kind": "dynamic", "until": until, "every": until / outputs} | more


# -- Strings -----------------------------------------------------------------------------------------------------

ALPHA = 0.5


def string_force(elements: int) -> Scenario:
    load = {"kind": "force", "on": "string", "force": [0, -WEIGHT], "travel": {"speed": ALPHA * WAVE}}
    return scenario({"string": taut(elements)}, {"force": load}, motion(0.9 / ALPHA / WAVE * LENGTH))


def string_force_miss(result: xr.Dataset) -> float:
    t, xi = result.time.values, result.xi.values
    given = {"force": WEIGHT, "speed": ALPHA * WAVE, **TAUT}
    field = string.moving_force(xi, t[:, None], **given)
    path = string.moving_force_path(t, **given)
    return largest(-result.position.values[..., 1] - field, -result.contact_position.values[:, 0, 1] - path)


def string_mass(elements: int) -> Scenario:
    load = {"kind": "mass", "on": "string", "mass": 1.0, "force": [0, -WEIGHT], "travel": {"speed": ALPHA * WAVE}}
    return scenario({"string": taut(elements)}, {"mass": load}, motion(0.9 / ALPHA / WAVE * LENGTH))


def string_mass_miss(result: xr.Dataset) -> float:
    exact = string.moving_mass(
        result.time.values, load_mass=1.0, speed=ALPHA * WAVE, gravity=WEIGHT, **TAUT
    )  # fmt: skip
    return largest(-result.contact_position.values[:, 0, 1] - exact.deflection)


def released(elements: int) -> Scenario:
    start = {"kind": "mode", "number": 2, "amplitude": 1e-6}
    return scenario({"string": taut(elements)}, {}, motion(3.0, start=start))


def released_miss(result: xr.Dataset) -> float:
    t, xi = result.time.values, result.xi.values
    exact = 1e-6 * np.sin(2 * np.pi * xi / LENGTH) * np.cos(2 * np.pi * WAVE / LENGTH * t[:, None])
    return largest(result.position.values[..., 1] - exact)


def joined_strings(elements: int) -> Scenario:
    half = {"length": 0.5 * LENGTH, "mass": 1.0, "axial_stiffness": EA, "elements": elements // 2}
    knot = {"kind": "joined", "to": "knot"}
    lines = {
        "first": {"start": [0, 0], "end": [0.5, 0], "end_support": knot, **half},
        "second": {"start": [0.5, 0], "end": [1, 0], "start_support": knot, **half},
    }
    load = {"kind": "force", "on": "first", "force": [0, -WEIGHT], "travel": {"speed": ALPHA * WAVE}}
    return scenario(lines, {"force": load}, motion(0.45 / ALPHA / WAVE * LENGTH), joints={"knot": {}})


def joined_strings_miss(result: xr.Dataset) -> float:
    t, xi = result.time.values, result.xi.values + np.where(result.line.values == "second", 0.5 * LENGTH, 0.0)
    given = {"force": WEIGHT, "speed": ALPHA * WAVE, **TAUT}
    field = string.moving_force(xi, t[:, None], **given)
    path = string.moving_force_path(t, **given)
    return largest(-result.position.values[..., 1] - field, -result.contact_position.values[:, 0, 1] - path)


# -- Soft strings and ropes --------------------------------------------------------------------------------------

KINK = 0.46 * np.sqrt(0.05 / 1.05)


def self_similar(elements: int) -> Scenario:
    """Until a front comes back from an end."""
    line = {"start": [0, 0], "end": [2.1, 0], "length": 2.0, "mass": 1.0, "axial_stiffness": 1.0, "elements": elements}
    load = {"kind": "force", "on": "string", "force": [0, -0.01], "travel": {"speed": KINK, "from": 1.0}}
    return scenario({"string": line}, {"force": load}, motion(0.95))


def self_similar_miss(result: xr.Dataset) -> float:
    wave = selfsimilar.moving_force(
        force=0.01, speed=KINK, axial_stiffness=1.0, mass=1.0, prestrain=0.05, contact="clamped"
    )
    t, path = result.time.values, result.contact_position.values[:, 0]
    velocity = np.array([wave.contact_velocity[0], -abs(wave.contact_velocity[1])])
    return largest(np.linalg.norm(path - [1.05, 0.0] - t[:, None] * velocity, axis=1))


ROPE = {"span": 20.0, "length": 22.0, "weight": 19.62, "axial_stiffness": 1e5}


def hanging(elements: int, loads: dict[str, object] | None = None) -> Scenario:
    line = {"start": [0, 0], "end": [20, 0], "length": 22.0, "mass": 2.0, "axial_stiffness": 1e5, "elements": elements}
    return scenario({"rope": line}, loads or {}, {"kind": "equilibrium"}, gravity=9.81)


def hanging_miss(result: xr.Dataset) -> float:
    shape = rope.elastic_catenary(**ROPE)
    return largest(np.linalg.norm(result.position.values[0] - shape.position(result.xi.values), axis=-1))


def burdened(elements: int) -> Scenario:
    load = {"kind": "force", "on": "rope", "force": [0, -700], "travel": {"speed": 1.0, "from": 7.3}}
    return hanging(elements, {"force": load})


def burdened_miss(result: xr.Dataset) -> float:
    at = float(result.contact_xi.values[0, 0])
    shape = rope.elastic_catenary(**ROPE, loads=[(at, (0.0, -700.0))])
    nodes = np.linalg.norm(result.position.values[0] - shape.position(result.xi.values), axis=-1)
    return largest(nodes, np.linalg.norm(result.contact_position.values[0, 0] - shape.position(at), axis=-1))


# -- Beams and membranes -----------------------------------------------------------------------------------------

BEAM = {"length": 1.0, "bending_stiffness": 1.0, "mass": 1.0}
PACE = 0.5 * np.pi


def beam_line(elements: int) -> dict[str, object]:
    return {"start": [0, 0], "end": [1, 0], "length": 1.0, "mass": 1.0, "axial_stiffness": 1e4,
            "bending_stiffness": 1.0, "elements": elements}  # fmt: skip


def beam_force(elements: int) -> Scenario:
    load = {"kind": "force", "on": "beam", "force": [0, -1e-3], "travel": {"speed": PACE}}
    return scenario({"beam": beam_line(elements)}, {"force": load}, motion(1.0 / PACE, geometry="linearised"))


def beam_force_miss(result: xr.Dataset) -> float:
    exact = beam.moving_force(result.xi.values, result.time.values[:, None], force=1e-3, speed=PACE, **BEAM)
    return largest(-result.position.values[..., 1] - exact)


def beam_mass(elements: int) -> Scenario:
    load = {"kind": "mass", "on": "beam", "mass": 0.3, "force": [0, -3e-3], "travel": {"speed": PACE}}
    return scenario({"beam": beam_line(elements)}, {"mass": load}, motion(0.95 / PACE, geometry="linearised"))


def beam_mass_miss(result: xr.Dataset) -> float:
    exact = beam_crossing.moving_mass(result.time.values, load_mass=0.3, speed=PACE, gravity=1e-2, **BEAM)
    return largest(-result.contact_position.values[:, 0, 1] - exact.deflection[:, 0])


def drum(elements: int) -> Scenario:
    net = {"kind": "membrane", "corner": [0, 0, 0], "sides": [[1, 0, 0], [0, 1, 0]], "cells": [elements, elements],
           "mass": 1.0, "stiffness": 1e4, "tension": 1.0}  # fmt: skip
    start = {"kind": "mode", "number": 1, "amplitude": 1e-5}
    return scenario({}, {}, motion(0.8, start=start), nets={"drum": net})


def drum_miss(result: xr.Dataset) -> float:
    side = round(np.sqrt(result.sizes["node"])) - 1
    j, i = np.divmod(np.arange(result.sizes["node"]), side + 1)
    mode = np.sin(np.pi * i / side) * np.sin(np.pi * j / side)
    frequency = float(membrane.rectangle_frequency(1, 1, sides=(1.0, 1.0), tension=1.0, mass=1.0))
    exact = 1e-5 * mode * np.cos(frequency * result.time.values[:, None])
    return largest(result.position.values[..., 2] - exact)


PROBLEMS = {
    "a force crosses a taut string": Problem(string_force, string_force_miss, 80),
    "a mass crosses a taut string": Problem(string_mass, string_mass_miss, 80, of_contacts=True),
    "a string is released from a mode": Problem(released, released_miss, 40),
    "a force crosses two joined strings": Problem(joined_strings, joined_strings_miss, 80),
    "a force on a soft string": Problem(self_similar, self_similar_miss, 192, of_contacts=True),
    "a rope hangs": Problem(hanging, hanging_miss, 24),
    "a rope hangs under a force": Problem(burdened, burdened_miss, 24),
    "a force crosses a beam": Problem(beam_force, beam_force_miss, 32),
    "a mass crosses a beam": Problem(beam_mass, beam_mass_miss, 32, of_contacts=True),
    "a membrane is released from a mode": Problem(drum, drum_miss, 16),
}
