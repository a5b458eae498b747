"""From a web at rest to a frame of the result: tensions, contacts, reactions, energy."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics import law
from ropewalk.model.scenario import Scenario
from ropewalk.results.audit import energies
from ropewalk.results.frame import MOVES, Account, Contacts, Frame, Layout
from ropewalk.webs.lengths import doubt_slack, laid_at_rest
from ropewalk.webs.potential import Potential
from ropewalk.webs.pull import blown
from ropewalk.webs.seats import neighbours
from ropewalk.webs.web import MASS, OFF, Array


class FrameBuilder:
    """A web of lines laid out, and what builds frames of it.

    Args:
        scenario: what is computed.
        account: filled in.
        until: how long the histories of the loads are needed, s.

    Raises:
        RopewalkError: the web cannot be laid out, or has no rest.
    """

    def __init__(self, scenario: Scenario, account: Account, until: float) -> None:
        self.scenario, self.account = scenario, account
        self.laid, self.rest = laid_at_rest(scenario, until)
        account.warnings += self.laid.remarks
        self.web = self.laid.web
        self._refuse_beyond()
        self.axes = [0, 2] if self.laid.plane else [0, 1, 2]
        strands = self.laid.strands
        self.shown = np.concatenate([s.node for s in strands])
        self.links = np.concatenate([s.first + np.arange(s.node.size - 1) for s in strands])
        self.layout = Layout(
            axes=("x", "z") if self.laid.plane else ("x", "y", "z"),
            node_line=tuple(s.name for s in strands for _ in s.node),
            node_xi=np.concatenate([s.station for s in strands]),
            link_line=tuple(s.name for s in strands for _ in s.node[1:]),
            link_xi=np.concatenate([0.5 * (s.station[1:] + s.station[:-1]) for s in strands]),
            contact_load=tuple(t.name for t in self.laid.travellers),
            support=tuple(end.name for end in self.laid.ends),
            path="load_path",
            weight=self._weight(),
        )

    def _weight(self) -> float:
        """What supports and sheaves carry at rest, N; unknown where the wind bears some of it."""
        if self.scenario.wind is not None and not self.scenario.wind.is_calm:
            return float("nan")
        own = sum(float((end.mass * self.web.gravity + end.force)[2]) for end in self.laid.ends)
        return own - float(self.web.body.force[: self.web.nodes, 2].sum())

    def _refuse_beyond(self) -> None:
        """Refuse loads that would begin beyond the end of their line; the distance of its ends stands for the far one.

        Raises:
            RopewalkError: there is such a load.
        """
        for traveller, length in zip(self.laid.travellers, self.web.course.length, strict=True):
            start, line = float(traveller.knots[1, 0]), self.scenario.lines.get(traveller.on)
            if start > length * (1.0 + 1e-9) and not (line is not None and np.isclose(start, line.distance, 1e-9)):
                raise RopewalkError(
                    f"load {traveller.name} would begin {start:g} m along {traveller.on}, which ends at {length:g} m; "
                    "change its from"
                )

    def note_slack(self, r: Array) -> None:
        """Doubt shapes of lines that nothing pulls at."""
        doubt_slack(self.scenario, self.account, self.layout.link_line, self.strain(r)[1])

    def build(self, r: Array, path: float, t: float) -> Frame:
        """The frame of a rest.

        Args:
            r: (node, 3) m, places of nodes and contacts.
            path: along the load path, m.
            t: s, in the histories.
        """
        web, seats, axes = self.web, self.web.seats, self.axes
        contacts, on = seats.kind.size, seats.kind != OFF
        force = seats.load + np.where((seats.kind == MASS)[:, None], seats.mass[:, None] * web.gravity, 0.0)
        strain, tension = self.strain(r)
        seen = Contacts(contacts, len(axes))
        for k in np.flatnonzero(on):
            for side, p in enumerate(neighbours(web, int(k))):
                seen.tension[k, side] = self._tension(p, r)
        place = r[web.nodes :][on][:, axes]
        seen.position[on], seen.force[on], seen.hold[on] = place, force[on][:, axes], 0.0
        seen.xi[on], seen.speed[on], seen.state[on] = seats.xi[on], seats.speed[on], MOVES
        position = r[self.shown][:, axes]
        return Frame(
            path=path, position=position, velocity=np.zeros_like(position), tension=tension, strain=strain,
            **seen.told(), body_position=np.zeros((0, len(axes))), body_velocity=np.zeros((0, len(axes))),
            reaction=self._reactions(r, t)[:, axes], energy=self._energy(r),
        )  # fmt: skip

    def _tension(self, p: int, r: Array) -> float:
        links = self.web.links
        length = float(np.linalg.norm(r[links.other[p]] - r[links.one[p]]))
        return float(law.tension(links.laws[links.law[p]], length / links.rest[p] - 1.0))

    def strain(self, r: Array) -> tuple[Array, Array]:
        """Strain and tension of all links shown; where a contact or a sheave divides one, in the mean of both parts."""
        web, links = self.web, self.web.links
        p = self.links
        length = np.linalg.norm(r[links.other[p]] - r[links.one[p]], axis=1)
        extra = np.zeros(web.own_links)
        for e, b in zip(web.sheaves.link.tolist(), web.sheaves.node.tolist(), strict=True):
            both = np.linalg.norm(r[b] - r[links.one[e]]) + np.linalg.norm(r[links.other[e]] - r[b])
            extra[e] = both - np.linalg.norm(r[links.other[e]] - r[links.one[e]])
        for e in set(web.seats.divided[web.seats.kind != OFF].tolist()):
            pieces = 0.0
            for k in np.flatnonzero(web.seats.divided == e):
                behind, ahead = neighbours(web, int(k))
                pieces += float(np.linalg.norm(r[links.other[behind]] - r[links.one[behind]]))
                if links.other[ahead] < web.nodes:
                    pieces += float(np.linalg.norm(r[links.other[ahead]] - r[links.one[ahead]]))
            extra[e] = pieces - np.linalg.norm(r[links.other[e]] - r[links.one[e]])
        strain = (length + extra[p]) / links.rest[p] - 1.0
        tension = np.zeros_like(strain)
        for row, packed in enumerate(links.laws):
            own = links.law[p] == row
            tension[own] = law.tensions(packed, strain[own])
        return strain, tension

    def _reactions(self, r: Array, t: float) -> Array:
        """Forces of supports on lines, (support, 3) N: springs and rails together."""
        web, held = self.web, self.web.held
        ahead = web.sheaves.ahead.copy()
        pull = Potential(web, rubs=True).pull(r) + blown(web, t, r)
        web.sheaves.ahead[:] = ahead  # looking at a sheave must not make its line slip
        force = np.zeros_like(pull)
        force[held.fixed] = -pull[held.fixed]
        for n, along in zip(held.rail, held.along, strict=True):
            force[n] = (pull[n] @ along) * along - pull[n]
        for n, place, K in zip(held.spring, held.place, held.stiffness, strict=True):
            force[n] += K @ (place - r[n])
        ends = [force[end.node] + end.mass * web.gravity + end.force for end in self.laid.ends]
        return np.array(ends).reshape(-1, 3)

    def _energy(self, r: Array) -> Array:
        web, seats, n = self.web, self.web.seats, self.web.nodes
        masses = np.flatnonzero(seats.kind == MASS)
        return energies(
            elastic=Potential(web).stored(r), gravitational=-float((web.body.force[:n] * r[:n]).sum()),
            load_potential=-float((seats.mass[masses, None] * web.gravity * r[n + masses]).sum()),
        )  # fmt: skip
