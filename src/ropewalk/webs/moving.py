"""A motion of webs, from output to output."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate

import numpy as np

from ropewalk.checkpoint import Arrays, Tree, arrays_of, copied, put
from ropewalk.errors import RopewalkError
from ropewalk.mechanics.portions import portions
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Account, Frame, Layout
from ropewalk.results.running import Ending
from ropewalk.webs import motion
from ropewalk.webs.beginning import begin_elsewhere
from ropewalk.webs.frames import FrameBuilder
from ropewalk.webs.laying import Laid
from ropewalk.webs.motion import Room, advance, look_at_contacts
from ropewalk.webs.rest import settle, stand
from ropewalk.webs.seats import held_place, hold_on
from ropewalk.webs.stability import SAFETY, largest_step
from ropewalk.webs.web import MASS, WORKS, Array, State

_ENDS = {
    motion.DIVERGED: ("diverged", "positions stopped being numbers; take a smaller run.step"),
    motion.NOT_FOUND: (
        "diverged",
        "no place was found where the forces on a contact balance; take a smaller run.step, more elements, or "
        "a little damping",
    ),
    motion.AT_SHEAVE: ("travel ended", "a load has come to a sheave, which it cannot pass; let it turn back before"),
    motion.AT_END: (
        "travel ended",
        "a load has come to an end of its line or path; write at_end: leave or stay, or end the run before",
    ),
    motion.LINE_OUT: ("line ran out", "a line has run over a sheave up to its end, or to another sheave or a load"),
}
# Energy lost with the pieces beside a mass that leaves, over what moves, from which on it is told.
_PARTING = 0.02
# Part of the speed of transverse waves from which on masses on lines are doubtful: 1.7 % of the deflection at 0.8.
_FAST = 0.8
# What a step costs for a node, over what it costs on a line alone.
_EFFORT = 10


class Motion:
    """Joined lines, nets and membranes as the engine of a motion, in their first state.

    Args:
        scenario: what is computed.
        account: filled in.
        times: output instants in s, from 0.
        past: whether it will go on from a state: then it need not begin.

    Raises:
        RopewalkError: the web cannot be laid out, has no rest, or cannot begin to move.
    """

    turns = ()
    looks_ahead = False

    def __init__(self, scenario: Scenario, account: Account, times: Array, *, past: bool = False) -> None:
        asked = scenario.run
        assert isinstance(asked, Dynamic)
        self._builder, self.account, self.times = FrameBuilder(scenario, account, asked.until), account, times
        web = self._builder.web
        self.state = self._first(with_loads=asked.start.with_loads)
        if asked.start.kind != "rest" and not past:
            begin_elsewhere(self.laid, self.state, asked.start, self._builder.shown, self._builder.axes)
        self._room, stable = Room.of(web), largest_step(web)
        self._step = stable if asked.step is None else asked.step
        limit = stable / SAFETY
        if self._step > limit:
            account.warnings.append(
                f"the step of {self._step:.3g} s is larger than {limit:.3g} s, up to which the motion is stable for "
                "certain; write a smaller run.step, or leave it out"
            )
        account.method, account.step = "explicit", self._step
        account.reason = (
            "Verlet's method for all nodes; the pieces of links beside contacts by the implicit midpoint rule"
        )
        account.warnings += self._remarks()
        self._builder.note_slack(self.state.r)
        self._interval, self._broken = 0.0, False  # since the frame before, s; whether it has come to an end
        if not past and not look_at_contacts(web, self.state, self._room):
            raise RopewalkError(f"the run cannot begin: {_ENDS[motion.NOT_FOUND][1]}")
        if not past:
            self.state.work[:] = 0.0

    @property
    def laid(self) -> Laid:
        """The web that moves."""
        return self._builder.laid

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the frames."""
        return self._builder.layout

    def get_state(self) -> Tree:
        """All that changes."""
        changing = {name: copied(arrays) for name, arrays in self._changing().items()}
        return {"frames": self._builder.get_state(), **changing}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._builder.set_state(tree["frames"])
        for name, arrays in self._changing().items():
            put(arrays, tree[name])

    def _changing(self) -> dict[str, Arrays]:
        """Arrays that change: slots are made anew, and lines slip over sheaves, in those of the web itself."""
        web = self._builder.web
        return {
            "state": arrays_of(self.state), "room": arrays_of(self._room), "sheaves": arrays_of(web.sheaves),
            "links": arrays_of(web.links, "one", "other", "rest", "law", "on"),
            "seats": arrays_of(
                web.seats, "kind", "xi", "load", "speed", "cell", "divided", "last", "before", "weight", "beyond",
                "hold",
            ),
            "course": arrays_of(web.course, "at_end"), "held": arrays_of(web.held, "place", "rate"),
        }  # fmt: skip

    def advance(self, i: int) -> Ending | None:
        """Go on to output instant i."""
        if not i:
            return None
        web, state, t = self._builder.web, self.state, float(self.times[i])
        self._interval = t - float(self.times[i - 1])
        state.pushed[:] = 0.0
        steps = int(np.ceil(self._interval / self._step))
        for done in accumulate(portions(steps, web.nodes, _EFFORT)):
            end = t if done == steps else t - self._interval * (1.0 - done / steps)
            status = advance(web, state, self._room, end, float(self._step))
            if status != motion.RUNNING:
                break
        if status == motion.RUNNING and not np.isfinite(state.r[self._builder.shown]).all():
            status = motion.DIVERGED
        self.account.steps += steps
        self._note_parting()
        if status != motion.RUNNING:
            self._broken = True
            outcome, advice = _ENDS[status]
            return Ending(outcome, f"stopped at t = {state.t[0]:.6g} s: {advice}")
        look_at_contacts(web, state, self._room)
        return None

    def frame(self) -> Frame | None:
        """The present frame; none of a motion that has come to an end."""
        return None if self._broken else self._builder.build(self.state, self._interval)

    def remark(self, frame: Frame) -> None:
        """Nothing: what there is to say is said before and between frames."""

    def _note_parting(self) -> None:
        """Tell of masses that have torn at an end of their line when they left it, each of them once."""
        laid, state = self.laid, self.state
        moving = 0.5 * float((laid.web.body.mass[:, None] * state.v**2).sum())
        moving += 0.5 * float((laid.web.seats.mass[:, None] * np.nan_to_num(state.u) ** 2).sum())
        for k in np.flatnonzero(state.parting > _PARTING * moving):
            t = laid.travellers[k]
            self.account.warnings.append(
                f"load {t.name} left {t.on} and took {state.parting[k]:.3g} J of the pieces beside it, which are lost: "
                "the last piece before an end is stretched the more, the finer the mesh is; what follows depends on "
                "it: let it leave earlier (travel.margin), or end the run before"
            )
        state.parting[:] = 0.0

    def _remarks(self) -> Iterator[str]:
        """Masses on lines for which the coupling gets worse; where it is known to fail a doubt (docs/notes/webs.md)."""
        web, seats, course = self._builder.web, self._builder.web.seats, self._builder.web.course
        strain, tension = self._builder.strain(self._builder.rest)
        for k in np.flatnonzero(seats.wanted == MASS):
            name, mine = self._builder.laid.travellers[k].name, self._builder.links[:, None] - seats.first[k]
            mine = ((mine >= 0) & (mine < seats.pieces[k])).ravel()
            waves = np.sqrt(np.maximum(tension[mine] / (seats.density[k] * (1.0 + strain[mine])), 0.0))
            wave, mean = float(waves.min()), float(waves.mean())
            knots = slice(course.first[k], course.first[k] + course.knots[k])
            fastest = float(np.abs(course.speed[knots]).max())
            if fastest > mean:
                self.account.doubt(
                    f"load {name}: a mass at {fastest:.4g} m/s on a joined line whose waves have {mean:.4g} m/s",
                    "its contact force is wrong once it is faster than the waves of its line",
                    f"loads.{name}.travel.speed", "let it go slower, or compute that line by itself, without joints",
                )  # fmt: skip
            elif fastest > _FAST * wave:
                yield (
                    f"load {name}: a mass at {fastest:.4g} m/s on a joined line whose slowest waves have "
                    f"{wave:.4g} m/s: its deflection misses 2 % and its contact force more; write more elements"
                )
            link = float(seats.density[k] * web.links.rest[self._builder.links[mine]].max())
            if seats.mass[k] < link:
                yield (
                    f"load {name}: {seats.mass[k]:.3g} kg is less than a link of its line ({link:.3g} kg) and may ring "
                    "until the run diverges; write more elements, or a force instead"
                )

    def _first(self, *, with_loads: bool) -> State:
        web, r = self._builder.web, self._builder.rest.copy()
        contacts = web.seats.kind.size
        q, u = np.full((contacts, 3), np.nan), np.full((contacts, 3), np.nan)
        if with_loads:
            stand(web, r, 0.0)
            r = settle(web, r)
            on = web.seats.kind == MASS
            weight = web.seats.mass[on, None] * web.gravity + web.seats.load[on]
            for k in np.flatnonzero(on):
                hold_on(web, k)
                q[k] = [held_place(web, r, k, a) for a in range(3)]
            q[on] += weight / web.seats.grip[on, None]
            web.seats.last[:] = -1
        return State(
            np.zeros(1), r, np.zeros_like(r), q, u, np.zeros(WORKS), np.zeros((contacts, 3)), np.zeros(contacts)
        )
