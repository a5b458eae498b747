"""Profiles of lines as cubic splines: what lies between a line and the wheels on it, and before and behind the line.

The way of a wheel is the spline of its line and the profile r(s) above it, p + r e_z: of it the contact knows the place
and the slope, so that masses feel r'' U^2 + r' U'.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined, lean
from ropewalk.mechanics.profile_spectra import profile_of, usual_wavelengths
from ropewalk.model.scenario import Scenario
from ropewalk.model.travel import Travel
from ropewalk.overhead.irregularity import read_irregularity

# Part by which a profile is longer than what loads are thought to reach: speeds may be measured along what stretches.
_LONGER = 0.1


class Profiles(NamedTuple):
    """Profiles of all lines; of their splines the coefficients of 1, x, x^2, x^3 from the knot on."""

    first: Integers  # (line,) its first knot
    knots: Integers  # (line,) 0: it is smooth
    s: Array  # (knot,) m
    c: Array  # (4, knot)

    @staticmethod
    def none(lines: int) -> Profiles:
        """Lines that are smooth."""
        none = np.zeros(lines, dtype=np.int64)
        return Profiles(none, none.copy(), np.zeros(0), np.zeros((4, 0)))

    @staticmethod
    def of(scenario: Scenario, names: Sequence[str], lengths: Sequence[float], until: float) -> Profiles:
        """Those of the lines of a scenario, as far as loads may come.

        Args:
            scenario: with its lines.
            names: of lines, the first ones of all.
            lengths: of all lines, m.
            until: s, how long loads travel.

        Raises:
            ScenarioError: a file cannot be read, or its rows are not as they should be.
        """
        found = Profiles.none(len(lengths))
        if not any(line.profile for line in scenario.lines.values()):
            return found
        from scipy.interpolate import CubicSpline  # lazy: it takes long to import, and few lines have a profile

        s, c = list[Array](), list[Array]()
        for i, (name, length) in enumerate(zip(names, lengths, strict=False)):
            line = scenario.lines.get(name)
            if line is None or line.profile is None:
                continue
            x, z = rows_of(scenario, name, length, until)
            polynomials = CubicSpline(x, z, bc_type="natural").c[::-1]
            found.first[i], found.knots[i] = sum(one.size for one in s), x.size
            s.append(x)
            c.append(np.hstack([polynomials, [[z[-1]], [0.0], [0.0], [0.0]]]))
        return found._replace(s=np.concatenate(s), c=np.hstack(c)) if s else found


def rows_of(scenario: Scenario, name: str, length: float, until: float) -> tuple[Array, Array]:
    """Places and heights of the profile of a line, as far as loads may come, m.

    Args:
        scenario: with the line.
        name: of the line, which has a profile.
        length: of it, m.
        until: s, how long loads travel.

    Raises:
        ScenarioError: its file cannot be read, or its rows are not as they should be.
    """
    profile = scenario.lines[name].profile
    assert profile is not None
    if profile.file is not None:
        rows = read_irregularity(Path(profile.file), f"lines.{name}.profile.file")
        return rows.x, rows.z
    begin, end = _reach(scenario, name, length, until)
    assert profile.spectrum is not None
    shortest, longest = profile.wavelengths or usual_wavelengths(profile.spectrum)
    return profile_of(profile.spectrum, profile.seed, (shortest, longest), begin, end)


def _reach(scenario: Scenario, name: str, length: float, until: float) -> tuple[float, float]:
    """Between which places along a line wheels can be, m."""
    low, high = 0.0, length
    for load in scenario.loads.values():
        travel = getattr(load, "travel", None)
        if load.on != name or not isinstance(travel, Travel):
            continue
        way = float(np.abs(speed_table(travel.speed, until)[1]).max()) * until
        low = min(low, *(place.start - way for place in load.starts()))
        high = max(high, *(place.start + way for place in load.starts()))
    longer = _LONGER * (high - low)
    return low - longer, high + longer


@inlined
def height_at(profiles, line, s):
    """Height of the profile of a line at s in m, and its slope."""
    if profiles.knots[line] == 0:
        return 0.0, 0.0
    low = profiles.first[line]
    high = low + profiles.knots[line] - 1
    if s <= profiles.s[low]:
        return profiles.c[0, low], 0.0
    if s >= profiles.s[high]:
        return profiles.c[0, high], 0.0
    while high - low > 1:
        middle = (low + high) // 2
        if s < profiles.s[middle]:
            high = middle
        else:
            low = middle
    x, c = s - profiles.s[low], profiles.c
    height = c[0, low] + x * (c[1, low] + x * (c[2, low] + x * c[3, low]))
    return height, c[1, low] + x * (2.0 * c[2, low] + 3.0 * x * c[3, low])


@lean
def profile_entry(profiles, line, s):
    """The height of `height_at` as Python calls it."""
    return height_at(profiles, line, s)[0]
