"""What wires at rest bear: the rest of wires and of the loads that stand on them, together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.wires.equilibrium import Potential, settle_on_rails
from ropewalk.wires.journey import ON_GROUND, Journey
from ropewalk.wires.mesh import Mesh, riders_of
from ropewalk.wires.plan import Array
from ropewalk.wires.pressing import pressing
from ropewalk.wires.seat import Seat, seat_at, seat_below
from ropewalk.wires.task import Start, Task, along

_MOST_ROUNDS = 50
_NEAR = 1e-12  # of the longest wire: contacts that move less are where they were


@dataclass(frozen=True)
class Borne:
    """Wires and loads at rest together."""

    position: Array  # (3, node) m
    seats: tuple[Seat | None, ...]  # of each contact; None: it is off its wire
    station: Array  # (contact,) m
    force: Array  # (contact,) N upwards on the wire
    height: Array  # (contact,) m, of the wire itself
    touches: NDArray[np.bool_]  # (contact,) whether it is on its wire and has not lifted off
    coordinates: Array  # of all riders, one rider after the other, m


class Bearing:
    """Lets loads stand on wires.

    Args:
        mesh: the wires.
        journeys: of the loads.
        unstrained: (node,) m, of the link behind each node.
        space: whether anything moves sideways.
    """

    def __init__(self, mesh: Mesh, journeys: Sequence[Journey], unstrained: Array, *, space: bool) -> None:
        self.mesh, self.journeys, self.space = mesh, tuple(journeys), space
        self.riders = riders_of([journey.rider for journey in journeys])
        self.potential = Potential(mesh, unstrained)
        self._size = max(wire.length for wire in mesh.plan.wires)

    def stand(self, t: float, near: Array) -> Borne:
        """Rest with all loads where they are at an instant in s, next to a shape (3, node) in m.

        Raises:
            EquilibriumError: there is none.
        """
        riders, station = self.riders, self.stations(t)
        self.potential.place, near = self.mesh.holds.places(t), self.mesh.led(near, t)
        inside = np.array([0.0 <= s <= self.length(k) for k, s in enumerate(station)], dtype=np.bool_)
        ground = np.where(inside, np.nan, self.ground(station))
        touches, position = inside | np.isfinite(ground), near
        for _ in range(_MOST_ROUNDS):
            seats = [self._seat(k, station[k], position) if inside[k] else None for k in range(station.size)]
            local = np.array([seat.local if seat is not None else 0.0 for seat in seats])
            with np.errstate(divide="ignore"):
                local = np.where(riders.spring > 0.0, np.maximum(local, -0.5 / riders.spring), local)
            found = pressing(self.journeys, riders, t, local, self.rough(station), touches, ground)
            self.potential.pressing = (self.rows(seats), found)
            before, position = position, settle_on_rails(self.potential, position, space=self.space).position
            height = np.array([seat.value(position[2]) if seat is not None else 0.0 for seat in seats])
            force = found.given - found.stiffness @ height
            lifted = touches & inside & riders.lifts & (riders.sign * force < 0.0)
            if lifted.any():
                touches &= ~lifted
                continue
            sliding = inside & ~riders.material
            if not sliding.any() or float(np.abs(position - before).max()) <= _NEAR * self._size:
                return Borne(
                    position, tuple(seats), station, np.where(touches, force, 0.0), height + local * force,
                    touches & inside, found.coordinates(height),
                )  # fmt: skip
        raise EquilibriumError("no places were found at which the loads stand: the line gives way below them")

    def stations(self, t: float) -> Array:
        """Stations of all contacts at an instant in s, (contact,) m."""
        behind = [c.behind for journey in self.journeys for c in journey.rider.contacts]
        places = [float(journey.place(np.array([t]))[0]) for journey in self.journeys for _ in journey.rider.contacts]
        return np.array(places, dtype=np.float64) - np.array(behind, dtype=np.float64)

    def ground(self, station: Array) -> Array:
        """Heights of the level ground before and behind the wires, for loads that roll there; NaN for others, m."""
        owner = [journey for journey in self.journeys for _ in journey.rider.contacts]
        wires = [self.mesh.plan.wires[int(a)] for a in self.riders.wire]
        return np.array([
            (wire.start if s < 0.0 else wire.end)[2] if journey.beside == ON_GROUND else np.nan
            for journey, wire, s in zip(owner, wires, station, strict=True)
        ]).reshape(-1)  # fmt: skip

    def rough(self, station: Array) -> Array:
        """Heights that are added to the wires at the contacts, (contact,) m."""
        owner = [journey for journey in self.journeys for _ in journey.rider.contacts]
        return np.array([float(j.rough(np.array([s]))[0]) for j, s in zip(owner, station, strict=True)]).reshape(-1)

    def length(self, k: int) -> float:
        """What stations of contact k count up to, with room for rounding, m."""
        wire = self.mesh.plan.wires[int(self.riders.wire[k])]
        return wire.length * (1.0 + 1e-12)

    def _seat(self, k: int, station: float, position: Array) -> Seat:
        a, strands = int(self.riders.wire[k]), self.mesh.strands
        inside = min(station, self.mesh.plan.wires[a].length)
        if self.riders.material[k]:
            return seat_at(self.mesh, a, inside / float(strands.h[a]))
        begin, along = strands.across[a]
        return seat_below(self.mesh, a, position[0], float(begin + along * inside))

    def rows(self, seats: Sequence[Seat | None]) -> sparse.csr_matrix:
        """Interpolation of heights at the contacts, (contact, node)."""
        found = sparse.lil_matrix((len(seats), self.mesh.nodes))
        for k, seat in enumerate(seats):
            if seat is not None:
                found[k, seat.first : seat.first + seat.weight.shape[1]] = seat.weight[0]
        return found.tocsr()


def at_rest_together(task: Task, start: Start) -> tuple[Task, Start]:
    """A task whose wires and loads begin at rest with each other, and that beginning.

    Raises:
        EquilibriumError: there is no such rest.
    """
    bearing = Bearing(start.mesh, task.journeys, start.unstrained, space=task.space)
    found = bearing.stand(0.0, start.position)
    begin = np.concatenate([[0], np.cumsum(bearing.riders.size)])
    journeys = tuple(
        replace(journey, first=found.coordinates[begin[i] : begin[i + 1]]) for i, journey in enumerate(task.journeys)
    )
    beginning = replace(start, position=found.position)
    # Rates follow the wires as they are with the loads on them.
    return replace(task, journeys=tuple(along(beginning, journey) for journey in journeys)), beginning
