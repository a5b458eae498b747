"""Bodies that cross, or slide at, an attachment of a rope: an inner support, or the end of a joined line.

The piece of rope between the body and the attachment is an axial spring of stiffness EA / length. A prescribed material
coordinate shortens it to nothing, so that the driving force oscillates with a frequency and an amplitude that the mesh
decides. A body of 60 kg at 1 m/s on a rope with EA = 29 MN: 4 to 47 kN on links of 0.5 to 2 m, 250 N if its horizontal
speed is prescribed. A body with a free travel that slides to and fro at an attachment gains energy there, and its
tensions differ by more than its friction bears.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.model.joint import Joined
from ropewalk.model.load import Rolling
from ropewalk.model.travel import FreeTravel
from ropewalk.results.frame import MOVES, OFF_LINE, Array, Doubt, Integers
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
    from ropewalk.model.load import AnyLoad

_RESOLVED = 10  # output instants near an attachment, from which on they show its peak
_BOTH = 3  # output instants with friction that is too large, in each direction: a body that crosses has one only
_CLOSE = 0.1  # of a link: a body with a free travel crosses an attachment there
_CLEARLY = 3.0  # times the typical contact forces of a load: a peak of a driving force with a horizontal speed
_AT = 0.01  # of a link: a body so close to an attachment is located at it
_MORE = 0.1  # friction coefficient by which that of the tensions may exceed the one of a body that slides
_TIMES = 10.0  # the typical contact force: a contact force near an attachment beyond that is a peak
_DRIVER = "travel.kind: free with travel.driver, which limits the driving force"
_MAY_BE_FREE = ("mass", "trolley")  # whose travel may be free without another key
_FORCES = ("hold_force", "contact_force")


class _Attachment(NamedTuple):
    """A point of a line that a support or another line holds."""

    name: str
    xi: float  # m, unstrained
    reach: float  # m, length of a link


class AttachmentWatch(Watch):
    """Watches bodies for peaks of their driving force near attachments, and for too much friction at them."""

    def _prepare(self) -> None:
        scenario = self.scenario
        moves = scenario.run.kind == "dynamic" and scenario.run.geometry == "nonlinear"
        self._points = {
            k: points
            for k, name in enumerate(self.loads)
            if moves and (points := self._attachments_below(scenario.loads.get(name)))
        }  # fmt: skip
        self._crossed = dict[tuple[int, int], tuple[float, float]]()  # smallest and largest distance, m
        self._peak = dict[tuple[int, int], tuple[float, float, float]]()  # driving and contact force, N, when, s
        self._frames = dict[tuple[int, int], int]()
        self._slid = dict[tuple[int, int], tuple[int, int, float, float]]()  # forwards, backwards, friction, when, s

    def _attachments_below(self, load: AnyLoad | None) -> list[_Attachment]:
        """Attachments of the line of a body; of ropes only."""
        line = None if load is None else self.scenario.lines.get(load.on)
        if line is None or line.has_bending_stiffness or not isinstance(load, Rolling):
            return []
        reach = (line.length or line.distance) / line.elements
        found = [_Attachment(f"inner support {name}", each.at, reach) for name, each in line.supports.items()]
        rows = {name: each for row in self.scenario.hangers for name, each in self.scenario.hung(row).items()}
        for name, other in (self.scenario.lines | rows).items():
            for end in (other.start_support, other.end_support):
                if isinstance(end, Joined) and end.to == load.on and isinstance(end.at, float):
                    found.append(_Attachment(f"joined line {name}", end.at, reach))
        return found

    def _load(self, k: int) -> Any:
        """The load of contact `k`, which has a travel."""
        return self.scenario.loads[self.loads[k]]

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        for k, points in self._points.items():
            on = np.flatnonzero(frames.of["contact_state"][:, k] != OFF_LINE)
            for p, point in enumerate(points) if on.size else ():
                away = frames.of["contact_xi"][on, k] - point.xi
                low, high = self._crossed.get((k, p), (np.inf, -np.inf))
                self._crossed[k, p] = min(low, float(away.min())), max(high, float(away.max()))
                self._see_near(frames, (k, p), on[np.abs(away) < point.reach])
                self._see_sliding(frames, (k, p), on[np.abs(away) < _AT * point.reach])

    def _see_near(self, frames: Frames, at: tuple[int, int], near: Integers) -> None:
        drive, force = (np.linalg.norm(np.nan_to_num(frames.of[key][near, at[0]]), axis=1) for key in _FORCES)
        self._frames[at] = self._frames.get(at, 0) + near.size
        if near.size:
            i = int(drive.argmax())
            found = float(drive[i]), float(force.max()), float(frames.path[near[i]])
            self._peak[at] = max(self._peak.get(at, found), found)

    def _see_sliding(self, frames: Frames, at: tuple[int, int], there: Integers) -> None:
        load = self._load(at[0])
        if not there.size or not isinstance(load.travel, FreeTravel):
            return
        needed = np.nan_to_num(frames.of["contact_friction"][there, at[0]], posinf=0.0)
        needed[frames.of["contact_state"][there, at[0]] != MOVES] = 0.0
        speed, i = frames.of["contact_speed"][there, at[0]], int(needed.argmax())
        large = needed > load.travel.friction + _MORE
        ahead, back, most, when = self._slid.get(at, (0, 0, 0.0, 0.0))
        if needed[i] > most:
            most, when = float(needed[i]), float(frames.path[there[i]])
        self._slid[at] = (
            ahead + int((large & (speed > 0.0)).sum()),
            back + int((large & (speed < 0.0)).sum()),
            most,
            when,
        )

    def _slides(self, at: tuple[int, int]) -> bool:
        """Whether a body slides to and fro at an attachment with more friction than it has."""
        return min(self._slid.get(at, (0, 0))[:2]) >= _BOTH

    def blamed(self, k: int, xi: Array) -> NDArray[np.bool_]:
        """Return whether contact `k` is where an attachment spoils its motion, of each of its coordinates `xi`, m."""
        found, points = np.zeros(xi.size, dtype=np.bool_), self._points.get(k, ())
        free = bool(points) and isinstance(self._load(k).travel, FreeTravel)
        for point in points:
            found |= np.abs(xi - point.xi) < (_CLOSE if free else 1.0) * point.reach
        return found

    def findings(self, force: Array) -> Iterator[Doubt]:
        """Find the loads whose driving force has a peak at an attachment, or that slide at one.

        Args:
            force: (sample, contact) N, of contacts.
        """
        reported = set[str]()
        for (k, p), (low, high) in self._crossed.items():
            name = self.loads[k]
            free = isinstance(self._load(k).travel, FreeTravel)
            crosses = low <= 0.0 <= high and high - low > _AT * self._points[k][p].reach
            found = self._sliding(k, p) if free else self._crossing(k, p, force) if crosses else None
            if found is not None and name not in reported:
                reported.add(name)
                yield found

    def _sliding(self, k: int, p: int) -> Doubt | None:
        if not self._slides((k, p)):
            return None
        most, when = self._slid[k, p][2:]
        load, point = self._load(k), self._points[k][p]
        what = (
            f"load {self.layout.contact_load[k]} slides at {point.name} of line {load.on}, xi = {point.xi:.4g} m: "
            f"its tensions need a friction coefficient of {most:.3g} at t = {when:.4g} s (travel.friction is "
            f"{load.travel.friction:.3g})"
        )
        cause = "a body that slides over an attachment of a rope gains energy there"
        return Doubt(what, cause, f"loads.{self.loads[k]}.travel", self.remedy_for(k))

    def _crossing(self, k: int, p: int, force: Array) -> Doubt | None:
        load, point = self._load(k), self._points[k][p]
        typical, whole = _typical(force[:, k]), sum(
            _typical(force[:, j]) for j, name in enumerate(self.loads) if name == self.loads[k]
        )  # fmt: skip
        drive, contact, when = self._peak.get((k, p), (0.0, 0.0, 0.0))
        horizontal = load.travel.measured == "horizontal"
        peaks = drive > (_CLEARLY * whole if horizontal else typical) or contact > _TIMES * whole
        if not peaks and (horizontal or self._frames[k, p] >= _RESOLVED):
            return None
        what = f"load {self.layout.contact_load[k]} crosses {point.name} of line {load.on} at xi = {point.xi:.4g} m"
        if drive > typical:
            what += (
                f" with a driving force of {drive:.4g} N at t = {when:.4g} s (typical contact force {typical:.4g} N)"
            )
        cause = (
            f"travel is prescribed as {load.travel.measured} over a point where the rope cannot move along itself, "
            "so that the peak of the driving force depends on the mesh"
        )
        return Doubt(what, cause, f"loads.{self.loads[k]}.travel", self.remedy_for(k))

    def remedy_for(self, k: int) -> str:
        """Return the changes that make contact `k` right at attachments, without those that its load has already."""
        load = self._load(k)
        if isinstance(load.travel, FreeTravel):
            if any(self._slides((k, p)) for p in range(len(self._points[k]))):
                return f"write travel.from at least one link, {self._points[k][0].reach:.3g} m, away from it"
            return f"write more elements for line {load.on} (lines.{load.on}.elements)"
        wheels = getattr(load, "wheels", {}).values()
        soft = any(getattr(each, "contact_stiffness", None) is not None for each in (load, *wheels))
        free = f"write {_DRIVER}" if load.kind in _MAY_BE_FREE else ""
        line, horizontal = self.scenario.lines[load.on], load.travel.measured == "horizontal"
        if not horizontal and line.start[0] != line.end[0]:
            more = " and leave contact_stiffness out" if soft else ""
            if line.end[0] < line.start[0]:
                more += f", and exchange start and end of {load.on}, with their supports and all that counts along it"
            remedy = f"write travel.measured: horizontal (travel.from becomes a horizontal distance){more}"
            return f"{remedy}, or {free}" if free else remedy
        if soft and horizontal:
            return "leave contact_stiffness out"
        return free or f"give lines.{load.on} a bending_stiffness"


def _typical(force: Array) -> float:
    """Return the median of the contact forces of a contact while it presses, N."""
    pressing = force[np.nan_to_num(force) > 0.0]
    return float(np.median(pressing)) if pressing.size else 0.0
