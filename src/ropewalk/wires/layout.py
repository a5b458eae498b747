"""Names and coordinates of the results of wires."""

from __future__ import annotations

import numpy as np

from ropewalk.results.frame import Layout, uniform
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array, Integers, Plan
from ropewalk.wires.rest import without_supports
from ropewalk.wires.task import Task


def axes_of(task: Task) -> list[int]:
    """The axes that results have, as numbers of x, y and z."""
    return [0, 1, 2] if task.space else [0, 2]


def supports_of(plan: Plan) -> tuple[tuple[str, ...], Integers]:
    """Names of all that holds wires, ends first, and which of them each hold is."""
    ends = [f"{wire.name}.{end}" for wire in plan.wires for end in ("start", "end")]
    names = tuple(dict.fromkeys([*ends, *(hold.name for hold in plan.holds)]))
    return names, np.array([names.index(hold.name) for hold in plan.holds], dtype=np.int64)


def reactions(mesh: Mesh, bare: Array, hold: Array) -> Array:
    """Forces of all that holds wires on them, (support, 3) N.

    A mass at the end of a wire is part of the support there: what accelerates and carries it is no reaction.

    Args:
        bare: (3, node) N on all nodes but for what holds do.
        hold: (hold, 3) N.
    """
    names, which = supports_of(mesh.plan)
    out = np.zeros((len(names), 3))
    np.add.at(out, which, hold)
    ends = np.stack([mesh.strands.first, mesh.strands.first + mesh.strands.links], axis=1).ravel()
    mass, weight = mesh.mass[ends] - mesh.own[ends], np.zeros((ends.size, 3))
    weight[:, 2] = -mesh.plan.gravity * mass
    given, held = bare[:, ends].T, out[: ends.size]
    inertia = (mass / mesh.mass[ends])[:, None] * (given + held)
    out[: ends.size] = np.where(mesh.fixed[:, ends].T, weight - given, held + weight - inertia)
    return out


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
    # Beds carry some of the weight: how much is unknown.
    bedded = any(wire.bed for wire in plan.wires)
    return Layout(
        axes=tuple("xyz"[a] for a in axes_of(task)), contact_load=task.contacts,
        **uniform([wire.name for wire in plan.wires], strands.links, strands.h),
        support=supports_of(plan)[0], body=tuple(body.name for body in task.shown),
        tie=tuple(tie.name for tie in plan.ties), tie_station=tuple(tie.spot.station for tie in plan.ties),
        foreign=foreign, watched=tuple(plan.watched),
        watched_station=tuple(spot.station for spot in plan.watched.values()), sample=sample, path=path,
        weight=float("nan") if bedded else float(plan.gravity * without_supports(mesh).sum()),
    )  # fmt: skip
