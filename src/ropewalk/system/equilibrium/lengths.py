"""Unstrained lengths of lines that are given by their tension: with these they have it in the mean at rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np
import scipy.sparse.linalg

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import pack
from ropewalk.mechanics.chain import Array
from ropewalk.model.joint import Joined
from ropewalk.model.law import Inextensible
from ropewalk.model.line import Line
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Guided
from ropewalk.solve.search_budget import search
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.rest import at_rest, tensions, with_ends
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure

# Rests that are sought at most, and the part of a tension to which it is found; what rounding may leave of it.
_ROUNDS, _NEAR, _ROUNDING = 30, 1e-9, 1e-6
# Of its length, by which a line is cut shorter or longer at once, and to see what that changes.
_FAR, _NUDGE = 0.02, 1e-7
# Part of the largest response below which lines answer alike; of a tension that lines in a row may miss, and
# without a warning; rounds without progress after which they do.
_ALIKE, _ACCEPTED, _SILENT, _STUCK = 1e-3, 5e-3, 1e-4, 4


Build = Callable[[Mapping[str, float], Assembled | None], Assembled]
"""Makes a structure with given lengths of all lines, m, and about its rest, where that of others is known."""


class _Lengths:
    """Lengths of lines that are given by their tensions, and their equilibrium with these."""

    def __init__(self, scenario: Scenario, build: Build) -> None:
        self.names, lines = list(scenario.lines), scenario.lines
        self.given = [name for name, line in lines.items() if line.length is None]
        self.at = [self.names.index(name) for name in self.given]
        self.wanted = np.array([lines[name].tension for name in self.given])
        self._scenario, self._build = scenario, build
        self.assembled, found = _rested(scenario, build(about(scenario), None))
        self.whole = self.assembled.structure.lines.length[: len(self.names)].copy()
        self.miss: Array = found[self.at] / self.wanted - 1.0

    @property
    def largest(self) -> float:
        """The largest part of a tension that is missed."""
        return float(np.abs(self.miss).max())

    @property
    def by_name(self) -> dict[str, float]:
        """Lengths of all lines, m."""
        return dict(zip(self.names, self.whole.tolist(), strict=True))

    def change(self, step: Array) -> None:
        """Let lines be longer by steps in m."""
        self.whole[self.at] += step
        self.assembled, found = _rested(self._scenario, self._build(self.by_name, self.assembled))
        self.miss = found[self.at] / self.wanted - 1.0

    def responses(self) -> Array:
        """Change of what is missed with each length, (line, line) 1/m, to the first order at rest."""
        gravity, rest, within = _gravity(self._scenario, self.assembled), self.assembled.near, self._scenario.is_plane
        T = tensions(self.assembled.structure, rest)

        def missed(structure: Structure, r: Array) -> Array:
            return np.asarray(mean_tensions(structure, r)[self.at] / self.wanted - 1.0, dtype=np.float64)

        def bearing(assembled: Assembled) -> SystemPotential:
            structure = with_ends(assembled.structure, gravity, T)
            return SystemPotential(structure, LoadedStructure(structure, rest), 1.0, within=within)

        potential, out = bearing(self.assembled), np.zeros((len(self.at),) * 2)
        solve = scipy.sparse.linalg.splu(potential.stiffness(rest.ravel()))
        before, force = missed(potential.structure, rest), potential.out_of_balance(rest.ravel())
        for column, name in enumerate(self.given):
            nudge = _NUDGE * self.by_name[name]
            other = bearing(self._build({**self.by_name, name: self.by_name[name] + nudge}, self.assembled))
            way = potential.free @ solve.solve(other.out_of_balance(rest.ravel()) - force)
            out[:, column] = (missed(other.structure, rest + way.reshape(rest.shape)) - before) / nudge
        return out

    def search(self, H: Array, most: Array) -> None:
        """Broyden's method from an inverse of the responses, by steps of at most (line,) m, as long as it closes in."""
        best, since = np.inf, 0
        for _ in range(_ROUNDS):
            largest = self.largest
            best, since = (largest, 0) if largest < 0.5 * best else (best, since + 1)
            if largest < _NEAR or (since > _STUCK and largest < _ACCEPTED):
                return
            before, step = self.miss, np.clip(-H @ self.miss, -most, most)
            self.change(step)
            if self.largest >= largest and largest < _ROUNDING:
                return
            change = H @ (self.miss - before)
            if (size := float(step @ change)) != 0.0:
                H = H + np.outer(step - change, step @ H) / size


def _diagonal(values: list[float]) -> Array:
    return np.diag(np.array(values, dtype=np.float64))


def _inverse(J: Array, alike: float = 1e-15) -> Array:
    """The inverse of responses, without those that are less than a part of the largest one."""
    return np.asarray(np.linalg.pinv(J, rcond=alike), dtype=np.float64)


def with_tensions(scenario: Scenario, build: Build) -> Assembled:
    """A structure whose lines are as long as their tensions want them, and about how it rests.

    Lines in one row answer to any of their lengths alike: these change together first, and one by one only as far as
    that leaves them about as they are drawn.

    Args:
        scenario: what is there.
        build: makes the structure.

    Raises:
        EquilibriumError: there is no rest, or not with these tensions.
    """
    found = _Lengths(scenario, build)
    most, parts = _FAR * found.whole[found.at], scenario.parts
    if len(found.given) == 1 or scenario.tracks or parts.runs_over_sheaves or parts.has_saddles:
        found.search(_diagonal([-_answer(scenario.lines[name], scenario.gravity) for name in found.given]), most)
    else:
        try:
            J = found.responses()
        except RuntimeError:  # something is free to move
            J = _diagonal([-1.0 / _answer(scenario.lines[name], scenario.gravity) for name in found.given])
        found.search(_inverse(J, _ALIKE), most)
        if _ROUNDING < found.largest < _ACCEPTED:
            whole = found.whole.copy()
            with suppress(EquilibriumError):
                found.search(_inverse(found.responses()), 0.1 * most)
            if not found.largest < _ROUNDING or np.abs(found.whole - whole)[found.at].max() > most.max():
                found.change(whole[found.at] - found.whole[found.at])
    if not found.largest < _ACCEPTED:
        T = (found.miss + 1.0) * found.wanted
        raise EquilibriumError(_not_found(scenario, dict(zip(found.given, T.tolist(), strict=True))))
    _check_joined(scenario, found.by_name)
    return found.assembled


def off_tension(scenario: Scenario, assembled: Assembled) -> Iterator[str]:
    """Warn of lines whose tension at rest is not the one that they are given by."""
    given = {name: line.tension for name, line in scenario.lines.items() if line.length is None and line.tension}
    if not given or scenario.overhead_lines:
        return
    T = dict(zip(scenario.lines, mean_tensions(assembled.structure, assembled.near).tolist(), strict=False))
    name = max(given, key=lambda key: abs(T[key] / given[key] - 1.0))
    if abs(T[name] / given[name] - 1.0) > _SILENT:
        yield (
            f"lines.{name}.tension: the mean tension in equilibrium is {T[name]:.6g} N instead of {given[name]:g} N, "
            "and that "
            "of other lines is off by less: lines in one row share their horizontal force, and steeper ones have more "
            "tension; give length instead of tension where this matters"
        )


def about(scenario: Scenario) -> dict[str, float]:
    """Unstrained lengths of all lines, m: those that are given, and those of straight lines with their tension."""
    found = {}
    for name, line in scenario.lines.items():
        if line.length is not None:
            found[name] = line.length
            continue
        assert line.tension is not None
        stretch = 0.0
        if not isinstance(line.law, Inextensible):
            stretch = float(law.strain(pack(line.law, line.axial_stiffness), line.tension))
        found[name] = line.distance / (1.0 + stretch)
    return found


def _rested(scenario: Scenario, assembled: Assembled) -> tuple[Assembled, Array]:
    """A structure with the places of its nodes at rest, and the mean tensions of its lines, (line,) N."""
    with search(assembled.line):
        structure, rest = at_rest(
            assembled.structure, _gravity(scenario, assembled), assembled.near, within=scenario.is_plane
        )
    return replace(assembled, near=rest), mean_tensions(structure, rest)


def _gravity(scenario: Scenario, assembled: Assembled) -> Array:
    gravity = np.zeros(len(assembled.axes))
    gravity[-1] = -scenario.gravity
    return gravity


def mean_tensions(structure: Structure, rest: Array) -> Array:
    """Tensions of all lines at rest (axis, node), in the mean over their lengths without strain, (line,) N."""
    runs, lines, T = structure.runs, structure.lines, tensions(structure, rest)
    over = set() if structure.sheaves is None else set(structure.sheaves.run.tolist())
    out = np.zeros(lines.first.size)
    for i, (first, count) in enumerate(zip(lines.first, lines.runs, strict=True)):
        total = whole = 0.0
        for s in range(first, first + count):
            links = int(runs.links[s]) + (s in over)
            total += float(T[runs.first[s] : runs.first[s] + links].sum() * runs.h[s])
            whole += links * float(runs.h[s])
        out[i] = total / whole if whole else 0.0
    return out


def _answer(line: Line, gravity: float) -> float:
    """By how much a line by itself is shorter for a tension that is larger by all of it, m: stretch, and sag."""
    assert line.tension is not None
    strain, stretch, T, span = 0.0, 0.0, line.tension, line.distance
    if not isinstance(line.law, Inextensible):
        packed = pack(line.law, line.axial_stiffness)
        strain = float(law.strain(packed, T))
        stretch = T / float(law.tangent(packed, strain))
    weight = line.mass * gravity * span
    return span * (stretch / (1.0 + strain) ** 2 + (weight / T) ** 2 / 12.0)


def _check_joined(scenario: Scenario, lengths: Mapping[str, float]) -> None:
    """Refuse ends that are joined to a line beyond the length that its tension gives it, and supports there."""
    for name, line in scenario.lines.items():
        for key, inner in line.supports.items():
            if lengths[name] <= inner.at * (1.0 + 1e-9):
                raise EquilibriumError(
                    f"lines.{name}.supports.{key}.at: {inner.at:g} m is not between the ends of the line, which with "
                    f"its tension is {lengths[name]:.6g} m long; stay within that"
                )
        for key, support in (("start_support", line.start_support), ("end_support", line.end_support)):
            if not isinstance(support, Joined) or not isinstance(support.at, float):
                continue
            if (length := lengths[support.to]) * (1.0 + 1e-9) < support.at:
                raise EquilibriumError(
                    f"lines.{name}.{key}.at: {support.at:g} m is off the line {support.to}, which with its tension is "
                    f"{length:.6g} m long; stay within that"
                )


def _not_found(scenario: Scenario, found: Mapping[str, float]) -> str:
    """Why lines do not have their given tension at rest: the one furthest from it, and what may set it instead."""
    given = {name: line.tension or 0.0 for name, line in scenario.lines.items() if line.length is None}
    name = max(given, key=lambda key: abs(found[key] / given[key] - 1.0))
    guided = [
        f"lines.{other}.{key}"
        for other, it in scenario.lines.items()
        for key in ("start_support", "end_support")
        if isinstance(getattr(it, key), Guided)
    ]
    remedy = f"give length instead of lines.{name}.tension"
    if guided:
        remedy += f", or change {' and '.join(guided)}: an end that is free along its rail sets the tension itself"
    tried = f"{len(given)} lines with a given tension have no equilibrium with it" if len(given) > 1 else (
        f"line {name} has no equilibrium with its tension")  # fmt: skip
    if len(given) > 1 and not guided:
        remedy += "; lines that are joined in one row share their horizontal force"
    far = f"{found[name]:.5g} N instead of {given[name]:g} N"
    if (missed := abs(found[name] / given[name] - 1.0)) < 1e-4:  # digits that are printed are the same
        far = f"of {given[name]:g} N the search misses {missed:.1e}"
    return f"lines.{name}.tension: {tried}: {far}; {remedy}"
