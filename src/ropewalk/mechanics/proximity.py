"""Crowds: wheels of one or of several loads that come so close to each other that a node cannot carry both."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.mechanics.travelled import Travelled

# Times at which the places of two wheels are compared, besides those at which a speed has a corner.
INSTANTS = 2001
# Part of a place by which two ways of measuring it may differ: the stretch and the slopes of a line.
MEASURED = 0.1


def shares_links(
    wheels: Sequence[ContactPoint],
    weightless: set[str],
    links: dict[str, float],
    lengths: dict[str, float],
    until: float,
) -> set[int]:
    """Find the wheels that come close to another one.

    Forces alone share nodes, which costs accuracy and nothing else. Beside a wheel of a body, and beside whatever has
    a place of its own for that, a contact needs one as well.

    Args:
        wheels: of all loads.
        weightless: the loads that are forces.
        links: distance that counts as close on each line, m.
        lengths: of the lines, unstrained, m.
        until: how long the run is, s.

    Returns:
        Their numbers. Feet are not among them: nobody knows where they will stand.
    """
    pairs = [
        (j, k)
        for j, k in combinations(range(len(wheels)), 2)
        if wheels[j].on == wheels[k].on
        and wheels[j].given
        and wheels[k].given
        and _come_close(wheels[j], wheels[k], links[wheels[j].on], lengths[wheels[j].on], until)
    ]
    found = {k for pair in pairs for k in pair if any(wheels[n].load not in weightless for n in pair)}
    while more := {k for pair in pairs if found & set(pair) for k in pair} - found:
        found |= more
    return found


def _come_close(one: ContactPoint, two: ContactPoint, distance: float, length: float, until: float) -> bool:
    """Whether two wheels are closer than a distance in m at some time, or pass each other, while on the line."""
    if one.free is not None or two.free is not None:
        return True  # where one of them will be is not known
    tables = [speed_table(wheel.speed, until) for wheel in (one, two)]
    times = np.linspace(0.0, until, INSTANTS)
    times = np.unique(np.concatenate([times, *(t[(t > 0.0) & (t < until)] for t, _ in tables)]))
    a, b = (Travelled(*table).at(times, wheel.start) for wheel, table in zip((one, two), tables, strict=True))
    slack = 0.0 if one.measured == two.measured else MEASURED * length
    on = np.minimum(a, b) > -distance
    on &= np.maximum(a, b) < length * (1.0 + MEASURED) + distance
    gap = np.abs(b - a) - slack
    passing = (np.sign(b[1:] - a[1:]) != np.sign(b[:-1] - a[:-1])) & on[1:] & on[:-1]
    return bool((gap[on] < distance).any() or passing.any())
