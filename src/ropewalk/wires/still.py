"""Wires at rest: equilibrium with the loads at their start, and slow motion of the loads along their ways."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.results.frame import ENERGY_FORMS, IN_AIR, MOVES, OFF_LINE, Account, Frame, Layout
from ropewalk.wires.bearing import Bearing, Borne
from ropewalk.wires.layout import axes_of, layout_of, reactions
from ropewalk.wires.plan import Array
from ropewalk.wires.task import Task, ready

_FINE = 20001  # instants among which the end of a way is looked for
_MOST_DOUBLINGS = 60


class Still:
    """A run without inertia: its layout, and its frames one after the other.

    Args:
        task: what is computed.
        account: filled in.

    Raises:
        RopewalkError: there is no rest without loads.
    """

    def __init__(self, task: Task, account: Account) -> None:
        self.task, self._start = ready(task)
        account.warnings += task.remarks
        account.method, account.reason = "rest", "least potential energy"
        self.account, self.mesh = account, self._start.mesh
        self._axes = axes_of(task)
        self._bearing = Bearing(self.mesh, self.task.journeys, self._start.unstrained, space=task.space)

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        return layout_of(self.task, self.mesh, path="load_path")

    def standing(self) -> Iterator[Frame]:
        """The only frame of an equilibrium."""
        yield self._frame(self._bearing.stand(0.0, self._start.position), 0.0)

    def slowly(self, positions: int) -> Iterator[Frame]:
        """Frames at equal steps of the way of the first load, until it has come to the end of its line.

        Raises:
            EquilibriumError: the first load has no way, or there is no rest with it where it starts.
        """
        times, ways = self._timetable(positions)
        near = self._start.position
        for t, way in zip(times, ways, strict=True):
            try:
                found = self._bearing.stand(float(t), near)
            except RopewalkError as error:
                if self.account.steps == 0:
                    raise
                self.account.outcome = "no rest shape"
                self.account.advice = f"at load path {way:.6g} m: {error}"
                return
            near = found.position
            self.account.steps += 1
            yield self._frame(found, float(way))

    def _timetable(self, positions: int) -> tuple[Array, Array]:
        """Times at which the first load has gone equal parts of its way, and how far that is, m."""
        if not self.task.journeys:
            raise EquilibriumError("slow motion needs a load that travels")
        journey = self.task.journeys[0]
        length = self.task.plan.wires[journey.rider.contacts[0].wire].length
        behind = np.array([contact.behind for contact in journey.rider.contacts])

        begin = float(journey.place(np.zeros(1))[0])

        def gone(places: Array) -> Array:
            """How far all contacts are beyond the end that they go to, as a part of the line; negative: not yet."""
            ahead, back = places - behind.max() - length, behind.min() - places
            beyond: Array = np.where(places < begin, np.maximum(ahead, back), ahead) / length
            return beyond

        until, before = 1.0, np.nan
        for _ in range(_MOST_DOUBLINGS):
            place = float(journey.place(np.array([until]))[0])
            if gone(np.array([place]))[0] >= 0.0 or place == before:
                break
            until, before = 2.0 * until, place
        times = np.linspace(0.0, until, _FINE)
        places = journey.place(times)
        beyond = gone(places)
        if (beyond >= 0.0).any():
            i = max(int(np.argmax(beyond >= 0.0)), 1)
            last = float(np.interp(0.0, beyond[i - 1 : i + 1], times[i - 1 : i + 1]))
            times = np.append(times[:i], last)
            places = journey.place(times)
        way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(places)))])
        if not way[-1] > 0.0:
            raise EquilibriumError(
                f"load {journey.rider.name} has no path: it stands at the end of its line and would move off it, or "
                "its speed is zero; let it start elsewhere (travel.from), or turn the sign of speed"
            )
        grown = np.concatenate([[True], np.diff(way) > 0.0])
        wanted = np.linspace(0.0, float(way[-1]), positions)
        return np.interp(wanted, way[grown], times[grown]), wanted

    def _frame(self, found: Borne, path: float) -> Frame:
        axes, mesh, count, dim = self._axes, self.mesh, found.station.size, len(self._axes)
        r, strands = found.position, mesh.strands
        potential, riders = self._bearing.potential, self._bearing.riders
        tension = potential.tension(r)
        EA = np.repeat([wire.axial_stiffness for wire in self.task.plan.wires], strands.links)
        place, force, both = np.full((count, dim), np.nan), np.full((count, dim), np.nan), np.full((count, 2), np.nan)
        xi, state = np.full(count, np.nan), np.full(count, OFF_LINE)
        first = np.concatenate([[0], np.cumsum(strands.links)[:-1]])
        for k, seat in enumerate(found.seats):
            if seat is None:
                continue
            a = int(riders.wire[k])
            place[k] = seat.value(r)[axes]
            place[k, -1], force[k], force[k, -1] = found.height[k], 0.0, found.force[k]
            xi[k] = seat.links * strands.h[a]
            both[k] = tension[first[a] + min(int(seat.links), int(strands.links[a]) - 1)]
            state[k] = MOVES if found.touches[k] else IN_AIR
        unknown, none = np.full(count, np.nan), np.zeros(count)
        off = np.isnan(place)
        bodies = self._bodies(found)
        return Frame(
            path=path, position=r[axes].T, velocity=np.zeros_like(r[axes].T), tension=tension, strain=tension / EA,
            contact_position=place, contact_force=force, hold_force=np.where(off, np.nan, 0.0), contact_xi=xi,
            contact_speed=np.where(np.isnan(xi), np.nan, 0.0), contact_tension=both, contact_friction=unknown,
            contact_state=state, contact_in_air=none, friction_power=none.copy(), body_position=bodies,
            body_velocity=np.zeros_like(bodies), reaction=self._reactions(r)[:, axes], energy=self._energy(found),
            tie_force=potential.tie_forces(r),
        )  # fmt: skip

    def _bodies(self, found: Borne) -> Array:
        riders = self._bearing.riders
        begin = np.concatenate([[0], np.cumsum(riders.size)])
        out = np.zeros((len(self.task.shown), len(self._axes)))
        for i, body in enumerate(self.task.shown):
            k = int(np.flatnonzero(riders.owner == body.journey)[body.wheel])
            a = int(riders.wire[k])
            start, along = self.mesh.strands.across[a].tolist()
            seat, station = found.seats[k], float(found.station[k])
            x = float(seat.value(found.position)[0]) if seat is not None else start + along * station
            q = found.coordinates[begin[body.journey] : begin[body.journey + 1]]
            out[i, 0], out[i, -1] = x + np.sign(along) * body.ahead, body.base + float(body.row @ q)
        return out

    def _reactions(self, r: Array) -> Array:
        """Forces of ends and holds on their wires, (support, 3) N."""
        potential = self._bearing.potential
        return reactions(self.mesh, potential.bare_pull(r), potential.hold_forces(r))

    def _energy(self, found: Borne) -> Array:
        potential, r = self._bearing.potential, found.position
        loads, potential.pressing = potential.pressing, None
        weights = float((potential.force * r).sum())
        energy = dict.fromkeys(ENERGY_FORMS, 0.0)
        energy["elastic"], energy["gravitational"] = potential.energy(r) + weights, -weights
        potential.pressing = loads
        energy["load_potential"] = -float(self._bearing.riders.rest @ np.where(found.touches, found.height, 0.0))
        return np.array([energy[form] for form in ENERGY_FORMS])
