"""Wires at rest: equilibrium with the loads at their start, and slow motion of the loads along their ways."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.audit import energies
from ropewalk.results.frame import IN_AIR, MOVES, Contacts, Frame, Layout, RunInfo
from ropewalk.solve.following import Mover, quasistatic_motion, schedule
from ropewalk.wires.bearing import Bearing, Borne
from ropewalk.wires.layout import Reactions, axes_of, axial_force, layout_of
from ropewalk.wires.mesh import WireTies
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import ROUNDING
from ropewalk.wires.task import WireTask, ready

_ALIKE = 1e-6  # of a ratio of force to strength: what is as close to the largest fails with it, and rounding has no say


class Failure(NamedTuple):
    """A tie that has failed."""

    tie: int
    t: float  # s
    force: float  # N, under which it did


@dataclass(frozen=True)
class BorneByTheRest:
    """Wires and loads at rest by what has not failed."""

    borne: Borne
    failed: NDArray[np.bool_]  # (tie,) whether it pulls no more
    failures: tuple[Failure, ...]  # up to here, in their order


def stand_while_ties_fail(bearing: Bearing, t: float, near: Array, before: tuple[Failure, ...] = ()) -> BorneByTheRest:
    """Rest at an instant in s: ties fail one after the other, each under the forces that those before it left.

    What was cut up to then fails first; then that which bears most of its strength, as long as it bears more than all.

    Args:
        t: s.
        near: (3, node) m, a shape close by.
    """
    ties, failures = bearing.mesh.ties, before
    failed = np.zeros(ties.length.size, dtype=np.bool_)
    failed[[failure.tie for failure in before]] = True
    while True:
        found = bearing.stand(t, near, failed)
        which = _next(ties, failed, found.tie_force, t)
        if not which.size:
            return BorneByTheRest(found, failed, failures)
        failures += tuple(Failure(int(i), t, float(found.tie_force[i])) for i in which)
        failed, near = failed.copy(), found.position
        failed[which] = True


def _next(ties: WireTies, failed: NDArray[np.bool_], force: Array, t: float) -> Integers:
    """Which ties are the next ones to fail under some forces in N at t in s."""
    due = np.where(failed, np.inf, ties.fails_at * (1.0 - ROUNDING))
    if due.min(initial=np.inf) <= t:
        return np.flatnonzero(due == due.min())
    part = np.where(failed, 0.0, force / ties.strength)
    most = float(part.max(initial=0.0))
    return np.flatnonzero(part >= (1.0 - _ALIKE) * most) if most > 1.0 else np.empty(0, dtype=np.int64)


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
        self._noted = 0  # how many failures have been

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        return layout_of(self.task, self.mesh, path="load_path")

    def loaded(self) -> Frame:
        """The only frame of an equilibrium."""
        found = stand_while_ties_fail(self._bearing, 0.0, self._start.position)
        self._tell_of_cuts(0.0)
        self._tell_of_failures(found, "at rest")
        return self._frame(found, 0.0)

    def slowly(self, positions: int, turn: float | None) -> Iterator[Frame]:
        """Yield frames at equal steps of the load path, until all loads have left their lines or stopped.

        Args:
            positions: how many.
            turn: rad, see `solve/following.py`.

        Raises:
            EquilibriumError: no load moves, or there is no equilibrium with the loads somewhere on their path.
        """

        def rest(t: float, near: BorneByTheRest | None) -> BorneByTheRest:
            if near is None:
                return stand_while_ties_fail(self._bearing, t, self._start.position)
            return stand_while_ties_fail(self._bearing, t, near.borne.position, near.failures)

        times, paths = schedule(self._movers())
        self._tell_of_cuts(float(times[-1]))
        for at in quasistatic_motion(rest, self._places, times, paths, positions, turn):
            self._tell_of_failures(at.shape, f"at load_path = {at.path:.4g} m")
            yield self._frame(at.shape, at.path)

    def _tell_of_cuts(self, until: float) -> None:
        """Say what is cut later than at the end of the run in s, and pulls all the time."""
        for tie in self.task.plan.ties:
            if until < tie.fails_at < np.inf:
                self.run_info.warnings.append(
                    f"{tie.name} is cut at t = {tie.fails_at:.4g} s, and is intact here: "
                    f"{'this equilibrium is at t = 0' if not until else f'the load ends at {until:.4g} s'}"
                )

    def _tell_of_failures(self, found: BorneByTheRest, where: str) -> None:
        """Say which ties have failed since the last time."""
        new, ties = found.failures[self._noted :], self.task.plan.ties
        if new and not self._noted:
            self.run_info.warnings.append(
                "the force of failed ties is redistributed quasi-statically here; with kind: dynamic it is "
                "redistributed suddenly, and more ties may fail"
            )
        self.run_info.warnings += [f"{where} {ties[each.tie].name} failed under {each.force:.4g} N" for each in new]
        self._noted += len(new)

    def _movers(self) -> list[Mover]:
        """Return the prescribed travel of every load."""
        wires, movers = self.task.plan.wires, []
        for motion in self.task.prescribed_motions:
            begin = float(motion.place(np.zeros(1))[0])
            own = [(begin - contact.behind, wires[contact.wire].length) for contact in motion.moving_load.contacts]
            low, high = -max(place for place, _ in own), max(length - place for place, length in own)
            movers.append(Mover(partial(_displacement, motion.place, begin), low, high, motion.settled))
        return movers

    def _places(self, rest: BorneByTheRest) -> Array:
        """Where contacts are, (contact, 3) m; NaN of those off their wires."""
        found = rest.borne
        out = np.full((len(found.locations), 3), np.nan)
        for k, location in enumerate(found.locations):
            if location is not None:
                out[k] = location.value(found.position)
                out[k, -1] = found.height[k]
        return out

    def _frame(self, rest: BorneByTheRest, path: float) -> Frame:
        found, failed = rest.borne, rest.failed
        axes, mesh, count, dim = self._axes, self.mesh, found.station.size, len(self._axes)
        r, strands = found.position, mesh.strands
        potential, moving_loads = self._bearing.potential, self._bearing.moving_loads
        stretched = potential.tension(r)
        tension = axial_force(mesh, stretched, r)
        EA = np.repeat([wire.axial_stiffness for wire in self.task.plan.wires], strands.links)
        seen = Contacts(count, dim)
        seen.position = self._places(rest)[:, axes]
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
            reaction=self._reactions(r, found.tie_force, failed)[:, axes], energy=self._energy(found, failed),
            tie_force=found.tie_force,
        )  # fmt: skip

    def _bodies(self, found: Borne) -> Array:
        moving_loads = self._bearing.moving_loads
        begin = np.concatenate([[0], np.cumsum(moving_loads.size)])
        out = np.zeros((len(self.task.displayed), len(self._axes)))
        for i, body in enumerate(self.task.displayed):
            own, x = np.flatnonzero(moving_loads.owner == body.prescribed_motion), 0.0
            for k, part in [(own[wheel], part) for wheel, part in body.shares]:
                start, along = self.mesh.strands.across[int(moving_loads.wire[k])].tolist()
                location, station = found.locations[k], float(found.station[k])
                x += part * float(
                    location.value(found.position)[0] if location is not None else start + along * station
                )
            q = found.coordinates[begin[body.prescribed_motion] : begin[body.prescribed_motion + 1]]
            out[i, 0], out[i, -1] = x + np.sign(along) * body.ahead, body.base + float(body.row @ q)
        return out

    def _reactions(self, r: Array, tie_force: Array, failed: NDArray[np.bool_]) -> Array:
        """Forces of ends, holds and arms on their wires, (support, 3) N."""
        potential = self._bearing.potential
        bare = potential.bare_pull(r, failed)[:, self._supports.ends].T
        return self._supports.of(bare, potential.hold_forces(r), tie_force, r)

    def _energy(self, found: Borne, failed: NDArray[np.bool_]) -> Array:
        potential, r = self._bearing.potential, found.position
        loads, potential.pressing = potential.pressing, None
        weights = float((potential.force * r).sum())
        stored = potential.energy(r, failed) + weights
        potential.pressing = loads
        borne = -float(self._bearing.moving_loads.rest @ np.where(found.touches, found.height, 0.0))
        return energies(elastic=stored, gravitational=-weights, load_potential=borne)


def _displacement(place: Callable[[Array], Array], begin: float, times: Array) -> Array:
    """Return displacements of a load from a station `begin` in m at times in s, m."""
    return place(times) - begin
