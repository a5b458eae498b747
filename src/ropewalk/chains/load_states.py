"""What bodies are and do at an instant: their contacts, their places, their energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.bodies import AWAY, FLYING, INSIDE, LOCATED, MOVING_WITH, WAITING, Bodies
from ropewalk.mechanics.chain import Array, ChainState
from ropewalk.mechanics.moving_contact import link_of
from ropewalk.mechanics.multibody_system import FIRM
from ropewalk.results.frame import IN_AIR, MOVES, OFF_LINE, STICKS
from ropewalk.solve.start import PreparedRun, onward
from ropewalk.solve.vehicle_statics import potential_of


@dataclass(frozen=True)
class StrandPoints:
    """Nodes and wheels of a strand, sorted along it."""

    X: Array  # (point,) m
    r: Array  # (axis, point) m
    v: Array  # (axis, point) m/s, of the points themselves
    U: Array  # (point,) m/s, d X / dt
    wheel: Array  # (point,) wheel that stands there, or -1


def points_of(setting: PreparedRun, state: ChainState, bodies: Bodies, s: int, v: Array, U: Array) -> StrandPoints:
    """Collect the points of strand s; v (axis, node) and U (node,) are those of its nodes."""
    dim = state.r.shape[0]
    first, last = int(setting.strands.first[s]), int(setting.strands.first[s] + setting.strands.links[s])
    X, r = state.X[first : last + 1], state.r[:, first : last + 1]
    v, U = v[:, first : last + 1].copy(), U[first : last + 1].copy()
    wheel = np.full(X.size, -1)
    inside = []
    for k, record in enumerate(bodies.wheels):
        if setting.loads.strand[k] != s:
            continue
        if record["phase"] == LOCATED:
            node = int(record["at"]) - first
            wheel[node], U[node], v[:, node] = k, state.speed[k], record["v"][:dim]
        elif record["phase"] == INSIDE:
            inside.append(k)
    if not inside:
        return StrandPoints(X, r, v, U, wheel)
    inside.sort(key=lambda k: state.xi[k])
    at = np.searchsorted(X, state.xi[inside])
    return StrandPoints(
        np.insert(X, at, state.xi[inside]),
        np.insert(r, at, bodies.wheels["r"][inside, :dim].T, axis=1),
        np.insert(v, at, bodies.wheels["v"][inside, :dim].T, axis=1),
        np.insert(U, at, state.speed[inside]),
        np.insert(wheel, at, inside),
    )


def contact_state(state: ChainState, bodies: Bodies, k: int) -> float:
    """In which state the contact of wheel k is."""
    phase = bodies.wheels[k]["phase"]
    if phase in (AWAY, WAITING) or (phase == MOVING_WITH and state.moving_load[k] <= -2):
        return OFF_LINE
    if phase == FLYING:
        return IN_AIR
    if phase == MOVING_WITH and not np.any(bodies.wheels[k]["on_line"]) and _is_buffered(bodies, k):
        return IN_AIR
    return MOVES if state.speed[k] != 0.0 else STICKS


def _is_buffered(bodies: Bodies, k: int) -> bool:
    return bool((bodies.buffers["wheel"] == k).any())


def located_nodes(setting: PreparedRun, state: ChainState, bodies: Bodies, r: Array, w: Array) -> None:
    """Put the particles that wheels carry to their own places, in r and w (axis, node)."""
    dim = r.shape[0]
    for k, record in enumerate(bodies.wheels):
        if record["phase"] != LOCATED:
            continue
        s, b = int(setting.loads.strand[k]), int(record["at"])
        h = float(setting.strands.h[s])
        home = (b - int(setting.strands.first[s])) * h
        near = slice(b - 1, b + 2)
        for a in range(dim):
            r[a, b] = np.interp(home, state.X[near], state.r[a, near])
        w[:, b] = record["store"][:dim] / (setting.strands.rho[s] * h)


def displayed_bodies(setting: PreparedRun, r: Array, bodies: Bodies) -> tuple[Array, Array]:
    """Positions and velocities of all bodies beside the contacts, (body, axis) each; nodes are at r (axis, node)."""
    assert setting.multibody_system is not None
    dim = r.shape[0]
    place, speed = (
        np.empty((len(setting.multibody_system.displayed), dim)),
        np.empty((len(setting.multibody_system.displayed), dim)),
    )
    for i, body in enumerate(setting.multibody_system.displayed):
        ahead = body.ahead * onward(setting, r, int(setting.loads.strand[body.wheel]))
        for a, d in enumerate(body.coordinates):
            record = bodies.wheels[body.wheel]
            place[i, a] = bodies.coordinates["q"][d] if d >= 0 else record["r"][a] + ahead[a]
            speed[i, a] = bodies.coordinates["v"][d] if d >= 0 else record["v"][a]
    return place, speed


def load_energies(setting: PreparedRun, bodies: Bodies) -> dict[str, float]:
    """Kinetic and potential energy of all loads, J."""
    dim, wheels = len(setting.axes), bodies.wheels
    mass, v = wheels["mass"][:, :dim], wheels["v"][:, :dim]
    kinetic = 0.5 * float((mass * v * v).sum())
    for i, vehicle in enumerate(bodies.vehicles):
        n, count, first = int(vehicle["coordinates"]), int(vehicle["wheels"]), int(vehicle["first"])
        size, locations = n + count, (bodies.wheel[i, :count], bodies.axis[i, :count])
        rate = np.concatenate((bodies.coordinates["v"][first : first + n], v[locations]))
        rate[np.diag(bodies.M[i])[:size] == FIRM] = 0.0  # what only its owner moves
        kinetic += 0.5 * float(rate @ bodies.M[i, :size, :size] @ rate)
    potential = potential_of(bodies, setting.strands.gravity)
    return {"load_kinetic": kinetic, "load_potential": potential}


def light_wheels(setting: PreparedRun, state: ChainState, bodies: Bodies, places: Array) -> None:
    """Note places and velocities of the wheels that ride as forces do; `places` are (wheel, axis)."""
    dim = state.r.shape[0]
    for k, record in enumerate(bodies.wheels):
        b, U = int(state.moving_load[k]), float(state.speed[k])
        if record["phase"] != MOVING_WITH or not np.isfinite(places[k]).all():
            continue
        record["r"][:dim] = places[k]
        near = slice(b - 1, b + 2) if b >= 0 else slice(0, 0)
        if b < 0:
            i = int(link_of(setting.strands, setting.loads, state, k))
            near = slice(i, i + 2)
        X = state.X[near]
        slope = (state.r[:, near][:, -1] - state.r[:, near][:, 0]) / (X[-1] - X[0])
        w = state.w[:, b] if b >= 0 else np.array([np.interp(state.xi[k], X, row) for row in state.w[:, near]])
        record["v"][:dim] = w + U * slope
