"""What links beside contacts have, read where the kinks of these end.

A load bends its line at one point. Nodes bear its force some links to either side of that, where they lie on a curve,
so that it has parts along the line: tensions in these links are off by about T half^2 where a line turns by 2 half at
once, and no mesh makes that less. Beyond three links they are right; up to the load they differ from there by what the
line weighs, which is of the first order of the mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.system.contact.contact_record import ON
from ropewalk.system.elements.segments import bending_of
from ropewalk.system.elements.structure import Structure

# Links from a contact to where its kink has ended.
_REACH = 3
# Sine of half the angle of a kink from which on nothing is told of links within it. Of smaller ones they are told in
# part: what is off, T half^2 at most, is then below 3e-3 of the tension.
_SHARP = 0.1


class Reading(NamedTuple):
    """Links that are read from others, an entry for each pair."""

    instant: Integers
    link: Integers  # by its first node
    source: Integers  # the same of the one beyond the kink
    part: Array  # how far: 1 by all

    def of(self, values: Array) -> Array:
        """What links have, (instant, node), as read.

        Args:
            values: what they have in the computation.

        Returns:
            A copy, with NaN where that has it.
        """
        out, own = values.copy(), values[self.instant, self.link]
        out[self.instant, self.link] = own + self.part * (values[self.instant, self.source] - own)
        return out


def beyond_kinks(contacts: Any, tension: Array, structure: Structure) -> Reading:
    """Where to read what links have beside contacts: beyond the kinks, but half way to the next contact at most.

    Args:
        contacts: (instant, contact) records.
        tension: of links by their first node, (instant, node) N.
        structure: what they are on.
    """
    runs = structure.runs
    N = np.linalg.norm(contacts["N"], axis=2)
    instant, k = np.nonzero((contacts["state"] == ON) & (runs.firm[contacts["run"]] == 0.0) & (N > 0.0))
    if structure.about.links.size or not k.size:
        return _together([])
    own = contacts[instant, k]
    order = np.lexsort((own["x"], own["run"], instant))
    instant, own, N = instant[order], own[order], N[instant, k][order]
    run, x, first = own["run"], own["x"], runs.first[own["run"]]
    alike = (instant[1:] == instant[:-1]) & (run[1:] == run[:-1])
    gap = np.where(alike, 0.5 * np.diff(x), np.inf)
    reach = np.minimum(np.array([[np.inf, *gap], [*gap, np.inf]]), _REACH)
    at = np.array([np.ceil(x - reach[0]) - 1.0, np.floor(x + reach[1])]).astype(np.int64)  # behind and ahead
    source = np.minimum(np.maximum(at, 0), runs.links[run] - 1)
    pull = tension[instant, first + source].sum(axis=0) + 2.0 * bending_of(structure, own) / runs.h[run] ** 2
    part = np.minimum(N / np.maximum(pull, N / _SHARP) / _SHARP, 1.0) ** 2
    found = []
    for side, beyond in zip((-1, 1), source, strict=True):
        for away in range(_REACH + 1):
            link = np.floor(x).astype(np.int64) + side * away
            between = ((link + 0.5 >= x) == (side > 0)) & (side * (beyond - link) > 0)
            found.append(Reading(*(e[between] for e in (instant, first + link, first + beyond, part))))
    return _together(found)


def _together(readings: Sequence[Reading]) -> Reading:
    none = np.zeros(0, dtype=np.int64)
    columns = zip(Reading(none, none, none, np.zeros(0)), *readings, strict=True)
    return Reading(*(np.concatenate(column) for column in columns))
