"""What explicit large motion of wires needs of them for steps of a length."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array
from ropewalk.wires.rest import rows, slowed_ends, without_supports


class Threads(NamedTuple):
    """What an inner step of a given length needs of the wires."""

    bending: Array  # (wire,) N m^2, corrected
    gain: Array  # (axis, node) m/N, displacement by a force during a step, less where axial inertia is scaled up
    kick: Array  # (axis, node) m/N, in the first inner step for a force of a whole step
    keep: Array  # (wire,) part of the last displacement that is kept, 1 without drag
    keep_end: Array  # (end,) the same of its last nodes, whose supports have a mass without drag
    fall: Array  # (axis, node) m during a step, by weight and constant forces; what the correction bends at rest, back
    pull: Array  # (node,) N/m, axial stiffness over unstrained length of the link behind the node
    rest: Array  # (node,) 1/m^2, one over the square of that length
    mass: Array  # (axis, node) kg, of which drag takes its part
    damped: bool  # whether any wire is


def threads_of(mesh: Mesh, position: Array, rest: Array, step: float, inner: int, inertia: float = 1.0) -> Threads:
    """Prepare inner steps.

    Args:
        mesh: the wires.
        position: (axis, node) m at rest, which keeps the real bending stiffness.
        rest: (node,) m, unstrained length of the link behind each node (those of last nodes are not used).
        step: s, of an inner step.
        inner: number of them in a step.
        inertia: factor on the mass for motion along x.
    """
    s, plan = mesh.strands, mesh.plan
    T = np.maximum(s.tension, 0.0)
    bending = s.stiffness + T * (s.h**2 - T / s.rho * step**2) / 12.0
    ends, axes = np.stack([s.first, s.first + s.links], axis=1).ravel(), components(position)
    slow, slow_end = 1.0 + 0.5 * step * s.drag, slowed_ends(mesh, step)
    slowed = np.repeat(slow, s.links + 1)
    slowed[ends] = slow_end
    gain = step**2 / mesh.mass / slowed / np.array([inertia, *np.ones(len(axes) - 1)])[:, None]
    gain[(mesh.fixed & ~mesh.driven)[axes]] = 0.0
    EA = np.repeat([wire.axial_stiffness for wire in plan.wires], s.links + 1)
    steady = correction(mesh, position, bending)
    steady[0] = 0.0  # only waves across are corrected
    steady[-1] -= plan.gravity * mesh.mass
    steady[1:-1] += mesh.sideways  # in space
    steady += (rows(mesh.holds.at, mesh.nodes).T @ mesh.holds.force).T[axes]
    return Threads(
        bending, gain, inner * gain, (2.0 - slow) / slow, (2.0 - slow_end) / slow_end, gain * steady,
        EA / rest, 1.0 / rest**2, np.outer([inertia, *np.ones(len(axes) - 1)], without_supports(mesh)),
        bool(s.drag.any() or s.retardation.any()),
    )  # fmt: skip


def correction(mesh: Mesh, position: Array, bending: Array) -> Array:
    """Forces that undo, in the shape of rest, what the correction of the bending stiffness adds, (axis, node) N."""
    s, out = mesh.strands, np.zeros_like(position)
    for a, n in enumerate(s.links):
        bent = np.diff(position[:, mesh.of(a)], 2, axis=1) * (bending[a] - s.stiffness[a]) / s.h[a] ** 3
        own = out[:, mesh.of(a)]
        own[:, :-2] += bent
        own[:, 1:-1] -= 2.0 * bent
        own[:, 2:] += bent
        for side, (end, i, d) in enumerate(((s.first[a], 0, 1), (s.first[a] + n, n, -1))):
            if s.clamped[a, side]:
                straight = mesh.straight()[:, end + d] - mesh.straight()[:, end]
                turn = position[:, end + d] - position[:, end] - straight[components(position)]
                turn *= 2.0 * (bending[a] - s.stiffness[a]) / s.h[a] ** 3
                own[:, i + d] += turn
                own[:, i] -= turn
    return out


def components(position: Array) -> list[int]:
    """Which of x, y and z positions (axis, node) have."""
    return [0, 1, 2] if position.shape[0] == 3 else [0, 2]
