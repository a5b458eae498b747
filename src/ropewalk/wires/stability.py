"""The largest step with which explicit motion of wires is stable."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.wires.bending import HIGHEST
from ropewalk.wires.mesh import Mesh, MovingLoads
from ropewalk.wires.plan import Array
from ropewalk.wires.rest import spring, ties_springs

SAFETY, SAFETY_ALONG = 0.9, 0.97  # nothing but the wire itself counts along it
_MOST = 2e8  # nodes times steps between two samples, about a second of computing, in which no signal is heard
_SQUARES = 0.72  # the largest sum of squares of the weights of a spline


def largest_step(mesh: Mesh, moving_loads: MovingLoads, *, along: bool = False) -> float:
    """A step in s that is stable for motion across, from bounds of all frequencies, which add up at worst.

    Args:
        mesh: the wires.
        moving_loads: what travels.
        along: whether ties along the line are seen to by the steps of motion along it.
    """
    s = mesh.strands
    T, m = np.maximum(s.tension, 0.0), s.rho * s.h
    bending = s.stiffness + T * s.h**2 / 12.0
    across = (4.0 * T / s.h + np.where(s.fourth, HIGHEST, 16.0) * bending / s.h**3 + s.bed * s.h) / m
    lightest = float(m.min())
    total = across + _attached(mesh, lightest, along) + _at_ends(mesh) + _loaded(mesh, moving_loads, lightest)
    # omega^2 (dt^2 + 2 beta dt) + 2 c / m dt < 4 for each wire
    late = s.retardation + _damped(mesh, moving_loads, lightest) / total
    steps = 4.0 / total / (np.sqrt(4.0 / total + late**2) + late)  # the difference of both rounds to 0
    return SAFETY * float(min(steps.min(), _alone(moving_loads)))


def largest_step_along(mesh: Mesh, inertia: float = 1.0) -> float:
    """A step in s that is stable for motion along wires; `inertia` is a factor on the mass for that."""
    s = mesh.strands
    EA = np.array([wire.axial_stiffness for wire in mesh.plan.wires])
    square = (4.0 * EA / s.h + 16.0 * s.stiffness / s.h**3) / (s.rho * s.h) / inertia + _at_ends(mesh) / inertia
    square += _lengthwise(mesh) / inertia
    return SAFETY_ALONG * float(2.0 / np.sqrt(square.max()))


def refuse_tiny_steps(mesh: Mesh, steps: int, sample: float) -> None:
    """Refuse a motion whose stable time step is so short that it would never end.

    Args:
        mesh: the wires.
        steps: in a sample.
        sample: interval of samples, s.

    Raises:
        RopewalkError: there are too many steps in a sample.
    """
    if steps * mesh.nodes <= _MOST:
        return
    EA = np.array([wire.axial_stiffness for wire in mesh.plan.wires])
    name = mesh.plan.wires[int((EA / mesh.strands.rho).argmax())].name
    raise RopewalkError(
        f"{name}: the motion needs time steps of {sample / steps:.2g} s and would never end; check the units of "
        "axial_stiffness, bending_stiffness and mass, and of springs and dampers of supports, droppers and loads"
    )


def _attached(mesh: Mesh, lightest: float, along: bool) -> float:
    """Bound of what ties and holds add to the square of a frequency; two neighbours may share nodes."""
    inside = (mesh.holds.node < 0)[:, None] & ~np.isinf(mesh.holds.stiffness)
    restrained = np.where(inside, spring(mesh.holds.stiffness, mesh.holds.at.local[:, None]), 0.0)
    stiff = [0.0, *ties_springs(mesh)[0][~(mesh.ties.lengthwise & along)], *restrained.ravel()]
    return 2.0 * _SQUARES * float(max(stiff)) / lightest


def _lengthwise(mesh: Mesh) -> float:
    """The same of ties along the line, which join wires end to end: what the masses at both ends add up to."""
    found = [0.0]
    for e in np.flatnonzero(mesh.ties.lengthwise):
        light = 0.0
        for end in (mesh.ties.one, mesh.ties.other):
            near = slice(int(end.base[e]), int(end.base[e]) + end.weight.shape[1])
            light += float((end.weight[e] ** 2 / mesh.mass[near]).sum())
        found.append(float(mesh.ties.stiffness[e]) * light)
    return max(found)


def _at_ends(mesh: Mesh) -> float:
    """The same of holds at ends, where half a link and a support move."""
    at = mesh.holds.node >= 0
    stiff = np.where(np.isinf(mesh.holds.stiffness[at]), 0.0, mesh.holds.stiffness[at]).max(axis=1, initial=0.0)
    return float((stiff / mesh.mass[mesh.holds.node[at]]).max(initial=0.0))


def _damped(mesh: Mesh, moving_loads: MovingLoads, lightest: float) -> float:
    """Bound of the rates of dampers that act with the velocity of half a step ago, 1/s; those of holds do not."""
    tied = 2.0 * _SQUARES * float(max([0.0, *mesh.ties.damping])) / lightest
    found = [0.0]
    for k, i in enumerate(moving_loads.owner):
        light = _light(moving_loads, k, i)
        found.append(moving_loads.damper[k] * (_SQUARES / lightest + light))
    return tied + float(sum(sorted(found)[-2:]))


def _light(moving_loads: MovingLoads, k: int, i: int) -> float:
    """One over the mass that contact k of moving load i feels, at most, wherever it is across the load, 1/kg."""
    n = moving_loads.size[i]
    if not n:
        return 0.0
    out = moving_loads.widest[k] * moving_loads.turn[k, :n]
    rows = moving_loads.row[k, :n] + np.array([-out, out])
    return float((rows * np.linalg.solve(moving_loads.mass[i, :n, :n], rows.T).T).sum(axis=1).max())


def _loaded(mesh: Mesh, moving_loads: MovingLoads, lightest: float) -> float:
    g = np.linspace(0.0, 0.25, 26)  # f (1 - f) at all parts of a link
    c = mesh.strands.local[:, :, None]
    local = (c[:, 0] + g * g * (c[:, 1] + g * c[:, 2])).min(axis=1)
    found = [0.0]
    for k, i in enumerate(moving_loads.owner):
        if moving_loads.spring[k] == 0.0 or np.isinf(moving_loads.spring[k]):
            continue
        stiff = 1.0 / (1.0 / moving_loads.spring[k] + max(local[moving_loads.wire[k]], -0.5 / moving_loads.spring[k]))
        light = _light(moving_loads, k, i)
        found.append(stiff * (_SQUARES / lightest + light))
    return float(sum(sorted(found)[-2:]))


def _alone(moving_loads: MovingLoads) -> float:
    """The same for moving loads on rigid ground."""
    steps = [np.inf]
    for i, n in enumerate(moving_loads.size):
        if n == 0:
            continue
        for aside in (-moving_loads.widest, moving_loads.widest):
            K: Array = moving_loads.stiffness[i, :n, :n].copy()
            rows = moving_loads.rows(aside)[:, :n]
            for k in np.flatnonzero(moving_loads.owner == i):
                if np.isfinite(moving_loads.spring[k]):
                    K += moving_loads.spring[k] * np.outer(rows[k], rows[k])
            square = np.abs(np.linalg.eigvals(np.linalg.solve(moving_loads.mass[i, :n, :n], K))).max()
            steps.append(2.0 / np.sqrt(square) if square > 0.0 else np.inf)
    return float(min(steps))
