"""A motion of the system, from output to output."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.checkpoint import Tree, copied, put
from ropewalk.controllers.assembly import controllers_of
from ropewalk.controllers.partner import Partner
from ropewalk.errors import EquilibriumError
from ropewalk.external.cosimulation_master import begun
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.loading import loading_of
from ropewalk.mechanics.notes import STEPS, Notes, numbers_of
from ropewalk.mechanics.portions import portion
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.results.exchanges import external_in
from ropewalk.results.frame import Layout, RunInfo
from ropewalk.results.frames import Frames, NotedInstants
from ropewalk.results.running import Ending
from ropewalk.solve.choice import RKN6_LIMIT, Bounds, rkn6_step
from ropewalk.solve.composition import RKN6, VERLET
from ropewalk.solve.search_budget import search
from ropewalk.solve.stages import LOBATTO, RADAU, Stages
from ropewalk.system.assembling.assembly import contacts_of, refuse_beyond
from ropewalk.system.contact.contact_record import BODY
from ropewalk.system.contact.feet import steps_by_table
from ropewalk.system.contact.tables import WHERE
from ropewalk.system.dynamics import motion, stability
from ropewalk.system.dynamics.asking import FAILED, Asking
from ropewalk.system.dynamics.beginning import begin_elsewhere, begin_in_wind, measure_from_rest
from ropewalk.system.dynamics.carrier import SHORTER, System, SystemCarrier
from ropewalk.system.dynamics.cuts import Cuts, FailingTies, runs_ahead_of_cuts
from ropewalk.system.dynamics.intervals import Intervals
from ropewalk.system.dynamics.partings import Partings
from ropewalk.system.dynamics.window import Window
from ropewalk.system.elements.compliance import compliances
from ropewalk.system.elements.inertia import remark_inertia, with_inertia
from ropewalk.system.elements.structure import WORKS, Buffers, SystemState
from ropewalk.system.equilibrium.carriages_at_rest import CarriagesAtRest
from ropewalk.system.equilibrium.lengths import off_tension
from ropewalk.system.equilibrium.rest import about_rest, least, refuse_limp, settled_in_wind, tensions
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import rest_before_motion, structure_of
from ropewalk.system.loads.crabs import Crabs, stand_on_lines
from ropewalk.system.loads.loaded_structure import Carried, LoadedStructure, load_springs, measure_from_ends
from ropewalk.system.loads.pantographs import stand_below, with_pantographs
from ropewalk.system.loads.payloads import place_payloads
from ropewalk.system.methods import first_damper, shaken
from ropewalk.system.reporting import doubts
from ropewalk.system.reporting.doubts import ContactDoubts
from ropewalk.system.reporting.frames import FrameBuilder, SystemNote
from ropewalk.system.reporting.sticking_friction import StickingFriction

if TYPE_CHECKING:
    from ropewalk.system.dynamics.implicit import Implicit

# Part of the longest step of the sixth order that is used: kinks raise the tensions that rest has.
RKN6_SAFETY = 0.9

_ENDS = {
    motion.NOT_FINITE: (
        "diverged",
        "positions are no numbers; write a smaller run.step, or axial_stiffness in place of an inextensible law",
    ),
    motion.AT_END: ("travel ended", "a load is at an end of its line; write at_end: leave or stay, or a shorter run"),
    motion.AT_SHEAVE: ("travel ended", "a load has reached a sheave, which it cannot pass; reverse its speed before"),
    motion.LINE_OUT: ("line ran out", "a line has moved over a sheave up to its end, to another sheave or to a joint"),
}


class SystemMotion:
    """Cable runs, joints and what they carry, as the engine of a motion in their first state.

    Args:
        scenario: what is computed.
        run_info: filled in.
        times: output instants in s, from 0.
        past: whether it goes on from a state that will be put, wherever it began.
        axes: names of the axes, if not those that the scenario needs.

    Raises:
        RopewalkError: the structure has no rest, or a load begins beyond its line.
    """

    looks_ahead = False

    def __init__(
        self, scenario: Scenario, run_info: RunInfo, times: Array, *, past: bool = False,
        axes: tuple[str, ...] | None = None,
    ) -> None:  # fmt: skip
        asked = scenario.run
        assert isinstance(asked, Dynamic)
        self.run_info, self.times, self._scenario, self._in_wind = run_info, times, scenario, asked.start.in_wind
        self.assembled = structure_of(scenario, asked.until, axes)
        gravity = np.zeros(len(self.assembled.axes))
        gravity[-1] = -scenario.gravity
        self.structure, self.rest = rest_before_motion(scenario, self.assembled, gravity)
        self._friction = StickingFriction(self.structure, self.rest) if asked.geometry == "linearised" else None
        if asked.geometry == "linearised":
            self.structure = about_rest(self.structure, self.rest)
            refuse_limp(self.structure, self.assembled.line, scenario.loads)
        if asked.axial_inertia != 1.0:
            self.structure = with_inertia(self.structure, self.rest, asked.axial_inertia)
            remark_inertia(run_info, asked.axial_inertia, self.structure, self.rest, self.assembled.line)
        self.assembled = replace(self.assembled, structure=self.structure, near=self.rest)
        loading = self.loading = loading_of(scenario, asked.until, axes=self.assembled.axes)
        self.contacts, self.tables, self.bodies = contacts_of(scenario, loading, self.structure, self.assembled.on)
        self._places = len(self.assembled.axes) * int((self.contacts["kind"] == BODY).sum())
        sections = self.assembled.sections
        self.bodies = with_pantographs(self.bodies, scenario, self._places, asked.until, sections)
        refuse_beyond(scenario, loading, self.contacts, self.structure)
        measure_from_ends(self.contacts, self.structure, self.rest)
        dim, n = self.rest.shape
        self.state = SystemState(
            np.zeros(1), self.rest.copy(), np.zeros((dim, n)), np.zeros(self.bodies.mass.size),
            np.zeros(self.bodies.mass.size), np.zeros(self.contacts.size), np.zeros(WORKS),
        )  # fmt: skip
        self._buffers, self._table, self._out = Buffers.of(self.structure, dim), compliances(), np.zeros(4)
        self._A, self._b = np.zeros((3, 4)), np.zeros(3)
        self._method, self._step = VERLET, 0.0
        stages = self._choose(asked)
        stability.limit_tension(self.structure, self.contacts, self._buffers)
        windy = scenario.wind is not None and not scenario.wind.is_calm
        ahead = runs_ahead_of_cuts(scenario, self.assembled.line, self.structure.lines.begin)
        self._builder = FrameBuilder(self.assembled, loading, self.bodies, windy, cut=ahead)
        cuts = Cuts(scenario, self.assembled, self.contacts, self.state.s)
        self._partings = Partings({"cuts": cuts, "ties": FailingTies(self.assembled)}, run_info)
        self._turned = np.zeros(1, dtype=np.int64)  # 1: it has been said that lines have turned far
        self._contact_doubts = ContactDoubts(loading, self.contacts, self.structure, run_info, times.size)
        self._carriages = CarriagesAtRest(scenario, loading, self.contacts, self.bodies, dim)
        self._crabs = Crabs(scenario, loading.wheels, self.contacts, self.bodies)
        if self._carriages.rounds:
            self._space_wheels()
        self._crabs.reach(self._locate)
        if asked.start.with_loads:
            bearing = self._settle(self.rest)
            for _ in range(self._carriages.rounds):  # they stand on slopes that they make
                self._carriages.roll(bearing)
                self._locate()
                self._carriages.hold(self.structure, self.state.r)
                bearing = self._settle(self.state.r)
            self._crabs.roll(self._locate, lambda: self._settle(self.state.r, self.state.u), self.state)
            measure_from_rest(self.contacts, self.state, self._locate)
        elif asked.start.in_wind and not past:
            begin_in_wind(self.structure, self.state, self._buffers)
        elif asked.start.kind != "rest" and not past:
            begin_elsewhere(
                self.structure, self.state, asked.start, self._builder.node, self.layout.node_line,
                within=scenario.is_plane, apart=tuple(self.assembled.sections),
            )  # fmt: skip
            self._crabs.reach(self._locate)
        self._stand(with_loads=asked.start.with_loads)
        run_info.step = self._step = min(self._step, self._allowed()) if stages is None else self._step
        self._lead()
        self._window = None if asked.window is None else Window.of(scenario, self.assembled, asked.window)
        self._implicit: Implicit | None = None
        if stages is not None:
            from ropewalk.system.dynamics.implicit import Implicit  # lazy: few runs need it

            longest = asked.until if asked.step is None else asked.step
            stable = stability.largest_step(self.structure, self.contacts, self.bodies, self.rest)
            self._implicit = Implicit(self._system(), self.rest, asked.precision, longest, stable, stages)
        self._elastic = np.zeros(1)
        self._sources = SystemNote.sources(self.state, self._buffers, self.contacts, self.bodies, self._elastic)
        self._numbers, self._is_due = numbers_of(self._sources), False
        self._notes = self._empty_notes(0)
        tension = tensions(self.structure, self.state.r)
        doubts.doubt_slack(scenario, run_info, self.layout.link_line, tension[self._builder.link])
        cut = stability.cut_by_damping(self.assembled, self.rest, self.times[-1] / self._step)
        run_info.warnings += [*shaken(scenario), *doubts.coarse_for_wheels(scenario), *self._carriages.slack(), *cut]
        run_info.warnings += doubts.not_pushed_outwards(scenario)
        run_info.warnings += [*doubts.joined_beside(scenario, self.assembled), *off_tension(scenario, self.assembled)]

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the frames."""
        return replace(self._builder.layout, external=external_in(self._scenario))

    @property
    def carrier(self) -> SystemCarrier:
        """The system with what may be done to its loads on the way."""
        return self._carrier

    @property
    def tension(self) -> Array:
        """Tensions of links by their first node, N."""
        return self._buffers.tension

    @property
    def displayed(self) -> Integers:
        """Nodes in the order of the result."""
        return self._builder.node

    def _choose(self, asked: Dynamic) -> Stages | None:
        """Choose method and step; returns the stages of an implicit one."""
        run_info, parts = self.run_info, (self.structure, self.contacts, self.bodies, self.rest)
        run_info.reason = "Verlet's method for all nodes and bodies; contacts on a spline of the fourth order"
        run_info.method, stable = "explicit", stability.largest_step(*parts)
        stable = min(stable, stability.while_passing(self.structure, self.contacts, self.tables))
        safe, self._step = stable / stability.SAFETY, stable
        stages: Stages | None = None
        if asked.method == "rkn6" and (damper := first_damper(self._scenario.parts)) is not None:
            stages, run_info.method = LOBATTO, "rkn6"
            run_info.reason = (
                "requested: sixth order, by Lobatto's method IIIC, because negative substeps are unstable with "
                f"{damper}; contacts on a spline of the fourth order"
            )
        elif asked.method == "rkn6":
            self._method, run_info.method = RKN6, "rkn6"
            run_info.reason = "requested: sixth order for nodes and bodies; contacts on a spline of the fourth order"
            frequency = stability.largest_frequency(*parts)
            safe = RKN6_LIMIT / max(frequency, 1e-300)
            longest = (self.structure.runs.h * self.structure.runs.links).max(
                initial=float(np.ptp(self.rest, axis=1).max())
            )
            relative = asked.precision / float(longest)
            self._step = RKN6_SAFETY * rkn6_step(Bounds(frequency, 0.0), relative)
        if asked.method == "implicit":
            stages, run_info.method = RADAU, "implicit"
            run_info.reason = "requested: Radau's method of order 5; contacts on a spline of the fourth order"
        if stages is not None:
            safe, self._step = np.inf, asked.until
        if asked.step is not None:
            self._step = asked.step
        if self._step > safe:
            run_info.warnings.append(
                f"the step of {self._step:.3g} s is larger than {safe:.3g} s, up to which the motion is "
                "stable for certain; write a smaller run.step, or leave it out"
            )
        self.contacts["step"] = self._step if self._gives_way else 0.0
        run_info.step = self._step
        return stages

    @property
    def _gives_way(self) -> bool:
        """Whether stiff contacts give way within a step."""
        return self.run_info.method == "explicit"

    def _allowed(self) -> float:
        """The step in s that tensions of inextensible lines allow that bear what is there at the beginning."""
        if (tight := self._buffers.tight) is None:
            return float("inf")
        potential, pull = self._bearing(self.rest), self._buffers.tension
        with (
            suppress(EquilibriumError),
            np.errstate(all="ignore"),
        ):  # set down suddenly it pulls about as much as at rest
            least(potential, potential.taken())
            pull = np.maximum(potential.buffers.tension, pull)
        return SHORTER * float(np.sqrt(tight.time[3] / max((tight.fast * pull).max(), 1e-300)))

    def _lead(self) -> None:
        """Let loads that decide on the way take their first decisions."""
        self._carrier = SystemCarrier(self._system(), self._scenario.gravity, self._places, self._step)
        led = {name: load for name, load in self._scenario.loads.items() if not steps_by_table(load)}
        controllers = controllers_of(self._carrier, self.loading, self._scenario.model_copy(update={"loads": led}))
        self._asking = Asking(self._carrier, controllers)
        self.cosimulation = [controller.cosimulation for controller in controllers if isinstance(controller, Partner)]
        with begun(self.cosimulation):
            self._asking.begin()

    def _system(self) -> System:
        return System(
            self.structure, self._buffers, self.contacts, self.tables, self.bodies, self.state, self._table, self._out,
            self._A, self._b, self._method,
        )  # fmt: skip

    def _bearing(self, near: Array) -> SystemPotential:
        """Potential energy of lines near a shape and of the loads where they begin, with kinks as in motion."""
        carried = Carried(self.contacts, self.tables, self.bodies)
        loaded = LoadedStructure(self.structure, self.rest, carried, as_moving=True)
        loaded.stand(0.0, near)
        return SystemPotential(self.structure, loaded, float(np.ptp(self.rest, axis=1).max()))

    def _settle(self, near: Array, u: Array | None = None) -> Any:
        """Let lines near a shape and loads, near coordinates if these are known, rest together; gives contacts there.

        Kinks are as in the steps to come.

        Raises:
            EquilibriumError: there is no such rest.
        """
        if self.times.size > 1 and self._gives_way:
            self.contacts["step"] = self._in_steps(1)[1]
        potential = self._bearing(near)
        if u is not None:
            potential.loaded.state.u[: u.size] = u
        with search(self.assembled.line):
            shape = (partial(settled_in_wind, t=0.0) if self._in_wind else least)(potential, potential.taken())
        potential.forces(shape)
        r, u = potential.put(shape)
        self.state.r[:], self.state.u[:] = r, u[: potential.loaded.own]
        self.state.s[:] = potential.loaded.state.s
        if self._buffers.tight is not None:
            self._buffers.tension[:] = potential.buffers.tension
        return potential.loaded.contacts

    def _space_wheels(self) -> None:
        """Let wheels of carriages stand as far apart as rockers have them, and hauling ropes hold them there."""
        self._locate()
        self._carriages.space()
        self._locate()
        self._carriages.hold(self.structure, self.state.r)

    def _stand(self, *, with_loads: bool) -> None:
        """Let bodies move along with the line; where they do not rest on it, with springs without force but weights."""
        state, resting = self.state, self.state.u.copy()
        self._locate()
        stand_on_lines(self.loading.wheels, self.contacts, state)
        load_springs(self.bodies, state.u, state.w)
        payloads = self._scenario, self.loading.wheels, self.contacts, self.bodies.tethers, state
        place_payloads(*payloads)
        stand_below(self._scenario, self.contacts, self.bodies, self._places, state)
        if with_loads:
            state.u[:] = resting
            place_payloads(*payloads, displaced=True)
        if self._carriages.rounds:
            self._carriages.hang(state.u, state.w)
            self._carriages.pay_out(self.structure, self._buffers, state.r, state.u)
        self.contacts["comes"] = 0
        self._look()
        self._crabs.hold(state)
        self._buffers.before[:] = self._buffers.strain

    def _advance(self, dt: float, steps: int) -> float:
        return float(self._system().advance(dt, steps)[1])

    def _locate(self) -> float:
        return self._advance(0.0, motion.LOCATE)

    def _look(self) -> float:
        """Find all forces; returns the energy stored in the lines and at contacts, J."""
        return self._advance(0.0, motion.LOOK)

    def _in_steps(self, i: int) -> tuple[int, float]:
        """How many steps lead to output instant i, and how long they are, s."""
        begin, end = float(self.times[i - 1]), float(self.times[i])
        steps = max(1, int(np.ceil((end - begin) / self._step - 1e-9)))
        return steps, (end - begin) / steps

    def advance(self, i: int, most: int = 1) -> Ending | None:
        """Go on to output instant i, and to those after it if nobody need look in between."""
        self._notes, self._is_due, status = self._empty_notes(0), False, motion.RUNNING
        if i and not (intervals := self._intervals(i, most)).end.size:
            status = self._go(float(self.times[i]))
        elif i:
            self._notes, before = intervals.notes, self.run_info.steps
            try:
                status = self._carrier.advance(0.0, motion.LOOK, intervals)[0]
            finally:
                self.run_info.steps = before + int(intervals.notes.gone[STEPS])
        self._is_due = status != motion.RUNNING or not self._notes.noted
        if (crossed := self._partings.crossed()) is not None:
            return Ending("travel ended", f"stopped at t = {self.state.t[0]:.6g} s: {crossed}")
        if status == motion.RUNNING:
            return None
        outcome, advice = ("load failed", self._asking.message) if status == FAILED else _ENDS[status]
        return Ending(outcome, f"stopped at t = {self.state.t[0]:.6g} s: {advice}")

    def _go(self, end: float) -> int:
        """Go on to a time in s; returns what has come of it."""
        if self._implicit is not None:
            status = self._partings.implicitly(self._implicit, end)
            self.run_info.steps = self._implicit.steps
            return status
        status = self._partings.to(self._asking, end) if self._window is None else self._go_in_window(end)
        self.run_info.steps, self._carrier.steps = self.run_info.steps + self._carrier.steps, 0
        return status

    def _empty_notes(self, most: int) -> Notes:
        return Notes.empty(self._numbers, most)

    def _intervals(self, i: int, most: int) -> Intervals:
        """Output instants from i on to which it goes without being looked at: one for each step of constant length."""
        structure, carrier, count = self.structure, self._carrier, self.rest.shape[1]
        looks = self._implicit is not None or self._window is not None or self._method is not VERLET
        looks = looks or bool(self._asking.controllers) or self._partings.any or structure.sheaves is not None
        looks = looks or (self._friction is not None and structure.saddles is not None)
        if looks or self._buffers.tight is not None or structure.inertia.along.size:
            return Intervals.nowhere(self.bodies)
        times = self.times[i : i + most]
        return Intervals.through(
            carrier.t, times, carrier.longest, portion(count), self.bodies, self._empty_notes(times.size),
            self._elastic, self._buffers.reaction,
        )  # fmt: skip

    def _go_in_window(self, end: float) -> int:
        """Go on to a time in s; the window follows the contacts."""
        assert self._window is not None
        carrier, status = self._carrier, motion.RUNNING
        while status == motion.RUNNING and (begin := carrier.t) < end:
            left = max(1, int(np.ceil((end - begin) / self._step - 1e-9)))
            steps = min(left, self._window.wait(self.contacts, self.tables, self._step))
            narrow = self._window.around(self.contacts, self.state)
            self._window.leave(narrow, self.state, self._buffers)
            carrier.system = self._system()._replace(structure=narrow)
            carrier.system.advance(0.0, motion.LOOK)
            self._buffers.before[:] = self._buffers.strain  # which differs where it is cut
            status = carrier.go(end if steps == left else begin + steps * (end - begin) / left)
        carrier.system = self._system()
        return status

    def note(self) -> NotedInstants:
        """What the frames of the instants that it came to will be made of; nothing of a motion without numbers."""
        if self._is_due and np.isfinite(self.state.r).all():
            self._is_due, notes = False, self._empty_notes(self._notes.noted + 1)
            self._look_at_present()
            notes.extend(self._notes)
            notes.add()
            self._notes = notes
        return NotedInstants(self._notes.noted, self._notes)

    def note_present(self) -> NotedInstants:
        """What a frame of the present will be made of, whatever came before."""
        self._notes, self._is_due = self._empty_notes(0), True
        return self.note()

    def _look_at_present(self) -> None:
        """Find all forces, but those of supports: of these the last kick knows."""
        reaction = self._buffers.reaction.copy()
        self._elastic[0] = self._carrier.advance(0.0, motion.LOOK)[1]
        self._buffers.reaction[:] = reaction
        for e in () if self._window is None else np.flatnonzero(self._window.still):
            self._buffers.reaction[e] = -self._buffers.force[:, self.structure.restraints.members(int(e))].sum(axis=1)
        t = float(self.state.t[0])
        if t == 0.0:
            self._buffers.react(self.structure.restraints)
        self._ask_turned(t)
        if self._friction is not None:
            moved = self.state.r - self.rest
            doubts.ask_sticking(self._friction, self.structure, moved, self._buffers, self.run_info, t)
        tension = self._buffers.tension[self._builder.link]
        doubts.doubt_struts(self._scenario, self.run_info, self.layout.link_line, tension, f"at t = {t:.4g} s")

    def frames(self, notes: Sequence[NotedInstants]) -> Frames:
        """The frames of some notes."""
        at = SystemNote.together([noted.of for noted in notes], self._sources)
        frames = self._builder.build(at)
        self._contact_doubts.doubt_speeds(at.t, at.contacts)
        doubts.doubt_saddles(self._scenario, self.run_info, frames, self.layout.node_line)
        if self._carriages.rounds or self._crabs.each:
            doubts.doubt_wheels(self._scenario, self.run_info, frames, self.loading.wheels)
            doubts.judge_hauling_ropes(self._scenario, self.run_info, frames, self.layout.hauled, at.hauls["deep"])
        self._contact_doubts.ask_friction(frames, at.contacts)
        return frames

    @property
    def together(self) -> bool:
        """Whether frames may be made later: nodes over sheaves go to other runs, and ties that fail are gone."""
        return self.structure.sheaves is None and not (self.assembled.attached and self.assembled.attached.fails)

    def _ask_turned(self, t: float) -> None:
        """Note once where lines with an axial inertia have turned so far that the step may be too long."""
        if self._turned[0] or not self.structure.inertia.along.size or self._method is not VERLET:
            return
        largest = stability.largest_step(self.structure, self.contacts, self.bodies, self.state.r, self.rest)
        if self._step > (stable := largest / stability.SAFETY):
            self._turned[0] = 1
            self.run_info.warnings.append(doubts.turned_far(t, self._step, stable))

    def get_state(self) -> Tree:
        """All that changes.

        Raises:
            RopewalkError: a load is an external model that gives no state.
        """
        changing = {name: copied(arrays) for name, arrays in self._changing().items()}
        own = {"frames": self._builder.get_state(), "longest": self._carrier.longest}
        return {**own, **changing, "guides": self._asking.get_state(), "partings": self._partings.get_state()}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._builder.set_state(tree["frames"])
        self._carrier.longest = tree["longest"]
        located = self.contacts[WHERE].copy()
        for name, arrays in self._changing().items():
            put(arrays, tree[name])
        self.contacts[WHERE] = located  # the run may be longer than that of the checkpoint
        self._asking.set_state(tree["guides"])
        self._partings.set_state(tree["partings"])

    def _changing(self) -> dict[str, Any]:
        own = {**self._contact_doubts.changing(), "turned": self._turned}
        if self._implicit is not None:
            own["step"] = self._implicit.memory
        return {**self._system().changing(), "loads": own}
