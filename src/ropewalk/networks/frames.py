"""From a network at rest to a frame of the result: tensions, contacts, reactions, energy."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics import law
from ropewalk.model.scenario import Scenario
from ropewalk.networks.contact_location import neighbours
from ropewalk.networks.internal_forces import blown
from ropewalk.networks.lengths import doubt_slack, laid_at_rest
from ropewalk.networks.network import MASS, OFF, Array
from ropewalk.networks.potential import NetworkPotential
from ropewalk.results.audit import energies
from ropewalk.results.frame import MOVES, Contacts, Frame, Layout, RunInfo


class NetworkFrameBuilder:
    """A network of lines laid out, and what builds frames of it.

    Args:
        scenario: what is computed.
        run_info: filled in.
        until: how long the histories of the loads are needed, s.

    Raises:
        RopewalkError: the network cannot be laid out, or has no rest.
    """

    def __init__(self, scenario: Scenario, run_info: RunInfo, until: float) -> None:
        self.scenario, self.run_info = scenario, run_info
        self.laid, self.rest = laid_at_rest(scenario, until)
        run_info.warnings += self.laid.diagnostics
        self.network = self.laid.network
        self._refuse_beyond()
        self.axes = [0, 2] if self.laid.plane else [0, 1, 2]
        strands = self.laid.strands
        self.displayed = np.concatenate([s.node for s in strands])
        self.links = np.concatenate([s.first + np.arange(s.node.size - 1) for s in strands])
        self.layout = Layout(
            axes=("x", "z") if self.laid.plane else ("x", "y", "z"),
            node_line=tuple(s.name for s in strands for _ in s.node),
            node_xi=np.concatenate([s.station for s in strands]),
            link_line=tuple(s.name for s in strands for _ in s.node[1:]),
            link_xi=np.concatenate([0.5 * (s.station[1:] + s.station[:-1]) for s in strands]),
            contact_load=tuple(t.name for t in self.laid.moving_loads),
            support=tuple(end.name for end in self.laid.ends),
            path="load_path",
            weight=self._weight(),
        )

    def _weight(self) -> float:
        """What supports and sheaves carry at rest, N; unknown where the wind bears some of it."""
        if self.scenario.wind is not None and not self.scenario.wind.is_calm:
            return float("nan")
        own = sum(float((end.mass * self.network.gravity + end.force)[2]) for end in self.laid.ends)
        return own - float(self.network.body.force[: self.network.nodes, 2].sum())

    def _refuse_beyond(self) -> None:
        """Refuse loads that would begin beyond the end of their line; the distance of its ends stands for the far one.

        Raises:
            RopewalkError: there is such a load.
        """
        for moving_load, length in zip(self.laid.moving_loads, self.network.course.length, strict=True):
            start, line = float(moving_load.knots[1, 0]), self.scenario.lines.get(moving_load.on)
            if start > length * (1.0 + 1e-9) and not (line is not None and np.isclose(start, line.distance, 1e-9)):
                raise RopewalkError(
                    f"load {moving_load.name} would begin {start:g} m along {moving_load.on}, which ends at "
                    f"{length:g} m; "
                    "change its from"
                )

    def note_slack(self, r: Array) -> None:
        """Doubt shapes of lines that nothing pulls at."""
        doubt_slack(self.scenario, self.run_info, self.layout.link_line, self.strain(r)[1])

    def build(self, r: Array, path: float, t: float) -> Frame:
        """The frame of a rest.

        Args:
            r: (node, 3) m, places of nodes and contacts.
            path: along the load path, m.
            t: s, in the histories.
        """
        network, locations, axes = self.network, self.network.locations, self.axes
        contacts, on = locations.kind.size, locations.kind != OFF
        force = locations.load + np.where(
            (locations.kind == MASS)[:, None], locations.mass[:, None] * network.gravity, 0.0
        )
        strain, tension = self.strain(r)
        seen = Contacts(contacts, len(axes))
        for k in np.flatnonzero(on):
            for side, p in enumerate(neighbours(network, int(k))):
                seen.tension[k, side] = self._tension(p, r)
        place = r[network.nodes :][on][:, axes]
        seen.position[on], seen.force[on], seen.hold[on] = place, force[on][:, axes], 0.0
        seen.xi[on], seen.speed[on], seen.state[on] = locations.xi[on], locations.speed[on], MOVES
        position = r[self.displayed][:, axes]
        return Frame(
            path=path, position=position, velocity=np.zeros_like(position), tension=tension, strain=strain,
            **seen.fields(), body_position=np.zeros((0, len(axes))), body_velocity=np.zeros((0, len(axes))),
            reaction=self._reactions(r, t)[:, axes], energy=self._energy(r),
        )  # fmt: skip

    def _tension(self, p: int, r: Array) -> float:
        links = self.network.links
        length = float(np.linalg.norm(r[links.other[p]] - r[links.one[p]]))
        return float(law.tension(links.laws[links.law[p]], length / links.rest[p] - 1.0))

    def strain(self, r: Array) -> tuple[Array, Array]:
        """Strain and tension of all links shown; where a contact or a sheave divides one, in the mean of both parts."""
        network, links = self.network, self.network.links
        p = self.links
        length = np.linalg.norm(r[links.other[p]] - r[links.one[p]], axis=1)
        extra = np.zeros(network.own_links)
        for e, b in zip(network.sheaves.link.tolist(), network.sheaves.node.tolist(), strict=True):
            both = np.linalg.norm(r[b] - r[links.one[e]]) + np.linalg.norm(r[links.other[e]] - r[b])
            extra[e] = both - np.linalg.norm(r[links.other[e]] - r[links.one[e]])
        for e in set(network.locations.split_link[network.locations.kind != OFF].tolist()):
            segments = 0.0
            for k in np.flatnonzero(network.locations.split_link == e):
                behind, ahead = neighbours(network, int(k))
                segments += float(np.linalg.norm(r[links.other[behind]] - r[links.one[behind]]))
                if links.other[ahead] < network.nodes:
                    segments += float(np.linalg.norm(r[links.other[ahead]] - r[links.one[ahead]]))
            extra[e] = segments - np.linalg.norm(r[links.other[e]] - r[links.one[e]])
        strain = (length + extra[p]) / links.rest[p] - 1.0
        tension = np.zeros_like(strain)
        for row, packed in enumerate(links.laws):
            own = links.law[p] == row
            tension[own] = law.tensions(packed, strain[own])
        return strain, tension

    def _reactions(self, r: Array, t: float) -> Array:
        """Forces of supports on lines, (support, 3) N: springs and rails together."""
        network, restrained = self.network, self.network.restrained
        ahead = network.sheaves.ahead.copy()
        pull = NetworkPotential(network, rubs=True).pull(r) + blown(network, t, r)
        network.sheaves.ahead[:] = ahead  # looking at a sheave must not make its line slip
        force = np.zeros_like(pull)
        force[restrained.fixed] = -pull[restrained.fixed]
        for n, along in zip(restrained.rail, restrained.along, strict=True):
            force[n] = (pull[n] @ along) * along - pull[n]
        for n, place, K in zip(restrained.spring, restrained.place, restrained.stiffness, strict=True):
            force[n] += K @ (place - r[n])
        ends = [force[end.node] + end.mass * network.gravity + end.force for end in self.laid.ends]
        return np.array(ends).reshape(-1, 3)

    def _energy(self, r: Array) -> Array:
        network, locations, n = self.network, self.network.locations, self.network.nodes
        masses = np.flatnonzero(locations.kind == MASS)
        return energies(
            elastic=NetworkPotential(network).stored(r), gravitational=-float((network.body.force[:n] * r[:n]).sum()),
            load_potential=-float((locations.mass[masses, None] * network.gravity * r[n + masses]).sum()),
        )  # fmt: skip
