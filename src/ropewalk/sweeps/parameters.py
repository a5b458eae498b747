"""Parameters: keys of a scenario with the values that they take, or the distribution that those are drawn from."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np

from ropewalk.errors import Problem, Refused, ScenarioError, did_you_mean
from ropewalk.sweeps.distributions import DISTRIBUTIONS, Distribution
from ropewalk.units import to_si

MOST = 100_000
"""The most values of one parameter."""
FORM = "write for example 100:350:5 km/h (from, to, step), 'linear(1 kN, 5 kN, 9)', or values with commas between them"
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*([^\W\d_%°].*?|[%°].*?|1/.*?)?\s*")
_CALL = re.compile(r"\s*([a-z_]+)\s*\((.*)\)\s*")
_RANGE = re.compile(rf"\s*{_NUMBER}[^:]*:\s*{_NUMBER}[^:]*:\s*{_NUMBER}[^:]*")
One = TypeVar("One")
_SPACED: dict[str, Callable[..., Any]] = {"linear": np.linspace, "log": np.geomspace}


@dataclass(frozen=True)
class Parameter:
    """A key and what it takes.

    Args:
        key: as `--set` has it.
        levels: its values, as a file has them; empty: they are drawn.
        drawn: the distribution that they are drawn from.
    """

    key: str
    levels: tuple[Any, ...] = ()
    drawn: Distribution | None = None

    @classmethod
    def read(cls, key: str, values: Any) -> Parameter:
        """Read the values of a key: a list, or text as the command line has it.

        Raises:
            ScenarioError: these are no values; it says what to write.
        """
        if not isinstance(values, str):
            levels = tuple(value.item() if hasattr(value, "item") else value for value in values)
            return cls(key, _checked(key, levels, values))
        call = _CALL.fullmatch(values)
        if call is not None and "(" not in call[2]:
            return _called(key, call[1], [part.strip() for part in call[2].split(",")], values)
        if _RANGE.fullmatch(values):
            return cls(key, _stepped(key, values))
        return cls(key, _checked(key, tuple(_split(values)), values))

    def at(self, part: float) -> Any:
        """The value below which a part of all values lies, 0 <= part < 1; each of several levels is equally likely."""
        if self.drawn is not None:
            return self.drawn.at(part)
        return self.levels[min(int(part * len(self.levels)), len(self.levels) - 1)]


def setting(key: str, value: Any) -> str:
    """A value at a key, as `--set` has it."""
    return f"{key}={value if isinstance(value, str) else json.dumps(value)}"


def numbers(values: Sequence[Any], unit: str) -> tuple[list[float], str] | None:
    """Values as numbers in the unit that all of them have, else in the SI unit of their key; None if they are no such.

    Args:
        values: of a parameter.
        unit: SI unit of the key, empty if it has none.
    """
    found = [_number(value) for value in values]
    known = [pair for pair in found if pair is not None]
    if len(known) < len(found):
        return None
    units = {named for _, named in known}
    if len(units) == 1 and units != {""}:
        return [value for value, _ in known], units.pop()
    try:
        return [to_si(value, unit or "dimensionless") for value in values], unit
    except Refused:
        return None


def _number(value: Any) -> tuple[float, str] | None:
    if isinstance(value, str):
        found = _QUANTITY.fullmatch(value)
        return None if found is None else (float(found[1]), found[2] or "")
    return (float(value), "") if isinstance(value, int | float) and not isinstance(value, bool) else None


def quantity(key: str, text: str) -> tuple[str, str]:
    """The number and the unit of a text.

    Raises:
        ScenarioError: it is neither.
    """
    found = _QUANTITY.fullmatch(text)
    if found is None or not math.isfinite(float(found[1])):
        refuse(key, "this is no number with or without a unit", repr(text), FORM)
        raise AssertionError
    return found[1], found[2] or ""


def _checked(key: str, levels: tuple[Any, ...], given: Any) -> tuple[Any, ...]:
    if not levels or any(level is None or level == "" for level in levels):
        refuse(key, "these are no values", repr(given)[:60], FORM)
    if len(levels) > MOST:
        refuse(key, f"has more than {MOST} values", str(len(levels)), "take fewer")
    return levels


def _split(text: str) -> list[str]:
    """Text between commas, brackets kept whole."""
    parts, depth = [""], 0
    for sign in text:
        depth += (sign in "[{(") - (sign in "]})")
        if sign == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += sign
    return [part.strip() for part in parts]


def _stepped(key: str, text: str) -> tuple[str, ...]:
    """FROM:TO:STEP, exactly as decimal numbers add up; TO is taken where a step falls on it."""
    read = [quantity(key, part) for part in text.split(":")]
    unit = _one_unit(key, [named for _, named in read])
    first, last, step = (Fraction(number) for number, _ in read)
    if step == 0 or (last - first) * step < 0:
        refuse(key, "the step does not lead from the first value to the last", text, FORM)
    count = int((last - first) / step) + 1
    if count > MOST:
        refuse(key, f"has more than {MOST} values", str(count), "take a longer step")
    return tuple(written(float(first + k * step), unit) for k in range(count))


def _called(key: str, name: str, parts: list[str], text: str) -> Parameter:
    """linear(FROM, TO, COUNT), log(FROM, TO, COUNT), or a distribution."""
    known = (*_SPACED, *DISTRIBUTIONS)
    if name not in known:
        refuse(key, "no such values", repr(name), did_you_mean(name, known))
    if len(parts) != (3 if name in _SPACED else 2):
        what = "FROM, TO, COUNT" if name in _SPACED else DISTRIBUTIONS[name].form
        refuse(key, "the arguments do not match", text, f"write {name}({what})")
    read = [quantity(key, part) for part in parts]
    if name == "lognormal" and read[1][1]:
        refuse(key, "the deviation of a logarithm has no unit", parts[1], "write for example 0.1")
    unit = _one_unit(key, [named for _, named in read[: 1 if name == "lognormal" else 2]])
    a, b = (float(number) for number, _ in read[:2])
    if name in DISTRIBUTIONS:
        problem = DISTRIBUTIONS[name].problem(a, b)
        if problem:
            refuse(key, problem, text, f"write {name}({DISTRIBUTIONS[name].form})")
        return Parameter(key, drawn=Distribution(name, a, b, unit))
    count, named = read[2]
    if named or not count.isdecimal() or not 1 <= int(count) <= MOST:
        refuse(key, "the number of values is no whole number", parts[2], f"write one from 1 to {MOST}")
    if name == "log" and not (a > 0.0 and b > 0.0):
        refuse(key, "equal factors have positive values only", text, "write linear(...)")
    return Parameter(key, tuple(written(float(value), unit) for value in _SPACED[name](a, b, int(count))))


def _one_unit(key: str, units: Sequence[str]) -> str:
    named = {unit for unit in units if unit}
    if len(named) > 1:
        refuse(key, "all numbers of a range need the same unit", " and ".join(sorted(named)), "write them in one unit")
    return named.pop() if named else ""


def written(value: float, unit: str) -> str:
    """A value as a file has it, read back exactly."""
    return f"{repr(value).removesuffix('.0')} {unit}".strip()


def refuse(key: str, wrong: str, given: str, remedy: str, origin: str = "") -> None:
    """Raise one mistake of a sweep."""
    raise ScenarioError([Problem(key, wrong, given, remedy, origin)])


def parameters_of(over: Mapping[str, Any]) -> tuple[Parameter, ...]:
    """Read all parameters, or tell all their mistakes.

    Raises:
        ScenarioError: with every mistake found.
    """
    return read_all(Parameter.read, over)


def read_all(read: Callable[[str, Any], One], given: Mapping[str, Any]) -> tuple[One, ...]:
    """Read what is given for each key, or tell all the mistakes in it.

    Raises:
        ScenarioError: with every mistake found.
    """
    problems, found = list[Problem](), []
    for key, value in given.items():
        try:
            found.append(read(key, value))
        except ScenarioError as error:
            problems += error.problems
    if problems:
        raise ScenarioError(problems)
    return tuple(found)
