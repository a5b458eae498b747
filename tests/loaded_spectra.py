"""Frequency equations of strings and beams that carry a mass or an oscillator."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ropewalk.solve.spectrum import Modes

Array = NDArray[np.float64]
Receptance = Callable[[float], float]


def of_string(length: float, place: float, tension: float, mass: float) -> Receptance:
    """Deflection of a taut string under a harmonic unit force where it acts: sin(k a) sin(k b) / (T k sin(k L))."""

    def receptance(w: complex) -> complex:
        k = w * np.sqrt(mass / tension)
        return np.sin(k * place) * np.sin(k * (length - place)) / (tension * k * np.sin(k * length))

    return receptance  # type: ignore[return-value]


def of_beam(length: float, bending_stiffness: float, mass: float) -> Receptance:
    """The same of a hinged beam in its middle: (tan(beta L / 2) - tanh(beta L / 2)) / (4 EI beta^3)."""

    def receptance(w: complex) -> complex:
        beta = (w * w * mass / bending_stiffness) ** 0.25
        half = 0.5 * beta * length
        return (np.tan(half) - np.tanh(half)) / (4.0 * bending_stiffness * beta**3)

    return receptance  # type: ignore[return-value]


def rigid(mass: float) -> Receptance:
    """Force over displacement of a mass, by -w^2 of which it is pushed: w^2 m."""
    return lambda w: w * w * mass


def sprung(mass: float, stiffness: float, damping: float = 0.0, wheel: float = 0.0) -> Receptance:
    """The same of a mass on a spring and a damper: w^2 (m_w + m k / (k - m w^2)), k complex if damped."""

    def force(w: complex) -> complex:
        k = stiffness + 1j * w * damping if damping else stiffness
        return w * w * (wheel + mass * k / (k - mass * w * w))

    return force  # type: ignore[return-value]


def roots(receptance: Receptance, load: Receptance, count: int, highest: float) -> Array:
    """The lowest frequencies at which structure and load agree: receptance * load = 1, on a fine grid and refined."""
    w = np.linspace(highest / 40000, highest, 40000)

    def miss(x: float) -> float:
        return 1.0 / float(receptance(x)) - float(load(x))

    values = np.array([miss(x) for x in w])
    found = []
    for a, b, u, v in zip(w, w[1:], values, values[1:], strict=False):
        if u * v < 0.0:
            root = brentq(miss, a, b, xtol=1e-14)
            if abs(miss(root)) < 1e-6 * (abs(u) + abs(v)):  # a pole is none
                found.append(root)
    assert len(found) >= count
    return np.array(found[:count])


def nearest(modes: Modes, wanted: Array) -> Array:
    """The frequencies of a spectrum next to wanted ones, rad/s."""
    return np.array([modes.frequency[np.abs(modes.frequency - w).argmin()] for w in wanted])
