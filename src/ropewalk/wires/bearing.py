"""What wires at rest bear: the rest of wires and of the loads that stand on them, together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.wires.contact_location import Location, location_at, location_below
from ropewalk.wires.equilibrium import WirePotential, settle_on_rails
from ropewalk.wires.mesh import Mesh, moving_loads_of
from ropewalk.wires.plan import Array, Contact
from ropewalk.wires.prescribed_motion import ON_GROUND, PrescribedMotion
from ropewalk.wires.pressing import pressing
from ropewalk.wires.task import WireStart, WireTask, along

_MOST_ROUNDS = 50
_NEAR = 1e-12  # of the longest wire: contacts that move less are where they were


@dataclass(frozen=True)
class Borne:
    """Wires and loads at rest together."""

    position: Array  # (3, node) m
    locations: tuple[Location | None, ...]  # of each contact; None: it is off its wire
    station: Array  # (contact,) m
    force: Array  # (contact,) N upwards on the wire
    height: Array  # (contact,) m, of the wire itself
    touches: NDArray[np.bool_]  # (contact,) whether it is on its wire and has not lifted off
    coordinates: Array  # of all moving loads, one moving load after the other, m
    tie_force: Array  # (tie,) N, positive in tension; those that failed have none


class Bearing:
    """Lets loads stand on wires.

    Args:
        mesh: the wires.
        prescribed_motions: of the loads.
        unstrained: (node,) m, of the link behind each node.
        space: whether anything moves sideways.
    """

    def __init__(
        self, mesh: Mesh, prescribed_motions: Sequence[PrescribedMotion], unstrained: Array, *, space: bool
    ) -> None:
        self.mesh, self.prescribed_motions, self.space = mesh, tuple(prescribed_motions), space
        self.moving_loads = moving_loads_of([prescribed_motion.moving_load for prescribed_motion in prescribed_motions])
        self.potential = WirePotential(mesh, unstrained)
        self._size = max(wire.length for wire in mesh.plan.wires)

    def stand(self, t: float, near: Array, failed: NDArray[np.bool_] | None = None) -> Borne:
        """Rest with all loads where they are at an instant in s, next to a shape (3, node) in m.

        Args:
            t: s.
            near: (3, node) m.
            failed: (tie,) whether it pulls no more; None: all do.

        Raises:
            EquilibriumError: there is none.
        """
        moving_loads, station = self.moving_loads, self.stations(t)
        self.potential.place, near = self.mesh.holds.places(t), self.mesh.led(near, t)
        inside = np.array([0.0 <= s <= self.length(k) for k, s in enumerate(station)], dtype=np.bool_)
        ground = np.where(inside, np.nan, self.ground(station))
        touches, position = inside | np.isfinite(ground), near
        for _ in range(_MOST_ROUNDS):
            locations = [self._location(k, station[k], position) if inside[k] else None for k in range(station.size)]
            local = np.array([location.local if location is not None else 0.0 for location in locations])
            with np.errstate(divide="ignore"):
                local = np.where(moving_loads.spring > 0.0, np.maximum(local, -0.5 / moving_loads.spring), local)
            found = pressing(
                self.prescribed_motions, moving_loads, t, local, self.rough(station), self.aside(station), touches,
                ground,
            )  # fmt: skip
            self.potential.pressing = (self.rows(locations), found)
            before, position = position, settle_on_rails(self.potential, position, failed, space=self.space).position
            height = np.array([location.value(position[2]) if location is not None else 0.0 for location in locations])
            force = found.given - found.stiffness @ height
            lifted = touches & inside & moving_loads.lifts & (moving_loads.sign * force < 0.0)
            if lifted.any():
                touches &= ~lifted
                continue
            sliding = inside & ~moving_loads.material
            if not sliding.any() or float(np.abs(position - before).max()) <= _NEAR * self._size:
                return Borne(
                    position, tuple(locations), station, np.where(touches, force, 0.0), height + local * force,
                    touches & inside, found.coordinates(height), self.potential.tie_forces(position, failed),
                )  # fmt: skip
        raise EquilibriumError("the positions of the loads have not converged: the line is too flexible")

    def stations(self, t: float) -> Array:
        """Stations of all contacts at an instant in s, (contact,) m."""
        behind = [
            c.behind for prescribed_motion in self.prescribed_motions for c in prescribed_motion.moving_load.contacts
        ]
        places = [
            float(prescribed_motion.place(np.array([t]))[0])
            for prescribed_motion in self.prescribed_motions
            for _ in prescribed_motion.moving_load.contacts
        ]
        return np.array(places, dtype=np.float64) - np.array(behind, dtype=np.float64)

    def ground(self, station: Array) -> Array:
        """Heights of the level ground before and behind the wires, for loads that roll there; NaN for others, m."""
        owner = [
            prescribed_motion
            for prescribed_motion in self.prescribed_motions
            for _ in prescribed_motion.moving_load.contacts
        ]
        wires = [self.mesh.plan.wires[int(a)] for a in self.moving_loads.wire]
        return np.array([
            (wire.start if s < 0.0 else wire.end)[2] if prescribed_motion.beside == ON_GROUND else np.nan
            for prescribed_motion, wire, s in zip(owner, wires, station, strict=True)
        ]).reshape(-1)  # fmt: skip

    def rough(self, station: Array) -> Array:
        """Heights that are added to the wires at the contacts, (contact,) m."""
        return self._along(station, lambda contact: contact.rough)

    def aside(self, station: Array) -> Array:
        """How far the wires are to the left of the middle of their loads at the contacts, (contact,) m."""
        return self._along(station, lambda contact: contact.aside)

    def _along(self, station: Array, of: Callable[[Contact], Callable[[Array], Array]]) -> Array:
        contacts = [contact for motion in self.prescribed_motions for contact in motion.moving_load.contacts]
        found = [float(of(contact)(np.array([s]))[0]) for contact, s in zip(contacts, station, strict=True)]
        return np.array(found, dtype=np.float64)

    def length(self, k: int) -> float:
        """What stations of contact k count up to, with room for rounding, m."""
        wire = self.mesh.plan.wires[int(self.moving_loads.wire[k])]
        return wire.length * (1.0 + 1e-12)

    def _location(self, k: int, station: float, position: Array) -> Location:
        a, strands = int(self.moving_loads.wire[k]), self.mesh.strands
        inside = min(station, self.mesh.plan.wires[a].length)
        if self.moving_loads.material[k]:
            return location_at(self.mesh, a, inside / float(strands.h[a]))
        begin, along = strands.across[a]
        return location_below(self.mesh, a, position[0], float(begin + along * inside))

    def rows(self, locations: Sequence[Location | None]) -> sparse.csr_matrix:
        """Interpolation of heights at the contacts, (contact, node)."""
        found = sparse.lil_matrix((len(locations), self.mesh.nodes))
        for k, location in enumerate(locations):
            if location is not None:
                found[k, location.first : location.first + location.weight.shape[1]] = location.weight[0]
        return found.tocsr()


def at_rest_together(task: WireTask, start: WireStart) -> tuple[WireTask, WireStart]:
    """A task whose wires and loads begin at rest with each other, and that beginning.

    Raises:
        EquilibriumError: there is no such rest.
    """
    bearing = Bearing(start.mesh, task.prescribed_motions, start.unstrained, space=task.space)
    found = bearing.stand(0.0, start.position)
    begin = np.concatenate([[0], np.cumsum(bearing.moving_loads.size)])
    prescribed_motions = tuple(
        replace(prescribed_motion, first=found.coordinates[begin[i] : begin[i + 1]])
        for i, prescribed_motion in enumerate(task.prescribed_motions)
    )
    beginning = replace(start, position=found.position)
    # Rates follow the wires as they are with the loads on them.
    return replace(
        task, prescribed_motions=tuple(along(beginning, prescribed_motion) for prescribed_motion in prescribed_motions)
    ), beginning
