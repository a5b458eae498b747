"""Names and coordinates of the results of wires."""

from __future__ import annotations

import numpy as np

from ropewalk.results.frame import Layout
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.task import Task


def axes_of(task: Task) -> list[int]:
    """The axes that results have, as numbers of x, y and z."""
    return [0, 1, 2] if task.space else [0, 2]


def layout_of(
    task: Task, mesh: Mesh, *, path: str = "time", foreign: tuple[str, ...] = (), sample: tuple[float, ...] = ()
) -> Layout:
    """The layout of a result.

    Args:
        path: its leading dimension.
        foreign: loads that are models of somebody else's.
        sample: s, of samples, from an output instant back.
    """
    plan, strands = task.plan, mesh.strands
    node_line, link_line, node_xi, link_xi = [], [], [], []
    for wire, n, h in zip(plan.wires, strands.links, strands.h, strict=True):
        node_line += [wire.name] * (int(n) + 1)
        link_line += [wire.name] * int(n)
        node_xi.append(np.arange(n + 1) * h)
        link_xi.append((np.arange(n) + 0.5) * h)
    ends = [f"{wire.name}.{end}" for wire in plan.wires for end in ("start", "end")]
    # Beds carry some of the weight: how much is unknown.
    bedded = any(wire.bed for wire in plan.wires)
    return Layout(
        axes=tuple("xyz"[a] for a in axes_of(task)), node_line=tuple(node_line), node_xi=np.concatenate(node_xi),
        link_line=tuple(link_line), link_xi=np.concatenate(link_xi), contact_load=task.contacts,
        support=(*ends, *(hold.name for hold in plan.holds)), body=tuple(body.name for body in task.shown),
        tie=tuple(tie.name for tie in plan.ties), tie_station=tuple(tie.spot.station for tie in plan.ties),
        foreign=foreign, watched=tuple(plan.watched),
        watched_station=tuple(spot.station for spot in plan.watched.values()), sample=sample, path=path,
        weight=float("nan") if bedded else float(plan.gravity * mesh.mass.sum()),
    )  # fmt: skip
