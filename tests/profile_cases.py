"""A sprung mass on a beam so stiff that it is ground, with a profile of one wave, and how it moves in closed form."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.model.scenario import Scenario
from ropewalk.scenario import loads

Array = NDArray[np.float64]

MASS, STIFFNESS, DAMPING, SPEED = 1000.0, 4e5, 4e3, 20.0
HEIGHT, WAVE = 0.01, 5.0  # m, of a profile of one wave
RATE = 2.0 * np.pi * SPEED / WAVE


def read(tree: dict[str, Any]) -> Scenario:
    """A scenario as from a file."""
    return loads(json.dumps(tree))


def rows(file: Path, step: float = 0.05) -> str:
    """A file of a sine as a profile."""
    x = np.arange(-20.0, 60.0 + 0.5 * step, step)
    np.savetxt(file, np.stack([x, HEIGHT * np.sin(2.0 * np.pi * x / WAVE)], axis=1), delimiter=",", fmt="%.17g")
    return str(file)


def rig(profile: dict[str, Any] | None, run: dict[str, Any], start: float = 0.0, axle: float = 0.0) -> dict[str, Any]:
    """A sprung mass that goes over a beam so stiff that it is ground; its wheel starts before the beam."""
    car = {
        "kind": "matrices", "on": "deck", "coordinates": ["body", "wheel"], "mass": [[MASS, 0.0], [0.0, axle]],
        "stiffness": [[STIFFNESS, -STIFFNESS], [-STIFFNESS, STIFFNESS]],
        "damping": [[DAMPING, -DAMPING], [-DAMPING, DAMPING]], "weight": [MASS * 9.81, axle * 9.81],
        "wheels": {"wheel": {"coordinate": "wheel", "at": start}}, "travel": {"speed": SPEED, "at_end": "leave"},
    }  # fmt: skip
    deck = {
        "start": [0.0, 0.0], "end": [40.0, 0.0], "length": 40.0, "mass": 1000.0, "axial_stiffness": 1e10,
        "bending_stiffness": 1e13, "elements": 20,
    }  # fmt: skip
    if profile is not None:
        deck["profile"] = profile
    return {"gravity": 0.0, "lines": {"deck": deck}, "loads": {"car": car}, "run": {"every": 0.02, **run}}


def base_excited(t: Array, start: float) -> tuple[Array, Array]:
    """Place and acceleration of the body of `rig` from its rest: steady motion and what dies away, in closed form."""
    phase = 2.0 * np.pi * start / WAVE
    steady = HEIGHT * (STIFFNESS + 1j * RATE * DAMPING) / (STIFFNESS - MASS * RATE**2 + 1j * RATE * DAMPING)
    steady = steady * np.exp(1j * (RATE * t + phase))
    root = (-DAMPING + np.sqrt(complex(DAMPING**2 - 4.0 * STIFFNESS * MASS))) / (2.0 * MASS)
    y = HEIGHT * np.sin(phase) - (steady[0]).imag
    v = HEIGHT * RATE * np.cos(phase) - (1j * RATE * steady[0]).imag
    free = (y - 1j * (v - y * root.real) / root.imag) * np.exp(root * t)
    return steady.imag + free.real, -(RATE**2) * steady.imag + (root**2 * free).real
