"""Values that follow from others: `bridge.length / speed + 2 s`, read by Python's parser, computed here with units."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from ropewalk.errors import Refused, did_you_mean
from ropewalk.sweeps.keys import ends_with
from ropewalk.units import measure

Dimension = tuple[Fraction, Fraction, Fraction]
NONE: Dimension = (Fraction(0), Fraction(0), Fraction(0))
LONGEST = 500  # characters
_QUANTITY = re.compile(
    r"(?<![\w.\]])((?>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))[ ]*"
    r"([^\W\d_][\w]*|%|°)((?:[*/^][^\W\d_]\w*|\^[+-]?\d+)*)"
)
_WRITTEN = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")
_BASE = ("m", "kg", "s")
_KNOWN = "write numbers, keys, + - * / ** and brackets, min, max, abs, sqrt; units without spaces in them, as 2 km/h"


@dataclass(frozen=True)
class Amount:
    """A number in SI units with its exponents of metre, kilogram and second."""

    value: float
    dimension: Dimension = NONE

    @classmethod
    def read(cls, text: object) -> Amount | None:
        """A value of a scenario as a file has it, None if it is no quantity."""
        if isinstance(text, int | float) and not isinstance(text, bool):
            return cls(float(text))
        found = _WRITTEN.fullmatch(text) if isinstance(text, str) else None
        if found is None:
            return None
        try:
            return _quantity(found[1], found[2])
        except Refused:
            return None

    def written(self) -> str:
        """As a file has it."""
        if any(power.denominator != 1 for power in self.dimension):
            raise Refused("the unit has a broken power", "check the expression")
        return f"{self.value!r} {_unit(self)}".strip()


def evaluated(text: str, value_of: Callable[[str], Amount]) -> str:
    """Compute an expression.

    Args:
        text: numbers with units, names of values, `+ - * / **`, `min max abs sqrt` and `pi`.
        value_of: gives the value of a name, which may have dots.

    Returns:
        The value as a file has it, with its unit.

    Raises:
        Refused: it cannot be read, has anything else in it, adds what does not go together, or is not finite.
    """
    if len(text) > LONGEST:
        raise Refused(f"the expression has more than {LONGEST} characters", "shorten it")
    units: dict[str, Amount] = {}

    def named(found: re.Match[str]) -> str:
        name = f"_quantity_{len(units)}"
        units[name] = _quantity(found[1], found[2] + found[3])
        return f" {name} "

    plain = _QUANTITY.sub(named, text)
    try:
        tree = ast.parse(plain.strip(), mode="eval")
        amount = _Evaluator(units, value_of).of(tree.body)
        if not math.isfinite(amount.value):
            raise OverflowError
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        if isinstance(error, Refused):
            raise
        raise Refused("this is no expression", _KNOWN) from None
    except (ArithmeticError, TypeError):
        raise Refused("the expression has no finite value", "check its divisors") from None
    return amount.written()


def _quantity(number: str, unit: str) -> Amount:
    if not unit:
        return Amount(float(number))
    try:
        factor, dimension = measure(unit)
    except Refused:
        raise Refused(f"unknown unit {unit}", "put spaces around * and / between values, none within units") from None
    m, kg, s = (Fraction(power) for power in dimension)
    return Amount(float(number) * factor, (m, kg, s))


class _Evaluator:
    """Walks a tree of the parser; whatever is not known here is refused."""

    def __init__(self, units: Mapping[str, Amount], value_of: Callable[[str], Amount]) -> None:
        self.units, self.value_of = units, value_of

    def of(self, node: ast.expr) -> Amount:
        """The value of a node."""
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return Amount(float(number))
            case ast.Name(id=name) if name in self.units:
                return self.units[name]
            case ast.Name(id="pi"):
                return Amount(math.pi)
            case ast.Name() | ast.Attribute() | ast.Subscript():
                return self.value_of(_name(node))
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                one = self.of(operand)
                return Amount(-one.value, one.dimension)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.of(operand)
            case ast.BinOp(left=left, op=op, right=right):
                return _binary(op, self.of(left), self.of(right))
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
                return _function(name, [self.of(argument) for argument in arguments])
        raise Refused("this cannot stand in an expression", _KNOWN, ast.unparse(node)[:60])


def _name(node: ast.expr) -> str:
    """A name with its dots; force[1] is the entry 1 of a list."""
    match node:
        case ast.Name(id=name):
            return name
        case ast.Attribute(value=inner, attr=name):
            return f"{_name(inner)}.{name}"
        case ast.Subscript(value=inner, slice=ast.Constant(value=int() as number)):
            return f"{_name(inner)}.{number}"
    raise Refused("this is no name", _KNOWN, ast.unparse(node)[:60])


def _binary(op: ast.operator, a: Amount, b: Amount) -> Amount:
    match op:
        case ast.Add() | ast.Sub():
            _same([a, b])
            return Amount(a.value + b.value if isinstance(op, ast.Add) else a.value - b.value, a.dimension)
        case ast.Mult():
            return Amount(a.value * b.value, _combined(a.dimension, b.dimension, 1))
        case ast.Div():
            return Amount(a.value / b.value, _combined(a.dimension, b.dimension, -1))
        case ast.Pow():
            if b.dimension != NONE:
                raise Refused("an exponent has a unit", "write a plain number")
            power = Fraction(b.value).limit_denominator(12)
            if any(a.dimension) and float(power) != b.value:
                raise Refused("an exponent of a unit is no simple number", "write for example 2 or 1/2")
            m, kg, s = (exponent * power for exponent in a.dimension)
            value = a.value**b.value
            if isinstance(value, complex):
                raise ArithmeticError
            return Amount(value, (m, kg, s))
    raise Refused("there is no such operator", _KNOWN)


def _function(name: str, arguments: list[Amount]) -> Amount:
    if name in ("min", "max") and arguments:
        _same(arguments)
        return Amount((min if name == "min" else max)(a.value for a in arguments), arguments[0].dimension)
    if name in ("abs", "sqrt") and len(arguments) == 1:
        one = arguments[0]
        return Amount(abs(one.value), one.dimension) if name == "abs" else _binary(ast.Pow(), one, Amount(0.5))
    raise Refused(f"there is no such function, or not with {len(arguments)} arguments", _KNOWN, name)


def _same(amounts: list[Amount]) -> None:
    if len({amount.dimension for amount in amounts}) > 1:
        dimensions = " and ".join(_unit(amount) or "a plain number" for amount in amounts)
        raise Refused(f"{dimensions} do not add up", "give all terms the same kind of unit")


def _unit(amount: Amount) -> str:
    return "*".join(f"{u}^{p}" if p != 1 else u for u, p in zip(_BASE, amount.dimension, strict=True) if p)


def _combined(a: Dimension, b: Dimension, sign: int) -> Dimension:
    m, kg, s = (x + sign * y for x, y in zip(a, b, strict=True))
    return m, kg, s


def resolved(derived: Mapping[str, str], given: Mapping[str, Any], written: Mapping[str, Any]) -> dict[str, str]:
    """Compute all values that follow from others, also from each other.

    Args:
        derived: expressions, by key.
        given: the values of the parameters in this case, by key.
        written: all single values of the scenario, by key.

    Returns:
        The values by key, as a file has them.

    Raises:
        Refused: with the key in its words; one expression cannot be computed, names nothing or several things, or they
            go round in a circle.
    """
    found: dict[str, str] = {}
    under_way: list[str] = []
    everything = {**written, **given, **derived}

    def value_of(name: str) -> Amount:
        among = next((keys for source in (given, derived, written) if (keys := _matching(name, source))), [])
        if not among:
            tails = {key.rpartition(".")[2] for key in everything}
            remedy = did_you_mean(name, [*everything, *tails], "write a key of the scenario, or its last parts")
            raise Refused(f"unknown name {name}", remedy)
        if len(among) > 1:
            raise Refused(f"{name} may be {' or '.join(among[:4])}", "write more of the key")
        key = among[0]
        text = given.get(key, written.get(key)) if key not in derived else computed(key)
        amount = Amount.read(text)
        if amount is None:
            raise Refused(f"{key} is no quantity", "name a number of the scenario", str(text)[:60])
        usual = Amount.read(written.get(key))
        bare = not isinstance(text, str) or text.strip()[-1:].isdecimal()
        return Amount(amount.value, usual.dimension) if bare and usual is not None else amount  # a bare number is SI

    def computed(key: str) -> str:
        if key in under_way:
            raise Refused(
                f"{' and '.join(dict.fromkeys(under_way))} depend on each other", "remove the circular reference"
            )
        if key not in found:
            under_way.append(key)
            found[key] = evaluated(derived[key], value_of)
            under_way.pop()
        return found[key]

    for key in derived:
        try:
            computed(key)
        except Refused as problem:
            raise Refused(f"{key} = {derived[key]}: {problem.wrong}", problem.remedy, problem.given) from None
    return found


def _matching(name: str, source: Mapping[str, Any]) -> list[str]:
    return [name] if name in source else [key for key in source if ends_with(key, name)]
