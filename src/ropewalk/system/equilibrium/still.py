"""The system at rest: equilibrium with the loads at their start, and slow motion of the loads along their ways."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.loading import loading_of
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Frame, Layout, RunInfo
from ropewalk.system.assembling.assembly import contacts_of, refuse_beyond
from ropewalk.system.contact.contact_record import ON
from ropewalk.system.elements.compliance import AT_REST
from ropewalk.system.elements.structure import SystemState
from ropewalk.system.equilibrium.lengths import off_tension
from ropewalk.system.equilibrium.rest import at_rest, settled_in_wind
from ropewalk.system.equilibrium.rubbing import LaggingPotential, RubbingPotential, is_lagging, is_rubbing, settle_after
from ropewalk.system.equilibrium.slow_motion import SlowMotion, positions_at, travelled
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import Carried, LoadedStructure
from ropewalk.system.reporting.doubts import joined_beside
from ropewalk.system.reporting.frames import FrameBuilder, SystemNote
from ropewalk.system.reporting.hold_forces import HoldForces, on_friction

_INSIDE = 1e-12  # part of a line by which loads that stay at its end stop before it: rounding must not pass it


class _RestShape(NamedTuple):
    """A rest on the way, and the contacts there."""

    places: Array  # as `statics.Potential` has them
    contacts: Any
    lag: Array  # (2, node) what hysteresis keeps in mind, N, and strains
    kept: Array | None  # of lines that rub on saddles, as of `RubbingPotential`


class SystemStatics(SlowMotion[_RestShape]):
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
        run_info.warnings += [*joined_beside(scenario, assembled), *off_tension(scenario, assembled)]
        self._carried.contacts["margin"] = 0.0
        self._scenario, self._run_info, self._structure, self._loading = scenario, run_info, structure, loading
        self._loaded = LoadedStructure(structure, rest, self._carried)
        size = float(np.ptp(rest, axis=1).max())
        kind = LaggingPotential if is_lagging(structure) else SystemPotential
        kind = RubbingPotential if is_rubbing(structure) else kind
        self.potential = kind(structure, self._loaded, size, within=within, part=AT_REST)
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

    def _rest(self, t: float, near: _RestShape | None) -> _RestShape:
        """Rest with all loads where they are at a time in s, next to another one."""
        loaded, structure, potential = self._loaded, self._structure, self.potential
        r = self._loaded.rest
        if near is not None:
            loaded.contacts[:] = near.contacts
            r = potential.put(near.places)[0]
        contacts, carried = loaded.contacts, self._carried
        place, length = positions_at(carried, structure, t), structure.lines.length[contacts["line"]]
        stays = (contacts["stays"] == 1) & (place >= 0.0)
        place[stays] = np.minimum(place, length * (1.0 - _INSIDE))[stays]
        moved = [float(travelled(carried.tables, contact, np.asarray(t))) for contact in contacts]
        contacts["begin"] = np.where(stays, place - moved, carried.contacts["begin"])
        if isinstance(potential, RubbingPotential):
            potential.kept = potential.laid if near is None or near.kept is None else near.kept
        loaded.stand(t, structure.restraints.put(r, t))  # what moves as prescribed is where it is then
        potential.arrange()

        def settle_alone(shape: Array) -> Array:
            found = settled_in_wind(potential, shape, t)
            potential.forces(found)  # and all that contacts note of them
            return found

        def settle(shape: Array) -> Array:
            if near is None or not lagging:
                return settle_alone(shape)
            return settle_after(potential, settle_alone, shape, near.lag)

        lagging = is_lagging(structure)
        s = loaded.state.s
        shape = self._restraint.hold(contacts, s, loaded.on, settle, potential.taken())
        if lagging:
            potential.buffers.lag[1] = potential.buffers.strain
        kept = potential.keep(shape) if isinstance(potential, RubbingPotential) else None
        return _RestShape(shape, contacts.copy(), potential.buffers.lag.copy(), kept)

    def _places(self, shape: _RestShape) -> Array:
        """Where contacts are, (contact, axis) m; NaN of those off their lines."""
        on = shape.contacts["state"] == ON
        return np.where(on[:, None], shape.contacts["place"][:, : self._loaded.rest.shape[0]], np.nan)

    def _frame(self, shape: _RestShape, path: float, t: float) -> Frame:
        loaded, potential = self._loaded, self.potential
        loaded.contacts[:], potential.buffers.lag[:] = shape.contacts, shape.lag
        loaded.state.t[0] = t
        if isinstance(potential, RubbingPotential) and shape.kept is not None:
            potential.kept = shape.kept
        elastic = potential.stored(shape.places)
        potential.forces(shape.places)
        buffers, own, seen = potential.buffers, loaded.own, loaded.state
        buffers.react(self._structure.restraints)
        state = SystemState(seen.t, seen.r, seen.v, seen.u[:own], seen.w[:own], seen.s, seen.work)
        note = SystemNote.of(state, buffers, loaded.contacts, self._carried.bodies, elastic)
        frame = self._builder.build(note, still=path)[0]
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
