"""Wires at rest: equilibrium with the loads at their start, and slow motion of the loads along their ways."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.results.audit import energies
from ropewalk.results.frame import IN_AIR, MOVES, Contacts, Frame, Layout, RunInfo
from ropewalk.solve.following import quasistatic_motion, schedule
from ropewalk.wires.bearing import Bearing, Borne
from ropewalk.wires.layout import Reactions, axes_of, axial_force, layout_of
from ropewalk.wires.plan import Array
from ropewalk.wires.task import WireTask, ready


class WireStatics:
    """A run without inertia: its layout, and its frames one after the other.

    Args:
        task: what is computed.
        run_info: filled in.

    Raises:
        RopewalkError: there is no rest without loads.
    """

    def __init__(self, task: WireTask, run_info: RunInfo) -> None:
        self.task, self._start = ready(task)
        run_info.warnings += task.diagnostics
        run_info.method, run_info.reason = "rest", "least potential energy"
        self.run_info, self.mesh = run_info, self._start.mesh
        self._axes, self._supports = axes_of(task), Reactions(self.mesh)
        self._bearing = Bearing(self.mesh, self.task.prescribed_motions, self._start.unstrained, space=task.space)

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        return layout_of(self.task, self.mesh, path="load_path")

    def loaded(self) -> Frame:
        """The only frame of an equilibrium."""
        return self._frame(self._bearing.stand(0.0, self._start.position), 0.0)

    def slowly(self, positions: int, turn: float | None) -> Iterator[Frame]:
        """Frames at equal steps of the path of the first load, until it has come to the end of its line.

        Args:
            positions: how many.
            turn: rad, see `solve/following.py`.

        Raises:
            EquilibriumError: the first load has no way, or there is no rest with the loads somewhere on it.
        """

        def rest(t: float, near: Borne | None) -> Borne:
            return self._bearing.stand(t, near.position if near is not None else self._start.position)

        for at in quasistatic_motion(rest, self._places, *self._schedule(), positions, turn):
            yield self._frame(at.shape, at.path)

    def _schedule(self) -> tuple[Array, Array]:
        """Times and paths of the first load, until all its contacts have come to the end of their line."""
        if not self.task.prescribed_motions:
            raise EquilibriumError("quasi-static runs need a load that travels")
        prescribed_motion = self.task.prescribed_motions[0]
        wires, contacts = self.task.plan.wires, prescribed_motion.moving_load.contacts
        behind = [contact.behind for contact in contacts]
        length = wires[contacts[0].wire].length
        last = max(wires[contact.wire].length + contact.behind for contact in contacts) - length
        return schedule(
            prescribed_motion.moving_load.name, prescribed_motion.place, length, last=last, first=min(behind)
        )

    def _places(self, found: Borne) -> Array:
        """Where contacts are, (contact, 3) m; NaN of those off their wires."""
        out = np.full((len(found.locations), 3), np.nan)
        for k, location in enumerate(found.locations):
            if location is not None:
                out[k] = location.value(found.position)
                out[k, -1] = found.height[k]
        return out

    def _frame(self, found: Borne, path: float) -> Frame:
        axes, mesh, count, dim = self._axes, self.mesh, found.station.size, len(self._axes)
        r, strands = found.position, mesh.strands
        potential, moving_loads = self._bearing.potential, self._bearing.moving_loads
        stretched = potential.tension(r)
        tension = axial_force(mesh, stretched, r)
        EA = np.repeat([wire.axial_stiffness for wire in self.task.plan.wires], strands.links)
        seen = Contacts(count, dim)
        seen.position = self._places(found)[:, axes]
        first = np.concatenate([[0], np.cumsum(strands.links)[:-1]])
        for k, location in enumerate(found.locations):
            if location is None:
                continue
            a = int(moving_loads.wire[k])
            seen.force[k], seen.force[k, -1] = 0.0, found.force[k]
            seen.xi[k], seen.speed[k], seen.hold[k] = location.links * strands.h[a], 0.0, 0.0
            seen.tension[k] = tension[first[a] + min(int(location.links), int(strands.links[a]) - 1)]
            seen.state[k] = MOVES if found.touches[k] else IN_AIR
        bodies = self._bodies(found)
        return Frame(
            path=path, position=r[axes].T, velocity=np.zeros_like(r[axes].T), tension=tension, strain=stretched / EA,
            **seen.fields(), body_position=bodies, body_velocity=np.zeros_like(bodies),
            reaction=self._reactions(r)[:, axes], energy=self._energy(found),
            tie_force=potential.tie_forces(r),
        )  # fmt: skip

    def _bodies(self, found: Borne) -> Array:
        moving_loads = self._bearing.moving_loads
        begin = np.concatenate([[0], np.cumsum(moving_loads.size)])
        out = np.zeros((len(self.task.displayed), len(self._axes)))
        for i, body in enumerate(self.task.displayed):
            k = int(np.flatnonzero(moving_loads.owner == body.prescribed_motion)[body.wheel])
            a = int(moving_loads.wire[k])
            start, along = self.mesh.strands.across[a].tolist()
            location, station = found.locations[k], float(found.station[k])
            x = float(location.value(found.position)[0]) if location is not None else start + along * station
            q = found.coordinates[begin[body.prescribed_motion] : begin[body.prescribed_motion + 1]]
            out[i, 0], out[i, -1] = x + np.sign(along) * body.ahead, body.base + float(body.row @ q)
        return out

    def _reactions(self, r: Array) -> Array:
        """Forces of ends, holds and arms on their wires, (support, 3) N."""
        potential = self._bearing.potential
        bare = potential.bare_pull(r)[:, self._supports.ends].T
        return self._supports.of(bare, potential.hold_forces(r), potential.tie_forces(r), r)

    def _energy(self, found: Borne) -> Array:
        potential, r = self._bearing.potential, found.position
        loads, potential.pressing = potential.pressing, None
        weights = float((potential.force * r).sum())
        stored = potential.energy(r) + weights
        potential.pressing = loads
        borne = -float(self._bearing.moving_loads.rest @ np.where(found.touches, found.height, 0.0))
        return energies(elastic=stored, gravitational=-weights, load_potential=borne)
