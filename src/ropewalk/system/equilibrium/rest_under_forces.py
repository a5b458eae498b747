"""Lines at rest and in slow motion under forces and masses, which stand at nodes: see `split_lines.py`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.loading import loading_of
from ropewalk.model.axles import Axles
from ropewalk.model.load import AnyLoad, MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import ENERGY_FORMS, MOVES, Contacts, Frame, Layout, RunInfo
from ropewalk.solve.vehicle_statics import agree, loaded_bodies, potential_of
from ropewalk.system.assembling.assembly import contacts_of, refuse_beyond
from ropewalk.system.assembling.laid import Over
from ropewalk.system.elements.structure import WORKS, SystemState
from ropewalk.system.equilibrium.lengths import off_tension
from ropewalk.system.equilibrium.slow_motion import SlowMotion, positions_at
from ropewalk.system.equilibrium.split_holds import Beside, FixedStations, SplitHolds
from ropewalk.system.equilibrium.split_lines import AT_SHEAVE, LineForce, LineShape, SplitLines, SplitRest
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import Carried
from ropewalk.system.reporting.doubts import joined_beside
from ropewalk.system.reporting.frames import FrameBuilder, SystemNote, onward_of
from ropewalk.system.reporting.hold_forces import on_friction

_PATH = "load_path"


def is_split(scenario: Scenario) -> bool:
    """Whether lines are divided at rest: all loads are forces on lines that do not bend, or one has sheaves."""
    parts = scenario.parts
    if parts.runs_over_sheaves:
        return True
    loads = scenario.loads.values()
    return bool(loads) and not parts.is_for_the_system and all(_is_a_force(load, scenario) for load in loads)


def _is_a_force(load: AnyLoad, scenario: Scenario) -> bool:
    """Whether a load is no more than a force at a place of a line that does not bend."""
    line = scenario.lines.get(load.on)
    if line is None or line.has_bending_stiffness:
        return False
    if isinstance(load, Axles):
        return True
    if not isinstance(load, MovingForce | MovingMass) or load.contact != "clamped":
        return False
    if isinstance(load, MovingForce):
        return load.friction is None
    return not (load.lift_off or load.air_drag)


class _Loaded(NamedTuple):
    """A rest, and where loads are."""

    rest: SplitRest
    at: Array  # (contact,) m along their lines
    on: NDArray[np.bool_]  # (contact,) whether they are on them
    force: Array  # (contact, axis) N, with what holds them
    hold: Array  # (contact, axis) N, of that


class RestUnderForces(SlowMotion[_Loaded]):
    """A run without inertia: its layout, and its frames.

    Args:
        scenario: what is computed.
        run_info: filled in.
        until: how long the histories of the loads are needed, s.

    Raises:
        RopewalkError: there is no rest without loads, or a load begins beyond its line.
    """

    def __init__(self, scenario: Scenario, run_info: RunInfo, until: float) -> None:
        assembled, loading = structure_of(scenario, until), loading_of(scenario, until)
        structure, bare = assembled.structure, scenario.model_copy(update={"loads": {}})
        self._scenario, self._run_info, self._loading, self._structure = scenario, run_info, loading, structure
        self._carried = Carried(*contacts_of(scenario, loading, structure, assembled.on))
        refuse_beyond(scenario, loading, self._carried.contacts, structure)
        run_info.warnings += [*joined_beside(scenario, assembled), *off_tension(scenario, assembled)]
        self._windy = scenario.wind is not None and not scenario.wind.is_calm
        lengths = dict(zip(scenario.lines, structure.lines.length.tolist(), strict=False))
        self._lines = SplitLines(scenario, lengths, until, assembled.axes)
        self._begin = LineShape.of(self._lines.settle(near=self._lines.shape_of(assembled)))
        self._bare = loading_of(bare, until, axes=assembled.axes)
        self._no_contacts, _, self._bodies = contacts_of(bare, self._bare, structure, {})
        builder = FrameBuilder(assembled, loading, self._carried.bodies, self._windy, path=_PATH)
        self._displayed = FixedStations(builder.layout)
        loads, contacts = loading.loads, self._carried.contacts
        ahead = np.copysign(1.0, loads.speed_value[loads.speed_first])
        self._holds = SplitHolds(loads.contact, contacts["friction"], contacts["block"], ahead)
        self._onward = [onward_of(assembled, line) for line in contacts["line"]]  # (contact,) of (axis,)
        self._level = structure.runs.ahead[structure.lines.first[contacts["line"]]]  # (contact, axis), of hold forces
        self._remarked: set[int] = set()
        self._before: Array | None = None  # whether contacts are ahead of sheaves, as they were at first
        run_info.method, run_info.reason = "rest", "least potential energy"

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        return self._displayed.layout

    def _rest(self, t: float, near: _Loaded | None) -> _Loaded:
        """Rest with all loads where they are at a time in s, next to another one."""
        contacts, tables, wheels = self._carried.contacts, self._carried.tables, self._loading.wheels
        length = self._structure.lines.length[contacts["line"]]
        at = positions_at(self._carried, self._structure, t)
        at = np.where(np.abs(at - length) <= 1e-9 * length, np.clip(at, 0.0, length), at)
        on, axes = (at >= 0.0) & (at <= length), range(self._lines.gravity.size)
        given = [[_at(tables.force_time, tables.force_value[a], c, "force", t) for a in axes] for c in contacts]
        force, base = (
            np.array(given).reshape(-1, len(axes)) + self._weights(),
            self._begin if near is None else near.rest,
        )
        self._refuse_passed(base.over, at, on)

        def settle(acting: Array) -> SplitRest:
            forces = [LineForce(wheels[k].on, float(at[k]), acting[k]) for k in np.flatnonzero(on).tolist()]
            found = self._lines.settle(forces, near=base, t=t, rubs=True)
            found.potential.forces(found.shape)  # which those who look beside a load want to be of this rest
            return found

        force, hold, rest = self._borne(force, at, on, settle)
        self._refuse_passed(rest.over, at, on)
        loaded = _Loaded(rest, at, on, force + hold, hold)
        self._remark(loaded, t)
        return loaded

    def _borne(
        self, given: Array, at: Array, on: NDArray[np.bool_], settle: Callable[[Array], SplitRest]
    ) -> tuple[Array, Array, SplitRest]:
        """Forces (contact, axis) on lines without those that hold contacts, these, and the rest under both, N."""
        lines, length = [wheel.on for wheel in self._loading.wheels], self._structure.lines.length
        far = length[self._carried.contacts["line"]]
        inner = np.flatnonzero(on & (at > 0.0) & (at < far)).tolist()
        hold, found = np.zeros(at.size), list[SplitRest]()

        def beside(rest: SplitRest, k: int) -> Beside:
            return Beside.of(rest, lines[k], float(at[k]))

        def give_way(vehicles: Array) -> Array:
            force = given + vehicles.T
            weight = float(np.abs(force[inner]).max(initial=0.0))
            rest, hold[:] = self._holds.hold(
                inner, weight, lambda level: settle(force + level[:, None] * self._level), beside
            )
            found[:] = [rest]
            return self._stands(rest, at).T

        place, vehicles = give_way(np.zeros(given.T.shape)), np.zeros(given.T.shape)
        if (system := self._loading.multibody_system) is not None and system.bodies.vehicles.size:
            vehicles = agree(system.bodies, give_way, place)
        return given + vehicles.T, hold[:, None] * self._level, found[0]

    def _stands(self, rest: SplitRest, at: Array) -> Array:
        """Where contacts at places along their lines stand, also those before and behind them, (contact, axis) m."""
        wheels = self._loading.wheels
        nodes = [rest.node_at(wheel.on, float(s)) for wheel, s in zip(wheels, at, strict=True)]
        return np.asarray(rest.r[:, nodes].T)

    def _weights(self) -> Array:
        """Weights of the masses on lines, (contact, axis) N."""
        return np.array([wheel.mass for wheel in self._loading.wheels])[:, None] * self._lines.gravity

    def _refuse_passed(self, over: Over, at: Array, on: NDArray[np.bool_]) -> None:
        """Refuse loads that have come to the other side of a sheave.

        Raises:
            EquilibriumError: one has.
        """
        if not over:
            return
        own = np.array([wheel.on for wheel in self._loading.wheels])
        beyond = np.array([(at > place) | ~on | (own != name) for (name, _), place in over.items()])
        if self._before is not None and (beyond != self._before)[:, on].any():
            raise EquilibriumError(AT_SHEAVE)
        self._before = beyond if self._before is None else self._before

    def _places(self, loaded: _Loaded) -> Array:
        """Where contacts are, (contact, axis) m; NaN of those off their lines."""
        return np.where(loaded.on[:, None], self._stands(loaded.rest, loaded.at), np.nan)

    def _remark(self, loaded: _Loaded, t: float) -> None:
        """Note what friction does not hold, each once."""
        for k in np.flatnonzero(loaded.on).tolist():
            contact, wheel = self._carried.contacts[k], self._loading.wheels[k]
            contact["hold"] = float(loaded.hold[k] @ self._level[k])
            needed = Beside.of(loaded.rest, wheel.on, float(loaded.at[k])).needed(block=bool(contact["block"]))
            found = on_friction(wheel.name, int(self._loading.loads.contact[k]), contact, needed)
            if found and k not in self._remarked:
                self._remarked.add(k)
                self._run_info.warnings.append(f"at {t:.4g} s of its travel, {found}")

    def _frame(self, loaded: _Loaded, path: float, t: float) -> Frame:
        rest = loaded.rest
        rest.potential.loaded.state.t[0] = t
        elastic, none = rest.potential.stored(rest.shape), np.zeros(0)
        rest.potential.forces(rest.shape)
        buffers = rest.potential.buffers
        buffers.react(rest.structure.restraints)
        state = SystemState(np.array([t]), rest.r, np.zeros_like(rest.r), none, none, none, np.zeros(WORKS))
        note = SystemNote.of(state, buffers, self._no_contacts, self._bodies, elastic)
        builder = FrameBuilder(rest.assembled, self._bare, self._bodies, self._windy, path=_PATH)
        own = builder.build(note, still=path)[0]
        position, tension, strain = self._displayed.of(rest, own, builder.layout)
        seen, energy = self._contacts(loaded, t), own.energy.copy()
        contacts: Any = seen.fields()
        places = np.zeros((0, self._lines.gravity.size))
        if (multibody_system := self._loading.multibody_system) is not None:
            bodies = loaded_bodies(multibody_system.bodies, self._stands(rest, loaded.at).T)
            energy[ENERGY_FORMS.index("load_potential")] += potential_of(bodies, self._lines.gravity)
            places = self._displayed_bodies(bodies, loaded.on)
        return replace(
            own, position=position, velocity=np.zeros_like(position), tension=tension, strain=strain, energy=energy,
            body_position=places, body_velocity=np.zeros_like(places),
            sheave_station=np.array(list(rest.over.values())) if rest.over else None, **contacts,
        )  # fmt: skip

    def _contacts(self, loaded: _Loaded, t: float) -> Contacts:
        """What is shown of contacts."""
        contacts, tables, rest = self._carried.contacts, self._carried.tables, loaded.rest
        seen, on = Contacts(*loaded.force.shape), loaded.on
        seen.position[:], seen.force[on], seen.hold[on] = self._places(loaded), loaded.force[on], loaded.hold[on]
        seen.xi[on], seen.state[on] = loaded.at[on], MOVES
        for k in np.flatnonzero(on).tolist():
            c = contacts[k]
            seen.speed[k] = _at(tables.speed_time, tables.speed_value, c, "speed", t)
            beside = Beside.of(rest, self._loading.wheels[k].on, float(loaded.at[k]))
            seen.tension[k], seen.friction[k] = (beside.behind, beside.ahead), beside.needed(block=bool(c["block"]))
        return seen

    def _displayed_bodies(self, bodies: Bodies, on: NDArray[np.bool_]) -> Array:
        """Places of all bodies, (body, axis) m; along what has no coordinate above wheels."""
        displayed = () if self._loading.multibody_system is None else self._loading.multibody_system.displayed
        out = np.zeros((len(displayed), self._lines.gravity.size))
        for i, body in enumerate(displayed):
            for a, c in enumerate(body.coordinates):
                beside = body.locate(bodies.wheels["r"][None, :, a], on[None], float(self._onward[body.wheel][a]))[0]
                out[i, a] = bodies.coordinates["q"][c] if c >= 0 else beside
        return out


def _at(time: Array, value: Array, contact: Any, of: str, t: float) -> float:
    """What a table says of a contact at a time in s."""
    own = slice(int(contact[f"{of}_first"]), int(contact[f"{of}_first"] + contact[f"{of}_count"]))
    return float(np.interp(t, time[own], value[own]))
