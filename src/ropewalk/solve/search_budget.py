"""Effort of searches for equilibrium: one that fails ends in time.

A search takes at most 5 s of CPU or 200 factorisations of its stiffness, whichever is more, without compilation.
Searches within another one share its budget.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import compiling

_SECONDS, _FACTORISATIONS = 5.0, 200


class SearchBudgetError(EquilibriumError):
    """A search that has taken too long.

    Attributes:
        shape: where it was, m; None: its cause has been found.
    """

    def __init__(self, text: str, shape: Array | None = None) -> None:
        self.shape = shape
        super().__init__(text)


def _used() -> float:
    """CPU time of this process without compilation, s."""
    return time.process_time() - compiling.seconds


@dataclass
class _Effort:
    """What one search has taken, and names of the runs of lines that it moves."""

    names: Sequence[str] = ()
    begin: float = field(default_factory=_used)
    factorisations: int = 0


_PRESENT: ContextVar[_Effort | None] = ContextVar("search", default=None)


@contextmanager
def search(names: Sequence[str] = ()) -> Iterator[None]:
    """Count what is done within as one search, or as a part of the present one.

    Args:
        names: lines of the runs whose equilibrium is sought, for messages.
    """
    present = _PRESENT.get()
    if present is not None:
        before, present.names = present.names, names or present.names
        try:
            yield
        finally:
            present.names = before
        return
    token = _PRESENT.set(_Effort(names))
    try:
        yield
    finally:
        _PRESENT.reset(token)


def names_of_runs() -> Sequence[str]:
    """Return the lines of the runs whose equilibrium is sought; empty where they are not known."""
    present = _PRESENT.get()
    return () if present is None else present.names


def spend(shape: Array) -> None:
    """Count one factorisation, of the stiffness at a shape in m.

    Raises:
        SearchBudgetError: the budget of the search is used up.
    """
    if (present := _PRESENT.get()) is None:
        return
    present.factorisations += 1
    if present.factorisations > _FACTORISATIONS and (used := _used() - present.begin) > _SECONDS:
        raise SearchBudgetError(
            f"no equilibrium was found in {present.factorisations} factorisations ({used:.1f} s of CPU)", shape
        )
