"""Quantities that several calculators share."""

from __future__ import annotations

from math import inf

from ropewalk.calc.answer import CalcValue

SPAN = CalcValue("span", "m", "level distance of the anchors", search=(1e-2, 1e5), typical=50.0)
LENGTH = CalcValue("length", "m", "of the rope, unstrained", search=(1e-2, 1e5), typical=50.0)
AXIAL_STIFFNESS = CalcValue(
    "axial_stiffness", "N", "EA: tension over strain", default=inf, search=(1e2, 1e11), typical=1e6
)
GRAVITY = CalcValue("gravity", "m/s^2", "of the Earth, unless given", default=9.81, search=(0.1, 100.0), typical=9.81)
ROPE_MASS = CalcValue("mass", "kg/m", "of the rope, per unstrained length", search=(1e-4, 1e4), typical=1.0)


def height(about: str) -> CalcValue:
    """A difference of heights, of either sign."""
    return CalcValue("height", "m", about, low=-inf, default=0.0, search=(1e-3, 1e4), zero=True)


def force(name: str, about: str) -> CalcValue:
    """A force that a calculator finds."""
    return CalcValue(name, "N", about, search=(1e-3, 1e10), typical=1e4)


def angle(name: str, about: str) -> CalcValue:
    """An angle that a calculator finds."""
    return CalcValue(name, "rad", about, low=-inf, zero=True)


def depth(name: str, about: str) -> CalcValue:
    """A depth that a calculator finds."""
    return CalcValue(name, "m", about, low=-inf, zero=True)
