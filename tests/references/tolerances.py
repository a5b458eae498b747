"""Tolerances of a case: from the difference between its mesh and one with half the elements.

The tolerance of a quantity is twice that difference, at least FLOOR of its range, at most CAP of it. Where the
difference is larger than SPREAD caps, the mesh does not decide the quantity: of a trace only the instants before that
are held, of energies also the last instant; impulses, low-passed forces and the numbers of the summary remain.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .observing import Array, Observation
from .recording import Record

FLOOR = 1e-3
CAP = {"position": 0.02, "force": 0.05, "energy": 0.05, "impulse": 0.05}
SPREAD = 1.5  # caps: the error of the finer mesh is a third of the difference or less where the order is 2
ROUNDING = 1e-6  # of the largest value
NOTHING = 1e-9
SHARE = 0.01  # of the largest range of the same kind: what is smaller counts as nothing
OFFSET = 0.1  # of the largest value: range of a quantity that hardly changes
LENGTHS = ("sag", "deflection", "sideways", "lowest", "height", "uplift")
TRUSTED, DOUBTFUL, WRONG = "trusted", "doubtful", "known wrong"


@dataclass
class Held:
    """A quantity that is compared: values (instant, ...) and their tolerance."""

    values: Array
    tolerance: float


@dataclass
class Reference:
    """The reference of a case, the result of today's engines.

    Args:
        mark: trusted, doubtful or known wrong.
        keys: of a refusal.
        structure: variables, attributes and keys by label of the result.
        quantities: that are compared, by name.
        numbers: value and tolerance by path.
    """

    name: str
    mark: str
    outcome: str
    exit_code: int
    keys: list[str] = field(default_factory=list)
    structure: dict[str, Any] = field(default_factory=dict)
    quantities: dict[str, Held] = field(default_factory=dict)
    numbers: dict[str, tuple[float, float]] = field(default_factory=dict)
    cpu: float = 0.0


def reference_of(record: Record, wrong: str) -> Reference:
    """Return the reference of a recorded case; `wrong` is the reason why it is known to be wrong."""
    full, half = record.full, record.half
    mark = WRONG if wrong else TRUSTED if full.outcome == "completed" else DOUBTFUL
    found = Reference(record.name, mark, full.outcome, full.exit_code, cpu=full.cpu, structure=full.structure)
    if full.outcome == "refused":
        found.keys = sorted({line.partition(":")[0] for line in full.note.splitlines()})
    if half is not None and half.outcome != full.outcome:
        half = None
    found.quantities = dict(_quantities(full.quantities, half))
    found.numbers = dict(_numbers(full.numbers, half))
    return found


def kind_of(name: str) -> str:
    """Return the kind of a quantity."""
    return name.partition(":")[0]


def scales(quantities: Mapping[str, Array]) -> dict[str, float]:
    """Return the largest range of each kind; of positions that of shapes and displacements."""
    found = dict.fromkeys(CAP, 0.0)
    for name, values in quantities.items():
        kind, finite = kind_of(name), values[np.isfinite(values)]
        if finite.size and (kind != "position" or any(word in name for word in ("shape", "displacement", "heights"))):
            found[kind] = max(found[kind], float(np.ptp(finite)), 0.0 if kind == "position" else OFFSET * _most(finite))
    return found


def _quantities(quantities: Mapping[str, Array], half: Observation | None) -> Iterable[tuple[str, Held]]:
    scale = scales(quantities)
    for name, values in quantities.items():
        kind = kind_of(name)
        finite = values[np.isfinite(values)]
        if not finite.size:
            continue
        spread = float(np.ptp(finite))
        spread = max(spread, SHARE * scale[kind], 0.0 if kind == "position" else OFFSET * _most(finite))
        least = max(FLOOR * spread, ROUNDING * _most(finite), NOTHING)
        cap = max(CAP[kind] * spread, least)
        other = half.quantities.get(name) if half is not None else None
        held, tolerance = _held(values, other, least, cap)
        if held:
            yield name, Held(values[:held], tolerance)
        if held < len(values) and kind == "energy":
            last, tolerance = _held(values[-1:], other[-1:] if other is not None else None, least, cap)
            if last:
                yield f"{name} at the end", Held(values[-1:], tolerance)


def _held(values: Array, other: Array | None, least: float, cap: float) -> tuple[int, float]:
    """Return the number of instants that are held, and the tolerance of these."""
    if other is None or other.shape != values.shape:
        return len(values), max(least, 0.5 * cap)
    apart = np.abs(values - other).reshape(len(values), -1)
    apart[(np.isnan(values) & np.isnan(other)).reshape(apart.shape)] = 0.0
    worst = np.where(np.isnan(apart), np.inf, apart).max(axis=1)
    beyond = np.flatnonzero(worst > SPREAD * cap)
    held = int(beyond[0]) if beyond.size else len(values)
    return held, float(min(max(2.0 * worst[:held].max(initial=0.0), least), cap))


def _numbers(numbers: Mapping[str, float], half: Observation | None) -> Iterable[tuple[str, tuple[float, float]]]:
    groups: dict[str, float] = {}
    for path, value in numbers.items():
        group = path.rpartition("/")[0]
        groups[group] = max(groups.get(group, 0.0), abs(value))
    for path, value in numbers.items():
        scale = max(abs(value), OFFSET * groups[path.rpartition("/")[0]])
        cap = (CAP["position"] if any(word in path for word in LENGTHS) else CAP["force"]) * scale
        least = max(FLOOR * scale, NOTHING)
        if half is None:
            yield path, (value, max(0.5 * cap, least))
        elif path in half.numbers and (apart := abs(value - half.numbers[path])) <= SPREAD * max(cap, least):
            yield path, (value, min(max(2.0 * apart, least), max(cap, least)))


def _most(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))
