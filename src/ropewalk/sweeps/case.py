"""One case of a sweep: a scenario, the quantities that are kept of its run, and what became of it."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import ropewalk
from ropewalk.errors import RopewalkError
from ropewalk.model import Dynamic, Linear, Quasistatic, Scenario
from ropewalk.model.writing import check_writable, text_of, tree_of
from ropewalk.permission import is_code_forbidden
from ropewalk.results.contract import doubts_of
from ropewalk.sweeps.by_modes import by_modes
from ropewalk.sweeps.keys import leaves
from ropewalk.sweeps.quantities import Measured, broken_limits, measured

FINE = ("completed", "doubtful")
FAILED, LOST, MISSING = "failed", "lost", "not computed"


@dataclass(frozen=True)
class Case:
    """What is computed: the key says what it is, and is the same for the same."""

    key: str
    scenario: Scenario
    record: tuple[str, ...]

    @classmethod
    def of(cls, scenario: Scenario, record: tuple[str, ...]) -> Case:
        """The case of a scenario, whose title and sweep do not matter."""
        scenario = scenario.model_copy(update={"title": "", "sweep": None})
        if is_code_forbidden():  # asked here already: the computers of a cluster do not inherit the environment
            from ropewalk.external.models import refuse_code  # lazy: most sweeps need no external models

            refuse_code(scenario.loads)
        check_writable(scenario)
        tree = tree_of(scenario)
        identity = [ropewalk.__version__, text_of(tree), *sorted(record), *_files_in(tree)]
        return cls(hashlib.sha256("\0".join(identity).encode()).hexdigest()[:32], scenario, record)


@dataclass(frozen=True)
class Outcome:
    """What became of a case.

    Args:
        outcome: that of the run, or failed, lost (its process died) or not computed.
        values: the quantities; of a run that stopped early there are none.
        doubts: why it must not be trusted.
        reason: why there are no values.
        seconds: that it took.
        broken: names of broken limits, by the quantities that count them.
    """

    outcome: str
    values: Measured
    doubts: tuple[str, ...] = ()
    reason: str = ""
    seconds: float = 0.0
    broken: dict[str, str] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """As plain values that fit into JSON."""
        return {
            "outcome": self.outcome, "values": {name: list(pair) for name, pair in self.values.items()},
            "doubts": list(self.doubts), "reason": self.reason, "seconds": round(self.seconds, 3),
            **({"broken": self.broken} if self.broken else {}),
        }  # fmt: skip

    @classmethod
    def from_dict(cls, found: dict[str, Any]) -> Outcome:
        """Back from plain values.

        Raises:
            KeyError, TypeError, ValueError: these are no such values.
        """
        values: Measured = {}
        for name, (value, unit) in found["values"].items():
            values[str(name)] = None if value is None else float(value), str(unit)
        doubts = tuple(str(doubt) for doubt in found["doubts"])
        broken = {str(name): str(text) for name, text in found.get("broken", {}).items()}
        return cls(str(found["outcome"]), values, doubts, str(found["reason"]), float(found["seconds"]), broken)


def computed(case: Case) -> Outcome:
    """Compute a case; whatever goes wrong is its outcome."""
    began = time.perf_counter()
    try:
        found = run(case)
    except RopewalkError as error:
        found = Outcome(FAILED, {}, reason="; ".join(str(error).splitlines()))
    except Exception as error:  # a fault in one case does not take the others with it
        found = Outcome(FAILED, {}, reason=f"a fault of ropewalk: {type(error).__name__}: {error}")
    return replace(found, seconds=time.perf_counter() - began)


def run(case: Case) -> Outcome:
    """Compute a case.

    Raises:
        RopewalkError: it has no result at all.
    """
    from ropewalk.simulate import simulate

    if (found := by_modes(case.scenario, case.record)) is not None:
        return Outcome("completed", found)
    with simulate(case.scenario) as result:
        outcome, doubts = str(result.attrs["outcome"]), tuple(doubts_of(result))
        if outcome in FINE:
            values = measured(result, case.record)
            return Outcome(outcome, values, doubts, broken=broken_limits(result, case.record))
        return Outcome(FAILED, {}, reason=f"{outcome}; {result.attrs['advice']}".rstrip("; "))


def check_record(case: Case) -> None:
    """Refuse quantities that a run does not have, from its first two instants; kernels are compiled on the way.

    Raises:
        ScenarioError: with all names that are unknown.
    """
    from ropewalk.simulate import output_times, simulate

    run = case.scenario.run
    if isinstance(run, Dynamic | Linear):
        first = float(output_times(run)[1])
        sample = run.sample if isinstance(run, Dynamic) and run.sample else 1e-3
        soon = min(first, 3.0 * sample)
        run = run.model_copy(update={"until": soon, "every": soon})
    elif isinstance(run, Quasistatic):
        run = run.model_copy(update={"positions": 2, "turn": None})
    try:
        result = simulate(case.scenario.model_copy(update={"run": run}))
    except RopewalkError:
        return  # each case tells by itself
    with result:
        measured(result, case.record)


def _files_in(tree: dict[str, Any]) -> Iterator[str]:
    """Contents of the files that a scenario names, as hashes: models of others, and results to start from."""
    for key, value in leaves(tree):
        if isinstance(value, str) and key.rpartition(".")[2] in ("file", "model"):
            for name in (value, value.rpartition(":")[0]):
                if name and os.path.isfile(name):
                    yield json.dumps([key, _content(name, os.stat(name).st_mtime_ns)])


@lru_cache(maxsize=256)
def _content(file: str, _: int) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()
