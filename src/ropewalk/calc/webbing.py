"""Highlines and slacklines: `highline`, a person on webbing without weight, and the bound of a leash fall."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot, sqrt

import numpy as np

from ropewalk.calc.answer import CalcValue
from ropewalk.calc.calculator import Calculator
from ropewalk.calc.common import AXIAL_STIFFNESS, GRAVITY, LENGTH, SPAN, depth, force
from ropewalk.calc.hanging import hang


@dataclass(frozen=True)
class Stance:
    """A person who stands: m below the anchors, the larger tension in N, frequencies of small vibrations in Hz."""

    sag: float
    tension: float
    bounce: float
    surge: float
    sway: float


def stance(
    span: float, length: float, axial_stiffness: float, mass: float, place: float, gravity: float
) -> Stance:  # fmt: skip
    """Of two straight pieces under a person clamped to them: stiffness EA/L along each, T/l across it."""
    rest = hang(span, 0.0, length, 0.0, axial_stiffness, place, mass * gravity)
    (x, z), stiffness, sway = rest.place, np.zeros((2, 2)), 0.0
    for pull, run, part in ((rest.behind, (x, z), place), (rest.ahead, (span - x, -z), 1.0 - place)):
        tangent, across = np.array(pull) / hypot(*pull), hypot(*pull) / hypot(*run)
        along = np.outer(tangent, tangent)
        stiffness += axial_stiffness / (part * length) * along + across * (np.eye(2) - along)
        sway += across
    squares, modes = np.linalg.eigh(stiffness / mass)
    frequencies = np.sqrt(squares) / (2.0 * np.pi)
    bounce = int(np.argmax(np.abs(modes[1])))
    sideways = sqrt(sway / mass) / (2.0 * np.pi)
    return Stance(-z, rest.largest_tension, float(frequencies[bounce]), float(frequencies[1 - bounce]), sideways)


def fall_sag(
    span: float, length: float, axial_stiffness: float, mass: float, gravity: float, fall: float
) -> float:  # fmt: skip
    """Depth at which all energy of a fall in the middle of the line is stored in it, m.

    m g (fall + y) = U(y) - U(0), U = EA (l/L - 1)^2 L/2, l = sqrt(span^2 + 4 y^2).
    """
    from scipy.optimize import brentq

    def stored(y: float) -> float:
        return 0.5 * axial_stiffness * length * max(hypot(span, 2.0 * y) / length - 1.0, 0.0) ** 2

    def short(y: float) -> float:
        return stored(y) - stored(0.0) - mass * gravity * (fall + y)

    high = span
    while short(high) < 0.0:
        high *= 2.0
    return float(brentq(short, 1e-9 * span, high, xtol=1e-13 * high, rtol=1e-13))


def fall_tension(span: float, length: float, axial_stiffness: float, fall_sag: float) -> float:
    """Tension of the line at that depth, N."""
    return axial_stiffness * max(hypot(span, 2.0 * fall_sag) / length - 1.0, 0.0)


highline = Calculator(
    "highline",
    "Person on a highline or slackline: sag, tension, bounce, and the most that a leash fall can do.",
    (
        SPAN,
        CalcValue("standing_tension", "N", "with nobody on the line", search=(1.0, 1e6), typical=2e3, zero=True),
        replace(AXIAL_STIFFNESS, default=None, about="EA of webbing: 10 kN over the stretch at 10 kN", typical=1e5),
        CalcValue("at", "N", "tension at which the stretch is specified", default=10e3, search=(1.0, 1e6), typical=1e4),
        CalcValue("mass", "kg", "of the person", search=(0.1, 1e5), typical=70.0),
        CalcValue(
            "place", "dimensionless", "part of webbing behind the person", high=1.0, default=0.5, share=True,
            search=(1e-3, 1.0),
        ),
        CalcValue(
            "fall", "m", "free fall, from the height of the bare line, until the leash is taut", optional=True,
            search=(1e-3, 1e3),
        ),
        GRAVITY,
    ),
    (
        CalcValue("stretch", "dimensionless", "of webbing at that tension", share=True, typical=0.1),
        replace(LENGTH, about="of webbing, unstrained"),
        depth("sag", "of the person below the anchors"),
        force("tension", "with the person standing, the larger one"),
        CalcValue("bounce_frequency", "Hz", "of small vibrations, up and down"),
        CalcValue("sway_frequency", "Hz", "to the side"),
        CalcValue("surge_frequency", "Hz", "along the line"),
        depth("fall_sag", "greatest depth in a fall, of webbing's middle; no loss, no stretch of the leash"),
        force("fall_tension", "greatest tension in a fall, likewise; mass of webbing and waves can add some per cent"),
        force("fall_force", "greatest pull of the leash, likewise"),
    ),
    {
        "stretch": lambda axial_stiffness, at: at / axial_stiffness,
        "length": lambda span, standing_tension, axial_stiffness: span / (1.0 + standing_tension / axial_stiffness),
        "stance": stance,
        "sag": lambda stance: stance.sag,
        "tension": lambda stance: stance.tension,
        "bounce_frequency": lambda stance: stance.bounce,
        "sway_frequency": lambda stance: stance.sway,
        "surge_frequency": lambda stance: stance.surge,
        "fall_sag": fall_sag,
        "fall_tension": fall_tension,
        "fall_force": lambda span, fall_tension, fall_sag: 4.0 * fall_tension * fall_sag / hypot(span, 2.0 * fall_sag),
    },
    points=120,
)  # fmt: skip
"""Two straight elastic pieces (docs/notes/highlines.md)."""
