"""Equilibrium and slow motion: rests of lines with their loads, one after the other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any, Generic, TypeVar

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Frame, Layout, RunInfo
from ropewalk.solve.following import quasistatic_motion, schedule
from ropewalk.system.contact.tables import Tables
from ropewalk.system.elements.structure import Structure
from ropewalk.system.loads.loaded_structure import Carried
from ropewalk.system.reporting.doubts import doubt_slack

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
        return frame

    def slowly(self, positions: int, turn: float | None) -> Iterator[Frame]:
        """Frames at equal steps of the path of the first load, until it has come to the end of its line.

        Args:
            positions: how many.
            turn: rad, see `solve/following.py`.

        Raises:
            EquilibriumError: the first load has no way, or there is no rest with the loads somewhere on it.
        """
        way = schedule_of(self._scenario, self._carried, self._structure)
        for at in quasistatic_motion(self._rest, self._places, *way, positions, turn):
            yield self._frame(at.shape, at.path, at.t)


def schedule_of(scenario: Scenario, carried: Carried, structure: Structure) -> tuple[Array, Array]:
    """Times and paths of the first load, until all its contacts have come to the end of their line.

    Raises:
        EquilibriumError: there is no load, or it has no way.
    """
    contacts, tables = carried.contacts, carried.tables
    if not contacts.size:
        raise EquilibriumError("quasi-static runs need a load that travels")
    first = contacts[0]
    mine = contacts["begin"][contacts["load"] == first["load"]]

    def place(times: Array) -> Array:
        return np.asarray(first["begin"] + travelled(tables, first, times))

    behind, name = first["begin"] - mine, list(scenario.loads)[int(first["load"])]
    end = float(structure.lines.length[first["line"]])
    return schedule(name, place, end, last=float(behind.max()), first=float(behind.min()))


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
