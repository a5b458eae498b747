"""The system at rest: equilibrium with the loads at their start, and slow motion of the loads along their ways."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import lean
from ropewalk.mechanics.loading import loading_of
from ropewalk.mechanics.moving_contact import look_up_integral
from ropewalk.model.scenario import Scenario
from ropewalk.networks.lengths import doubt_slack
from ropewalk.results.frame import Frame, Layout, RunInfo
from ropewalk.solve.following import quasistatic_motion, schedule
from ropewalk.system.assembly import contacts_of, refuse_beyond, structure_of
from ropewalk.system.cables import add_wind_forces
from ropewalk.system.compliance import AT_REST
from ropewalk.system.contacts import ON
from ropewalk.system.frames import FrameBuilder, SystemNote
from ropewalk.system.hold_forces import HoldForces, on_friction
from ropewalk.system.loaded_structure import Carried, LoadedStructure
from ropewalk.system.rest import at_rest, least
from ropewalk.system.statics import SystemPotential
from ropewalk.system.structure import SystemState

# Rounds in which lines find their rest in the wind, and the move over their size that is none any more.
_ROUNDS, _NEAR = 100, 1e-10


@lean
def _add_wind_forces(structure, buffers, r, v, t):
    """Forces of the wind on what stands still, to `room.air`."""
    add_wind_forces(structure, buffers, r, v, t, 0.0)


class _RestShape(NamedTuple):
    """A rest on the way, and the contacts there."""

    places: Array  # as `statics.Potential` has them
    contacts: Any


class SystemStatics:
    """A run without inertia: its layout, and its frames.

    Args:
        scenario: what is computed.
        run_info: filled in.
        until: how long the histories of the loads are needed, s.
        space: whether there are three axes also for what stays in the plane.

    Raises:
        RopewalkError: there is no rest without loads, or a load begins beyond its line.
    """

    def __init__(self, scenario: Scenario, run_info: RunInfo, until: float, *, space: bool = False) -> None:
        assembled = structure_of(scenario, until, ("x", "y", "z") if space else None)
        loading = loading_of(scenario, until, axes=assembled.axes)
        within = scenario.is_plane
        structure, rest = at_rest(assembled.structure, loading.gravity, assembled.near, within=within)
        assembled = replace(assembled, structure=structure, near=rest)
        self._carried = Carried(*contacts_of(scenario, loading, structure, assembled.on))
        refuse_beyond(scenario, loading, self._carried.contacts, structure)
        self._carried.contacts["margin"] = 0.0
        self._scenario, self._run_info, self._structure, self._loading = scenario, run_info, structure, loading
        self._loaded = LoadedStructure(structure, rest, self._carried)
        size = float(np.ptp(rest, axis=1).max())
        self.potential = SystemPotential(structure, self._loaded, size, within=within, part=AT_REST)
        loads = loading.loads
        ahead = np.copysign(1.0, loads.speed_value[loads.speed_first])
        self._restraint = HoldForces(loads.contact, ahead, structure, self.potential.buffers.tension, rest.shape[0])
        self._remarked: set[int] = set()
        windy = scenario.wind is not None and not scenario.wind.is_calm
        self._builder = FrameBuilder(assembled, loading, self._carried.bodies, windy, path="load_path")
        run_info.method, run_info.reason = "rest", "least potential energy"

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        return self._builder.layout

    @property
    def displayed(self) -> Integers:
        """Nodes in the order of the result."""
        return self._builder.node

    def at_rest_with_loads(self) -> Array:
        """The shape at rest with the loads at their start, see `Potential`.

        Raises:
            EquilibriumError: there is none.
        """
        return self._rest(0.0, None).places

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
        for at in quasistatic_motion(self._rest, self._places, *self._schedule(), positions, turn):
            yield self._frame(at.shape, at.path, at.t)

    def _rest(self, t: float, near: _RestShape | None) -> _RestShape:
        """Rest with all loads where they are at a time in s, next to another one."""
        loaded, structure, potential = self._loaded, self._structure, self.potential
        r = self._loaded.rest
        if near is not None:
            loaded.contacts[:] = near.contacts
            r = potential.put(near.places)[0]
        loaded.stand(t, structure.restraints.put(r, t))  # what moves as prescribed is where it is then
        potential.arrange()

        def settle(shape: Array) -> Array:
            found = self._settled(shape, t)
            potential.forces(found)  # and all that contacts note of them
            return found

        contacts, s = loaded.contacts, loaded.state.s
        shape = self._restraint.hold(contacts, s, loaded.on, settle, potential.taken())
        return _RestShape(shape, contacts.copy())

    def _settled(self, shape: Array, t: float) -> Array:
        """Rest in the wind as it blows at time t in s, next to a shape: what it pushes at depends on it.

        Raises:
            EquilibriumError: there is none.
        """
        potential, structure = self.potential, self._structure
        if not structure.wind.direction.any():
            return least(potential, shape)
        self._loaded.set_wind(t)
        for done in range(_ROUNDS):
            r = potential.put(shape)[0]
            _add_wind_forces(structure.for_kernels, potential.buffers.for_kernels(structure), r, np.zeros_like(r), t)
            if done and np.array_equal(potential.blown, potential.buffers.air):  # as in calm air
                return shape
            potential.blown[:] = potential.buffers.air
            last, shape = shape, least(potential, shape)
            if float(np.abs(shape - last).max()) <= _NEAR * potential.size:
                return shape
        raise EquilibriumError("no equilibrium was found in the wind: lines flutter or lift; lower wind.speed")

    def _places(self, shape: _RestShape) -> Array:
        """Where contacts are, (contact, axis) m; NaN of those off their lines."""
        on = shape.contacts["state"] == ON
        return np.where(on[:, None], shape.contacts["place"][:, : self._loaded.rest.shape[0]], np.nan)

    def _schedule(self) -> tuple[Array, Array]:
        """Times and paths of the first load, until all its contacts have come to the end of their line."""
        contacts, tables = self._loaded.contacts, self._carried.tables
        if not contacts.size:
            raise EquilibriumError("quasi-static runs need a load that travels")
        first = contacts[0]
        mine = contacts["begin"][contacts["load"] == first["load"]]
        end = float(self._structure.lines.length[first["line"]])

        def place(times: Array) -> Array:
            entries = int(first["speed_first"]), int(first["speed_count"])
            path = tables.speed_time, tables.speed_value, tables.speed_path
            return np.array([first["begin"] + look_up_integral(*path, *entries, t) for t in times])

        behind = first["begin"] - mine
        name = list(self._scenario.loads)[int(first["load"])]
        return schedule(name, place, end, last=float(behind.max()), first=float(behind.min()))

    def _frame(self, shape: _RestShape, path: float, t: float) -> Frame:
        loaded, potential = self._loaded, self.potential
        loaded.contacts[:] = shape.contacts
        loaded.state.t[0] = t
        elastic = potential.stored(shape.places)
        potential.forces(shape.places)
        buffers, own, seen = potential.buffers, loaded.own, loaded.state
        buffers.react(self._structure.restraints)
        state = SystemState(seen.t, seen.r, seen.v, seen.u[:own], seen.w[:own], seen.s, seen.work)
        note = SystemNote.of(state, buffers, loaded.contacts, self._carried.bodies, elastic)
        frame = self._builder.build(SystemNote.together([note]), still=path)[0]
        self._remark(frame)
        return frame

    def _remark(self, frame: Frame) -> None:
        """Note what friction does not hold, each once."""
        for k in self._loaded.on.tolist():
            contact, kind = self._loaded.contacts[k], int(self._loading.loads.contact[k])
            found = on_friction(self._loading.wheels[k].name, kind, contact, float(frame.contact_friction[k]))
            if found and k not in self._remarked:
                self._remarked.add(k)
                self._run_info.warnings.append(f"from load path {frame.path:.4g} m on, {found}")
