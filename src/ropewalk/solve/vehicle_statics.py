"""Statics of vehicles: how they stand on their wheels, and what these press on their lines with."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import Array
from ropewalk.solve.start import Setting


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


def resting_forces(setting: Setting) -> Array:
    """Forces of all bodies at rest on lines on which all wheels are at one height, (axis, wheel) N."""
    level = np.zeros((len(setting.axes), len(setting.wheels)))
    if setting.fleet is None:
        return level
    bodies = setting.fleet.bodies
    return weights_of_wheels(bodies, setting.strands.gravity) + forces_of_vehicles(bodies, level)
