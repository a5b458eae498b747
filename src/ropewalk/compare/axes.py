"""Axes: what is changed in a scenario, through which values."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from ropewalk.compare.ratios import RATIOS, SYMBOLS, Changes, Pair
from ropewalk.errors import Problem, ScenarioError, did_you_mean
from ropewalk.model import Scenario
from ropewalk.scenario import tree_of
from ropewalk.sweeps.keys import unit_at

Scale = Literal["linear", "log"]
SCALES = ("linear", "log")
MOST = 1000
"""The most values of an axis."""
FORM = 'write KEY=FROM:TO:COUNT or KEY=FROM:TO:COUNT:log, for example "load ratio=0.001:0.3:12:log"'

_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")


@dataclass(frozen=True)
class Axis:
    """One direction of a plane of parameters.

    Args:
        key: a key of the scenario as `--set` has it, such as "loads.train.travel.speed", or a ratio that is found from
            the scenario: "speed ratio" (speed over the speed of transverse waves on the line at rest), "load ratio"
            (weight or force over tension at rest), "mass ratio" (of load and line); "speed ratio of train" names the
            load.
        values: at least two, rising; SI, unless there is a unit.
        scale: of figures.
        unit: of the values of a key.
        load: of a ratio: name of the load (default: the only one).
        line: of a ratio: name of the line (default: the one that the load is on).

    Raises:
        ScenarioError: the values are too few or do not rise, or a ratio is unknown.
    """

    key: str
    values: tuple[float, ...]
    scale: Scale = "linear"
    unit: str = ""
    load: str = ""
    line: str = ""

    def __post_init__(self) -> None:
        key, load = _key(self.key)
        object.__setattr__(self, "key", key)
        object.__setattr__(self, "load", self.load or load)
        object.__setattr__(self, "values", tuple(float(value) for value in self.values))
        _check_values(self)

    @classmethod
    def linear(cls, key: str, first: float, last: float, count: int, **more: str) -> Axis:
        """Make an axis of equal steps."""
        return cls(key, tuple(np.linspace(first, last, _count(key, count)).tolist()), "linear", **more)

    @classmethod
    def logarithmic(cls, key: str, first: float, last: float, count: int, **more: str) -> Axis:
        """Make an axis of equal factors."""
        if not (first > 0.0 and last > 0.0):
            _refuse(key, "a logarithmic axis has positive values only", f"{first:g} to {last:g}", "leave log out")
        return cls(key, tuple(np.geomspace(first, last, _count(key, count)).tolist()), "log", **more)

    @classmethod
    def parse(cls, text: str) -> Axis:
        """Read an axis as the command line has it: "KEY=FROM:TO:COUNT", with ":log" for equal factors.

        Raises:
            ScenarioError: the text is no axis; it says what was given and what to write.
        """
        key, sign, values = (part.strip() for part in text.partition("="))
        parts = values.split(":")
        if not (sign and key and len(parts) in (3, 4) and all(part.strip() for part in parts)):
            _refuse("", "this is no axis", repr(text), FORM)
        scale = parts[3].strip() if len(parts) == 4 else "linear"
        if scale not in SCALES:
            _refuse(key, "no such scale", repr(scale), did_you_mean(scale, SCALES, "write log, or leave it out"))
        (first, unit), (last, other) = (_quantity(key, part) for part in parts[:2])
        if unit and other and unit != other:
            _refuse(key, "both ends of an axis need the same unit", f"{unit} and {other}", "write both in one unit")
        make = cls.logarithmic if scale == "log" else cls.linear
        return make(key, first, last, _whole(key, parts[2]), unit=unit or other)

    @property
    def is_ratio(self) -> bool:
        """Whether it is a ratio, and not a key."""
        return self.key in RATIOS

    def resolved(self, scenario: Scenario) -> Axis:
        """The same with what the scenario tells: the load and the line of a ratio, the unit of a key.

        Raises:
            ScenarioError: the scenario has no such load or line, or several loads.
        """
        if self.is_ratio:
            pair = Pair.of(scenario, self.key, self.load, self.line)
            return replace(self, load=pair.load, line=pair.line)
        written = tree_of(scenario)
        return self if self.unit else replace(self, unit=unit_at(written, self.key))

    def changes(self, scenario: Scenario, value: float) -> Changes:
        """What gives the scenario a value of this axis: new values by their keys.

        Raises:
            ScenarioError: the scenario has no such ratio.
            EquilibriumError: a line has no rest to find its tension from.
        """
        if self.is_ratio:
            return Pair.of(scenario, self.key, self.load, self.line).changes(self.key, value)
        return {self.key: f"{value!r} {self.unit}" if self.unit else value}

    def overrides(self, scenario: Scenario, value: float) -> list[str]:
        """The same as overrides of a scenario file, each "key=value"; errors as above."""
        return [f"{key}={_yaml(changed)}" for key, changed in self.changes(scenario, value).items()]

    @property
    def name(self) -> str:
        """What it is called in sentences: "speed ratio", "tension of rope"."""
        if self.is_ratio:
            return self.key
        block, *inner = self.key.split(".")
        if len(inner) < 2:
            return self.key
        what = " ".join(part.replace("_", " ") for part in reversed(inner[1:]) if part != "travel")
        return f"{what} of {inner[0]}" if block in ("lines", "loads", "overhead_lines") else self.key

    @property
    def label(self) -> str:
        """What stands at the axis of a figure: "speed ratio V/c of train on rope", "tension of rope (N)"."""
        if self.is_ratio:
            of = f" of {self.load}" if self.load else ""
            on = f" on {self.line}" if self.line else ""
            return f"{self.key} {SYMBOLS[self.key]}{of}{on}"
        return f"{self.name} ({self.unit})" if self.unit else self.name

    def caption(self, value: float) -> str:
        """A value in a sentence."""
        return f"{value:.3g} {self.unit}".strip()

    def as_dict(self) -> dict[str, Any]:
        """What it is, as plain values."""
        found = {"key": self.key, "values": list(self.values), "scale": self.scale}
        return found | {name: value for name in ("unit", "load", "line") if (value := getattr(self, name))}


def _key(key: str) -> tuple[str, str]:
    """A key or the name of a ratio, and the load that it names."""
    if "." in key or key in ("gravity",):
        return key, ""
    ratio, _, load = (part.strip() for part in key.partition(" of "))
    ratio = re.sub(r"[\s_-]+", " ", ratio)
    if ratio not in RATIOS:
        known = f"write a key such as loads.train.travel.speed, or one of {', '.join(RATIOS)}"
        _refuse(key, "neither a key of a scenario nor a ratio", repr(key), did_you_mean(ratio, RATIOS, known))
    return ratio, load


def _check_values(axis: Axis) -> None:
    values = axis.values
    _count(axis.key, len(values))
    if axis.scale not in SCALES:
        _refuse(axis.key, "no such scale", repr(axis.scale), "write linear or log")
    if not all(math.isfinite(value) for value in values):
        _refuse(axis.key, "a value is not finite", "", "give finite numbers")
    for before, after in pairwise(values):
        if not after > before:
            _refuse(axis.key, "values must rise", f"{after:g} after {before:g}", "begin with the smallest")
    if (axis.is_ratio or axis.scale == "log") and not values[0] > 0.0:
        what = "a ratio is" if axis.is_ratio else "a logarithmic axis has"
        _refuse(axis.key, f"{what} positive", f"{values[0]:g}", "begin with a value above 0")


def _count(key: str, count: int) -> int:
    if not 2 <= count <= MOST:
        _refuse(key, f"an axis has 2 to {MOST} values", str(count), "change the number of values")
    return count


def _whole(key: str, text: str) -> int:
    if not re.fullmatch(r"\s*\d{1,9}\s*", text):
        _refuse(key, "the number of values is no whole number", repr(text), FORM)
    return int(text)


def _quantity(key: str, text: str) -> tuple[float, str]:
    found = _QUANTITY.fullmatch(text)
    if found is None:
        _refuse(key, "this is no number with or without a unit", repr(text), FORM)
        raise AssertionError
    return float(found[1]), found[2]


def _yaml(value: Any) -> str:
    """A changed value in YAML, which JSON is."""
    return value if isinstance(value, str) else json.dumps(value)


def _refuse(key: str, wrong: str, given: str, remedy: str) -> None:
    raise ScenarioError([Problem(key, wrong, given, remedy)])
