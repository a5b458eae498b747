"""Equilibrium and slow motion: rests of lines with their loads, one after the other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import partial
from typing import Any, Generic, TypeVar

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Frame, Layout, RunInfo
from ropewalk.solve.following import Mover, quasistatic_motion, schedule
from ropewalk.system.contact.tables import Tables
from ropewalk.system.elements.structure import Structure
from ropewalk.system.loads.loaded_structure import Carried
from ropewalk.system.reporting.doubts import doubt_slack, doubt_struts

Rest = TypeVar("Rest")


class SlowMotion(ABC, Generic[Rest]):
    """A run without inertia, of rests of some kind."""

    _scenario: Scenario
    _run_info: RunInfo
    _carried: Carried
    _structure: Structure

    @property
    @abstractmethod
    def layout(self) -> Layout:
        """Names and coordinates of the result."""

    @abstractmethod
    def _rest(self, t: float, near: Rest | None) -> Rest:
        """Rest with all loads where they are at a time in s, next to another one."""

    @abstractmethod
    def _places(self, rest: Rest, /) -> Array:
        """Where contacts are, (contact, axis) m; NaN of those off their lines."""

    @abstractmethod
    def _frame(self, rest: Rest, /, path: float, t: float) -> Frame:
        """The frame of a rest at a path in m and a time in s."""

    def loaded(self) -> Frame:
        """The only frame of an equilibrium: at rest with the loads at their start."""
        frame = self._frame(self._rest(0.0, None), 0.0, 0.0)
        doubt_slack(self._scenario, self._run_info, self.layout.link_line, frame.tension)
        return self._doubted(frame)

    def _doubted(self, frame: Frame) -> Frame:
        """Doubt inextensible lines that push in a frame."""
        links, when = self.layout.link_line, f"at load_path = {frame.path:.4g} m"
        doubt_struts(self._scenario, self._run_info, links, frame.tension, when)
        return frame

    def slowly(self, positions: int, turn: float | None) -> Iterator[Frame]:
        """Yield frames at equal steps of the load path, until all loads have left their lines or stopped.

        Args:
            positions: how many.
            turn: rad, see `solve/following.py`.

        Raises:
            EquilibriumError: no load moves, or there is no equilibrium with the loads somewhere on their path.
        """
        way = schedule(movers_of(self._carried, self._structure))
        for at in quasistatic_motion(self._rest, self._places, *way, positions, turn):
            yield self._doubted(self._frame(at.shape, at.path, at.t))


def movers_of(carried: Carried, structure: Structure) -> list[Mover]:
    """Return the prescribed travel of every load."""
    contacts, movers = carried.contacts, []
    for load in np.unique(contacts["load"]):
        own = contacts[contacts["load"] == load]
        last = int(own[0]["speed_first"] + own[0]["speed_count"]) - 1
        settled = float(carried.tables.speed_time[last]) if own[0]["speed_count"] > 1 else 0.0
        low, high = -own["begin"], structure.lines.length[own["line"]] - own["begin"]
        first, last = (low.max(), high.min()) if own[0]["stays"] else (low.min(), high.max())
        place = partial(travelled, carried.tables, own[0])
        movers.append(Mover(place, float(first), float(last), max(settled, 0.0)))
    return movers


def positions_at(carried: Carried, structure: Structure, t: float) -> Array:
    """Return where contacts are along their lines at a time in s, (contact,) m; loads that stay stop at the end.

    A load with several contacts stops as a whole, when its first one has come to the end.
    """
    contacts, high = carried.contacts, structure.lines.length[carried.contacts["line"]]
    moved = np.array([float(travelled(carried.tables, contact, np.asarray(t))) for contact in contacts])
    for load in np.unique(contacts["load"][contacts["stays"] == 1]):
        own = contacts["load"] == load
        begin, end = contacts["begin"][own], high[own]
        moved[own] = np.clip(moved[own], -begin.min(), (end - begin).min())
    return np.asarray(contacts["begin"] + moved)


def travelled(tables: Tables, contact: Any, t: Array) -> Array:
    """How far a contact has come at times in s, m."""
    own = slice(int(contact["speed_first"]), int(contact["speed_first"] + contact["speed_count"]))
    time, speed, path = tables.speed_time[own], tables.speed_value[own], tables.speed_path[own]
    if time.size == 1:
        return np.asarray(path[0] + speed[0] * (t - time[0]))
    i = np.maximum(np.searchsorted(time, t, side="right") - 1, 0)
    ahead = np.minimum(i + 1, time.size - 1)
    part = np.clip((t - time[i]) / np.where(ahead > i, time[ahead] - time[i], 1.0), 0.0, 1.0)
    now = np.where(ahead > i, speed[i] + part * (speed[ahead] - speed[i]), speed[i])
    return np.asarray(path[i] + 0.5 * (t - time[i]) * (speed[i] + now))
