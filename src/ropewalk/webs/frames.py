"""From a state of a web to a frame of the result: tensions, contacts, reactions, energy."""

from __future__ import annotations

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.errors import RopewalkError
from ropewalk.mechanics import law
from ropewalk.model.scenario import Scenario
from ropewalk.results.audit import Audit, energies
from ropewalk.results.frame import MOVES, Account, Contacts, Frame, Layout
from ropewalk.webs.contacts import neighbours
from ropewalk.webs.fabric import tensions_of
from ropewalk.webs.lengths import doubt_slack, laid_at_rest
from ropewalk.webs.potential import Potential
from ropewalk.webs.pull import resistance
from ropewalk.webs.seats import held_place
from ropewalk.webs.web import (
    CONTACTS,
    DAMPED,
    LOADS,
    MASS,
    OFF,
    RUBBED,
    SUPPORTS,
    Array,
    State,
)

_WORKS = {
    "line_damping": DAMPED, "contact_dissipation": CONTACTS, "friction": RUBBED, "load_work": LOADS,
    "support_work": SUPPORTS,
}  # fmt: skip


class FrameBuilder:
    """A web laid out, and what builds frames of it; the energy at the first one of a motion is the audit's origin.

    Args:
        scenario: what is computed.
        account: filled in.
        until: how long the histories of the loads are needed, s.
        path: leading dimension of the result.

    Raises:
        RopewalkError: the web cannot be laid out, or has no rest.
    """

    def __init__(self, scenario: Scenario, account: Account, until: float, path: str = "time") -> None:
        self.scenario, self.account = scenario, account
        self.laid, self.rest = laid_at_rest(scenario, until)
        account.warnings += self.laid.remarks
        self.web = self.laid.web
        self._refuse_beyond()
        self.axes = [0, 2] if self.laid.plane else [0, 1, 2]
        strands, names = self.laid.strands, [sheet.name for sheet in self.laid.sheets]
        vertices = self.laid.vertex
        self.shown = np.concatenate([np.zeros(0, dtype=np.int64), *(s.node for s in strands), *vertices])
        place = np.cumsum([0, *(s.node.size for s in strands), *(v.size for v in vertices)])[len(strands) :]
        nan = [np.full(v.size, np.nan) for v in vertices]
        middles = [0.5 * (s.station[1:] + s.station[:-1]) for s in strands]
        cells = [
            tuple(int(i) for i in row)
            for sheet, first in zip(self.laid.sheets, place, strict=False)
            for row in sheet.surface.triangle + first
        ]
        self.links = np.concatenate(
            [np.zeros(0, dtype=np.int64), *(s.first + np.arange(s.node.size - 1) for s in strands)]
        )
        self.layout = Layout(
            axes=("x", "z") if self.laid.plane else ("x", "y", "z"),
            node_line=(
                *(s.name for s in strands for _ in s.node),
                *(name for name, v in zip(names, vertices, strict=True) for _ in v),
            ),
            node_xi=np.concatenate([np.zeros(0), *(s.station for s in strands), *nan]),
            link_line=tuple(s.name for s in strands for _ in s.node[1:]),
            link_xi=np.concatenate([np.zeros(0), *middles]),
            contact_load=tuple(t.name for t in self.laid.travellers),
            support=(*(end.name for end in self.laid.ends), *(f"{name}.edge" for name in names)),
            cell=tuple(cells),  # type: ignore[arg-type]
            cell_net=tuple(sheet.name for sheet in self.laid.sheets for _ in sheet.surface.triangle),
            path=path,
            weight=self._weight(),
        )
        self._audit = Audit()

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

    def get_state(self) -> Tree:
        """The origin of the audit."""
        return self._audit.get_state()

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._audit.set_state(tree)

    def build(self, state: State, interval: float = 0.0, *, still: float | None = None) -> Frame:
        """The frame of a state.

        Args:
            interval: since the last frame, s: contact forces of masses are the mean over it.
            still: of a rest, its load path in m.
        """
        web, seats, axes = self.web, self.web.seats, self.axes
        n, r = web.nodes, state.r
        contacts = seats.kind.size
        on = seats.kind != OFF
        weight = seats.load + np.where((seats.kind == MASS)[:, None], seats.mass[:, None] * web.gravity, 0.0)
        if still is not None:
            force = weight
        elif interval > 0.0:
            force = np.where((seats.kind == MASS)[:, None], state.pushed / interval, seats.load)
        else:
            gap = np.nan_to_num(state.q) - self._held(r)
            force = np.where((seats.kind == MASS)[:, None], seats.grip[:, None] * gap, seats.load)
        strain, tension = self.strain(r)
        seen = Contacts(contacts, len(axes))
        for k in np.flatnonzero(on):
            for side, p in enumerate(neighbours(web, int(k))):
                seen.tension[k, side] = self._tension(p, r)
        seen.position[on], seen.force[on], seen.hold[on] = r[n:][on][:, axes], force[on][:, axes], 0.0
        seen.xi[on], seen.speed[on], seen.state[on] = seats.xi[on], seats.speed[on], MOVES
        return Frame(
            path=float(state.t[0]) if still is None else still,
            position=r[self.shown][:, axes], velocity=state.v[self.shown][:, axes],
            tension=tension, strain=strain,
            **seen.told(), body_position=np.zeros((0, len(axes))), body_velocity=np.zeros((0, len(axes))),
            reaction=self._reactions(state)[:, axes],
            energy=self._energy(state, still=still is not None),
            cell_tension=tensions_of(web.cells, web.cells.area.size, r) if self.layout.cell else None,
        )  # fmt: skip

    def _held(self, r: Array) -> Array:
        """Places that masses hold on to, (contact, 3) m; of other contacts zero."""
        seats = self.web.seats
        masses = np.flatnonzero((seats.kind == MASS) & (seats.divided >= 0))
        out = np.zeros((seats.kind.size, 3))
        out[masses] = [[held_place(self.web, r, k, a) for a in range(3)] for k in masses] or np.zeros((0, 3))
        return out

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

    def _reactions(self, state: State) -> Array:
        """Forces of supports on lines and of edges on nets, (support, 3) N: spring, damper, rail and mass together."""
        web, held = self.web, self.web.held
        ahead = web.sheaves.ahead.copy()
        pull = Potential(web, rubs=True).pull(state.r)
        web.sheaves.ahead[:] = ahead  # looking at a sheave must not make its line slip
        pull += resistance(web, float(state.t[0]), state.r, state.v)
        force = np.zeros_like(pull)
        force[held.fixed] = -pull[held.fixed]
        for n, along in zip(held.rail, held.along, strict=True):
            force[n] = (pull[n] @ along) * along - pull[n]
        sprung = np.zeros_like(pull)
        springs = zip(held.spring, held.place, held.stiffness, held.damping, held.rate, strict=True)
        for n, place, K, C, rate in springs:
            sprung[n] += K @ (place - state.r[n]) - C @ (state.v[n] - rate)
        force += sprung
        ends = []
        for end in self.laid.ends:  # what is left of the support's own forces once its mass has had its share
            n, mass = end.node, web.body.mass[end.node]
            own = end.mass * web.gravity + end.force
            gained = (pull[n] + force[n] - sprung[n]) * (end.mass / mass if end.mass else 0.0)
            ends.append(force[n] + own - gained)
        edges = [force[vertex].sum(axis=0) for vertex in self.laid.vertex]
        return np.array([*ends, *edges]).reshape(-1, 3)

    def _energy(self, state: State, *, still: bool) -> Array:
        web, seats, n = self.web, self.web.seats, self.web.nodes
        # Of those that have left, too: as they were then.
        masses = np.flatnonzero((seats.wanted == MASS) & np.isfinite(state.q + state.u).all(axis=1))
        m, q = seats.mass[masses], state.q[masses]
        stored = {
            "kinetic": 0.5 * float((web.body.mass[:n, None] * state.v[:n] ** 2).sum()),
            "elastic": Potential(web).stored(state.r),
            "gravitational": -float((web.body.force[:n] * state.r[:n]).sum()),
        }
        potential = -float((m[:, None] * web.gravity * q).sum())
        if still:
            return energies(**stored, load_potential=potential)
        gap = (q - self._held(state.r)[masses]) * (seats.kind[masses, None] == MASS)
        potential += 0.5 * float((seats.grip[masses, None] * gap**2).sum())
        moving = 0.5 * float((m[:, None] * state.u[masses] ** 2).sum())
        works = {form: float(state.work[at]) for form, at in _WORKS.items()}
        return self._audit.of(**stored, load_kinetic=moving, load_potential=potential, **works)
