"""Walkers: the force of their steps, and crowds that sway a footbridge."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.model import Crowd
from ropewalk.scenario.examples import examples
from ropewalk.theory import gait
from ropewalk.theory.lateral_balance import sway_growth
from ropewalk.validation.known_case import KnownCase
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.publication import Publication

WEIGHT = 75.0 * 9.81
STEPS = """
gravity: 9.81
lines: {{path: {{start: [0, 0], end: [20, 0], tension: 1.0e+8, mass: 1000, axial_stiffness: 1.0e+10, elements: 20}}}}
loads:
  walker: {{kind: footsteps, on: path, mass: 75, frequency: {frequency}, step_length: 0.7, model: {model}, from: 4}}
run: {{kind: dynamic, until: {until!r}, every: {every!r}}}
"""


def steps(model: str, frequency: float) -> str:
    """Five seconds or so of a person on a firm path: a whole number of steps."""
    until = 10.0 / frequency
    return STEPS.format(model=model, frequency=frequency, until=until, every=until / 400.0)


def harmonic(result: Any, order: int) -> float:
    """Amplitude of a harmonic of the step frequency in the force of both feet, over the weight."""
    force = -np.nansum(result.contact_force.sel(axis="z").to_numpy(), axis=1)[:400]
    return float(2.0 * np.abs(np.fft.rfft(force))[10 * order] / force.size) / WEIGHT


def factor(model: Any, frequency: float, order: int) -> float:
    """The same as published."""
    return float(model(weight=WEIGHT, step_frequency=frequency).factors[order - 1])


def growth(result: Any) -> float:
    """Growth rate of the first lateral mode of 1.1 Hz from 10 s on, 1/s."""
    shape, w = np.sin(np.pi * result.xi.values / 60.0), 2.0 * np.pi * 1.1
    q, v = (result[key].sel(axis="y").values @ shape for key in ("position", "velocity"))
    late = result.time.values >= 10.0
    return float(np.polyfit(result.time.values[late], 0.5 * np.log(q**2 + (v / w) ** 2)[late], 1)[0])


def growth_by_theory() -> float:
    """The same by the pendulum's theory, 1/s."""
    people = Crowd(on="deck", number=60).people(60.0)
    return sway_growth(
        1.1, damping_rate=4.0 * np.pi * 0.007 * 1.1, modal_mass=0.5 * 900.0 * 60.0, leg_length=1.17,
        mass=[one.mass for one in people], step_time=[1.0 / one.frequency for one in people],
    ).real  # fmt: skip


BACHMANN = Publication(
    "H. Bachmann and W. Ammann, Vibrations in Structures, IABSE Structural Engineering Documents 3e, 1987"
)
YOUNG = Publication("P. Young, Improved floor vibration prediction methodologies, Arup Vibration Seminar, 2001")

CASES = (
    KnownCase(
        "walking-bachmann", "The force of a walker by Bachmann, two steps a second", BACHMANN, steps("bachmann", 2.0),
        (
            KnownNumber("first", "first harmonic over the weight", "", "published number", lambda: 0.4,
                lambda r: harmonic(r, 1), "the feet together give the sum exactly; outputs of ten "
                                          "steps", absolute=1e-3),
            KnownNumber("second", "second harmonic over the weight", "", "published number", lambda: 0.1,
                lambda r: harmonic(r, 2), "as above", absolute=1e-3),
        ),
        fault=("loads.walker.mass=77",), quick=True,
    ),
    KnownCase(
        "walking-young", "The force of a walker by Young, 1.8 steps a second", YOUNG, steps("young", 1.8),
        (
            KnownNumber("first", "first harmonic over the weight, 0.41 (f - 0.95)", "", "published number",
                lambda: 0.41 * (1.8 - 0.95), lambda r: harmonic(r, 1), "as above", absolute=1e-3),
            KnownNumber("second", "second harmonic over the weight, 0.069 + 0.0056 * 2 f", "", "published number",
                lambda: factor(gait.young, 1.8, 2), lambda r: harmonic(r, 2), "as above", absolute=1e-3),
        ),
        fault=("loads.walker.mass=77",),
    ),
    KnownCase(
        "crowd-lock-in", "Sixty people sway a footbridge of 1.1 Hz",
        Publication("J. H. G. Macdonald, Lateral excitation of bridges by balancing pedestrians, Proc. R. Soc. A 465 "
               "(2009), "
               "1055-1073, for the pendulum; its growth rate in ropewalk.theory.lateral_balance",
               "title, author, volume and pages"),
        lambda: examples()["footbridge-lock-in"],
        (
            KnownNumber("growth", "growth rate of the sway", "1/s", "closed form", growth_by_theory, growth,
                "the forces of the gait itself are still felt 10 s after the start", absolute=6e-3),
        ),
        fault=("lines.deck.damping.ratio=1.2 %",),
    ),
)  # fmt: skip
