"""What every peer offers, and the few helpers that the peers share."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Literal, Protocol

import numpy as np

from .problem import Array, Rope


@dataclass(frozen=True)
class Setting:
    """One way to run a peer: a method and its tolerance (m, m/s) or step (s).

    ``aligned`` means that steps end where the force passes a node: the integrator is restarted there, or the
    fixed step divides the time from node to node. Adaptive peers default to False, which is plain usage.
    """

    method: str
    size: float
    kind: Literal["tolerance", "step"] = "tolerance"
    aligned: bool = False

    def __str__(self) -> str:
        name = "tol" if self.kind == "tolerance" else "step"
        return f"{self.method}, {name} {self.size:.3g}{', aligned' if self.aligned else ''}"


class Failed(RuntimeError):
    """The peer could not solve the case with this setting; the message says why in a few words."""


class Peer(Protocol):
    """A module of this folder: other packages seen through one door.

    ``settings`` are ordered from coarse to fine within each method and aim at errors from 1e-1 to 1e-5 m.
    ``run`` returns positions of shape (len(times), n + 1, 2) and the CPU seconds of the solve alone, after a
    warm-up where something is compiled; it raises `Failed`. ``suits`` returns None, or why a setting makes no
    sense for a rope. ``chain`` returns the chain that the peer really solves: the rope itself, or the same
    with another axial law, against which its error has to be measured.
    """

    name: str
    distribution: str
    settings: Sequence[Setting]

    def available(self) -> str | None: ...
    def suits(self, rope: Rope, setting: Setting) -> str | None: ...
    def chain(self, rope: Rope) -> Rope: ...
    def run(self, rope: Rope, times: Array, setting: Setting) -> tuple[Array, float]: ...


def missing(module: str, distribution: str) -> str | None:
    """None if ``module`` can be imported, else what to install."""
    return None if find_spec(module) else f"{distribution} is not installed"


def release(distribution: str) -> str:
    """Installed version of a distribution, for the heading of the table."""
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "-"


@contextmanager
def silent() -> Iterator[None]:
    """Send what compiled libraries write to standard output and error to nowhere, so that it does not break
    up the table.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(1), os.dup(2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for number, copy in enumerate(kept, start=1):
            os.dup2(copy, number)
            os.close(copy)
        os.close(nowhere)


def steps_per_passage(rope: Rope, step: float) -> int:
    """How many equal steps of about ``step`` take the force from node to node; raises `Failed` if not even
    one does.
    """
    count = round(rope.passage / step)
    if count < 1 or abs(count * step - rope.passage) > 1e-9 * rope.passage:
        raise Failed(f"a step of {step:g} s does not divide the {rope.passage:g} s from node to node")
    return count


def rows_by_step(times: Array, step: float) -> dict[int, int]:
    """Number of the fixed step that ends at each output time -> row of that time; raises `Failed` between steps."""
    counts = (times - times[0]) / step
    if np.abs(counts - np.round(counts)).max() > 1e-6:
        raise Failed(f"an output time is not a multiple of the step of {step:g} s")
    return {round(count): row for row, count in enumerate(counts)}


def piecewise(times: Array, breaks: Array, solve: Callable[[float, Array, Array], Array], state: Array) -> Array:
    """Integrate with a restart at each of ``breaks``; ``solve(start, stops, state)`` returns states at
    ``stops``, the last one new start.

    Returns the states at ``times``, the first of which is the start.
    """
    out = np.empty((len(times), state.size))
    out[0] = state
    start, done = times[0], 1
    for end in (*breaks, times[-1]):
        last = int(np.searchsorted(times, end + 1e-12))
        stops = times[done:last]
        if len(stops) == 0 or stops[-1] < end - 1e-12:
            stops = np.append(stops, end)
        states = solve(start, stops, state)
        out[done:last] = states[: last - done]
        state, start, done = states[-1], stops[-1], last
    return out
