"""What a sweep computes: a scenario, parameters, values that follow, and the cases of all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ropewalk.errors import Refused, RopewalkError, ScenarioError
from ropewalk.model import Scenario, Sweep
from ropewalk.scenario import dump, tree_of, varying
from ropewalk.sweeps.case import Case, Outcome
from ropewalk.sweeps.combining import combined
from ropewalk.sweeps.expressions import resolved
from ropewalk.sweeps.keys import leaves, overlap, short_names, unit_at
from ropewalk.sweeps.parameters import Parameter, numbers, parameters_of, refuse, setting

TEXT = ("outcome", "doubts", "reason", "seconds", "case")
"""What a table tells next to parameters and quantities."""
RESERVED = ("parameter", "quantity")
"""Names of dimensions over which the effects of parameters are told."""


@dataclass(frozen=True)
class Row:
    """One case: the values of the parameters, what sets them, and what is computed or why nothing is."""

    values: tuple[Any, ...]
    settings: list[str]
    case: Case | None
    refused: str = ""


@dataclass(frozen=True)
class Plan:
    """A sweep that is ready to be computed.

    Args:
        scenario: what the cases are changes of.
        sweep: what was asked.
        parameters: what varies.
        names: short names of the parameters.
        rows: all cases.
    """

    scenario: Scenario
    sweep: Sweep
    parameters: tuple[Parameter, ...]
    names: tuple[str, ...]
    rows: tuple[Row, ...]

    @classmethod
    def of(cls, scenario: Scenario, sweep: Sweep, most: int | None = None) -> Plan:
        """Make all cases, or at most so many of the first.

        Raises:
            ScenarioError: values cannot be read or combined, keys touch each other, or no case at all is a scenario.
        """
        scenario = scenario.model_copy(update={"sweep": None})
        parameters = parameters_of(sweep.over)
        keys = [*sweep.over, *sweep.derived]
        for k, key in enumerate(keys):
            if touched := overlap([key], keys[:k]):
                refuse(touched[0], "is set twice", "", "leave one of the two keys out")
        written = dict(leaves(tree_of(scenario)))
        count = sweep.count if most is None or sweep.count is None else min(sweep.count, most)
        points = combined(parameters, sweep.combine, count, sweep.seed, written)
        is_whole = count == sweep.count and (most is None or len(points) <= most)
        points = points[:most]
        make = varying(dump(scenario), "the sweep")
        rows, first = [], None
        for point in points:
            given = dict(zip(sweep.over, point, strict=True))
            settings = [setting(key, value) for key, value in given.items()]
            try:
                settings += [f"{key}={value}" for key, value in resolved(sweep.derived, given, written).items()]
                case, refused = Case.of(make(settings), sweep.record), ""
            except (RopewalkError, Refused) as error:
                first = first or error
                case, refused = None, "; ".join(str(error).splitlines())
            rows.append(Row(point, settings, case, refused))
        if first is not None and is_whole and all(row.case is None for row in rows):
            if isinstance(first, ScenarioError):
                raise first
            wrong = first.wrong if isinstance(first, Refused) else str(first)
            refuse("sweep.derived", wrong, "", first.remedy if isinstance(first, Refused) else "")
        names = tuple(short_names([p.key for p in parameters], (*TEXT, *sweep.record, *RESERVED)))
        return cls(scenario, sweep, parameters, names, tuple(rows))

    @property
    def is_grid(self) -> bool:
        """Whether each value goes with each."""
        return self.sweep.combine == "grid"

    def coordinate(self, k: int) -> tuple[np.ndarray[Any, Any], str]:
        """Values of a parameter as an array, and their unit: of a grid its levels, else one for each case."""
        parameter = self.parameters[k]
        values = parameter.levels if self.is_grid else [row.values[k] for row in self.rows]
        found = numbers(values, unit_at(tree_of(self.scenario), parameter.key))
        if found is None:
            return np.array([setting("", value)[1:] for value in values], dtype=object), ""
        return np.array(found[0]), found[1]

    def outcome(self, row: Row, done: Mapping[str, Outcome], otherwise: Outcome) -> Outcome:
        """What became of a case."""
        if row.case is None:
            return Outcome("failed", {}, reason=row.refused)
        return done.get(row.case.key, otherwise)


def asked(
    scenario: Scenario,
    over: Mapping[str, Any] | None,
    *,
    derived: Mapping[str, str] | None = None,
    record: str | Sequence[str] | None = None,
    combine: str | None = None,
    count: int | None = None,
    seed: int | None = None,
) -> Sweep:
    """Definition of a sweep: that of the scenario, with the given parts replaced.

    Raises:
        ScenarioError: nothing varies, or something does not go together.
    """
    own = scenario.sweep
    tree = {} if own is None else {name: getattr(own, name) for name in type(own).model_fields}
    names = [part.strip() for part in record.split(",")] if isinstance(record, str) else record
    given = {"over": over, "derived": derived, "record": names, "combine": combine, "count": count, "seed": seed}
    tree |= {name: value for name, value in given.items() if value is not None}
    if "over" not in tree:
        refuse(
            "sweep.over", "nothing varies", "", "name a key and its values, or write a block  sweep:  into the scenario"
        )
    try:
        return Sweep(**tree)
    except ScenarioError as error:
        raise ScenarioError([replace(p, key=f"sweep.{p.key}", file="") for p in error.problems]) from None
