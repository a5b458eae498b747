"""What becomes of a scenario when one optional key takes another value: felt, refused by name, or passed over."""

from __future__ import annotations

import copy
import hashlib
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import numpy as np
import xarray as xr

from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model._base import Declaration, declarations_in
from ropewalk.model.limits import Limits
from ropewalk.model.outputs import Outputs
from ropewalk.model.scenario import Scenario
from ropewalk.model.sweep import Sweep
from ropewalk.simulate import simulate

from .bases import BASES, EARLIER, HILLS
from .others import OTHER, Each, Patch
from .structures import Tree
from .working import furnish as furnish_matrix
from .working import read_scenario

FELT, REFUSED, UNFELT, WRONG = "felt", "refused", "UNFELT", "WRONG"
ENGINES = {
    "Scenario.overhead_lines", "Scenario.nets", "Scenario.run", "Line.bending_stiffness", "Line.foundation",
    "Line.sheaves", "Line.supports",
}  # fmt: skip
"""Keys that ask for another engine: what it does not know is refused by its own name."""
PART = 38
"""One in so many changes is in the sample; with this one, none needs kernels of its own (nets beside saddles)."""
SAME = 1e-10
"""Part of the largest value of a variable by which it may differ and be the same."""
_MESSAGE = ("title", "outcome", "advice", "doubts", "warnings", "mesh")
_MORE = 1.25  # times a number that is given
_PLAIN = 3  # letters: shorter names of keys are words of any text

Place = tuple[str, ...]


@dataclass(frozen=True)
class Change:
    """Another value of one key at one place of a base."""

    base: str
    place: Place
    model: type[Declaration]
    key: str  # as written
    choice: str  # which value, where several are tried
    patch: Tree

    @property
    def name(self) -> str:
        """As lists name it."""
        return f"{self.model.__name__}.{self.key}"

    @property
    def message(self) -> str:
        return f"{self.base}: {'.'.join((*self.place, self.key))} ({self.name}) = {self.choice[:80]}"

    def tree(self) -> Tree:
        """The scenario with it."""
        found: Tree = copy.deepcopy(BASES[self.base])
        here: Any = found
        model: Any = base_scenario(self.base)
        for step in self.place:
            model = _inner(model, step)
            here = here.setdefault(step, _begun(model)) if isinstance(here, dict) else here[int(step)]
        here.update(self.patch)
        for key in [key for key, value in here.items() if value is None]:
            del here[key]
        return found


def _begun(model: Any) -> Tree:
    return {"kind": model.kind} if hasattr(model, "kind") else {}


def _inner(model: Any, step: str) -> Any:
    if isinstance(model, dict):
        return model[step]
    if isinstance(model, tuple):
        return model[int(step)]
    names = {field.alias or name: name for name, field in type(model).model_fields.items()}
    return getattr(model, names[step])


@cache
def base_scenario(name: str) -> Scenario:
    """A base as a declaration."""
    found = read_scenario(BASES[name])
    assert isinstance(found, Scenario)
    return found


def optional(model: type[Declaration]) -> Iterator[str]:
    """Optional keys of a declaration as written, but for `kind` and for what a run takes no notice of."""
    for name, field in model.model_fields.items():
        if not field.is_required() and name not in ("kind", "sweep", "outputs", "limits"):
            yield field.alias or name


@cache
def declarations() -> tuple[type[Declaration], ...]:
    """Every declaration of which a run takes notice: not what says which runs there are to be, whose keys have
    tests/sweeps/test_sweep.py, nor what summaries speak of, which has tests/results/test_line_response.py and
    test_limits.py."""
    found: list[type[Declaration]] = []
    waiting: list[type[Declaration]] = [Scenario]
    while waiting:
        model = waiting.pop()
        if model not in found and model not in (Sweep, Outputs, Limits):
            found.append(model)
            waiting += [inner for field in model.model_fields.values() for inner in declarations_in(field.annotation)]
    return tuple(found)


def places(value: Any, place: Place = ()) -> Iterator[tuple[Place, Declaration]]:
    """Every declaration within a value, and where it stands."""
    if isinstance(value, Outputs):
        return
    if isinstance(value, Declaration):
        yield place, value
        for name, field in type(value).model_fields.items():
            yield from places(getattr(value, name), (*place, field.alias or name))
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from places(inner, (*place, key))
    elif isinstance(value, tuple):
        for index, inner in enumerate(value):
            yield from places(inner, (*place, str(index)))


def changes(base: str) -> Iterator[Change]:
    """All changes of a base: every key at every place."""
    for place, model in places(base_scenario(base)):
        for key in optional(type(model)):
            for choice, patch in others(model, key, base, place):
                yield Change(base, place, type(model), key, choice, patch)


def others(model: Declaration, key: str, base: str, place: Place) -> Iterator[tuple[str, Tree]]:
    """Other values of a key, by what they are, each as a patch of the block in which it stands."""
    name, field = next((n, f) for n, f in type(model).model_fields.items() if (f.alias or n) == key)
    value = getattr(model, name)
    listed = next((OTHER[k] for m in type(model).__mro__ if (k := f"{m.__name__}.{key}") in OTHER), None)
    if listed is None:
        listed = OTHER.get(f"*.{key}")
    if callable(listed):
        listed = listed(value, _written(base, place))
    if listed is None:
        listed = _understood(value, field.annotation)
    for other in listed if isinstance(listed, Each) else (listed,):
        patch = other if isinstance(other, Patch) else {key: other}
        if other is not None and patch.get(key, ...) != value:
            yield str(other), dict(patch)


def _written(base: str, place: Place) -> Tree:
    here: Any = BASES[base]
    for step in place:
        here = here.get(step, {}) if isinstance(here, dict) else here[int(step)]
    return dict(here)


def _understood(value: Any, annotation: Any) -> Any:
    """Another value where the table has none: the other choices, more of a number, the contrary."""
    words = [
        word for part in (annotation, *get_args(annotation)) if get_origin(part) is Literal for word in get_args(part)
    ]
    if words:
        return Each(word for word in words if word != value)
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float) and value:
        return value + 1 if isinstance(value, int) else _MORE * value
    return None


@dataclass(frozen=True)
class Outcome:
    """What came of a change."""

    change: Change
    verdict: str
    note: str = ""

    def __str__(self) -> str:
        return f"{self.verdict}: {self.change.message}{': ' if self.note else ''}{self.note}"


@cache
def _computed(base: str) -> dict[str, Any]:
    return values(simulate(base_scenario(base)))


def values(result: xr.Dataset) -> dict[str, Any]:
    """All that a result says: numbers, and what is told."""
    numbers = {str(name): v.values for name, v in result.variables.items() if v.dtype.kind in "fiub"}
    return {**numbers, **{key: str(result.attrs.get(key, "")) for key in _MESSAGE}}


def differing(one: dict[str, Any], other: dict[str, Any]) -> str:
    """What differs first, empty if nothing does."""
    for name in sorted({*one, *other}, key=lambda name: (name in _MESSAGE, name)):
        a, b = one.get(name), other.get(name)
        if isinstance(a, str) or isinstance(b, str) or a is None or b is None:
            if a is None or b is None or a != b:
                return name
        elif a.shape != b.shape or not _same(a, b):
            return name
    return ""


def _same(a: Any, b: Any) -> bool:
    holes = np.isnan(a)
    if (holes != np.isnan(b)).any():
        return False
    a, b = a[~holes], b[~holes]
    return not a.size or bool(np.abs(a - b).max() <= SAME * max(np.abs(a).max(), np.abs(b).max()))


def outcome(change: Change) -> Outcome:
    """Run a base with a change and say what became of it."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            before = _computed(change.base)
            scenario = read_scenario(change.tree())
            if scenario == base_scenario(change.base):
                return Outcome(change, WRONG, "is no other value")
            what = differing(before, values(simulate(scenario)))
    except RopewalkError as error:
        return Outcome(change, REFUSED if names(error, change) else WRONG, str(error))
    except Exception as error:  # a crash is none of the three
        return Outcome(change, WRONG, repr(error))
    return Outcome(change, FELT, what) if what else Outcome(change, UNFELT)


def is_in_the_sample(change: Change) -> bool:
    """Whether a change is one of those of every day: a part of all, always the same."""
    return int(hashlib.sha256(change.message.encode()).hexdigest(), 16) % PART == 0


def names(error: RopewalkError, change: Change) -> bool:
    """Whether an error names the key: in the place of a problem, or in what it says."""
    if change.name in ENGINES:
        return True
    problems = error.problems if isinstance(error, ScenarioError) else ()
    asked = {change.key, *change.patch}
    if any(asked & set(re.split(r"[.\[\]]", problem.key)) for problem in problems):
        return True
    return len(change.key) > _PLAIN and re.search(rf"\b{change.key}\b", str(error)) is not None


def furnish(folder: Path) -> None:
    """Put into a folder what bases name: a vehicle, a model of one's own, irregularities, an earlier result."""
    furnish_matrix(folder)
    (folder / HILLS).write_text("0, 0\n30, 0.002\n60, 0\n")
    simulate(read_scenario(BASES["plain"]), file=folder / EARLIER).close()


def main() -> None:
    """Print what becomes of every key of the bases that are named, or of all."""
    import contextlib
    import sys
    import tempfile
    import time

    chosen = sys.argv[1:] or list(BASES)
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        furnish(Path(folder))
        for base in chosen:
            begin, count = time.process_time(), 0
            for change in changes(base):
                count += 1
                print(outcome(change), flush=True)
            print(f"== {base}: {count} changes, {time.process_time() - begin:.2f} s", flush=True)


if __name__ == "__main__":
    main()
