"""What is to doubt of large motion: loads on steep lines, and compression that no bending stiffness bears."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ropewalk.checkpoint import Tree
from ropewalk.results.frame import OFF_LINE, Frame, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.wires.contact_location import location_at
from ropewalk.wires.mesh import Mesh, MovingLoads
from ropewalk.wires.spline import WIDTH, points
from ropewalk.wires.task import WireTask

_SLIGHT = 1e-9  # strain that is none
_STEEP = 0.2  # slope from which on loads miss their inertia along the line: 2 % of deflections, 10 % of contact forces
_SLIGHTLY_LESS = 1.0 - 1e-9  # of a slope that is looked at twice, with sums in another order


class LineDoubts:
    """What is to doubt, each contact and each wire once.

    Args:
        task, mesh, moving_loads: what is computed.
        run_info: the account.
    """

    def __init__(self, task: WireTask, mesh: Mesh, moving_loads: MovingLoads, run_info: RunInfo) -> None:
        self._task, self._mesh, self._moving_loads, self._run_info = task, mesh, moving_loads, run_info
        self._steep, self._pushed = set[str](), set[str]()

    def get_state(self) -> Tree:
        """What has been doubted."""
        return {"steep": sorted(self._steep), "pushed": sorted(self._pushed)}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._steep, self._pushed = set(tree["steep"]), set(tree["pushed"])

    def look(self, frames: Frames, count: int) -> None:
        """Look at the first frames."""
        for i in np.flatnonzero(self._are_odd(frames)[:count]).tolist():
            self._remark(frames[i])

    def _are_odd(self, frames: Frames) -> NDArray[np.bool_]:
        """Of which frames something may be to be remarked that has not been, (instant,)."""
        strands, odd, last = (
            self._mesh.strands,
            np.zeros(len(frames), dtype=np.bool_),
            np.cumsum(self._mesh.strands.links),
        )
        x, z = frames.of["position"][..., 0], frames.of["position"][..., -1]
        for k in np.flatnonzero(self._moving_loads.size[self._moving_loads.owner] > 0):
            on, a = frames.of["contact_state"][:, k] != OFF_LINE, int(self._moving_loads.wire[k])
            at = np.flatnonzero(on & (self._task.contacts[k] not in self._steep))
            links = frames.of["contact_xi"][at, k] / float(strands.h[a])
            first, weight = points(links, np.full(at.size, strands.links[a]), np.tile(strands.level[a], (at.size, 1)))
            near = strands.first[a] + first[:, None] + np.arange(WIDTH)
            rise, run = ((np.take_along_axis(own[at], near, axis=1) * weight[:, 1]).sum(axis=1) for own in (z, x))
            odd[at] |= np.abs(rise) > _SLIGHTLY_LESS * _STEEP * np.abs(run)
        for a, wire in enumerate(self._task.plan.wires):
            pushed = -frames.of["tension"][:, last[a] - strands.links[a] : last[a]].min(axis=1)
            odd |= (pushed > self._borne(a)[1]) & (wire.name not in self._pushed)
        return odd

    def _borne(self, a: int) -> tuple[float, float]:
        """What wire a bears between two nodes, pushed together, N; and that which is more than nothing."""
        wire = self._task.plan.wires[a]
        borne = np.pi**2 * wire.bending_stiffness / float(self._mesh.strands.h[a]) ** 2
        return float(borne), float(max(borne, _SLIGHT * wire.axial_stiffness))

    def _remark(self, frame: Frame) -> None:
        """Say what is to doubt of a frame, what has not been said before."""
        strands, last, z, x = self._mesh.strands, 0, frame.position[:, -1], frame.position[:, 0]
        for k in np.flatnonzero(
            (frame.contact_state != OFF_LINE) & (self._moving_loads.size[self._moving_loads.owner] > 0)
        ):
            a = int(self._moving_loads.wire[k])
            location = location_at(self._mesh, a, float(frame.contact_xi[k]) / float(strands.h[a]))
            slope = abs(float(location.slope(z))) / max(abs(float(location.slope(x))), 1e-300)
            name, wire = self._task.contacts[k], self._task.plan.wires[a].name
            if slope > _STEEP and name not in self._steep:
                self._steep.add(name)
                key, remedy = f"lines.{wire}.bending_stiffness", "leave it out, if the line is a rope"
                if section := wire.rpartition(".")[0]:
                    key, remedy = f"overhead_lines.{section}.contact_wire.tension", "give more of it, or a lighter load"
                self._run_info.doubt(
                    f"load {name} moves where {wire} has a slope of {slope:.2g}, at t = {frame.path:.4g} s",
                    "on such lines the longitudinal inertia of a load is neglected",
                    key,
                    remedy,
                )
        for a, wire_ in enumerate(self._task.plan.wires):
            first, last = last, last + int(strands.links[a])
            pushed, (borne, most) = -float(frame.tension[first:last].min()), self._borne(a)
            if pushed > most and wire_.name not in self._pushed:
                self._pushed.add(wire_.name)
                self._run_info.doubt(
                    f"{wire_.name} is compressed by {pushed:.4g} N at t = {frame.path:.4g} s",
                    f"between two nodes it bears {borne:.4g} N and buckles beyond, into waves that no mesh resolves",
                    f"lines.{wire_.name}.bending_stiffness",
                    "leave it out and write law: {kind: tension_only}, or give more drag",
                )  # fmt: skip
