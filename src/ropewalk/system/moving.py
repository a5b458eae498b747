"""A motion of the system, from output to output."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ropewalk.checkpoint import Tree, arrays_of, copied, put
from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.fleet import hung
from ropewalk.mechanics.loading import loading_of
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.trolley import Trolley
from ropewalk.results.frame import Account, Frame, Layout
from ropewalk.results.running import Ending
from ropewalk.system import motion
from ropewalk.system.assembly import contacts_of, structure_of
from ropewalk.system.bodies import with_step
from ropewalk.system.compliance import compliances
from ropewalk.system.contacts import BODY, FASTEST, ON
from ropewalk.system.frames import FrameBuilder
from ropewalk.system.stability import SAFETY, largest_step
from ropewalk.system.statics import at_rest, tensions
from ropewalk.system.structure import WORKS, Room, State
from ropewalk.webs.lengths import doubt_slack

# Part of a run for which a load may be faster than the waves of its line, as where that is slack for a while.
LONG = 0.2

_ENDS = {
    motion.NOT_FINITE: ("diverged", "positions stopped being numbers; take a smaller run.step"),
    motion.AT_END: (
        "travel ended",
        "a load has come to an end of its line; write at_end: leave or stay, or end the run before",
    ),
}


class Motion:
    """Cable runs, joints and what they carry, as the engine of a motion in their first state.

    Args:
        scenario: what is computed.
        account: filled in.
        times: output instants in s, from 0.

    Raises:
        RopewalkError: the structure has no rest, or a load begins beyond its line.
    """

    turns = ()
    looks_ahead = False

    def __init__(self, scenario: Scenario, account: Account, times: Array) -> None:
        asked = scenario.run
        assert isinstance(asked, Dynamic)
        self.account, self.times = account, times
        self.assembled = structure_of(scenario, asked.until)
        gravity = np.zeros(len(self.assembled.axes))
        gravity[-1] = -scenario.gravity
        self.structure, self.rest = at_rest(self.assembled.structure, gravity, self.assembled.near)
        self.assembled = replace(self.assembled, structure=self.structure)
        loading = loading_of(scenario, asked.until)
        self.loading = loading
        self.contacts, self._tables, self.bodies = contacts_of(scenario, loading, self.structure, tuple(scenario.lines))
        self._scenario = scenario
        self._refuse_beyond(scenario)
        axes, n = self.rest.shape
        self.state = State(
            np.zeros(1), self.rest.copy(), np.zeros((axes, n)), np.zeros(self.bodies.mass.size),
            np.zeros(self.bodies.mass.size), np.zeros(self.contacts.size), np.zeros(WORKS),
        )  # fmt: skip
        self._room, self._table, self._out = Room.of(self.structure, axes), compliances(), np.zeros(3)
        self._A, self._b = np.zeros((3, 4)), np.zeros(3)
        stable = largest_step(self.structure, self.contacts, self.bodies, self.rest)
        self._step = stable if asked.step is None else asked.step
        if self._step > stable / SAFETY:
            account.warnings.append(
                f"the step of {self._step:.3g} s is larger than {stable / SAFETY:.3g} s, up to which the motion is "
                "stable for certain; write a smaller run.step, or leave it out"
            )
        self.contacts["step"] = self._step
        account.method, account.step = "explicit", self._step
        account.reason = "Verlet's method for all nodes and bodies; contacts on a spline of the fourth order"
        windy = scenario.wind is not None and not scenario.wind.is_calm
        self._builder = FrameBuilder(self.assembled, loading, self.bodies, windy)
        self._fast = np.zeros(self.contacts.size, dtype=np.int64)  # frames in which each was faster than waves
        self._stand()
        tension = tensions(self.structure, self.rest)
        doubt_slack(scenario, account, self.layout.link_line, tension[self._builder.link])

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the frames."""
        return self._builder.layout

    def _refuse_beyond(self, scenario: Scenario) -> None:
        for wheel, contact in zip(self.loading.wheels, self.contacts, strict=True):
            length, line = float(self.structure.lines.length[contact["line"]]), scenario.lines[wheel.on]
            if wheel.start > length * (1.0 + 1e-9) and not np.isclose(wheel.start, line.distance, 1e-9):
                raise EquilibriumError(
                    f"load {wheel.name} would begin {wheel.start:g} m along {wheel.on}, which ends at {length:g} m; "
                    "change its from"
                )

    def _stand(self) -> None:
        """Put bodies on the line at rest and moving along with it, their springs without force but for weights."""
        self._stored()
        axes, state, bodies = self.rest.shape[0], self.state, self.bodies
        motion.stand(self.structure, self.contacts, state)
        for contact in self.contacts:
            if contact["kind"] != BODY:
                continue
            own = contact["first"] + np.arange(axes)
            if contact["state"] == ON:
                state.u[own], state.w[own] = contact["p"][:axes], contact["speed"] * contact["along"][:axes]
        for p, n in enumerate(bodies.size):
            at, K = bodies.at[p, :n], bodies.K[p, :n, :n]
            free, on = bodies.contact[at] < 0, bodies.contact[at] >= 0
            inner, across = K[np.ix_(free, free)], K[np.ix_(free, on)]
            solve = np.linalg.pinv(inner)
            state.u[at[free]] = solve @ (bodies.force[at[free]] - across @ state.u[at[on]])
            state.w[at[free]] = -solve @ across @ state.w[at[on]]
        for tether in self.bodies.tethers:
            first, above = int(tether["first"]), int(self.contacts[tether["contact"]]["first"])
            load = self._scenario.loads[self.loading.wheels[tether["contact"]].load]
            assert isinstance(load, Trolley)
            below = hung(load.payload, float(tether["stiffness"]), self._scenario.gravity, self.loading.axes)
            state.u[first : first + axes] = state.u[above : above + axes] + below
            state.w[first : first + axes] = state.w[above : above + axes]
        self.contacts["comes"] = 0
        self._stored()
        self._room.before[:] = self._room.strain
        self._look()

    def _arguments(self) -> tuple[Any, ...]:
        return (
            self.structure, self._room, self.contacts, self._tables, self.bodies, self.state, self._table, self._out,
        )  # fmt: skip

    def _stored(self) -> float:
        return float(motion.stored(*self._arguments()))

    def _look(self) -> None:
        motion.look(*self._arguments())

    def advance(self, i: int) -> Ending | None:
        """Go on to output instant i."""
        if not i:
            return None
        begin, end = float(self.times[i - 1]), float(self.times[i])
        steps = max(1, int(np.ceil((end - begin) / self._step - 1e-9)))
        dt = (end - begin) / steps
        self.contacts["step"] = dt
        self.bodies = self._builder.bodies = with_step(self.bodies, dt)
        status = motion.advance(*self._arguments(), self._A, self._b, dt, steps)
        if status != motion.AT_END:
            self.state.t[0] = end
        self.account.steps += steps
        if status == motion.RUNNING:
            return None
        outcome, advice = _ENDS[status]
        return Ending(outcome, f"stopped at t = {self.state.t[0]:.6g} s: {advice}")

    def frame(self) -> Frame | None:
        """The present frame; none of a motion that is no longer finite."""
        if not np.isfinite(self.state.r).all():
            return None
        reaction = self._room.reaction.copy()
        elastic = self._stored()
        self._look()
        self._room.reaction[:] = reaction
        if self.state.t[0] == 0.0:
            self._at_rest()
        return self._builder.build(self.state, self._room, self.contacts, elastic)

    def _at_rest(self) -> None:
        """Reactions of what stands still."""
        held, force = self.structure.holdings, self._room.force
        for e in range(held.mass.size):
            nodes = held.node[held.first[e] : held.first[e] + held.nodes[e]]
            self._room.reaction[e] = -force[:, nodes].sum(axis=1)

    def remark(self, frame: Frame) -> None:
        """Doubt kinks that are carried along faster than transverse waves."""
        runs = self.structure.runs
        for k, (wheel, contact) in enumerate(zip(self.loading.wheels, self.contacts, strict=True)):
            if contact["state"] != ON or contact["kind"] != BODY or runs.bending[contact["run"]] > 0.0:
                continue
            square = float(runs.rho[contact["run"]] * contact["speed"] ** 2)
            if square > FASTEST * max(float(contact["tension"]), 0.0) and square > 0.0:
                self._fast[k] += 1
                if self._fast[k] > LONG * self.times.size:
                    self._doubt(wheel.name, wheel.load, float(contact["speed"]), frame.path)

    def _doubt(self, name: str, load: str, speed: float, t: float) -> None:
        if any(doubt.key == f"loads.{load}.travel.speed" for doubt in self.account.doubts):
            return
        self.account.doubt(
            f"load {name}: a mass at {speed:.4g} m/s comes to the speed of the transverse waves of its line at "
            f"t = {t:.4g} s",
            "its contact force is wrong once it is as fast as the waves", f"loads.{load}.travel.speed",
            "let it go slower, or give the line more tension",
        )  # fmt: skip

    def get_state(self) -> Tree:
        """All that changes."""
        return {"frames": self._builder.get_state(), **{name: copied(arrays) for name, arrays in self._changing()}}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._builder.set_state(tree["frames"])
        for name, arrays in self._changing():
            put(arrays, tree[name])

    def _changing(self) -> Iterator[tuple[str, Any]]:
        yield "state", arrays_of(self.state)
        yield "room", arrays_of(self._room)
        yield "contacts", {"records": self.contacts}
        yield "loads", {"gone": self.bodies.gone, "fast": self._fast}
