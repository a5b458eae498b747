"""Statics of vehicles: how they stand on their wheels, and what these press on their lines with."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.bodies import PULLS, PUSHES, Bodies
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.loading import Loading

# Forces of vehicles agree with the heights of their wheels to this part of the largest force: well above the rounding
# of rest shapes, far below any other error.
AGREE = 1e-9
MOST_STEPS = 50
# Part of the largest force by which each is changed to see how far the lines give way.
PROBE = 1e-3


def coordinates_at_rest(bodies: Bodies, v: int, places: Array, heights: Array) -> Array:
    """Coordinates of vehicle v at rest on its wheels.

    Args:
        bodies: all of them.
        v: which vehicle.
        places: (place,) m, of its wheels, in the order of its matrices.
        heights: (wheel,) m, of all wheels, for those on a contact stiffness.
    """
    n, first = int(bodies.vehicles[v]["coordinates"]), int(bodies.vehicles[v]["first"])
    size = n + places.size
    K, f = bodies.K[v, :n, :n].copy(), bodies.load[v, :n] - bodies.K[v, :n, n:size] @ places
    for buffer in bodies.buffers:
        i = int(buffer["coordinate"]) - first
        if 0 <= i < n:
            K[i, i] += buffer["stiffness"]
            f[i] += buffer["stiffness"] * heights[buffer["wheel"]]
    return np.asarray(np.linalg.lstsq(K, f, rcond=None)[0])


def forces_of_vehicles(bodies: Bodies, place: Array) -> Array:
    """Forces of all vehicles at rest on their wheels, (axis, wheel) N.

    Args:
        bodies: all of them.
        place: (axis, wheel) m, of the wheels.
    """
    dim, force = place.shape[0], np.zeros_like(place)
    for v, vehicle in enumerate(bodies.vehicles):
        n, count, first = int(vehicle["coordinates"]), int(vehicle["wheels"]), int(vehicle["first"])
        wheel, axis, own = bodies.wheel[v, :count], bodies.axis[v, :count], slice(n, n + count)
        q = coordinates_at_rest(bodies, v, place[axis, wheel], place[-1])
        pushed = bodies.load[v, own] - bodies.K[v, own, :n] @ q - bodies.K[v, own, own] @ place[axis, wheel]
        np.add.at(force, (axis, wheel), pushed)
        for buffer in bodies.buffers:
            i = int(buffer["coordinate"]) - first
            if 0 <= i < n:
                force[-1, buffer["wheel"]] += buffer["stiffness"] * (q[i] - place[-1, buffer["wheel"]])
        for tether in bodies.tethers:
            if tether["first"] == first:
                force[:, tether["wheel"]] += bodies.load[v, :dim]
                break  # a person begins on one leg
    return force


def weights_of_wheels(bodies: Bodies, gravity: Array) -> Array:
    """Weights of what follows the lines, (axis, wheel) N."""
    weight = np.zeros((gravity.size, bodies.wheels.size))
    weight[-1] = gravity[-1] * bodies.wheels["mass"][:, gravity.size - 1]
    return weight


def resting_forces(loading: Loading) -> Array:
    """Forces of all bodies at rest on lines on which all wheels are at one height, (axis, wheel) N."""
    level = np.zeros((len(loading.axes), len(loading.wheels)))
    if loading.multibody_system is None:
        return level
    bodies = loading.multibody_system.bodies
    return weights_of_wheels(bodies, loading.gravity) + forces_of_vehicles(bodies, level)


def agree(bodies: Bodies, give_way: Callable[[Array], Array], place: Array) -> Array:
    """Forces (axis, wheel) in N of the vehicles that agree with where they put their wheels, by Broyden's method."""
    force = forces_of_vehicles(bodies, place)
    place = give_way(force)
    miss = forces_of_vehicles(bodies, place) - force
    scale, B = float(np.abs(force).max()), None
    for _ in range(MOST_STEPS):
        size = float(np.abs(miss).max())
        if size <= AGREE * scale:
            return force
        if B is None:
            B = _change_of_miss(bodies, give_way, force, place)
        step, part = np.linalg.solve(B, -miss.ravel()).reshape(miss.shape), 1.0
        while True:
            place = give_way(force + part * step)
            new = forces_of_vehicles(bodies, place) - force - part * step
            if np.abs(new).max() < size or part < 1e-3:
                break
            part *= 0.5
        moved, gained = part * step.ravel(), (new - miss).ravel()
        B = B + np.outer(gained - B @ moved, moved) / (moved @ moved)
        force, miss = force + part * step, new
    raise EquilibriumError(
        "no state was found in which the vehicles and their lines rest together; check the stiffnesses of the "
        "vehicles, or write run.start.with_loads: false"
    )


def _change_of_miss(bodies: Bodies, give_way: Callable[[Array], Array], force: Array, place: Array) -> Array:
    """How the disagreement changes with each force, (force, force): -1, and what the line gives way to."""
    size, change = PROBE * float(np.abs(force).max()), -np.eye(force.size)
    own = forces_of_vehicles(bodies, place)
    for j in range(force.size):
        probe = np.zeros(force.size)
        probe[j] = size
        moved = np.zeros(force.size)
        moved[j] = 1e-3  # m: does a vehicle care where this wheel is?
        if np.array_equal(forces_of_vehicles(bodies, place + moved.reshape(force.shape)), own):
            continue
        away = give_way(force + probe.reshape(force.shape))
        change[:, j] += (forces_of_vehicles(bodies, away) - own).ravel() / size
    return change


def loaded_bodies(bodies: Bodies, place: Array) -> Bodies:
    """A copy of all bodies as they stand on wheels at places (axis, wheel) in m, payloads hanging straight down."""
    bodies, dim = bodies.copy(), place.shape[0]
    bodies.wheels["r"][:, :dim], bodies.wheels["v"], bodies.coordinates["v"] = place.T, 0.0, 0.0
    for v, vehicle in enumerate(bodies.vehicles):
        n, count, first = int(vehicle["coordinates"]), int(vehicle["wheels"]), int(vehicle["first"])
        wheel, axis = bodies.wheel[v, :count], bodies.axis[v, :count]
        bodies.coordinates["q"][first : first + n] = coordinates_at_rest(bodies, v, place[axis, wheel], place[-1])
        for tether in bodies.tethers:
            if tether["first"] == first:
                hanging = place[:, tether["wheel"]].copy()
                hanging[-1] -= tether["length"] - bodies.load[v, dim - 1] / tether["stiffness"]
                bodies.coordinates["q"][first : first + dim] = hanging
    return bodies


def potential_of(bodies: Bodies, gravity: Array) -> float:
    """Energy of the weights of all bodies, zero at z = 0, and what their springs store, J."""
    dim = gravity.size
    r, mass = bodies.wheels["r"][:, :dim], bodies.wheels["mass"][:, dim - 1]
    total = -float((mass * gravity[-1] * r[:, -1]).sum())
    for i, vehicle in enumerate(bodies.vehicles):
        n, count, first = int(vehicle["coordinates"]), int(vehicle["wheels"]), int(vehicle["first"])
        own, locations = slice(first, first + n), (bodies.wheel[i, :count], bodies.axis[i, :count])
        u = np.concatenate((bodies.coordinates["q"][own], r[locations]))
        total += 0.5 * float(u @ bodies.K[i, : u.size, : u.size] @ u) - float(bodies.load[i, : u.size] @ u)
    for tether in bodies.tethers:
        if tether["on"]:
            own = slice(int(tether["first"]), int(tether["first"]) + dim)
            way = bodies.coordinates["q"][own] - r[tether["wheel"]]
            across = tether["across"][:dim]
            longer = float(np.linalg.norm(way - (across @ way) * across)) - float(tether["length"])
            if (tether["way"] == PULLS and longer < 0.0) or (tether["way"] == PUSHES and longer > 0.0):
                continue
            total += 0.5 * float(tether["stiffness"]) * longer * longer
    for buffer in bodies.buffers:
        deep = buffer["side"] * (r[buffer["wheel"], -1] - bodies.coordinates["q"][buffer["coordinate"]])
        total += 0.5 * float(buffer["stiffness"]) * max(float(deep), 0.0) ** 2
    return total
