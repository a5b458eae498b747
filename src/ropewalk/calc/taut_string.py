"""Taut string: waves, frequencies, and how much it gives way."""

from __future__ import annotations

from math import sqrt

from ropewalk.calc.answer import CalcValue
from ropewalk.calc.calculator import Calculator
from ropewalk.calc.common import GRAVITY, depth


def _frequency(n: int) -> CalcValue:
    return CalcValue(f"frequency_{n}", "Hz", f"of the {('first', 'second', 'third')[n - 1]} mode", search=(1e-3, 1e6))


string = Calculator(
    "string",
    "Taut string or wire between fixed ends.",
    (
        CalcValue("length", "m", "between the ends", search=(1e-3, 1e5), typical=10.0),
        CalcValue("tension", "N", "", search=(1e-3, 1e9), typical=1e4),
        CalcValue("mass", "kg/m", "per length", search=(1e-6, 1e5), typical=1.0),
        CalcValue("force", "N", "across the string", optional=True, search=(1e-6, 1e9)),
        CalcValue(
            "place", "dimensionless", "of the force, as a part of the length", high=1.0, default=0.5, share=True,
            search=(1e-4, 1.0),
        ),
        CalcValue("speed", "m/s", "of a load that moves along it", optional=True, search=(1e-6, 1e6)),
        GRAVITY,
    ),
    (
        CalcValue("wave_speed", "m/s", "sqrt(T/m)"),
        _frequency(1), _frequency(2), _frequency(3),
        depth("sag", "under its own weight, m g L^2/(8 T)"),
        depth("deflection", "under the force, F x (L - x)/(T L)"),
        CalcValue("compliance", "m/N", "deflection over force"),
        CalcValue("speed_ratio", "dimensionless", "speed over that of waves"),
        CalcValue("passage", "s", "time in which the load crosses"),
    ),
    {
        "wave_speed": lambda tension, mass: sqrt(tension / mass),
        "frequency_1": lambda wave_speed, length: wave_speed / (2.0 * length),
        "frequency_2": lambda wave_speed, length: wave_speed / length,
        "frequency_3": lambda wave_speed, length: 1.5 * wave_speed / length,
        "sag": lambda mass, gravity, length, tension: mass * gravity * length**2 / (8.0 * tension),
        "compliance": lambda place, length, tension: place * (1.0 - place) * length / tension,
        "deflection": lambda force, compliance: force * compliance,
        "speed_ratio": lambda speed, wave_speed: speed / wave_speed,
        "passage": lambda speed, length: length / speed,
    },
)  # fmt: skip
"""Closed forms of the taut string."""
