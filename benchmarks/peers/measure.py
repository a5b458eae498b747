"""Error against CPU seconds for many settings of many peers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from .interface import Failed, Peer, Setting
from .problem import Array, Rope, output_times
from .scipy_ivp import reference

USELESS = 1.0  # m: an error of the order of the sag


@dataclass(frozen=True)
class Row:
    """One setting of one peer: error (m) and CPU seconds, or a note that says why there are none."""

    peer: str
    setting: Setting
    error: float = float("nan")
    seconds: float = float("nan")
    note: str = ""


def largest_distance(positions: Array, others: Array) -> float:
    """Largest distance in m between two motions, over all nodes and times."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sqrt(np.sum((positions - others) ** 2, axis=2)).max())


def references(rope: Rope, times: Array) -> tuple[Array, float]:
    """The motion against which peers are measured, and its own uncertainty in m: the change for a ten times
    larger tolerance.

    A chain that goes slack amplifies rounding, so a tight tolerance would be wasted on it.
    """
    tolerance = 1e-7 if rope.tension_only and not rope.damping else 1e-11
    motion = reference(rope, times, tolerance)
    return motion, largest_distance(motion, reference(rope, times, 10 * tolerance))


def _predicted(done: Sequence[Row], setting: Setting) -> float:
    """CPU seconds to expect from the coarser settings of the same method that were run."""
    if not done:
        return 0.0
    last = done[-1]
    if setting.kind == "step":
        return last.seconds * last.setting.size / setting.size
    decades = np.log10(last.setting.size / setting.size)
    growth = 1.5
    if len(done) > 1:
        before = done[-2]
        growth = (last.seconds / before.seconds) ** (1 / np.log10(before.setting.size / last.setting.size))
    return last.seconds * min(max(growth, 1.2), 2.5) ** decades


def measure(
    rope: Rope,
    peers: Iterable[Peer],
    limit: float = 10.0,
    times: Array | None = None,
    motions: dict[Rope, tuple[Array, float]] | None = None,
) -> Iterator[Row]:
    """Rows for every setting of the installed peers, as soon as each is known; settings predicted above
    ``limit`` s are skipped.

    Runs below half a second are repeated twice and the least time counts. ``motions`` keeps the references
    between calls and lets the caller see them.
    """
    times = output_times(rope) if times is None else times
    motions = {} if motions is None else motions
    for peer in peers:
        if peer.available():
            continue
        chain = peer.chain(rope)
        if chain not in motions:
            motions[chain] = references(chain, times)
        done: dict[tuple[str, bool], list[Row]] = {}
        for setting in peer.settings:
            same = done.setdefault((setting.method, setting.aligned), [])
            expected = _predicted(same, setting)
            if reason := peer.suits(rope, setting):
                yield Row(peer.name, setting, note=reason)
                continue
            if expected > limit:
                yield Row(peer.name, setting, note=f"skipped: about {expected:.2g} s")
                continue
            try:
                positions, seconds = peer.run(rope, times, setting)
                for _ in range(2 if seconds < 0.5 else 0):
                    seconds = min(seconds, peer.run(rope, times, setting)[1])
            except Failed as failure:
                yield Row(peer.name, setting, note=f"failed: {failure}")
                continue
            error = largest_distance(positions, motions[chain][0])
            row = Row(peer.name, setting, error, seconds, "" if error < USELESS else "useless")
            same.append(row)
            yield row


def cheapest(rows: Iterable[Row], error: float) -> dict[tuple[str, str], Row]:
    """For each peer and method the row with the least CPU seconds whose error is at most ``error`` m."""
    best: dict[tuple[str, str], Row] = {}
    for row in rows:
        key = (row.peer, row.setting.method + (", aligned" if row.setting.aligned else ""))
        if row.error <= error and (key not in best or row.seconds < best[key].seconds):
            best[key] = row
    return best
