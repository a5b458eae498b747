"""Boarding: how bodies stand on their lines when a motion begins."""

from __future__ import annotations

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.bodies import AWAY, CARRIED, FREE, MOVING_WITH, PARKED, WAITING, Bodies
from ropewalk.mechanics.chain import HORIZONTAL, MATERIAL, OFF, Array, ChainState
from ropewalk.mechanics.law import tangents
from ropewalk.mechanics.moving_contact import contact_point, force_at, location_of, speed_at
from ropewalk.mechanics.moving_mass import land, on_straight, sort
from ropewalk.mechanics.multibody_system import MOST_CAPACITY, hung
from ropewalk.solve.coupled_equilibrium import settle_together
from ropewalk.solve.start import PreparedRun, onward
from ropewalk.solve.vehicle_statics import coordinates_at_rest, resting_forces

# A wheel leaves a support when it is as far away as it goes in this part of the time that waves take for a link. With
# half of it, a heavy mass near the speed of transverse waves gains energy (docs/notes/moving-mass.md).
STEPS_OF_CAPACITY = 1.0


def place_loads(setting: PreparedRun, state: ChainState, with_loads: bool = False) -> Bodies | None:
    """Let all bodies take their places, at rest within themselves and moving with their wheels.

    Args:
        setting, state: the model and its state, every load in the location of a force; the state is changed.
        with_loads: let lines and loads rest together.

    Returns:
        The bodies, None if there are none.

    Raises:
        RopewalkError: a wheel on a contact stiffness has no mass, or there is no rest.
    """
    if setting.multibody_system is None:
        if with_loads:
            settle_together(setting, state, None)
        return None
    for v, vehicle in enumerate(setting.multibody_system.bodies.vehicles):
        own, first = int(vehicle["coordinates"]), int(vehicle["first"])
        for buffer in setting.multibody_system.bodies.buffers:
            i = int(buffer["coordinate"]) - first
            if 0 <= i < own and setting.multibody_system.bodies.M[v, i, i] <= 0.0:
                name = setting.wheels[int(buffer["wheel"])].name
                wrong = "has no mass to move on its contact_stiffness; give it wheel_mass (of a vehicle: mass)"
                raise RopewalkError(f"load {name}: the wheel {wrong}, for example a tenth of the load it carries")
    bodies, loads, strands = setting.multibody_system.bodies.copy(), setting.loads, setting.strands
    dim = state.r.shape[0]
    landing: list[int] = []
    for k, wheel in enumerate(setting.wheels):
        record, s = bodies.wheels[k], int(loads.strand[k])
        first, n, h = int(strands.first[s]), int(strands.links[s]), float(strands.h[s])
        V = wheel.free.speed if wheel.free is not None else speed_at(loads, k, 0.0)
        if not wheel.given:
            _put_back(setting, state, k)
            state.moving_load[k], record["phase"] = OFF, AWAY
            continue
        if state.xi[k] < 0.0:
            record["phase"], state.moving_load[k], state.speed[k] = WAITING, CARRIED, V
            record["r"][:dim] = state.r[:, first]
            ahead = onward(setting, state.r, s)
            if loads.measure[k] == MATERIAL:  # the ground counts as stretched as the line that follows
                ahead *= float(np.linalg.norm(state.r[:, first + 1] - state.r[:, first])) / h
            record["r"][:dim] += state.xi[k] * ahead
            record["v"][:dim] = V * ahead
            continue
        place = np.zeros(dim)
        contact_point(strands, loads, state, k, place)
        i = int(location_of(state.X, state.xi[k], h, first, first + n))
        b = int(state.moving_load[k])
        near = slice(b - 1, b + 2) if b >= 0 else slice(i, i + 2)
        d = np.diff(state.r[:, near], axis=1)
        stretch = float(np.mean(np.sqrt((d * d).sum(axis=0)) / np.diff(state.X[near])))
        state.speed[k] = V if loads.measure[k] == MATERIAL and wheel.free is None else V / stretch
        if loads.measure[k] == HORIZONTAL and wheel.free is None:
            state.speed[k] = V / ((d[0].sum()) / float(state.X[near][-1] - state.X[near][0]))
        slope = (d / np.diff(state.X[near])).mean(axis=1)
        w = np.array([np.interp(state.xi[k], state.X[near], row) for row in state.w[:, near]])
        record["r"][:dim], record["v"][:dim] = place, w + state.speed[k] * slope
        if record["heavy"]:
            _put_back(setting, state, k)
            state.moving_load[k] = CARRIED
            length = n * h
            # In a step, which waves take for a link, the piece between wheel and support must not grow manifold.
            stiffness = float(tangents(strands.law[s], np.array([0.0, abs(stretch - 1.0) + 1e-9])).max())
            waves = float(np.sqrt(stiffness / strands.rho[s]))
            clearance = float(
                np.clip(STEPS_OF_CAPACITY * abs(state.speed[k]) / waves * h, record["clearance"], MOST_CAPACITY * h)
            )
            record["clearance"] = clearance
            moved = min(max(state.xi[k], clearance), length - clearance) if record["travel"] == FREE else state.xi[k]
            away, state.xi[k] = moved != state.xi[k], moved
            record["phase"], record["at"] = PARKED, int(location_of(state.X, state.xi[k], h, first, first + n))
            if away:
                on_straight(strands, state, bodies, k)
            if min(state.xi[k], length - state.xi[k]) >= clearance * (1.0 - 1e-9):
                landing.append(k)
            else:
                on_straight(strands, state, bodies, k)
        else:
            record["phase"] = MOVING_WITH
        record["ahead"] = record["v"]
    bodies.wheels["on_line"][:, :dim] = _pressing(setting) * _on_particles(setting, bodies)[:, :dim]
    # After all velocities have been looked up: a wheel that takes a node gives it its own. The nearest wheel takes it.
    for k in sorted(landing, key=lambda k: _to_node(setting, float(state.xi[k]), int(loads.strand[k]))):
        land(strands, loads, state, bodies, k)
    sort(loads, state, bodies)
    if with_loads and not len(bodies.tethers):  # what hangs on a tether, people among it, begins as it is put there
        settle_together(setting, state, bodies)
    _rest_on_wheels(setting, state, bodies)
    return bodies


def _to_node(setting: PreparedRun, xi: float, s: int) -> float:
    """Distance from a place on strand s to the nearest node, m."""
    place = xi / float(setting.strands.h[s])
    return abs(place - round(place)) * float(setting.strands.h[s])


def _put_back(setting: PreparedRun, state: ChainState, k: int) -> None:
    """Put the node that rides with load k at rest back to its own place."""
    b = int(state.moving_load[k])
    if b < 0:
        return
    s = int(setting.loads.strand[k])
    home = float((b - setting.strands.first[s]) * setting.strands.h[s])
    for values in (state.r, state.w):
        for row in values:
            row[b] = np.interp(home, state.X[b - 1 : b + 2], row[b - 1 : b + 2])
    state.X[b] = home


def _rest_on_wheels(setting: PreparedRun, state: ChainState, bodies: Bodies) -> None:
    """Let the coordinates of all vehicles stand where they rest on their wheels, and move with these."""
    dim = state.r.shape[0]
    for v, vehicle in enumerate(bodies.vehicles):
        n, first = int(vehicle["coordinates"]), int(vehicle["first"])
        locations = list(zip(bodies.wheel[v], bodies.axis[v], strict=True))[: int(vehicle["wheels"])]
        places = np.array([bodies.wheels["r"][k, a] for k, a in locations])
        speeds = np.array([bodies.wheels["v"][k, a] for k, a in locations])
        own = slice(first, first + n)
        if any(first <= int(t["first"]) < first + n for t in bodies.tethers):
            continue
        bodies.coordinates["q"][own] = coordinates_at_rest(bodies, v, places, bodies.wheels["r"][:, dim - 1])
        level = bodies.load[v].copy()
        bodies.load[v] = 0.0
        bodies.coordinates["v"][own] = coordinates_at_rest(bodies, v, speeds, bodies.wheels["v"][:, dim - 1])
        bodies.load[v] = level
        bodies.coordinates["ahead"][own] = bodies.coordinates["v"][own]
    _hang(setting, bodies, dim)


def _pressing(setting: PreparedRun) -> Array:
    """Forces with which all loads at rest press on their lines, until a kick has found them, (wheel, axis) N."""
    loads, resting = setting.loads, resting_forces(setting.loading).T
    given = [[force_at(loads, k, 0.0, a) for a in range(resting.shape[1])] for k in range(resting.shape[0])]
    return np.asarray(resting + np.array(given).reshape(resting.shape))


def _on_particles(setting: PreparedRun, bodies: Bodies) -> Array:
    """The part of the force on a light wheel that is set down which its particle takes, (wheel, axis)."""
    part, strands = np.ones_like(bodies.wheels["mass"]), setting.strands
    light = bodies.wheels["phase"] == MOVING_WITH
    m = (strands.rho * strands.h)[setting.loads.strand][:, None]
    part[light] = (m / (m + bodies.wheels["mass"]))[light]
    return part


def _hang(setting: PreparedRun, bodies: Bodies, dim: int) -> None:
    """Let payloads hang from their trolleys as declared."""
    for tether in bodies.tethers:
        k, first = int(tether["wheel"]), int(tether["first"])
        own = slice(first, first + dim)
        payload = setting.payloads.get(setting.wheels[k].load)
        if payload is None:
            continue
        below = hung(payload, float(tether["stiffness"]), -float(setting.strands.gravity[-1]), setting.axes)
        bodies.coordinates["q"][own] = bodies.wheels["r"][k, :dim] + below
        bodies.coordinates["v"][own] = bodies.coordinates["ahead"][own] = bodies.wheels["v"][k, :dim]
