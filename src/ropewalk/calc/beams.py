"""Beams on their usual supports: deflections, moments, frequencies, buckling.

EI w'''' = F delta(x - a) + q has w = F <x - a>^3/6 EI + q x^4/24 EI + c0 + c1 x + c2 x^2/2 + c3 x^3/6, with four
conditions at the ends for the c's. Frequencies are (beta/L)^2 sqrt(EI/m), beta L the roots of
cos cosh = -1 (cantilever), cos cosh = 1 (clamped), tan = tanh (propped), sin = 0 (simply supported).
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import cos, cosh, factorial, pi, sin, sinh, sqrt

import numpy as np

from ropewalk.calc.answer import CalcValue
from ropewalk.calc.calculator import Calculator
from ropewalk.calc.common import GRAVITY

# Derivatives of w that vanish at the start and at the end.
ENDS = {
    "simply_supported": ((0, 2), (0, 2)),
    "clamped": ((0, 1), (0, 1)),
    "propped": ((0, 1), (0, 2)),
    "cantilever": ((0, 1), (2, 3)),
}
# Free length over that of a beam on two hinges that buckles under the same force (Euler).
BUCKLES_AS = {"simply_supported": 1.0, "clamped": 0.5, "propped": pi / 4.493409457909064, "cantilever": 2.0}


def bent(ends: str, place: float, force: float, load: float) -> tuple[float, ...]:
    """c0 ... c3 of a beam of unit length and unit EI."""
    rows, right = [], []
    for at, orders in zip((0.0, 1.0), ENDS[ends], strict=True):
        for d in orders:
            rows.append([at ** (n - d) / factorial(n - d) if n >= d else 0.0 for n in range(4)])
            right.append(-_own(at, d, place, force, load))
    return tuple(float(c) for c in np.linalg.solve(rows, right))


def _own(x: float, d: int, place: float, force: float, load: float) -> float:
    """Derivative of order d of what force and load add."""
    jump = force * (x - place) ** (3 - d) / factorial(3 - d) if x >= place else 0.0
    return jump + load * x ** (4 - d) / factorial(4 - d)


def curve(x: float, d: int, ends: str, place: float, force: float, load: float) -> float:
    """Derivative of order d of the deflection of a beam of unit length and unit EI."""
    c = bent(ends, place, force, load)
    return sum(c[n] * x ** (n - d) / factorial(n - d) for n in range(d, 4)) + _own(x, d, place, force, load)


def largest(d: int, ends: str, place: float, force: float, load: float) -> float:
    """Largest size of that derivative: at the ends, at the force, or where the next one vanishes."""
    from scipy.optimize import brentq

    c = bent(ends, place, force, load)

    def value(x: float, order: int) -> float:
        own = _own(x, order, place, force, load)
        return sum(c[n] * x ** (n - order) / factorial(n - order) for n in range(order, 4)) + own

    grid = sorted({*np.linspace(0.0, 1.0, 41).tolist(), place})
    found = [abs(value(x, d)) for x in grid]
    for a, b in pairwise(grid):
        low, high = value(a + 1e-12, d + 1), value(b - 1e-12, d + 1)
        if low * high < 0.0:
            found.append(abs(value(float(brentq(lambda x: value(x, d + 1), a + 1e-12, b - 1e-12, xtol=1e-14)), d)))
    return max(found)


@cache
def wavenumber(ends: str, n: int) -> float:
    """beta L of mode n."""
    from scipy.optimize import brentq

    if ends == "simply_supported":
        return n * pi
    equations = {
        "clamped": (lambda b: cos(b) - 1.0 / cosh(b), n * pi, (n + 1) * pi),
        "cantilever": (lambda b: cos(b) + 1.0 / cosh(b), (n - 1) * pi, n * pi),
        "propped": (lambda b: sin(b) - cos(b) * sinh(b) / cosh(b), n * pi, (n + 0.5) * pi),
    }
    equation, low, high = equations[ends]
    return float(brentq(equation, low + 1e-3, high - 1e-6, xtol=1e-14))


def _deflection(ends: str, place: float, force: float, length: float, bending_stiffness: float) -> float:
    return curve(place, 0, ends, place, force, 0.0) * length**3 / bending_stiffness


def _sag(ends: str, load: float, length: float, bending_stiffness: float) -> float:
    return largest(0, ends, 0.5, 0.0, load) * length**4 / bending_stiffness


def _frequency(n: int) -> CalcValue:
    return CalcValue(f"frequency_{n}", "Hz", f"of the {('first', 'second', 'third')[n - 1]} mode", search=(1e-3, 1e6))


beam = Calculator(
    "beam",
    "Beam on its usual supports: deflections, bending moments, frequencies, buckling.",
    (
        CalcValue("length", "m", "between the supports, or of the cantilever", search=(1e-3, 1e4), typical=10.0),
        CalcValue("bending_stiffness", "N*m^2", "EI", search=(1e-3, 1e15), typical=1e8),
        CalcValue("mass", "kg/m", "per length", optional=True, search=(1e-4, 1e6), typical=1e3),
        CalcValue("force", "N", "across the beam", optional=True, search=(1e-3, 1e9), typical=1e4),
        CalcValue(
            "place", "dimensionless", "of the force, as a part of the length", high=1.0, default=0.5, share=True,
            search=(1e-3, 1.0),
        ),
        CalcValue("line_load", "N/m", "spread over the beam", optional=True, search=(1e-3, 1e8)),
        CalcValue("speed", "m/s", "of a force that crosses it", optional=True, search=(1e-3, 1e4)),
        GRAVITY,
    ),
    (
        CalcValue("deflection", "m", "under the force"),
        CalcValue("moment", "N*m", "largest under the force"),
        CalcValue("line_deflection", "m", "largest under the line load"),
        CalcValue("line_moment", "N*m", "largest under the line load"),
        CalcValue("sag", "m", "largest under its own weight"),
        _frequency(1), _frequency(2), _frequency(3),
        CalcValue("buckling_force", "N", "of Euler"),
        CalcValue("speed_ratio", "dimensionless", "speed times pi/L over the first circular frequency"),
    ),
    {
        "deflection": _deflection,
        "moment": lambda ends, place, force, length: largest(2, ends, place, force, 0.0) * length,
        "line_deflection": lambda ends, line_load, length, bending_stiffness: _sag(
            ends, line_load, length, bending_stiffness
        ),
        "line_moment": lambda ends, line_load, length: largest(2, ends, 0.5, 0.0, line_load) * length**2,
        "sag": lambda ends, mass, gravity, length, bending_stiffness: _sag(
            ends, mass * gravity, length, bending_stiffness
        ),
        "rate": lambda bending_stiffness, mass, length: sqrt(bending_stiffness / mass) / length**2,
        "frequency_1": lambda ends, rate: wavenumber(ends, 1) ** 2 * rate / (2.0 * pi),
        "frequency_2": lambda ends, rate: wavenumber(ends, 2) ** 2 * rate / (2.0 * pi),
        "frequency_3": lambda ends, rate: wavenumber(ends, 3) ** 2 * rate / (2.0 * pi),
        "buckling_force": lambda ends, bending_stiffness, length: bending_stiffness
        * (pi / (BUCKLES_AS[ends] * length)) ** 2,
        "speed_ratio": lambda speed, length, frequency_1: speed / (2.0 * length * frequency_1),
    },
    points=120,
    choices={"ends": tuple(ENDS)},
)  # fmt: skip
"""Bernoulli-Euler beam."""
