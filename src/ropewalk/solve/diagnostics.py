"""Diagnostics of plain ropes in quasi-static runs and in motion, each reported once, where it begins."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.bodies import CARRIED
from ropewalk.mechanics.chain import CLAMPED, COULOMB, OFF, Array, ChainState
from ropewalk.solve.quasistatic import LoadPosition
from ropewalk.solve.start import PreparedRun

# A tension below this part of that on the other side is none.
_SLACK = 1e-6
# What a wheel may take with it when it leaves its line, as a part of the moving and the elastic energy.
_PARTING = 0.02
# More links than these are no remedy.
_MOST_LINKS = 10_000


class Diagnostics:
    """Watches the places of a walk."""

    def __init__(self, setting: PreparedRun, names: tuple[str, ...]) -> None:
        self.setting, self.names = setting, names
        self._made: set[tuple[int, str]] = set()
        self._last: LoadPosition | None = None

    def on(self, place: LoadPosition) -> list[str]:
        """The remarks that are new with this place."""
        found = []
        for s, rest in enumerate(place.stands):
            first, last = float(rest.r[0, 0]), float(rest.r[0, -1])
            low, high, span = min(first, last), max(first, last), float(rest.X[-1])
            for k, load in enumerate(self.setting.on[s]):
                x, both = float(rest.r[0, rest.contact[k]]), rest.beside[k].tolist()
                if not low - 1e-9 * span <= x <= high + 1e-9 * span:
                    found.append((load, "beyond", f"hangs beyond the support, at x = {x:.4g} m"))
                least, most = min(both), max(both)
                if least <= _SLACK * most and most > 0.0:
                    side = "ahead of" if both[1] < both[0] else "behind"
                    found.append((load, "slack", f"leaves the part {side} it slack"))
                found += self._friction(int(load), float(rest.friction[k]), float(rest.hold[k]))
                if self._last is not None:
                    before = self._last.stands[s]
                    step = x - float(before.r[0, before.contact[k]])
                    along = (place.xi[load] - self._last.xi[load]) * (last - first)
                    if step * along < 0.0 and abs(step) > 1e-9 * span:
                        found.append((load, "back", f"moves backwards, at x = {x:.4g} m"))
        self._last = place
        new = [(int(load), kind, text) for load, kind, text in found if (int(load), kind) not in self._made]
        self._made |= {(load, kind) for load, kind, _ in new}
        return [f"from load path {place.path:.4g} m on, load {self.names[load]} {text}" for load, _, text in new]

    def _friction(self, load: int, needed: float, hold: float) -> list[tuple[int, str, str]]:
        given, kind = float(self.setting.loads.friction[load]), self.setting.loads.contact[load]
        if kind == CLAMPED and needed > given:
            text = f"needs a friction coefficient of {needed:.3g}, more than the given {given:g}"
            return [(load, "friction", text)]
        if kind == COULOMB and hold != 0.0:
            return [(load, "friction", f"slips at friction {given:g}: a driving force of {hold:.4g} N is added")]
        return []


def on_friction(setting: PreparedRun, needed: Array, t: float, made: set[int]) -> list[str]:
    """The given forces that their friction does not hold at time t in s, each once; `needed` coefficients, (load,)."""
    given, found = setting.loads.friction, []
    for k in np.flatnonzero((setting.loads.contact == CLAMPED) & (needed > given)).tolist():
        if k not in made:
            made.add(k)
            found.append(
                f"load {setting.wheels[k].name} needs a friction coefficient of {needed[k]:.3g} at t = {t:.4g} s, "
                f"more than the given {given[k]:g}"
            )
    return found


def in_one_link(setting: PreparedRun) -> list[str]:
    """The two contacts of each line that begin closest to each other within one of its links, in words."""
    found = []
    for s, line in enumerate(setting.lines):
        on, h, links = setting.on[s], float(setting.strands.h[s]), int(setting.strands.links[s])
        known = [k for k in on if setting.wheels[k].given]
        pairs = [(round(abs(float(setting.xi[j] - setting.xi[k])), 9), j, k) for j, k in combinations(known, 2)]
        gap, j, k = min(pairs, default=(math.inf, 0, 0))
        if gap < h * (1.0 - 1e-9):
            one, two = setting.wheels[j].name, setting.wheels[k].name
            more = math.ceil(links * h / gap) if gap > 0.0 else _MOST_LINKS + 1
            remedy = f"; raise lines.{line}.elements (now {links}) to {more:d}, or take it as it is"
            if more > _MOST_LINKS:
                remedy = (
                    "; write one load with the sum of both" if one.partition(".")[0] != two.partition(".")[0] else ""
                )
            found.append(
                f"contacts {one} and {two} begin {gap:.3g} m apart, within one "
                f"link of {line} ({h:.3g} m): between nodes a line bends only under loads with an independent "
                f"position{remedy}"
            )
    return found


def who_met(setting: PreparedRun, state: ChainState) -> str:
    """The two contacts that have met, one of them with a place of its own: the closest on one line, in words."""
    strand, xi, on = setting.loads.strand, state.xi, (state.moving_load != OFF) & (state.xi >= 0.0)
    pairs = [
        (abs(float(xi[j] - xi[k])), j, k)
        for j, k in combinations(range(xi.size), 2)
        if strand[j] == strand[k] and on[j] and on[k] and CARRIED in (state.moving_load[j], state.moving_load[k])
    ]
    if not pairs:
        return "two loads meet"
    _, j, k = min(pairs)
    one, two, line = setting.wheels[j].name, setting.wheels[k].name, setting.lines[strand[j]]
    return f"load {one} meets load {two} at {xi[k]:.4g} m (unstrained) along {line}"


def counts(parting: Array, energy: Array) -> NDArray[np.bool_]:
    """Whether what wheels have lost when they left their lines counts beside an energy, (instant, wheel) and (instant,)
    J."""
    return np.abs(parting) > _PARTING * energy[:, None]


def on_parting(setting: PreparedRun, parting: Array, energy: float, made: set[int]) -> list[str]:
    """The wheels that have torn at a support when they left their line, each of them once; `energy` in J counts.

    Args:
        parting: (wheel,) J, lost by the line when each left it.
    """
    found = []
    for k, lost in enumerate(parting):
        if lost > _PARTING * energy and k not in made:
            made.add(k)
            name, line = setting.wheels[k].name, setting.lines[setting.loads.strand[k]]
            found.append(
                f"load {name} left {line} and took {lost:.3g} J of the adjacent links, which are lost: it reached "
                "its support from below or above, and the stretch of the last link grows with the number of "
                "elements; later results depend on it: increase travel.margin, or end the run before"
            )
    return found


def on_springing_up(
    setting: PreparedRun, parting: Array, energy: float, made: set[int]
) -> list[tuple[str, str, str, str]]:
    """The wheels whose leaving has set their lines springing, each of them once: what is to doubt, cause, key, remedy.

    A line that turned back on itself at the load is pushed together when its link is whole again, and springs up with
    more than it had; `energy` in J counts.
    """
    found = []
    for k, lost in enumerate(parting):
        if -lost > _PARTING * energy and k not in made:
            made.add(k)
            name, line = setting.wheels[k].name, setting.lines[setting.loads.strand[k]]
            found.append((
                f"load {name} left {line}, and the line springs up with {-lost:.3g} J without a source of energy",
                "the line turned back on itself at the load, and its last link is pushed together without it",
                f"loads.{name.partition('.')[0]}.travel",
                f"increase travel.margin, end the run before, or write lines.{line}.law: "
                "{kind: tension_only}",
            ))  # fmt: skip
    return found
