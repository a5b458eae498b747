"""Contacts closer than a link: each bends the line by itself, and the bends of the others are not added to its own."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ropewalk.results.frame import MOVES, STICKS, Array, Doubt, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

_MUCH = 0.02  # force over tension and EI/h^2: the angle in rad by which the line turns there; below, nobody sees it
_FINE = 120  # links of a line, from which on the deflection under two halves of a load is wrong by less than 1 %


class _Pair(NamedTuple):
    """Two neighbouring contacts within a link."""

    angle: float  # rad, of the smaller force
    gap: float  # m
    path: float
    first: str
    second: str


class CloseContactsWatch(Watch):
    """Watches lines with contacts on splines for neighbours that are closer than a link."""

    def _prepare(self) -> None:
        scenario, loads = self.scenario, [self.scenario.loads.get(name) for name in self.loads]
        on = [load.on if load is not None and not getattr(load, "also_on", ()) else "" for load in loads]
        moves = scenario.run.kind in ("dynamic", "linear")  # ropes in equilibrium have a node at each load
        self._contacts = {
            name: np.flatnonzero(np.array(on) == name)
            for name, line in scenario.lines.items() if on.count(name) > 1 and (moves or line.has_bending_stiffness)
        }  # fmt: skip
        self._worst = dict[str, _Pair]()

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        for name, own in self._contacts.items():
            state, force = frames.of["contact_state"][:, own], frames.of["contact_force"][:, own]
            on = (state == STICKS) | (state == MOVES)
            xi = np.where(on, frames.of["contact_xi"][:, own], np.inf)
            order = np.argsort(xi, axis=1)
            along = np.take_along_axis(xi, order, axis=1)
            with np.errstate(invalid="ignore"):
                gap = np.diff(along, axis=1)
            pull = np.nan_to_num(frames.of["contact_tension"][:, own].min(axis=2))
            angle = np.take_along_axis(np.linalg.norm(force, axis=2) / self._bearing(name, pull), order, axis=1)
            angle = np.where(gap < self._link(name), np.nan_to_num(np.minimum(angle[:, :-1], angle[:, 1:])), 0.0)
            i, k = np.unravel_index(int(angle.argmax()), angle.shape)
            if angle[i, k] > self._worst.get(name, (0.0,))[0]:
                pair = (self.layout.contact_load[own[order[i, k + side]]] for side in (0, 1))
                self._worst[name] = _Pair(float(angle[i, k]), float(gap[i, k]), float(frames.path[i]), *pair)

    def _link(self, name: str) -> float:
        """Return the length of a link, m."""
        own: Array = np.array(self.layout.node_xi)[self.nodes_of(name)]
        return float(own.max() - own.min()) / max(int(own.size) - 1, 1) * (1.0 - 1e-9)

    def _bearing(self, name: str, pull: Array) -> Array:
        """Return tension and bending stiffness over the square of a link, N, which bear a force on a link."""
        return np.maximum(
            np.maximum(pull, 0.0) + self.scenario.lines[name].bending_stiffness / self._link(name) ** 2, 1e-9
        )

    def doubts(self, run_info: RunInfo) -> Iterator[Doubt]:
        """Yield a doubt for each inextensible line, whose tension depends on these bends alone."""
        for name, (what, remedy) in self._found(run_info):
            if self.scenario.lines[name].law.kind == "inextensible":
                yield Doubt(what, "each of them bends the line independently", f"lines.{name}.elements", remedy)

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """Yield a warning for each other line."""
        for name, (what, remedy) in self._found(run_info):
            if self.scenario.lines[name].law.kind != "inextensible":
                yield f"{what}: each of them bends the line independently, which makes it too stiff; {remedy}"

    def _found(self, run_info: RunInfo) -> Iterator[tuple[str, tuple[str, str]]]:
        """Yield lines, and for each what is wrong and the remedy."""
        for name, pair in self._worst.items():
            link, count = self._link(name), self.layout.link_line.count(name)
            coarse = count < _FINE or self.scenario.lines[name].law.kind == "inextensible"
            if pair.angle <= _MUCH or not coarse or not run_info.on_splines:
                continue
            what = (
                f"contacts {pair.first} and {pair.second} are {pair.gap:.3g} m apart at {self.at(pair.path)}, "
                f"closer than a link of {name} ({link:.3g} m)"
            )
            links = math.ceil(count * link / max(pair.gap, 1e-12))
            several = pair.first.partition(".")[0] != pair.second.partition(".")[0]
            remedies = ["write one load with the sum of both"] if several else []
            if links <= 10_000:
                remedies.append(f"write lines.{name}.elements: {links} or more")
            yield name, (what, " or ".join(remedies) or f"raise lines.{name}.elements until the result stays")
