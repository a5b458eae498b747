"""Coupled equilibrium: lines, and the loads that stand on them, at rest together.

The chain is taken as it moves afterwards: heavy wheels are points of their own between the nodes, light loads press on
those nodes that they will move with, and frictionless contacts are held so that the tensions beside them agree. How a
vehicle shares its weight among its wheels depends on how high these stand, and that on the shares: both are found by
Newton's method, with the compliance of the lines and the stiffness of the vehicles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.bodies import CARRIED, FREE, GIVEN, INSIDE, LOCATED, PARKED, Bodies
from ropewalk.mechanics.chain import CAPSTAN, FRICTIONLESS, HORIZONTAL, MATERIAL, OFF, Array, ChainState, Integers
from ropewalk.mechanics.moving_contact import contact_point, force_at, link_of, part_of, speed_at
from ropewalk.mechanics.moving_mass import on_straight
from ropewalk.solve.equilibrium import at_rest
from ropewalk.solve.hold_forces import StrandContacts, StrandHoldForces
from ropewalk.solve.start import PreparedRun
from ropewalk.solve.vehicle_statics import agree, weights_of_wheels


@dataclass(frozen=True)
class _StrandPoints:
    """The points of one strand, in order."""

    X: Array  # (point,) m, material coordinates
    node: Integers  # (point,) node there, also one that a wheel carries; -1: none
    wheel: Integers  # (point,) heavy wheel there; -1: none
    weight: Array  # (axis, point) N, of the line
    pressing: tuple[tuple[int, int, float], ...]  # load, point that it presses on, and with which part of its force
    even: tuple[int, ...]  # points whose tensions are held equal


def settle_together(setting: PreparedRun, state: ChainState, bodies: Bodies | None) -> None:
    """Move lines, wheels and vehicles to where they rest together; `state` and `bodies` are changed.

    Args:
        setting, state: the model and its state, all loads at their nodes.
        bodies: on board already; None: there are none.

    Raises:
        EquilibriumError: there is no such state, or none was found.
    """
    dim, count = len(setting.axes), state.xi.size
    lines = [_points(setting, state, bodies, s) for s in range(len(setting.lines))]
    given = np.array([[force_at(setting.loads, k, 0.0, a) for k in range(count)] for a in range(dim)])
    given = given.reshape(dim, count)
    if bodies is not None:
        given += weights_of_wheels(bodies, setting.strands.gravity)

    def give_way(force: Array) -> Array:
        """Let all lines rest under forces (axis, wheel) in N of the vehicles; gives the places (axis, wheel) of all."""
        for s, points in enumerate(lines):
            _lay(setting, state, bodies, s, points, given + force)
        return _places(setting, state, bodies)

    if bodies is None:
        give_way(np.zeros((dim, count)))
        return
    force = agree(bodies, give_way, _places(setting, state, bodies))
    bodies.wheels["on_line"][:, :dim] = (given + force).T
    bodies.wheels["r"][:, :dim] = _places(setting, state, bodies).T
    for s, points in enumerate(lines):
        _let_travel(setting, state, bodies, s, points)


def _points(setting: PreparedRun, state: ChainState, bodies: Bodies | None, s: int) -> _StrandPoints:
    """The points of strand s: its nodes, and the heavy wheels that stand on it."""
    strands, loads = setting.strands, setting.loads
    first, n, h = int(strands.first[s]), int(strands.links[s]), float(strands.h[s])
    node, wheel, X = np.arange(first, first + n + 1), np.full(n + 1, -1), state.X[first : first + n + 1].copy()
    on = setting.on[s]
    for k in on:
        phase = int(bodies.wheels[k]["phase"]) if bodies is not None else GIVEN
        if bodies is not None and phase == LOCATED:
            wheel[int(bodies.wheels[k]["at"]) - first] = k
        elif bodies is not None and phase == INSIDE:
            node, wheel, X = np.append(node, -1), np.append(wheel, k), np.append(X, state.xi[k])
    order = np.argsort(X, kind="stable")
    X, node, wheel = X[order], node[order], wheel[order]
    place = {int(i): at for at, i in enumerate(node) if i >= 0}
    mass = np.where(node >= 0, strands.rho[s] * h, 0.0)
    for end, other in ((first, first + 1), (first + n, first + n - 1)):
        mass[place[end]] = 0.5 * strands.rho[s] * abs(state.X[end] - state.X[other])
    pressing: list[tuple[int, int, float]] = []
    for k in on:
        b = int(state.moving_load[k])
        if bodies is not None and b == CARRIED:
            pressing += [(int(k), int(at), 1.0) for at in np.flatnonzero(wheel == k)]
        elif b >= 0:  # its neighbours bear half the links that they really have
            pressing.append((int(k), place[b], 1.0))
            for side in (b - 1, b + 1):
                if first < side < first + n:
                    mass[place[side]] += 0.5 * strands.rho[s] * (abs(state.X[b] - state.X[side]) - h)
        elif b != OFF:
            i = int(link_of(strands, loads, state, k))
            part = float(part_of(state, k, i))
            pressing += [(int(k), place[i], 1.0 - part), (int(k), place[i + 1], part)]
        elif not setting.wheels[k].given and 0.0 <= state.xi[k] <= n * h:  # a foot, which is set down at t = 0
            i = min(int(state.xi[k] / h), n - 1)
            part = float(state.xi[k] / h - i)
            pressing += [(int(k), place[first + i], 1.0 - part), (int(k), place[first + i + 1], part)]
    even = tuple(at for k, at, _ in pressing if _is_even(setting, state, bodies, k))
    return _StrandPoints(X, node, wheel, strands.gravity[:, None] * mass, tuple(pressing), even)


def _is_even(setting: PreparedRun, state: ChainState, bodies: Bodies | None, k: int) -> bool:
    """Whether load k, which has a point of its own, is held so that the tensions beside it are equal."""
    if bodies is not None and state.moving_load[k] == CARRIED:
        return int(bodies.wheels[k]["travel"]) not in (GIVEN, FREE)
    return bool(state.moving_load[k] >= 0 and setting.loads.contact[k] == FRICTIONLESS)


def _lay(
    setting: PreparedRun, state: ChainState, bodies: Bodies | None, s: int, points: _StrandPoints, force: Array
) -> None:
    """Let strand s rest under the forces (axis, wheel) of all loads."""
    p, restrained, bare = setting.strands.law[s], setting.ends[s], setting.bare[s]
    f, ell = points.weight.copy(), np.diff(points.X)
    for k, at, part in points.pressing:
        f[:, at] += part * force[:, k]
    guess = bare.first_force if bare is not None else None
    if points.even:
        count = len(points.even)
        kind, nothing = np.full(count, FRICTIONLESS), np.zeros(count)
        even = np.array(points.even, dtype=np.int64)
        none = np.zeros((f.shape[0], count, 2))
        contacts = StrandContacts(even, kind, nothing, np.full(count, CAPSTAN), nothing, none)
        with_ends = f.copy()
        with_ends[:, [0, -1]] += restrained.force.T
        try:
            np.add.at(f[0], even, StrandHoldForces(p, ell, with_ends, restrained, contacts, guess).forces(nothing))
        except EquilibriumError as error:
            raise EquilibriumError(f"line {setting.lines[s]}: {error}") from None
    try:
        r = at_rest(p, ell, f, restrained, guess).position
    except EquilibriumError as error:
        raise EquilibriumError(f"line {setting.lines[s]}: {error}") from None
    is_node = points.node >= 0
    state.r[:, points.node[is_node]] = r[:, is_node]
    if bodies is None:
        return
    for at in np.flatnonzero(points.wheel >= 0).tolist():
        bodies.wheels["r"][points.wheel[at], : r.shape[0]] = r[:, at]
    for k in setting.on[s]:
        if int(bodies.wheels[k]["phase"]) == PARKED:
            on_straight(setting.strands, state, bodies, k)


def _places(setting: PreparedRun, state: ChainState, bodies: Bodies | None) -> Array:
    """Where all loads touch their lines, (axis, wheel) m."""
    dim, count = state.r.shape[0], state.xi.size
    place = np.zeros((dim, count)) if bodies is None else bodies.wheels["r"][:, :dim].T.copy()
    for k in range(count):
        if state.moving_load[k] > OFF:
            at = np.zeros(dim)
            contact_point(setting.strands, setting.loads, state, k, at)
            place[:, k] = at
    return place


def _let_travel(setting: PreparedRun, state: ChainState, bodies: Bodies, s: int, points: _StrandPoints) -> None:
    """Let the heavy wheels on strand s travel along it as they do at the beginning."""
    loads, dim = setting.loads, state.r.shape[0]
    for at in np.flatnonzero(points.wheel >= 0).tolist():
        k = int(points.wheel[at])
        record, free = bodies.wheels[k], setting.wheels[k].free
        V = free.speed if free is not None else float(speed_at(loads, k, 0.0))
        sides = [
            (record["r"][:dim] - _at(state, bodies, points, other)) / (points.X[at] - points.X[other])
            for other in (at - 1, at + 1)
        ]
        slope = 0.5 * (sides[0] + sides[1])
        U = V / float(np.mean([np.linalg.norm(side) for side in sides]))
        if free is None and loads.measure[k] == MATERIAL:
            U = V
        elif free is None and loads.measure[k] == HORIZONTAL:
            U = V / float(slope[0])
        state.speed[k] = U
        record["v"][:dim] = U * slope
        record["ahead"] = record["v"]
        if int(record["phase"]) == LOCATED:
            state.w[:, points.node[at]] = record["v"][:dim]


def _at(state: ChainState, bodies: Bodies, points: _StrandPoints, at: int) -> Array:
    """Position of a point, (axis,) m."""
    dim, k = state.r.shape[0], int(points.wheel[at])
    return np.asarray(state.r[:, points.node[at]] if k < 0 else bodies.wheels["r"][k, :dim])
