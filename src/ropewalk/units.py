"""Quantities at the edge: a number is SI, a string carries its unit; inside, everything is an SI float."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint  # lazy: only scenarios that write units pay for it

    return pint.UnitRegistry()


def to_si(value: object, unit: str) -> float:
    """Read a quantity as a float in `unit` (an SI unit).

    Args:
        value: a number (already SI) or a string such as "100 kN"; a bare number in a string is SI too.
        unit: the SI unit wanted, for example "N" or "kg/m".

    Raises:
        ValueError: not a quantity, not finite, or of another dimension; the message says what was expected.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"expected a number or a quantity in {unit}")
    try:
        number = float(value) if not isinstance(value, str) else _parse(value, unit)
    except OverflowError:
        raise ValueError(f"the number is too large to be a quantity in {unit}") from None
    if not math.isfinite(number):
        raise ValueError(f"expected a finite quantity in {unit}")
    return number


def _parse(text: str, unit: str) -> float:
    try:
        return float(text)
    except ValueError:
        pass
    import pint

    registry = _registry()
    try:
        quantity = registry.Quantity(text)
        return float(quantity.to(unit).magnitude)
    except pint.DimensionalityError:
        raise ValueError(f"the unit does not fit: expected a quantity in {unit}") from None
    except Exception:  # pint raises a dozen kinds for unreadable text; all mean the same here
        raise ValueError(f"cannot be read as a quantity in {unit}") from None


def _reader(unit: str) -> Any:
    def read(value: object) -> float:
        return to_si(value, unit)

    schema = {"anyOf": [{"type": "number"}, {"type": "string"}], "unit": unit}
    return BeforeValidator(read), WithJsonSchema(schema)


_l, _t, _f, _v, _m, _d, _r, _a = (
    _reader(unit) for unit in ("m", "s", "N", "m/s", "kg/m", "N*s", "1/s", "m/s^2")
)
Length = Annotated[float, _l[0], _l[1]]
Time = Annotated[float, _t[0], _t[1]]
Force = Annotated[float, _f[0], _f[1]]
Speed = Annotated[float, _v[0], _v[1]]
MassPerLength = Annotated[float, _m[0], _m[1]]
AxialDamping = Annotated[float, _d[0], _d[1]]
Rate = Annotated[float, _r[0], _r[1]]
Acceleration = Annotated[float, _a[0], _a[1]]
Strain = Annotated[float, *_reader("dimensionless")]
