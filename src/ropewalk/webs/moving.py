"""A web in motion: its frames one after the other."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.checkpoint import Arrays, Tree, arrays_of, copied, put
from ropewalk.errors import RopewalkError
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Account, Frame, Layout
from ropewalk.webs import motion
from ropewalk.webs.beginning import begin_elsewhere
from ropewalk.webs.frames import Run
from ropewalk.webs.laying import Laid
from ropewalk.webs.motion import Room, advance, look_at_contacts
from ropewalk.webs.stability import SAFETY, SAFETY_OF_NETS, largest_step
from ropewalk.webs.web import Array

_ENDS = {
    motion.DIVERGED: ("diverged", "positions stopped being numbers; take a smaller run.step"),
    motion.NOT_FOUND: (
        "diverged",
        "no place was found where the forces on a contact balance; take a smaller run.step, more elements or cells, or "
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


class Motion:
    """A motion of joined lines, nets and membranes under way: its layout, and its frames one after the other.

    Args:
        scenario: what is computed.
        account: filled in.
        times: output instants in s, from 0.
        past: what `get_state` gave, to go on from there.

    Raises:
        RopewalkError: the web cannot be laid out, has no rest, or cannot begin to move.
    """

    def __init__(self, scenario: Scenario, account: Account, times: Array, past: Tree | None = None) -> None:
        asked = scenario.run
        assert isinstance(asked, Dynamic)
        self._run, self.times = Run(scenario, account, asked.until), times
        web = self._run.web
        self.state = self._run._first(with_loads=asked.start.with_loads)
        if asked.start.kind != "rest" and past is None:
            begin_elsewhere(self._run.laid, self.state, asked.start, self._run._shown, self._run._axes)
        self._room, stable = Room.of(web), largest_step(web)
        self._step = stable if asked.step is None else asked.step
        limit = stable / (SAFETY_OF_NETS if web.own_cells else SAFETY)
        if self._step > limit:
            account.warnings.append(
                f"the step of {self._step:.3g} s is larger than {limit:.3g} s, up to which the motion is stable for "
                "certain; write a smaller run.step, or leave it out"
            )
        account.method, account.step = "explicit", self._step
        account.reason = (
            "Verlet's method for all nodes; the pieces of links and cells beside contacts by the implicit midpoint rule"
        )
        account.warnings += self._run._remarks()
        self._run._note_slack(self.state.r)
        self._taken = 0
        if past is not None:
            self._set_state(past)
        elif not look_at_contacts(web, self.state, self._room):
            raise RopewalkError(f"the run cannot begin: {_ENDS[motion.NOT_FOUND][1]}")
        else:
            self.state.work[:] = 0.0

    @property
    def laid(self) -> Laid:
        """The web that moves."""
        return self._run.laid

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the frames."""
        return self._run.layout

    @property
    def total(self) -> int:
        """How many frames it will have."""
        return int(self.times.size)

    def get_state(self) -> Tree:
        """All that changes."""
        return {
            "frames": self._taken, "account": self._run.account.get_state(), "first": self._run._start_energy,
            **{name: copied(arrays) for name, arrays in self._changing().items()},
        }  # fmt: skip

    def _set_state(self, tree: Tree) -> None:
        self._taken, self._run._start_energy = tree["frames"], tree["first"]
        self._run.account.set_state(tree["account"])
        for name, arrays in self._changing().items():
            put(arrays, tree[name])

    def _changing(self) -> dict[str, Arrays]:
        """Arrays that change: slots are made anew, and lines slip over sheaves, in those of the web itself."""
        web = self._run.web
        return {
            "state": arrays_of(self.state), "room": arrays_of(self._room), "sheaves": arrays_of(web.sheaves),
            "links": arrays_of(web.links, "one", "other", "rest", "law", "on"),
            "cells": arrays_of(web.cells, "node", "inverse", "area", "fabric", "on"),
            "seats": arrays_of(
                web.seats, "kind", "xi", "load", "speed", "cell", "divided", "last", "before", "weight", "beyond",
                "hold", "plan",
            ),
            "course": arrays_of(web.course, "at_end"), "held": arrays_of(web.held, "place", "rate"),
        }  # fmt: skip

    def frames(self) -> Iterator[Frame]:
        """The frames that are still to come."""
        for i in range(self._taken, self.times.size):
            before = float(self.times[i - 1]) if i else 0.0
            if i and not self._move(before, float(self.times[i])):
                return
            frame = self._run._frame(self.state, float(self.times[i]) - before if i else 0.0)
            self._taken = i + 1
            yield frame

    def _move(self, before: float, t: float) -> bool:
        """Go on to a time in s; False if that fails."""
        web, state, account = self._run.web, self.state, self._run.account
        state.pushed[:] = 0.0
        status = advance(web, state, self._room, t, float(self._step))
        if status == motion.RUNNING and not np.isfinite(state.r[self._run._shown]).all():
            status = motion.DIVERGED
        account.steps += int(np.ceil((t - before) / self._step))
        self._note_parting()
        if status != motion.RUNNING:
            account.outcome, advice = _ENDS[status]
            account.advice = f"stopped at t = {state.t[0]:.6g} s: {advice}"
            return False
        look_at_contacts(web, state, self._room)
        return True

    def _note_parting(self) -> None:
        """Tell of masses that have torn at an end of their line when they left it, each of them once."""
        run, state = self._run, self.state
        moving = 0.5 * float((run.web.body.mass[:, None] * state.v**2).sum())
        moving += 0.5 * float((run.web.seats.mass[:, None] * np.nan_to_num(state.u) ** 2).sum())
        for k in np.flatnonzero(state.parting > _PARTING * moving):
            t = run.laid.travellers[k]
            run.account.warnings.append(
                f"load {t.name} left {t.on} and took {state.parting[k]:.3g} J of the pieces beside it, which are lost: "
                "the last piece before an end is stretched the more, the finer the mesh is; what follows depends on "
                "it: let it leave earlier (travel.margin), or end the run before"
            )
        state.parting[:] = 0.0
