"""Runs of scenario trees, and their results as fields that relations can map onto each other."""

from __future__ import annotations

import json
import time
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from .trees import Tree

Fields = dict[tuple[str, str], NDArray[np.float64]]
"""Arrays by variable and owner, (frame, ..., 3 components): ("tension", "rope"), ("contact_force", "load.front")."""

OWNERS = {
    "position": "line", "tension": "link_line", "reaction": "support", "contact_force": "load",
    "contact_position": "load", "body_position": "body", "energy": "form",
}  # fmt: skip
"""Variables of the contract that are compared, and the coordinate that names their owner."""

WITH_AXIS = ("position", "reaction", "contact_force", "contact_position", "body_position")
DONE, REFUSED, STOPPED, CRASH = "done", "refused", "stopped", "crash"


@dataclass(frozen=True)
class Outcome:
    """A run: how it ended, its fields, and the reason it did not end well."""

    kind: str
    fields: Fields = field(default_factory=dict)
    text: str = ""
    doubts: str = ""


def read(tree: Tree) -> Any:
    """Return the scenario of a tree, as from a file."""
    from ropewalk.scenario.loading import loads

    return loads(json.dumps(tree), "property.json")


def engine(tree: Tree) -> str:
    """Return the name of the engine that computes a tree, empty if it is refused."""
    from ropewalk import capabilities
    from ropewalk.errors import RopewalkError

    try:
        own = capabilities.engine_of(read(tree))
    except RopewalkError:
        return ""
    names = ("ROPES", "WIRES", "SYSTEM", "LINEAR", "SUPERPOSED")
    return next(name.lower() for name in names if getattr(capabilities, name) is own)


def engines(one: Tree, other: Tree) -> str:
    """Return a note where two trees are computed by two engines."""
    names = engine(one), engine(other)
    return "" if names[0] == names[1] else f"engines differ: {' and '.join(name or 'none' for name in names)}"


def attempt(compute: Callable[[], xr.Dataset]) -> Outcome:
    """Run something that gives a result; a refusal, a stopped run and a crash are outcomes, too."""
    from ropewalk.errors import RopewalkError, ScenarioError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return _ended(compute())
    except ScenarioError as error:
        return Outcome(REFUSED, text="; ".join(f"{problem.key}: {problem.wrong}" for problem in error.problems))
    except RopewalkError as error:
        return Outcome(STOPPED, text=str(error))
    except Exception as error:  # a crash is reported as a violation
        frame = traceback.extract_tb(error.__traceback__)[-1]
        return Outcome(CRASH, text=f"{type(error).__name__}: {error} ({Path(frame.filename).name}:{frame.lineno})")


def _ended(result: xr.Dataset) -> Outcome:
    if result.attrs["outcome"] not in ("completed", "doubtful"):
        return Outcome(STOPPED, fields_of(result), f"{result.attrs['outcome']}: {result.attrs['advice']}")
    return Outcome(DONE, fields_of(result), doubts=result.attrs["doubts"])


def run(tree: Tree) -> Outcome:
    """Simulate a tree; equal trees are run once."""
    return _run(json.dumps(tree))


@lru_cache(maxsize=24)
def _run(text: str) -> Outcome:
    from ropewalk.simulate import simulate

    return attempt(lambda: simulate(read(json.loads(text))))


def fields_of(result: xr.Dataset) -> Fields:
    """Return the compared variables by owner, vectors with three components, and the path (time or load path)."""
    leading = "time" if "time" in result.dims else "load_path"
    found: Fields = {(leading, ""): result[leading].values}
    for name, owner in OWNERS.items():
        values, owners = result[name].values, result[owner].values
        if name in WITH_AXIS and values.shape[-1] == 2:
            values = np.stack([values[..., 0], 0.0 * values[..., 0], values[..., 1]], axis=-1)
        for own in dict.fromkeys(owners.tolist()):
            here = values[:, owners == own]
            found[name, own] = here if name in ("position", "tension") else here[:, 0]
    xi, lines = result["xi"].values, result["line"].values
    for own in dict.fromkeys(lines.tolist()):
        found["xi", own] = xi[lines == own]
    for k, own in enumerate(result["load"].values.tolist()):
        found["contact_xi", own] = result["contact_xi"].values[:, k]
    if leading == "load_path" and result.sizes[leading] > 1:  # at last a load is exactly at an end of its line
        return {key: values if key[0] == "xi" else values[:-1] for key, values in found.items()}
    return found


def length_of(tree: Tree, line: str) -> float:
    """Return the unstrained length of a line, m: as given, or as found from its tension."""
    given = tree["lines"][line].get("length")
    if given is None:  # linearised runs count along the chord
        found = run(tree).fields or run({**tree, "loads": {}, "run": {"kind": "equilibrium"}}).fields
        ends = tree["lines"][line]["start"], tree["lines"][line]["end"]
        given = found["xi", line][-1] if found else np.linalg.norm(np.subtract(*ends))
    return float(given)


def seconds() -> float:
    """Return the CPU time of this process, s."""
    return time.process_time()
