"""Runs of kind linear on the system: small motion about equilibrium by superposition of its modes.

Loads travel along lines as these rest without loads, see `solve/superposition.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.loading import loading_of
from ropewalk.model.mean_speed import MeanSpeed
from ropewalk.model.run import Linear
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import ENERGY_FORMS, Frame, Layout, RunInfo
from ropewalk.solve.crossings import CLOSE, LOOKS, crossings
from ropewalk.solve.modal import ModalBasis
from ropewalk.solve.superposition import (
    TOLERANCE,
    ModalBodies,
    Moment,
    Stretch,
    Superposition,
    passed_an_end,
    restrained_by_pulling,
)
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.assembling.assembly import contacts_of, refuse_beyond
from ropewalk.system.contact.contact_record import BODY
from ropewalk.system.elements.structure import WORKS, SystemState
from ropewalk.system.elements.surfaces import tensions_about_rest
from ropewalk.system.equilibrium.rest import about_rest, at_rest
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import Carried, LoadedStructure, load_springs, measure_from_ends
from ropewalk.system.loads.pantographs import stand_below, with_pantographs
from ropewalk.system.loads.pushes import pushes_at
from ropewalk.system.reporting.doubts import doubt_slack, doubt_sticking, joined_beside
from ropewalk.system.reporting.frames import FrameBuilder, SystemNote
from ropewalk.system.small_motion.mean_wind import RestInWind, doubt_gusts, unknowns_at
from ropewalk.system.small_motion.passing import Passing
from ropewalk.system.small_motion.rest_state import RestState, TiesAboutRest

_STORED = ("kinetic", "elastic", "gravitational", "load_kinetic", "load_potential")
_KNOWN = [ENERGY_FORMS.index(form) for form in _STORED]
_DRAWN = 1e-2  # of the largest force of a pantograph: by so much it may draw the wire down as it begins
_DRIFTS = 1e-3  # rad that what nothing holds would swing in the time of the run: a drift but for their square
_INSTANTS, _NEGLECTED = 20, 0.005  # instants of contacts, and a part of what modes neglect that is reported
_LOOKS = 41  # instants at which contact forces of bodies are compared, and not at those of output only
_LINKS = 0.5  # of a link, that contacts go in the longest step


class Superposed:
    """A linear run: its layout, and its frames.

    Args:
        scenario: what is computed.
        run: its run.
        times: output instants in s, from 0.
        run_info: filled in.

    Raises:
        RopewalkError: there is no rest, or something resists nothing to the first order.
    """

    def __init__(self, scenario: Scenario, run: Linear, times: Array, run_info: RunInfo) -> None:
        self._scenario, self._times, self._run_info = scenario, times, run_info
        assembled = structure_of(scenario, run.until)
        loading = loading_of(scenario, run.until, axes=assembled.axes)
        structure, rest = at_rest(assembled.structure, loading.gravity, assembled.near, within=scenario.is_plane)
        self._air: RestInWind | None = None
        if scenario.wind is not None and (speed := MeanSpeed.of(scenario.wind.speed, run.until)).mean != 0.0:
            self._air = RestInWind(structure, rest, speed, run.until, within=scenario.is_plane)
            structure, rest = self._air.structure, self._air.rest
            doubt_gusts(speed, run_info)
        self.rest, self._linear = rest, about_rest(structure, rest)
        self._assembled: Assembled = replace(assembled, structure=self._linear)
        contacts, self._tables, self._of = contacts_of(scenario, loading, structure, assembled.on)
        self._places = len(assembled.axes) * int((contacts["kind"] == BODY).sum())
        self._of = with_pantographs(self._of, scenario, self._places, run.until, assembled.sections)
        self._below = contacts["lift"] < 0  # pantographs, which touch as long as nothing is asked
        contacts["lift"] = 0
        refuse_beyond(scenario, loading, contacts, structure)
        run_info.warnings += joined_beside(scenario, assembled)
        measure_from_ends(contacts, structure, rest)
        contacts["margin"] = contacts["step"] = 0.0
        self._least, self._most = np.zeros((2, contacts.size))  # N, of contact forces upwards
        self._still = RestState(structure, rest, None if self._air is None else self._air.pushed)
        K, M, C = self._still.equations
        drifting = _DRIFTS / run.until if scenario.overhead_lines else 0.0  # between weights, along the line
        free, uneven = self._still.free, self._still.uneven
        begin = None if self._air is None else unknowns_at(self._air.moved, free)
        self.modes = ModalBasis.of(K, M, C, free, run.modes, drifting, uneven, begin)
        if self._air is not None and not drifting:
            self._air.doubt_start(K, free, run_info)
        carried = Carried(contacts, self._tables, self._of)
        self._loaded = LoadedStructure(self._linear, rest, carried)
        size = float(np.ptp(rest, axis=1).max())
        self._potential = SystemPotential(self._linear, self._loaded, size)
        self._potential.forces(self._potential.taken())
        self._loaded.stand(0.0, rest)
        names = [wheel.load for wheel in loading.wheels]
        runs, self._damping = structure.runs, np.zeros(rest.shape[1])  # N s, of links, by their first nodes
        for first, links, c in zip(runs.first, runs.links, runs.damping, strict=True):
            self._damping[first : first + links] = c
        if self._linear.sheaves is not None:  # links that these divide
            self._damping[self._linear.sheaves.about.node[:, 0]] = runs.damping[self._linear.sheaves.run]
        self._passing = Passing(self._linear, self._loaded, self._potential, self._tables, names)
        self._builder = FrameBuilder(self._assembled, loading, self._of, windy=self._air is not None)
        self._ties: TiesAboutRest | None = None
        if structure.ties is not None and assembled.attached is not None:
            self._ties = TiesAboutRest(structure.ties, rest, assembled.attached)
        doubt_slack(scenario, run_info, self.layout.link_line, self._potential.buffers.tension[self._builder.link])
        run_info.method = "modal superposition"
        run_info.audit = "the linear theory superposes modes and keeps no works"

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the frames."""
        return self._builder.layout

    def frames(self) -> Iterator[Frame]:
        """All frames.

        Raises:
            RopewalkError: a load passes an end of its line that it must not pass.
        """
        gusts = None if self._air is None else self._air.gusts
        motion = Superposition(self.modes, self._passing, self._bodies(), self.rest.shape[0], gusts)
        stretches = self._stretches()
        few = [self._passing.at(s.end, s.on) for s in stretches[:: max(1, len(stretches) // _INSTANTS)]]
        # Near supports kinks are stiffer: halving finds shorter steps.
        longest = min(self._longest(), max((motion.longest(touch) for touch in few), default=np.inf))
        moments, step, missed = motion.moments(stretches, longest, self._start(stretches[0].on))
        if not np.isfinite(missed):
            raise RopewalkError(
                f"the motion of bodies grows beyond all bounds in steps of {step:.3g} s, which would have "
                "to be halved more often; ask for kind: dynamic, geometry: linearised"
            )
        count, among = self.modes.frequency.size, self._still.free.shape[1]
        run_info = self._run_info
        run_info.step = step
        run_info.reason = (
            f"{count} of {among} modes about equilibrium; the remaining modes follow the forces quasi-statically"
        )
        if count == among:
            run_info.reason = f"all {count} modes about equilibrium"
        if self._scenario.overhead_lines:
            run_info.reason += "; droppers that are taut there stay taut, and heads of pantographs on the wire"
        if missed > 10.0 * TOLERANCE:
            run_info.doubt(
                f"half the steps still change {missed:.2g} of the displacement or contact force",
                "a body on the structure oscillates fast against its travel", "",
                "compare with kind: dynamic, geometry: linearised",
            )  # fmt: skip
        displayed = [s for s in stretches if s.displayed]
        if self.modes.left_out:
            self._warn_of_modes([motion.neglected(touch) for touch in few])
        lost: set[int] = set()
        for t, moment, on in zip(self._times, moments, [stretches[0].on, *(s.on for s in displayed)], strict=True):
            self._ask_contact(float(t), moment, lost)
            yield self._frame(float(t), moment, on)
        self._doubt_contact()

    def _warn_of_modes(self, parts: list[tuple[Array, Array]]) -> None:
        """Warn of a number of modes that leaves the inertia of much of the static response out."""
        count = getattr(self._scenario.run, "modes", None)
        left, whole = (
            max((float(own.max(initial=0.0)) for own in one), default=0.0) for one in zip(*parts, strict=True)
        )
        part = left / (whole or 1.0)
        if count is not None and part > _NEGLECTED:
            self._run_info.warnings.append(
                f"run.modes: up to {100.0 * part:.2g} % of the static displacement under a load lies outside of "
                f"{count} modes and follows without inertia; leave modes out, or write {2 * count} and compare"
            )

    def _bodies(self) -> ModalBodies:
        own, loaded = self._loaded.own, self._loaded
        first = loaded.contacts["first"].copy()
        first[first >= own] = -1
        K, C = loaded.K.toarray()[:own, :own], loaded.damping(loaded.state.u).toarray()[:own, :own]
        M = loaded.masses().toarray()[:own, :own]
        pushes = partial(pushes_at, self._of) if self._of.pushed.size else None
        return ModalBodies(M, C, K, loaded.weight[:own], first, self._of.load, pushes)

    def _longest(self) -> float:
        """Length of a step in which contacts go part of a link, s."""
        contacts, runs = self._loaded.contacts, self._linear.runs
        longest = float(np.diff(self._times).max(initial=0.0)) or 1.0
        for k in range(contacts.size):
            begin, count = int(contacts[k]["speed_first"]), int(contacts[k]["speed_count"])
            fastest = float(np.abs(self._tables.speed_value[begin : begin + count]).max(initial=0.0))
            h = float(runs.h[self._linear.lines.first[contacts[k]["line"]]])
            if fastest > 0.0:
                longest = min(longest, _LINKS * h / fastest)
        return longest

    def _start(self, on: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Bodies at rest on their springs, as they go along; contacts that are not on their lines on the ground."""
        loaded, own, u = self._loaded, self._loaded.own, self._loaded.state.u.copy()
        w, touch = np.zeros(u.size), self._passing.at(0.0, on)
        first = self._loaded.contacts["first"]
        moved = (self.modes.shape @ self.modes.begin).real.reshape(self.rest.shape)
        for i, k in enumerate(touch.contact):
            contact, at = loaded.contacts[k], first[k] + np.arange(self.rest.shape[0])
            used = np.flatnonzero((touch.weight[i] != 0.0) | (contact["slope"] != 0.0))
            below, rate = moved[:, touch.near[i] + used], contact["speed"] / self._linear.runs.h[contact["run"]]
            u[at] = touch.point[i] + below @ touch.weight[i][used]
            w[at] = touch.way[i] + rate * (below @ contact["slope"][used])
        beside = self._passing.beside(0.0, on)
        for k in np.flatnonzero(~on & (first < own)):
            w[first[k] + np.arange(self.rest.shape[0])] = beside[k]
        load_springs(self._of, u, w)
        stand_below(self._scenario, loaded.contacts, self._of, self._places, loaded.state._replace(u=u, w=w))
        return u[:own], w[:own]

    def _stretches(self) -> list[Stretch]:
        """The time of the run between instants of output, jumps of histories, and loads that come and go."""
        until, tables = float(self._times[-1]), self._tables
        gusts = np.zeros(0) if self._air is None else self._air.instants
        jumps = np.concatenate([tables.speed_time, tables.force_time, self._of.push_time, gusts])
        looks = np.linspace(0.0, until, _LOOKS) if self._loaded.own else np.zeros(0)  # at which forces are compared
        events = [*self._times, *looks, *jumps[(jumps > 0.0) & (jumps < until)], *self._comings(until)]
        instants = np.unique(np.array(events))
        kept = np.concatenate([[True], np.diff(instants) > CLOSE * until])
        instants = instants[kept]
        displayed = {int(np.abs(instants - t).argmin()) for t in self._times}
        contacts = self._loaded.contacts
        been, found = self._passing.whether_on(0.0, np.zeros(contacts.size, dtype=np.bool_)), []
        seen = been.copy()
        for i in range(instants.size - 1):
            begin, end = float(instants[i]), float(instants[i + 1])
            on = self._passing.whether_on(0.5 * (begin + end), seen)
            self._refuse_to_leave(seen & ~on, begin)
            seen |= on
            loads = np.unique(contacts["load"][seen & ~on])
            gone = frozenset(int(n) for n in loads if not on[contacts["load"] == n].any())
            found.append(Stretch(begin, end, on, gone, i + 1 in displayed))
        return found

    def _refuse_to_leave(self, off: NDArray[np.bool_], t: float) -> None:
        for k in np.flatnonzero(off & (self._loaded.contacts["refuses"] == 1)):
            name = self._builder.loading.wheels[int(k)].load
            raise passed_an_end(name, t)

    def _comings(self, until: float) -> Iterator[float]:
        """Instants at which loads come to their lines or leave them, s."""
        none_on = np.zeros(self._loaded.contacts.size, dtype=np.bool_)
        if not none_on.size:
            return
        looks = np.unique(np.concatenate([np.linspace(0.0, until, LOOKS), self._times]))
        seen = np.array([self._passing.whether_on(float(t), none_on) for t in looks])
        yield from crossings(looks, seen, lambda t: self._passing.whether_on(t, none_on), CLOSE * until)

    def _ask_contact(self, t: float, moment: Moment, lost: set[int]) -> None:
        """Note once where a contact holds a wheel by pulling."""
        contacts, forces = self._loaded.contacts, moment.force[:, -1]
        if moment.force.size:
            upwards = np.nan_to_num(moment.force[:, -1])
            self._least, self._most = np.minimum(self._least, upwards), np.maximum(self._most, upwards)
        for k in np.flatnonzero((contacts["first"] < self._loaded.own) & (forces > 0.0) & ~self._below):
            if k not in lost:
                lost.add(int(k))
                name = self._builder.loading.wheels[int(k)].name
                remedy = "kind: dynamic with lift_off: true lets it fly"
                self._run_info.warnings.append(restrained_by_pulling(name, t, remedy))

    def _doubt_contact(self) -> None:
        """Doubt a run in which a pantograph has drawn the wire down by more than a little."""
        for k in np.flatnonzero(self._below):
            if -self._least[k] > _DRAWN * self._most[k]:
                what = f"{self._builder.loading.wheels[int(k)].name} draws the wire down with {-self._least[k]:.3g} N"
                cause = "it would have lost contact there: linear theory keeps it on the wire"
                self._run_info.doubt(what, cause, "run.kind", "ask for kind: dynamic, geometry: linearised")

    def _frame(self, t: float, moment: Moment, on: NDArray[np.bool_]) -> Frame:
        loaded, potential, dim = self._loaded, self._potential, self.rest.shape[0]
        touch, own = self._passing.at(t, on), loaded.own
        x = moment.place
        r = self.rest + x.reshape(self.rest.shape)
        shape = np.concatenate([r.ravel(), moment.u, np.zeros(loaded.weight.size - own)])
        for i, k in enumerate(touch.contact):  # a contact is where it presses as it does
            contact, at = loaded.contacts[k], slice(touch.near[i], touch.near[i] + touch.weight.shape[1])
            below = r[:, at] @ touch.weight[i][: r[:, at].shape[1]]
            first = r.size + int(contact["first"])
            shape[first : first + dim] = below + moment.force[k] * touch.soft[i]
            shape[first + dim - 1] += contact["rough"]
            contact["hold"] = 0.0
            if contact["frictionless"]:
                level = self._linear.runs.ahead[contact["run"]]
                contact["hold"] = level @ (moment.force[k] - contact["given"][:dim])
        buffers, v = potential.buffers, moment.velocity.reshape(r.shape)
        later = self._strains_of_damped(shape, moment.velocity)
        if self._linear.taut is not None:  # tensions of lines that do not stretch are nobody's to find but `kept`
            buffers.tension[:] = self._linear.taut
        potential.forces(shape)
        viscous = self._damping if later is None else self._damping * (later - buffers.strain)
        inertia, forces = self._still.mass * moment.acceleration, self._still.forces(x, moment.velocity, moment.gusts)
        forces = forces + self._still.handed(self._pressed(touch, moment.force)) - inertia
        pulled, forces = self._still.kept(forces)
        buffers.tension[:] += pulled + viscous
        left, slips = self._still.friction.rubbed(forces, x)
        buffers.force[:] = left.reshape(r.shape)
        if slips:
            doubt_sticking(self._run_info, t, "a saddle")
        if self._still.friction.slips_over(self._linear.sheaves):
            doubt_sticking(self._run_info, t, "a sheave")
        buffers.react(self._linear.restraints)
        located = loaded.contacts[touch.contact]
        kinks = 0.5 * float((located["firm"][:, None] * located["d"] ** 2).sum())
        state = SystemState(
            np.array([t]), r, v, moment.u, moment.w, self._passing.state.s, np.zeros(WORKS)
        )  # fmt: skip
        note = SystemNote.of(state, buffers, loaded.contacts, self._of, self._still.stored(x) + kinks)
        frame = self._builder.build(note)[0]
        energy = np.full(len(ENERGY_FORMS), np.nan)
        energy[_KNOWN] = frame.energy[_KNOWN]
        return self._with_ties(replace(frame, energy=energy, cell_tension=self._cell_tensions(x)), t, x, v)

    def _with_ties(self, frame: Frame, t: float, x: Array, v: Array) -> Frame:
        """The same with forces of ties, and of supports that are ties, to the first order."""
        if self._ties is None or (attached := self._assembled.attached) is None:
            return frame
        x = x.reshape(self.rest.shape)
        self._ties.doubt(x, t, self._run_info)
        force, pull = self._ties.forces(x, v)
        reaction, begin = frame.reaction.copy(), len(self._assembled.supports)
        for e in range(len(attached.support)):
            reaction[begin + e] = pull[attached.holds == e].sum(axis=0)
        if not attached.sampled:
            return replace(frame, reaction=reaction)
        own = force[: len(attached.tie)]
        return replace(frame, reaction=reaction, tie_force=own, sampled_tie_force=own[None])

    def _strains_of_damped(self, shape: Array, velocity: Array) -> Array | None:
        """Strains (node,) after a second with these velocities, which grow evenly; None: there are no axial dampers."""
        if not self._damping.any():
            return None
        moved = shape.copy()
        moved[: velocity.size] += velocity
        self._potential.forces(moved)
        return self._potential.buffers.strain.copy()

    def _pressed(self, touch: Any, force: Array) -> Array:
        """Forces of contacts on all places, N."""
        dim, n = self.rest.shape
        out = np.zeros((dim, n))
        for i, k in enumerate(touch.contact):
            used = np.flatnonzero(touch.weight[i])
            out[:, touch.near[i] + used] += np.outer(force[k], touch.weight[i][used])
        return out.ravel()

    def _cell_tensions(self, x: Array) -> Array | None:
        """Tensions of cells to the first order, (cell, direction) N/m."""
        if (surfaces := self._linear.surfaces) is None:
            return None
        r = self.rest + x.reshape(self.rest.shape)
        return np.asarray(tensions_about_rest(surfaces.cells, surfaces.cells.area.size, self.rest, r[None])[0])
