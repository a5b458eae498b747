"""Comparison of an answer with the reference of its case."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from ruamel.yaml import YAML

from .observing import Array, Observation, rank
from .tolerances import TRUSTED, Held, Reference

ACCEPTED = Path(__file__).with_name("accepted.yaml")
BETTER = "better"


@dataclass(frozen=True)
class Difference:
    """One difference of a case.

    Args:
        case: its name.
        quantity: the quantity, number or part of the structure.
        text: how they differ.
        size: over the tolerance; infinite where something is missing.
    """

    case: str
    quantity: str
    text: str
    size: float = np.inf

    def __str__(self) -> str:
        """One line."""
        return f"{self.case}: {self.quantity}: {self.text}"


def differences(reference: Reference, found: Observation) -> Iterator[Difference]:
    """Return the differences of an answer from its reference.

    Outcome, exit code and structure are compared in every case, numbers in trusted ones only. A better outcome is no
    difference, and then the rest is not compared.
    """
    name, worse = reference.name, rank(found.outcome) - rank(reference.outcome)
    if worse < 0:
        return
    if worse > 0 or found.exit_code != reference.exit_code:
        text = f"{found.outcome} (exit code {found.exit_code}), was {reference.outcome} ({reference.exit_code})"
        yield Difference(name, "outcome", f"{text}: {' '.join(found.note.split())[:200]}")
    if worse > 0 and not found.structure:
        return
    yield from _in_structure(name, reference.structure, found.structure)
    if reference.mark != TRUSTED:
        return
    for quantity, held in reference.quantities.items():
        yield from _in_quantity(name, quantity, held, found.quantities)
    for path, (value, tolerance) in reference.numbers.items():
        if path not in found.numbers:
            yield Difference(name, path, f"missing, was {value:.6g}")
        elif not (apart := abs(found.numbers[path] - value)) <= tolerance + 1e-6 * abs(value):  # stored in single
            size = apart / tolerance
            yield Difference(name, path, f"{found.numbers[path]:.6g}, was {value:.6g}, {size:.2g} tolerances", size)


def is_better(reference: Reference, found: Observation) -> bool:
    """Return whether the outcome is better than it was."""
    return rank(found.outcome) < rank(reference.outcome)


def _in_quantity(name: str, quantity: str, held: Held, found: Mapping[str, Array]) -> Iterator[Difference]:
    source = quantity.removesuffix(" at the end")
    if source not in found:
        yield Difference(name, quantity, "missing")
        return
    values = found[source][-1:] if source != quantity else found[source][: len(held.values)]
    if values.shape != held.values.shape:
        yield Difference(name, quantity, f"shape {list(values.shape)}, was {list(held.values.shape)}")
        return
    apart = np.abs(values - held.values)
    apart[np.isnan(values) & np.isnan(held.values)] = 0.0
    apart = np.where(np.isnan(apart), np.inf, apart)
    size = float(apart.max(initial=0.0)) / (held.tolerance * STORED)
    if size > 1.0:
        at = np.unravel_index(int(apart.argmax()), apart.shape)
        text = f"{values[at]:.6g}, was {held.values[at]:.6g} at {list(map(int, at))}, {size:.2g} tolerances"
        yield Difference(name, quantity, text, size)


STORED = 1.125
"""Tolerances, with the rounding of stored values to quarters of one."""


def _in_structure(name: str, was: Mapping[str, Any], found: Mapping[str, Any]) -> Iterator[Difference]:
    for label, own in was.items():
        if label not in found:
            yield Difference(name, label, "missing")
            continue
        for part, value in own.items():
            for text in _missing(value, found[label].get(part)):
                yield Difference(name, f"{label} {part}", text)


def _missing(was: Any, found: Any) -> Iterator[str]:
    """Return what an answer lacks: entries of lists, keys of dictionaries; values of keys must be equal."""
    if isinstance(was, dict):
        for key, value in was.items():
            if key not in (found or {}):
                yield f"{key} is missing"
            elif isinstance(value, list) and value and isinstance(value[-1], list):  # a variable
                yield from _of_variable(key, value, found[key])
            elif value != found[key]:
                yield f"{key} is {found[key]}, was {value}"
    elif isinstance(was, list):
        yield from (f"{entry} is missing" for entry in was if entry not in (found or []))
    elif was != found:
        yield f"{found}, was {was}"


def _of_variable(key: str, was: list[Any], found: list[Any]) -> Iterator[str]:
    for name, one, other in zip(("dimensions", "type", "units"), was, found, strict=False):
        if one != other:
            yield f"{name} of {key}: {other}, was {one}"
    yield from (f"attribute {entry} of {key} is missing" for entry in was[3] if entry not in found[3])


@dataclass(frozen=True)
class Accepted:
    """A difference that is accepted, with an independent number that decides for the new value."""

    case: str
    quantity: str
    value: float
    tolerance: float
    source: str


def accepted(file: Path = ACCEPTED) -> list[Accepted]:
    """Return the accepted differences."""
    return [Accepted(**entry) for entry in YAML(typ="safe").load(file) or ()]


def without_accepted(found: Iterable[Difference], answer: Observation, own: Iterable[Accepted]) -> list[Difference]:
    """Return the differences that are not accepted: where the answer has the independent number."""
    kept = []
    entries = {(entry.case, entry.quantity): entry for entry in own}
    for difference in found:
        entry = entries.get((difference.case, difference.quantity))
        if entry is None or not _agrees(entry, answer):
            kept.append(difference)
    return kept


def _agrees(entry: Accepted, answer: Observation) -> bool:
    values = answer.quantities.get(entry.quantity, np.array([answer.numbers.get(entry.quantity, np.nan)]))
    return bool(np.nanmin(np.abs(values - entry.value), initial=np.inf) <= entry.tolerance)
