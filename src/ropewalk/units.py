"""Quantities at the edge: a number is SI, a string carries its unit; inside, everything is an SI float."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from functools import lru_cache
from numbers import Real
from typing import Any

from ropewalk.errors import Refused, did_you_mean

LARGEST = 1e30
"""Quantities beyond this (in SI) are refused: products of a few of them would overflow."""
SMALLEST = 1e-30
"""Positive quantities below this (in SI) are refused: quotients by them would overflow."""

_LONGEST_TEXT = 100
_Dimension = tuple[int, int, int]  # exponents of metre, kilogram, second

_TABLE: dict[_Dimension, str] = {
    (1, 0, 0): "m 1, km 1000, dm 0.1, cm 0.01, mm 0.001, µm 1e-6, um 1e-6, "
    "in 0.0254, ft 0.3048, yd 0.9144, mi 1609.344",
    (0, 1, 0): "kg 1, g 0.001, mg 1e-6, t 1000, lb 0.45359237",
    (0, 0, 1): "s 1, ms 0.001, µs 1e-6, us 1e-6, min 60, h 3600",
    (1, 1, -2): "N 1, mN 0.001, daN 10, kN 1e3, MN 1e6, GN 1e9, kgf 9.80665, lbf 4.4482216152605",
    (-1, 1, -2): "Pa 1, kPa 1e3, MPa 1e6, GPa 1e9",
    (0, 0, -1): "Hz 1, kHz 1e3",
    (0, 0, 0): "% 0.01, dimensionless 1, rad 1, mrad 0.001, deg 0.017453292519943295",
}
_SYMBOLS: dict[str, tuple[Fraction, _Dimension]] = {
    entry.split()[0]: (Fraction(entry.split()[1]), dimension)
    for dimension, entries in _TABLE.items()
    for entry in entries.split(", ")
}

_MEANING = {
    "m": ("a length", "19.5 m"),
    "s": ("a time", "10 ms"),
    "N": ("a force", "100 kN"),
    "kg": ("a mass", "80 kg"),
    "rad": ("an angle", "69 deg"),
    "Hz": ("a frequency", "2 Hz"),
    "m/s": ("a speed", "72 km/h"),
    "N/m": ("a stiffness", "14 kN/m"),
    "N*s/m": ("a damping", "200 N*s/m"),
    "kg*m^2": ("a moment of inertia", "1200 kg*m^2"),
    "kg/m": ("a mass per length", "1.35 kg/m"),
    "N*s": ("an axial damping", "50 N*s"),
    "1/s": ("a rate", "0.1 1/s"),
    "m/s^2": ("an acceleration", "9.81 m/s^2"),
    "dimensionless": ("a plain number", "0.02"),
}

_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
_FACTOR = re.compile(r"\s*(?P<operator>[*/])?\s*(?P<symbol>[^\W\d_][\w]*|%|1)(?:\s*\^\s*(?P<power>[+-]?\d))?\s*")
_SAME = str.maketrans(
    {"μ": "µ", "−": "-", "·": "*", "⋅": "*", "²": "^2", "³": "^3", "°": " deg", "\u00a0": " ", "\u202f": " "}
)


def to_si(value: object, unit: str) -> float:
    """Read a quantity as a float in `unit` (an SI unit).

    Args:
        value: a number (already SI) or a string such as "100 kN"; a bare number in a string is SI too.
        unit: the SI unit wanted, for example "N" or "kg/m".

    Raises:
        Refused: (a ValueError) not a quantity, not finite, of another dimension, or beyond 1e30 in size.
    """
    if isinstance(value, str):
        number = _read(value, unit)
    elif isinstance(value, Real) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    else:
        raise Refused(f"expected {_meaning(unit)}", _write_it(unit))
    if math.isnan(number):
        raise Refused(f"expected {_meaning(unit)}, not nan", _write_it(unit))
    if abs(number) > LARGEST:
        raise Refused("the number is too large to calculate with", f"stay below {LARGEST:g} {_displayed(unit)}")
    return number


def written(value: float, unit: str) -> str | float:
    """Write an SI value as text that `to_si` reads back exactly: "1.35 kg/m"; plain numbers stay numbers."""
    text = repr(float(value)).removesuffix(".0")
    return float(value) if unit == "dimensionless" else f"{text} {unit}"


def measure(unit: str) -> tuple[float, _Dimension]:
    """Read a unit such as "kN/m" as its size in SI units and its exponents of metre, kilogram and second.

    Raises:
        Refused: (a ValueError) it is no unit.
    """
    factor, dimension = _product(unit.translate(_SAME).replace("**", "^").strip(), unit)
    return float(factor), dimension


def _meaning(unit: str) -> str:
    return _MEANING.get(unit, (f"a quantity in {unit}", ""))[0]


def _displayed(unit: str) -> str:
    return "" if unit == "dimensionless" else unit


def _write_it(unit: str) -> str:
    example = _MEANING.get(unit, ("", f"1 {unit}"))[1]
    return f"write it as {example}" if unit == "dimensionless" else f"write it in {unit}, for example {example}"


@lru_cache(maxsize=4096)
def _read(text: str, unit: str) -> float:
    if len(text) > _LONGEST_TEXT:
        raise Refused(f"{len(text)} characters are too long for {_meaning(unit)}", _write_it(unit))
    plain = text.translate(_SAME).replace("**", "^").strip()
    match = _NUMBER.match(plain)
    if match is None or re.match(r"\d*,\d|_\d", plain[match.end() :]):
        hint = "write a decimal point and no separators" if match else _write_it(unit)
        raise Refused(f"cannot be read as {_meaning(unit)}", hint)
    number = float(match.group())
    if not math.isfinite(number):
        return number
    if number == 0.0:
        if re.search("[1-9]", re.split("[eE]", match.group())[0]):
            raise Refused("the number is too small to calculate with", f"stay above {SMALLEST:g} or write 0")
        exact = Fraction(0)
    else:
        exact = Fraction(match.group())
    rest = plain[match.end() :].strip()
    if not rest:
        return number
    factor, dimension = _product(rest, unit)
    if dimension != _product(unit, unit)[1]:
        remedy = _recased(rest, unit) or _write_it(unit)
        if unit == "kg" and dimension == (1, 1, -2):  # of a force
            remedy = f"write it in kg: {float(exact * factor) / 9.81:.4g} kg weigh as much"
        raise Refused(f"{rest} does not fit: expected {_meaning(unit)}", remedy)
    try:
        return float(exact * factor)
    except OverflowError:
        return math.inf


def _recased(text: str, unit: str) -> str:
    """Suggest the unit of the same letters, some of them capital or not, that would fit."""
    wanted = _product(unit, unit)[1]
    same = [name for name, (_, dims) in _SYMBOLS.items() if name.lower() == text.lower() and dims == wanted]
    return f"did you mean {same[0]}?" if same else ""


@lru_cache(maxsize=1024)
def _product(text: str, wanted: str) -> tuple[Fraction, _Dimension]:
    """Read a product of units such as "kg/m" or "m/s^2" as its SI factor and its dimension."""
    factor, dimension, at = Fraction(1), (0, 0, 0), 0
    while at < len(text):
        match = _FACTOR.match(text, at)
        if match is None:
            raise Refused(f"the unit cannot be read: expected {_meaning(wanted)}", _write_it(wanted))
        one, dims = _symbol(match["symbol"], wanted)
        power = int(match["power"] or 1) * (-1 if match["operator"] == "/" else 1)
        factor *= one**power
        m, kg, s = (a + power * b for a, b in zip(dimension, dims, strict=True))
        dimension, at = (m, kg, s), match.end()
    return factor, dimension


def _symbol(symbol: str, wanted: str) -> tuple[Fraction, _Dimension]:
    if symbol == "1":
        return Fraction(1), (0, 0, 0)
    if symbol in _SYMBOLS:
        return _SYMBOLS[symbol]
    found = _rare(symbol)
    if found is None:
        options = [*_SYMBOLS, "N*s", "N*m"]
        raise Refused(f"unknown unit {symbol}", did_you_mean(symbol, options, otherwise=_write_it(wanted)))
    return found


@lru_cache(maxsize=256)
def _rare(symbol: str) -> tuple[Fraction, _Dimension] | None:
    """Look one symbol up in pint (slow to import, hence only for units that are not in the table above)."""
    import pint

    try:
        base = _registry().Quantity(1.0, symbol).to_base_units()
        if any(power != int(power) for power in base.dimensionality.values()):
            return None
        dims = {name: int(power) for name, power in base.dimensionality.items()}
        if set(dims) - {"[length]", "[mass]", "[time]"}:
            return Fraction(1), (99, 99, 99)  # a unit, but of no mechanical dimension
        factor = Fraction(repr(float(base.magnitude)))
    except (pint.errors.PintError, ArithmeticError, ValueError, TypeError, AttributeError):
        return None
    return factor, (dims.get("[length]", 0), dims.get("[mass]", 0), dims.get("[time]", 0))


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()
