"""Distributions of a parameter, by their quantiles."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import NormalDist

_LEAST = 2.0**-53  # the part of values below which none is drawn: a normal quantile of 0 is infinite


@dataclass(frozen=True)
class Kind:
    """A family of distributions: what its two numbers are, problems of them, its quantile."""

    form: str
    problem: Callable[[float, float], str]
    quantile: Callable[[float, float, float], float]


def _rising(a: float, b: float) -> str:
    return "" if a < b else "the upper bound is not above the lower one"


DISTRIBUTIONS = {
    "uniform": Kind("LOW, HIGH", _rising, lambda a, b, p: a + p * (b - a)),
    "loguniform": Kind(
        "LOW, HIGH",
        lambda a, b: _rising(a, b) if a > 0.0 else "equal factors have positive values only",
        lambda a, b, p: a * (b / a) ** p,
    ),
    "normal": Kind(
        "MEAN, STD",
        lambda _, b: "" if b > 0.0 else "the standard deviation is not positive",
        lambda a, b, p: a + b * NormalDist().inv_cdf(max(p, _LEAST)),
    ),
    "lognormal": Kind(
        "MEDIAN, STD of the logarithm",
        lambda a, b: "" if a > 0.0 and b > 0.0 else "median and deviation are not positive",
        lambda a, b, p: a * math.exp(b * NormalDist().inv_cdf(max(p, _LEAST))),
    ),
}


@dataclass(frozen=True)
class Distribution:
    """One distribution, in a unit."""

    kind: str
    a: float
    b: float
    unit: str = ""

    def at(self, part: float) -> str:
        """The value below which a part of all values lies, as a file has it."""
        value = DISTRIBUTIONS[self.kind].quantile(self.a, self.b, part)
        return f"{float(value)!r} {self.unit}".strip()
